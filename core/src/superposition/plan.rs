//! The plan: which components this scene needs, with which settings, why, at what error and cost.
//!
//! No more is modelled than a scene needs: a scene without movable objects has no irradiance volume,
//! one without area emitters no shadow-ray sampling, one that reflects nothing no radiosity. Expected
//! errors follow from the square-root law of sampling, anchored at figures the tests hold; expected
//! costs from ray counts at a stated rate, to be compared with what `report.json` then measures.

use crate::{
    irradiance_volume::VolumeSettings,
    radiosity::RadiositySettings,
    scene::{Scene, emitters::Emitter, world::World},
    transport::live::SolveSettings,
};

/// Tolerance the settings' defaults were measured at: median relative error of surface irradiance.
pub const DEFAULT_TOLERANCE: f32 = 0.04;

/// Incoherent rays a second assumed for expected cost, on two cores.
const RAYS_PER_SECOND: f64 = 4.0e6;

/// What will be computed for a scene, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// One line a component.
    pub lines: Vec<PlanLine>,
    /// Settings of the solvers.
    pub solve: SolveSettings,
    /// Shadow rays an area emitter and pixel for pictures written to files.
    pub direct_samples: u32,
}

/// One component of the plan.
#[derive(Clone, Debug, PartialEq, serde::Serialize)]
pub struct PlanLine {
    /// Name of the component.
    pub component: String,
    /// Whether it is computed at all.
    pub used: bool,
    /// Its settings in words, with units.
    pub settings: String,
    /// Why it is needed or left out.
    pub reason: String,
    /// Expected relative error of its part, median; `None` where it is exact.
    pub expected_error: Option<f32>,
    /// Expected cost on two cores, s.
    pub expected_seconds: f64,
    /// Whether the user's override decided.
    pub overridden: bool,
}

impl Plan {
    /// Reads a scene and a tolerance (median relative error wanted of surface irradiance).
    pub fn new(scene: &Scene, world: &World, tolerance: f32, seed: u64) -> Self {
        let tolerance = if tolerance.is_finite() { tolerance.clamp(0.005, 0.5) } else { DEFAULT_TOLERANCE };
        let effort = (DEFAULT_TOLERANCE / tolerance).powi(2);
        let over = &scene.plan;
        let area_emitters = world.emitters.list.iter().filter(|e| matches!(e, Emitter::Area(_))).count();
        let reflects = world.geometry.materials.iter().any(|m| m.reflectance != glam::Vec3::ZERO);
        let movable = scene.objects.iter().filter(|o| o.movable).count();

        let mut radiosity = RadiositySettings { seed, ..RadiositySettings::default() };
        radiosity.gather_rays =
            over.gather_rays.unwrap_or((radiosity.gather_rays as f32 * effort).clamp(16.0, 4096.0) as u32);
        radiosity.shadow_rays =
            over.shadow_rays.unwrap_or((radiosity.shadow_rays as f32 * effort).clamp(4.0, 256.0) as u32);
        radiosity.element_spacing_m = over.element_spacing_m;
        if !reflects {
            radiosity.gather_rays = 1;
        }
        let wants_volume = over.volume.unwrap_or(movable > 0);
        let volume = wants_volume.then(|| {
            let mut settings =
                VolumeSettings { seed, samples: over.volume_samples, ..VolumeSettings::default() };
            settings.second_level = over.volume_second_level.unwrap_or(settings.second_level);
            settings.bins_n = over.volume_bins_n.unwrap_or(settings.bins_n);
            settings
        });
        let direct_samples = if area_emitters == 0 { 1 } else { (16.0 * effort).clamp(1.0, 256.0) as u32 };

        let elements = expected_elements(world, radiosity.element_spacing_m);
        let lines = vec![
            line(
                "emitted",
                !world.emitters.is_empty(),
                String::new(),
                format!("{} emitters, {area_emitters} of them surfaces", world.emitters.len()),
                None,
                0.0,
            ),
            line(
                "direct",
                !world.emitters.is_empty(),
                format!("{direct_samples} shadow rays an area emitter and pixel"),
                if area_emitters == 0 {
                    "no area emitters: one ray a lamp is exact".into()
                } else {
                    "area emitters cast soft shadows; exact outside penumbrae, at worst this in the middle of one".into()
                },
                (area_emitters > 0).then_some(0.5 / (direct_samples as f32).sqrt()),
                0.0,
            ),
            PlanLine {
                overridden: over.gather_rays.is_some()
                    || over.element_spacing_m.is_some()
                    || over.shadow_rays.is_some(),
                ..line(
                    "radiosity",
                    reflects,
                    format!(
                        "{} gather rays an element, elements every {}",
                        radiosity.gather_rays,
                        radiosity.element_spacing_m.map_or("1/80 of the scene".into(), |s| format!("{s} m"))
                    ),
                    if reflects {
                        "surfaces reflect diffusely".into()
                    } else {
                        "nothing reflects: no indirect light".into()
                    },
                    reflects.then_some(tolerance),
                    if reflects {
                        elements * f64::from(radiosity.gather_rays) / RAYS_PER_SECOND
                    } else {
                        0.0
                    },
                )
            },
            PlanLine {
                overridden: over.volume.is_some()
                    || over.volume_samples.is_some()
                    || over.volume_bins_n.is_some(),
                ..line(
                    "irradiance volume",
                    wants_volume,
                    volume.as_ref().map_or(String::new(), |v| {
                        format!("{} bins a sample, second level {}³", 2 * v.bins_n * v.bins_n, v.second_level)
                    }),
                    match (over.volume, movable) {
                        (Some(_), _) => "asked for".into(),
                        (None, 0) => "nothing can be moved: not built".into(),
                        (None, n) => format!("{n} movable objects are lit from it"),
                    },
                    wants_volume.then_some(1.5 * tolerance),
                    volume
                        .as_ref()
                        .map_or(0.0, |v| 2_287.0 * f64::from(2 * v.bins_n * v.bins_n) / RAYS_PER_SECOND),
                )
            },
        ];
        Self { lines, solve: SolveSettings { radiosity, volume, preview: false }, direct_samples }
    }

    /// Settings of the irradiance volume; plans one where the scene needs none.
    pub fn volume_settings(&mut self) -> &mut VolumeSettings {
        let seed = self.solve.radiosity.seed;
        self.solve.volume.get_or_insert_with(|| VolumeSettings { seed, ..VolumeSettings::default() })
    }
}

/// Elements the radiosity room will likely lay out: a grid on large faces, some for each small one.
fn expected_elements(world: &World, spacing_m: Option<f32>) -> f64 {
    let geometry = &world.geometry;
    let (low, high) = geometry.bounds();
    let spacing = spacing_m.unwrap_or((high - low).length() / 80.0).max(f32::MIN_POSITIVE);
    let area: f64 =
        (0..geometry.len() as u32).map(|t| 0.5 * f64::from(geometry.area_normal(t).length())).sum();
    (area / f64::from(spacing).powi(2)).min(24_000.0) + 0.45 * geometry.len() as f64
}

fn line(
    component: &str,
    used: bool,
    settings: String,
    reason: String,
    expected_error: Option<f32>,
    expected_seconds: f64,
) -> PlanLine {
    PlanLine {
        component: component.into(),
        used,
        settings,
        reason,
        expected_error,
        expected_seconds,
        overridden: false,
    }
}
