//! Glossy reflection in object space: particles of light, splatted with the lobe they meet (Bastos 1999, §7.3).
//!
//! Emitters send particles, each with a share of their flux; wherever one meets what reflects, its direction and
//! what is left of it are kept, and it goes on as the surface scatters it ([`trace`]). Nothing of that depends on
//! the eye. A picture sums the particles around each of its points, each times the lobe between where it came
//! from and the eye, under a Gaussian ([`splat`]). Straight light, whose highlights and shadows the Gaussian
//! blurs, may be left out of that and evaluated at the point instead ([`straight`]).
//!
//! More particles refine what there is: a particle keeps what is left of it, not its flux, which is the emitter's
//! over the number sent so far (Eq. 7.4).
//!
//! Gathered at each pixel from a sorted grid, not splatted as triangles: the same sum, without one triangle for
//! every particle.
//!
//! Limits. The sum is the radiance convolved with the Gaussian, so its bias is 0.086 h² ΔL to second order, h the
//! radius, where the surface goes on; within a radius of a surface's edge the Gaussian reaches past it and
//! up to half of the light is lost, three quarters at a rectangular corner; shadows leak by the same radius. Its
//! variance is that of the lobe's value over some dozens of particles, so lobes narrower than the light they mirror
//! need very many. Neither particles nor straight light pass glass: what is glossy is dark behind it.
//!
//! As a method of the picture (`glossy: particles`) they are a part of the solution ([`light`]): a lamp that is dimmed
//! costs the sorting alone, one that is moved its own particles. [`gpu`] is the twin of [`pass`].

pub mod emission;
pub mod gpu;
pub mod inspect;
pub mod light;
pub mod pass;
pub mod splat;
pub mod straight;
pub mod trace;
