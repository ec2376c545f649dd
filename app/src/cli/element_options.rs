//! How radiosity's elements are laid out: options that override the plan of the scene file.

use anyhow::bail;
use clap::Args;
use lumenscope_core::scene::file::PlanOverrides;

/// Options of the elements.
#[derive(Args, Clone)]
pub struct ElementOptions {
    /// Distance between radiosity elements, m.
    #[arg(long, global = true)]
    element_spacing: Option<f32>,
    /// Times that a cell of that size may be split where light bends, 0 to 4.
    #[arg(long, global = true)]
    element_levels: Option<u8>,
    /// Deviation from bilinear that is let be on an unsplit cell, relative to the irradiance.
    #[arg(long, global = true)]
    element_tolerance: Option<f32>,
    /// Cells that share an edge differ by one level at most.
    #[arg(long, global = true, num_args = 0..=1, default_missing_value = "true")]
    element_restricted: Option<bool>,
}

impl ElementOptions {
    /// Takes over the options that were given; the others stay as the scene file has them.
    ///
    /// # Errors
    /// The first value that cannot be used.
    pub fn apply(&self, over: &mut PlanOverrides) -> anyhow::Result<()> {
        over.element_spacing_m = self.element_spacing.or(over.element_spacing_m);
        over.element_levels = self.element_levels.or(over.element_levels);
        over.element_tolerance = self.element_tolerance.or(over.element_tolerance);
        over.element_restricted = self.element_restricted.or(over.element_restricted);
        match over.problem() {
            Some((name, value)) => bail!("{name} cannot be {value}"),
            None => Ok(()),
        }
    }
}
