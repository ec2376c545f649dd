//! A solution that follows the user: what a change touches is redone, the rest is kept.
