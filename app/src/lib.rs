//! The lumenscope program: its window, its panels and its command line.

pub mod command;
pub mod session;
pub mod viewport;
pub mod widgets;
