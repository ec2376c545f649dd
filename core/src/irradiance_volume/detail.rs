//! How finely, and how shiny, moving objects are lit from the volume.

use super::moments::Order;
use crate::math::frame::mirrored;
use glam::Vec3;

/// How finely a dynamic object asks the volume.
#[derive(
    Clone, Copy, Debug, Default, PartialEq, Eq, PartialOrd, Ord, Hash, serde::Serialize, serde::Deserialize,
)]
pub enum Detail {
    /// At a few of the vertices; the others blend their neighbours. For objects of many vertices in motion.
    Coarse,
    /// At every vertex; triangles blend their corners.
    Vertices,
    /// At every node, so that large triangles show what happens inside them.
    #[default]
    Fine,
    /// At every pixel, as fine as the volume itself, by the processor: a graphics device has no volume to ask, and
    /// where it must make the picture it is given every node.
    Pixels,
}

impl Detail {
    /// Every level, the coarsest first.
    pub const ALL: [Self; 4] = [Self::Coarse, Self::Vertices, Self::Fine, Self::Pixels];

    /// Name on screen.
    pub fn name(self) -> &'static str {
        match self {
            Self::Coarse => "coarse",
            Self::Vertices => "vertices",
            Self::Fine => "fine",
            Self::Pixels => "pixels",
        }
    }
}

/// How objects that may be moved shine: by a moment of the volume, seen from somewhere (Greger 1996, §4.4 and
/// Fig. 4.18).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gloss {
    /// Order of the moment; 1 is diffuse.
    pub order: Order,
    /// Where the eye is, m.
    pub eye: Vec3,
}

impl Gloss {
    /// The direction a surface asks the volume about: its normal at order 1, else the view vector mirrored at
    /// it.
    pub fn towards(&self, position: Vec3, normal: Vec3) -> Vec3 {
        if self.order == Order::IRRADIANCE {
            return normal;
        }
        mirrored((self.eye - position).normalize_or(normal), normal)
    }
}
