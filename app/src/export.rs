//! Pictures and layers as files.

use crate::worker::ExportRequest;
use anyhow::{Result, bail};
use lumenscope_core::math::progress::Progress;

/// Writes what was asked for.
///
/// # Errors
/// With the file's name, if it cannot be written; [`Cancelled`](lumenscope_core::math::progress::Cancelled).
pub fn write(request: &ExportRequest, progress: &Progress) -> Result<()> {
    progress.begin("picture");
    progress.report(0.0)?;
    bail!("{}: pictures cannot be written yet", request.path.display())
}
