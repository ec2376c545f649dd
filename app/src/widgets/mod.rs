//! Widgets that show a quantity of light: legends, spheres, plots, tables.

pub mod beside;
pub mod field;
pub mod legend;
pub mod moments;
pub mod number;
pub mod placement_map;
pub mod radial_plot;
pub mod resolutions;
mod shades;
pub mod sphere_image;
pub mod sphere_inspector;
pub mod sphere_numbers;
pub mod sphere_pair;
pub mod unfolded;
pub mod value_table;
pub mod volume_pair;

pub use lumenscope_core::irradiance_volume::probe::Probe;
