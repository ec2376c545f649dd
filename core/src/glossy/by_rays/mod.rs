//! The lobe by rays: what the convolutions are held to.

pub mod pass;
