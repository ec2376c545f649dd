//! Lines of a plan: components, what is expected of them, and who decided their settings.

use crate::scene::file::PlanOverrides;

/// A part of the light that a plan computes or leaves out.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum Component {
    /// What emitters send straight to the eye.
    Emitted,
    /// Light straight from the emitters.
    Direct,
    /// Diffuse interreflection on surfaces.
    Radiosity,
    /// Light in the air.
    IrradianceVolume,
    /// What flat polished surfaces show.
    Mirror,
    /// What glossy surfaces make of that.
    Glossy,
}

impl Component {
    /// Every component, in the order of the plan.
    pub const ALL: [Self; 6] =
        [Self::Emitted, Self::Direct, Self::Radiosity, Self::IrradianceVolume, Self::Mirror, Self::Glossy];

    /// Name, that of the stage in a solution's provenance too.
    pub fn name(self) -> &'static str {
        match self {
            Self::Emitted => "emitted",
            Self::Direct => "direct",
            Self::Radiosity => "radiosity",
            Self::IrradianceVolume => "irradiance volume",
            Self::Mirror => "mirror",
            Self::Glossy => "glossy",
        }
    }

    /// Whether overrides fix any of its settings.
    pub fn is_overridden(self, over: &PlanOverrides) -> bool {
        self.freed(over) != *over
    }

    /// The overrides without those of this component: it is automatic again.
    pub fn freed(self, over: &PlanOverrides) -> PlanOverrides {
        let over = over.clone();
        match self {
            Self::Emitted => over,
            Self::Direct => PlanOverrides { direct_samples: None, ..over },
            Self::Radiosity => PlanOverrides {
                element_spacing_m: None,
                element_levels: None,
                element_tolerance: None,
                element_restricted: None,
                gather_rays: None,
                shadow_rays: None,
                lookup: None,
                reconstruction: None,
                ..over
            },
            Self::Mirror => PlanOverrides { mirror_depth: None, mirrors: None, mirror_images: None, ..over },
            Self::Glossy => {
                PlanOverrides { glossy: None, glossy_particles: None, glossy_depth: None, ..over }
            }
            Self::IrradianceVolume => PlanOverrides {
                volume: None,
                volume_samples: None,
                volume_second_level: None,
                volume_target_samples: None,
                volume_pocket_samples: None,
                volume_refine_tolerance: None,
                volume_refine_geometry: None,
                volume_supersample: None,
                volume_informed_rays: None,
                volume_specular_cutoff: None,
                volume_back_face_limit: None,
                volume_ignored: None,
                volume_bins_n: None,
                volume_basis: None,
                volume_repair: None,
                volume_guard: None,
                volume_moments: None,
                ..over
            },
        }
    }
}

/// Error expected of a component, relative, median over its points.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
#[serde(rename_all = "snake_case")]
pub enum ExpectedError {
    /// None but rounding.
    Exact,
    /// This share of the value.
    Median(f32),
    /// Not known for these settings.
    Unknown,
}

/// One component of the plan.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PlanLine {
    /// The component.
    pub component: Component,
    /// Whether it is computed at all.
    pub used: bool,
    /// Its settings in words, with units.
    pub settings: String,
    /// Why it is needed or left out.
    pub reason: String,
    /// Expected error of its part.
    pub expected_error: ExpectedError,
    /// Where the expected error comes from.
    pub error_basis: String,
    /// Expected cost on two cores, s.
    pub expected_seconds: f64,
    /// Whether an override, of the scene file or the user, decided one of its settings.
    pub overridden: bool,
}
