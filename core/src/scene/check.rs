//! What in a scene would make light wrong.
