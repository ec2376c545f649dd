//! Glossy reflection: the mirror image convolved with the lobe of the material (Bastos 1999, ch. 7).
//!
//! A flat glossy surface scatters what it mirrors. What a point would see within its lobe is taken from the
//! mirror image around its pixel ([`crate::mirror`] makes it, with the distance of everything in it), and
//! the lobe becomes a kernel over that image. [`invariant`] has one kernel for the whole reflector;
//! [`variant`] evaluates the lobe of each pixel at the place of each pixel around it, so that what touches
//! the surface stays sharp and what is far off is blurred, as far apart as the mirror image knows them to be.
//! Both divide by the sum of their weights: constant light stays constant, up to the reflectance.
//!
//! Not the feed-forward splats of the thesis's Program 7.17: with a kernel that varies they do not keep a
//! constant image constant. And not kernel textures: evaluating the lobe is as cheap as looking it up.
//! Its library by cos θ ([`lobes`]) holds what an evaluation cannot give: how far a lobe reaches, how much
//! of the light it keeps, and at which angle the Fresnel equation stands for all of it.
//!
//! At half resolution ([`pass`]) the variant kernel is summed at every second pixel of every second row where it is
//! large, and what lies between shows the mean of the nodes that show the same. What one kernel over the picture's own
//! pixels would give, directly or by Fourier transforms, is in [`convolution`]. All are held to the lobe by rays
//! ([`by_rays`]) in the same light, which tells the error of convolving from that of the light.
//!
//! What is curved has no mirror image, but a map of the light around it, as has what is glossy in a mirror:
//! [`environment`]. In object space, without any mirror image, [`particles`] of light make the same.
//!
//! Limits. What the mirror image does not show (behind its edges and what stands in front, the visibility
//! assumption of §7.4.1) is taken to look as what it shows. Surfaces seen at grazing angles have few pixels
//! to draw on. Lobes narrower than roughness 0.2 show their mirror image unblurred where a mirror shows them.

pub mod by_rays;
pub mod convolution;
pub mod environment;
pub mod gpu;
pub mod inspect;
pub mod inspect_maps;
pub mod inspect_point;
pub mod invariant;
pub mod kernel;
pub mod lobes;
pub mod particles;
pub mod pass;
pub mod pyramid;
pub mod variant;

pub use crate::scene::glossy::GlossyMethod;
