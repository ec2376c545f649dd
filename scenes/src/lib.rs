//! Generators of the scenes that lumenscope ships.
//!
//! Every scene is a binary glTF model and a RON file that adds what glTF lacks: what may be dragged,
//! where illuminance is measured, the first view. The same source gives the same bytes on every run:
//! coordinates are computed in `f64` and rounded once, random choices come from fixed seeds, and
//! nothing reads the clock or the machine.

pub mod analytic;
pub mod cornell;
pub mod glass;
pub mod glb;
pub mod grotto;
pub mod house;
pub mod office;
pub mod pictures;
pub mod polished;
pub mod random;
pub mod shapes;
pub mod wall;
pub mod walls;

use std::path::PathBuf;

/// Every scene file: path relative to `scenes/`, and its bytes.
pub fn generate() -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    files.extend(office::files());
    files.extend(cornell::files());
    files.extend(analytic::files());
    files.extend(walls::files());
    files.extend(polished::files());
    files.extend(glass::files());
    files.extend(house::files());
    files
}
