//! Glossy reflection: kernels, particles, maps, each against a closed form or against rays.

mod commands;
mod depth;
mod environment;
mod footprint;
mod frames;
mod kernels;
mod particle_light;
mod particles;
mod setting;
mod teapot;
