//! The wgpu side: device, shaders, buffers, readback.
//!
//! Every pass here is the twin of a CPU function that specifies it and names it; a test compares the
//! two. The GPU shows, it does not solve: what it draws was computed by the solvers.

pub mod clock;
pub mod device;
pub mod emitters;
pub mod frame;
mod indices;
pub mod inspection;
pub mod offline;
mod picture;
pub(crate) mod pipelines;
mod read;
mod readback;
pub mod renderer;
pub(crate) mod scene;
pub mod shaders;
pub(crate) mod storage;
pub mod tables;
pub(crate) mod targets;

pub use clock::{Stage, StageClock};
pub use device::{GpuContext, GpuError, required_features, required_limits};
pub use frame::FrameSettings;
pub use renderer::GpuRenderer;
