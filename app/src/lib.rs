//! The lumenscope program: its window, its panels and its command line.

pub mod app;
pub mod cli;
pub mod command;
pub mod copies;
pub mod document;
pub mod examples;
pub mod export;
pub mod grid_view;
pub mod history;
pub mod journal;
pub mod light_paths;
pub mod lightmaps;
pub mod panels;
pub mod panoramas;
pub mod pipeline;
pub mod placement;
pub mod session;
pub mod session_file;
pub mod theme;
pub mod viewport;
pub mod wall;
pub mod widgets;
pub mod window;
pub mod worker;

pub use app::LumenscopeApp;
pub use window::run_window;
