//! Images-with-depth: what a reflector mirrors, sampled beforehand and shown from where one looks
//! (Bastos 1999, §6.6).
//!
//! A reflector is cut into elements; behind each stands a hemisphere of centres of projection, and from each
//! of those a picture is taken through the element, with the distance of every pixel ([`sample`]). To show
//! the reflector, the samples nearest to the mirrored eye are chosen ([`select`]), their pixels put into the
//! scene as points and seen from the mirrored eye ([`mod@reproject`]). The price is that of the pictures' pixels,
//! whatever the scene; what no chosen sample has seen stays a hole.
//!
//! Pixels keep the triangle they saw and the place on it (images-with-ids, §6.8), so that their colour is
//! read anew from the radiosity when a lamp changes, and nothing is traced. Points of many samples are many
//! times the same surface: a layered image ([`layered`]) keeps each once.
//!
//! Limits. Colours must not depend on where one looks from: what is mirrored in the mirror is left out, and
//! shown are emitted and diffuse light alone. Points are treated as small squares that face their sample, so
//! surfaces that run away from it are thinner than they should be and show cracks from elsewhere.

pub mod inspect;
pub mod layered;
pub mod pass;
pub mod reproject;
pub mod sample;
pub mod select;

pub use layered::LayeredImage;
pub use reproject::{Reprojected, Splat, reproject};
pub use sample::{ImageWithDepth, Point, ReflectorImages, SampleSettings};
pub use select::Selection;
