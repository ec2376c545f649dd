//! Glossy reflection: kernels, particles, maps, each against a closed form or against rays.

mod commands;
mod depth;
mod environment;
mod kernels;
mod particle_light;
mod particles;
mod teapot;
