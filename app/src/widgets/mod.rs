//! Widgets that show a quantity of light: legends, spheres, plots, tables.

pub mod legend;
pub mod sphere_inspector;

/// Light at one point in the air, for every direction.
#[derive(Clone, Debug, Default)]
pub struct Probe {}
