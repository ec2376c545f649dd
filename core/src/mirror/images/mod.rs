//! Images-with-depth: what a reflector mirrors, sampled beforehand and shown from where one looks
//! (Bastos 1999, §6.6).
//!
//! A reflector is cut into elements; behind each stands a hemisphere of centres of projection, and from each
//! of those a picture is taken through the element, with the distance of every pixel ([`elements`], [`sample`], [`sets`]). To show
//! the reflector, the samples nearest to the mirrored eye are chosen ([`select`]), what of their pixels may be in
//! sight ([`visible`]) is put into the scene as points, and seen from the mirrored eye ([`mod@reproject`]). The price
//! is that of the pictures' pixels, whatever the scene; what no chosen sample has seen stays a hole.
//!
//! Pixels keep the triangle they saw (images-with-ids, §6.8). So pictures read the light of what a point shows from
//! the radiosity, where the pixel's own ray meets the point's triangle: a lamp that changes costs nothing, textures
//! stay sharp, and other mirrors are seen in it. Holes reflect as if dull. With the colours kept in the pixels, as the
//! thesis has them, points are shown by themselves ([`pass`]). Points of many samples are many times the same
//! surface: a layered image ([`layered`]) keeps each once.
//!
//! Something that moves costs the rays that meet it ([`follow`]): images are kept through a drag.
//!
//! Limits. Images stand for views of depth 1, mirrors in them are drawn from the geometry. While a large reflector
//! itself moves mirrors are shown from the geometry, until its images are taken anew. Points are treated as small
//! squares that face their sample, so surfaces that run away from it are thinner than they should be and show cracks
//! from elsewhere.

pub mod elements;
pub mod follow;
pub mod gpu;
pub mod inspect;
pub mod layered;
pub mod pass;
pub mod reproject;
pub mod sample;
pub mod select;
pub mod sets;
pub mod visible;

pub use elements::SampleSettings;
pub use layered::LayeredImage;
pub use reproject::{Reprojected, Splat, reproject};
pub use sample::{ImageWithDepth, NOTHING, Point};
pub use select::Selection;
pub use sets::{ImagesError, MirrorImages, ReflectorImages};
