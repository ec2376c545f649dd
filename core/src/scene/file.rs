//! The RON scene file: models to load, and what model files lack. Documented in `scenes/README.md`.

use super::{
    MeasuringPlane,
    camera::Camera,
    glossy::GlossyMethod,
    lookup::{Lookup, Reconstruction},
    mirrors::MirrorMethod,
    volume::{Basis, Repair},
};
use crate::math::moment::Order;
use glam::Vec3;
use serde::{Deserialize, Serialize};

/// A RON scene. Every field may be left out.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct SceneFile {
    /// Model files (glTF, GLB, OBJ), relative to the RON file.
    pub models: Vec<ModelEntry>,
    /// Point, spot and directional lamps.
    pub lamps: Vec<LampEntry>,
    /// Rectangular area lamps, textured or not.
    pub area_lamps: Vec<AreaLampEntry>,
    /// Names of objects that may be dragged; `*` at the end matches any rest of a name.
    pub movable: Vec<String>,
    /// Names of materials whose lobe is Phong's instead of GGX's, as wide; `*` as there.
    pub phong: Vec<String>,
    /// First view; without one the camera of the model file, or one that frames everything.
    pub camera: Option<Camera>,
    /// Planes on which illuminance is measured.
    pub planes: Vec<MeasuringPlane>,
    /// Overrides of the rendering plan.
    pub plan: PlanOverrides,
}

/// A model file and where it stands.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct ModelEntry {
    /// Path relative to the scene file.
    pub file: String,
    /// Name given to the objects of an OBJ file; by default the file's stem.
    #[serde(default)]
    pub name: Option<String>,
    /// Position, m.
    #[serde(default)]
    pub translate: Vec3,
    /// Turn about the y axis, degrees, counter-clockwise from above.
    #[serde(default)]
    pub rotate_y_deg: f32,
    /// Scale: metres per unit of the file.
    #[serde(default = "one")]
    pub scale: f32,
    /// Whether all its objects may be dragged.
    #[serde(default)]
    pub movable: bool,
}

/// A lamp without a surface.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub enum LampEntry {
    /// The same intensity everywhere.
    Point {
        /// Name shown.
        name: String,
        /// Position, m.
        at: Vec3,
        /// Intensity, cd per channel.
        intensity: Vec3,
    },
    /// A cone of light.
    Spot {
        /// Name shown.
        name: String,
        /// Position, m.
        at: Vec3,
        /// Point it is aimed at, m.
        towards: Vec3,
        /// Intensity on the axis, cd per channel.
        intensity: Vec3,
        /// Half angle of the full cone, degrees.
        inner_deg: f32,
        /// Half angle of the dark, degrees.
        outer_deg: f32,
    },
    /// Parallel light.
    Directional {
        /// Name shown.
        name: String,
        /// Direction the light travels.
        direction: Vec3,
        /// Illuminance on a plane facing it, lx per channel.
        illuminance: Vec3,
    },
}

/// A rectangular lamp; it emits from the side of `edge_u × edge_v`.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct AreaLampEntry {
    /// Name shown.
    pub name: String,
    /// Corner, m.
    pub corner: Vec3,
    /// First edge, m.
    pub edge_u: Vec3,
    /// Second edge, m.
    pub edge_v: Vec3,
    /// Radiance, cd/m² per channel.
    pub radiance: Vec3,
    /// Picture multiplied into the radiance, relative to the scene file.
    #[serde(default)]
    pub texture: Option<String>,
    /// Whether it emits from both sides.
    #[serde(default)]
    pub double_sided: bool,
}

/// Settings of the rendering plan that the user fixes; the rest is chosen from the scene.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(default, deny_unknown_fields)]
pub struct PlanOverrides {
    /// Distance between radiosity elements, m.
    pub element_spacing_m: Option<f32>,
    /// Times that a cell of that size may be split where light bends, 0 to 4.
    pub element_levels: Option<u8>,
    /// Deviation from bilinear that is let be on a cell of that size, relative to the irradiance.
    pub element_tolerance: Option<f32>,
    /// Whether cells that share an edge differ by one level at most.
    pub element_restricted: Option<bool>,
    /// Gather rays an element.
    pub gather_rays: Option<u32>,
    /// Shadow rays an area emitter and element.
    pub shadow_rays: Option<u32>,
    /// How pictures look up what is stored on surfaces.
    pub lookup: Option<Lookup>,
    /// What becomes of it before.
    pub reconstruction: Option<Reconstruction>,
    /// Shadow rays an area emitter and pixel of pictures written to files.
    pub direct_samples: Option<u32>,
    /// Mirrors that light is followed through on its way to the eye; 0 shows none.
    pub mirror_depth: Option<u32>,
    /// Where what flat mirrors show comes from.
    pub mirrors: Option<MirrorMethod>,
    /// Images-with-depth an element that stand for a mirrored view.
    pub mirror_images: Option<u32>,
    /// How the layer `glossy` is made.
    pub glossy: Option<GlossyMethod>,
    /// Glossy reflections, one seen in the other, that maps of the light around reflectors hold, 1 or more.
    pub glossy_depth: Option<u32>,
    /// Particles of light that it is made of where it is made of them.
    pub glossy_particles: Option<u32>,
    /// Whether an irradiance volume is built.
    pub volume: Option<bool>,
    /// Samples along each axis of the volume's first level.
    pub volume_samples: Option<[u32; 3]>,
    /// Samples along each axis of a second-level grid.
    pub volume_second_level: Option<u32>,
    /// Rows of direction bins a hemisphere: 2n² bins.
    pub volume_bins_n: Option<u32>,
    /// Samples of the volume over both levels that the grid stays within.
    pub volume_target_samples: Option<u32>,
    /// Samples of the volume beside those, for places that the others stand for badly.
    pub volume_pocket_samples: Option<u32>,
    /// Divides cells of the volume in which interpolation errs by more than this share, instead of those
    /// with geometry.
    pub volume_refine_tolerance: Option<f32>,
    /// Whether cells with geometry are divided beside those.
    pub volume_refine_geometry: Option<bool>,
    /// Radiance rays a bin of the volume.
    pub volume_supersample: Option<u32>,
    /// Extra radiance rays a sample of the volume, aimed at what is bright.
    pub volume_informed_rays: Option<u32>,
    /// Share of a ray's light left after mirrors below which it is given up.
    pub volume_specular_cutoff: Option<f32>,
    /// Share of a sample's rays that may meet backs before it counts as inside a solid.
    pub volume_back_face_limit: Option<f32>,
    /// Objects, lamps and materials that the volume leaves out as sources of light, by name.
    pub volume_ignored: Option<Vec<String>>,
    /// What queries of the volume read.
    pub volume_basis: Option<Basis>,
    /// What is done with samples inside solids.
    pub volume_repair: Option<Repair>,
    /// Whether queries use only samples that see the point.
    pub volume_guard: Option<bool>,
    /// Orders of moments kept beside the irradiance.
    pub volume_moments: Option<Vec<Order>>,
}

impl PlanOverrides {
    /// The first setting that cannot be used, and its value.
    pub fn problem(&self) -> Option<(&'static str, String)> {
        let spacing = self.element_spacing_m.filter(|s| !(s.is_finite() && *s > 0.0));
        if let Some(spacing) = spacing {
            return Some(("element_spacing_m", spacing.to_string()));
        }
        if let Some(levels) = self.element_levels.filter(|levels| *levels > 4) {
            return Some(("element_levels", levels.to_string()));
        }
        if let Some(tolerance) = self.element_tolerance.filter(|t| !(t.is_finite() && *t > 0.0)) {
            return Some(("element_tolerance", tolerance.to_string()));
        }
        let shares = [
            ("volume_refine_tolerance", self.volume_refine_tolerance, 10.0),
            ("volume_specular_cutoff", self.volume_specular_cutoff, 1.0),
            ("volume_back_face_limit", self.volume_back_face_limit, 1.0),
        ];
        for (name, share, most) in shares {
            if let Some(share) = share.filter(|s| !(0.0..=most).contains(s)) {
                return Some((name, share.to_string()));
            }
        }
        let counts = [
            ("volume_target_samples", self.volume_target_samples),
            ("volume_supersample", self.volume_supersample),
            ("gather_rays", self.gather_rays),
            ("shadow_rays", self.shadow_rays),
            ("direct_samples", self.direct_samples),
            ("mirror_images", self.mirror_images),
            ("glossy_particles", self.glossy_particles),
            ("glossy_depth", self.glossy_depth),
            ("volume_second_level", self.volume_second_level),
            ("volume_bins_n", self.volume_bins_n),
            ("volume_samples", self.volume_samples.map(|s| s[0].min(s[1]).min(s[2]))),
        ];
        let zero = counts.into_iter().find(|(_, value)| *value == Some(0));
        zero.map(|(name, _)| (name, "0".into()))
    }
}

fn one() -> f32 {
    1.0
}
