//! The only file that names every room.
