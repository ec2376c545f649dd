//! Mirrors: flat surfaces that show the scene from a mirrored eye (Bastos 1999, ch. 6).
//!
//! A flat mirror is a window to the scene seen from the eye's mirror image. So every flat piece of a
//! polished material is a [`reflectors`] entry, the ones that can be seen, by way of each other too, get a
//! mirrored view ([`views`]), and the same passes that make the picture make what is seen in each, under
//! the mask of the reflector and cut off at its plane ([`pass`]). What comes back is the radiance that
//! arrives along the mirrored direction at each pixel, with its distance: times the Fresnel reflectance
//! it is the layer `mirror`; convolved first, the layer `glossy`.
//!
//! Not rays alone, although on the CPU a mirrored view is a bundle of reflected rays: a raster pass shows
//! the whole of a mirror at the price of one more picture, on any graphics card, and what has no
//! reflector in sight pays nothing. Where the scene is so complex that this price is too high, the plan's
//! `mirrors: images` shows mirrors from pictures with depth that were taken of it beforehand ([`images`]).
//!
//! Limits. Curved polished surfaces and wide lobes seen in mirrors have no mirrored view: they show a map of the
//! light around them ([`crate::glossy`] makes it), and what has none reflects as if its lobe were as wide as
//! the hemisphere, as do reflectors beyond the depth of recursion. Lamps without a surface are not seen in
//! mirrors.

pub use crate::scene::mirrors::MirrorMethod;

use crate::scene::file::PlanOverrides;

pub mod culling;
pub mod gpu;
pub mod images;
pub mod in_sight;
pub mod inspect;
pub mod pass;
pub mod reflectors;
pub mod thrown;
pub mod view_table;
pub mod views;
mod work;

/// Mirrored views that one frame shows, at most: the largest first at each depth.
pub const MOST_VIEWS: usize = 64;

/// Images-with-depth an element that stand for a mirrored view, if the plan does not say. Two, as in Bastos 1999,
/// §6.6.5, leave pixels in which what is bright and far shows through what none of the two has seen before it.
pub const IMAGES: u32 = 4;

/// The same, at most.
pub const MOST_IMAGES: u32 = 64;

/// How mirrors are followed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct MirrorSettings {
    /// Mirrors that light is followed through on its way to the eye; 0 shows none.
    pub depth: u32,
    /// Images-with-depth an element that stand for a mirrored view; `None` where it is made from the geometry.
    pub images: Option<u32>,
}

impl Default for MirrorSettings {
    /// A mirror in a mirror, from the geometry.
    fn default() -> Self {
        Self { depth: 2, images: None }
    }
}

impl MirrorSettings {
    /// Those of a scene: its plan's overrides, or the usual ones.
    pub fn of(plan: &PlanOverrides) -> Self {
        let usual = Self::default();
        let by_images = plan.mirrors.unwrap_or_default() == MirrorMethod::Images;
        Self {
            depth: plan.mirror_depth.unwrap_or(usual.depth).min(MOST_VIEWS as u32),
            images: by_images.then(|| plan.mirror_images.unwrap_or(IMAGES).clamp(1, MOST_IMAGES)),
        }
    }
}
