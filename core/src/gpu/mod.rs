//! The wgpu side: device, shaders, buffers, readback.
