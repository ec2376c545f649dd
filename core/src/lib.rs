#![doc = include_str!("../ARCHITECTURE.md")]

pub mod math;
pub mod scene;

pub mod glossy;
pub mod irradiance_volume;
pub mod mirror;
pub mod radiosity;
pub mod reference;

pub mod transport;

pub mod superposition;

pub mod gpu;
pub mod inspection;
pub mod io;
pub mod measure;
pub mod registry;
