//! The plan: which components this scene needs, with which settings, why, at what error and cost.
//!
//! No more is modelled than a scene needs: a scene without movable objects has no irradiance volume,
//! one without area emitters no shadow-ray sampling, one that reflects nothing no radiosity. Expected
//! errors of sampling follow from the square-root law, anchored at figures the tests hold; where no
//! measurement stands behind an error it is called unknown. Expected costs follow from ray counts at
//! a stated rate, to be compared with what `report.json` then measures. Every line can be overridden.

mod component;

pub use component::{Component, ExpectedError, PlanLine};

use crate::{
    glossy::{
        GlossyMethod, environment,
        particles::light,
        pass::{MOST_LOBES, key},
    },
    irradiance_volume::VolumeSettings,
    mirror::{MOST_VIEWS, MirrorSettings, images::MirrorImages, reflectors::Reflectors},
    radiosity::{RadiositySettings, subdivide::Subdivision, surface_map::ElementLayout},
    scene::{Scene, brdf::Lobe, emitters::Emitter, file::PlanOverrides, world::World},
    transport::live::SolveSettings,
};
use std::collections::BTreeSet;

/// Tolerance the settings' defaults were measured at: median relative error of surface irradiance.
pub const DEFAULT_TOLERANCE: f32 = 0.04;

/// Median relative error of the default volume, measured at 1,000 points and directions in the air of
/// the office against the path tracer, direct light interpolated.
const VOLUME_ERROR: f32 = 0.033;

/// Incoherent rays a second assumed for expected cost, on two cores.
const RAYS_PER_SECOND: f64 = 4.0e6;

/// Most gather rays that a tolerance alone asks for.
const MOST_GATHER_RAYS: f32 = 4096.0;

/// What will be computed for a scene, and why.
#[derive(Clone, Debug, PartialEq)]
pub struct Plan {
    /// One line a component.
    pub lines: Vec<PlanLine>,
    /// Settings of the solvers.
    pub solve: SolveSettings,
    /// Settings of the irradiance volume, whether it is built or not.
    pub volume: VolumeSettings,
    /// Shadow rays an area emitter and pixel for pictures written to files.
    pub direct_samples: u32,
}

/// What a plan reads off a scene.
struct Needs<'a> {
    world: &'a World,
    over: &'a PlanOverrides,
    tolerance: f32,
    area_emitters: usize,
    reflects: bool,
    movable: usize,
}

impl Plan {
    /// Reads a scene and a tolerance (median relative error wanted of surface irradiance).
    pub fn new(scene: &Scene, world: &World, tolerance: f32, seed: u64) -> Self {
        let tolerance = if tolerance.is_finite() { tolerance.clamp(0.005, 0.5) } else { DEFAULT_TOLERANCE };
        let effort = (DEFAULT_TOLERANCE / tolerance).powi(2);
        let over = &scene.plan;
        let needs = Needs {
            world,
            over,
            tolerance,
            area_emitters: world.emitters.list.iter().filter(|e| matches!(e, Emitter::Area(_))).count(),
            reflects: world
                .geometry
                .materials
                .iter()
                .any(|m| m.reflectance * m.diffuse_share() != glam::Vec3::ZERO),
            movable: scene.objects.iter().filter(|o| o.movable).count(),
        };
        let mut radiosity = RadiositySettings { seed, ..RadiositySettings::default() };
        let scaled = |rays: u32, least: f32, most: f32| (rays as f32 * effort).clamp(least, most) as u32;
        radiosity.gather_rays =
            over.gather_rays.unwrap_or(scaled(radiosity.gather_rays, 16.0, MOST_GATHER_RAYS));
        radiosity.shadow_rays = over.shadow_rays.unwrap_or(scaled(radiosity.shadow_rays, 4.0, 256.0));
        radiosity.element_spacing_m = over.element_spacing_m;
        let levels = over.element_levels.filter(|levels| *levels > 0);
        radiosity.subdivision = levels.map(|levels| Subdivision {
            levels,
            tolerance: over.element_tolerance.unwrap_or(Subdivision::default().tolerance),
            restricted: over.element_restricted.unwrap_or_default(),
        });
        if !needs.reflects {
            radiosity.gather_rays = 1;
        }
        let wanted = VolumeSettings::overridden(scene, seed);
        let volume = over.volume.unwrap_or(needs.movable > 0).then(|| wanted.clone());
        let automatic = if needs.area_emitters == 0 { 1 } else { scaled(16, 1.0, 256.0) };
        let direct_samples = over.direct_samples.unwrap_or(automatic);
        let lines = vec![
            needs.emitted(),
            needs.direct(direct_samples),
            needs.radiosity(&radiosity),
            needs.volume(volume.as_ref()),
            needs.mirror(),
            needs.glossy(),
        ];
        let solve = SolveSettings { radiosity, volume, preview: false };
        Self { lines, solve, volume: wanted, direct_samples }
    }

    /// Settings of the irradiance volume; plans one where the scene needs none.
    pub fn volume_settings(&mut self) -> &mut VolumeSettings {
        self.solve.volume.get_or_insert_with(|| self.volume.clone())
    }
}

impl Needs<'_> {
    fn line(&self, component: Component, used: bool, settings: String, reason: String) -> PlanLine {
        PlanLine {
            component,
            used,
            settings,
            reason,
            expected_error: ExpectedError::Exact,
            error_basis: "nothing is sampled".into(),
            expected_seconds: 0.0,
            overridden: component.is_overridden(self.over),
        }
    }

    fn emitted(&self) -> PlanLine {
        let emitters = &self.world.emitters;
        let reason = format!("{}, {} with a surface", counted(emitters.len(), "emitter"), self.area_emitters);
        self.line(Component::Emitted, !emitters.is_empty(), String::new(), reason)
    }

    fn direct(&self, samples: u32) -> PlanLine {
        let used = !self.world.emitters.is_empty();
        if self.area_emitters == 0 {
            let reason = "no area emitters: one ray a lamp is exact".into();
            return self.line(Component::Direct, used, String::new(), reason);
        }
        let rays = counted(samples as usize, "shadow ray");
        let settings = format!("{rays} an area emitter and pixel of pictures written to files");
        PlanLine {
            expected_error: ExpectedError::Median(0.5 / (samples as f32).sqrt()),
            error_basis: "at worst, in the middle of a penumbra: half over the root of the rays; \
                          exact where an emitter is seen whole or not at all"
                .into(),
            ..self.line(Component::Direct, used, settings, "area emitters cast soft shadows".into())
        }
    }

    fn radiosity(&self, settings: &RadiositySettings) -> PlanLine {
        if !self.reflects {
            let reason = "nothing reflects: no indirect light".into();
            return self.line(Component::Radiosity, false, String::new(), reason);
        }
        let layout = ElementLayout::new(&self.world.geometry, settings.element_spacing_m);
        let coarser = settings.element_spacing_m.is_none() && layout.spacing_m > 1.01 * layout.hundredth_m;
        let cap = if coarser {
            format!(
                " (1/100 of the scene would be {}; coarser, to stay near 50,000)",
                metres(layout.hundredth_m)
            )
        } else {
            String::new()
        };
        let trees =
            settings.subdivision.map_or(String::new(), |Subdivision { levels, tolerance, restricted }| {
                let restricted = if restricted { ", restricted" } else { "" };
                format!(
                    ", split up to {} where light bends by more than {:.1} %{restricted}",
                    counted(levels.into(), "time"),
                    100.0 * tolerance
                )
            });
        let words = format!(
            "{} an element, elements every {}{cap}{trees}",
            counted(settings.gather_rays as usize, "gather ray"),
            metres(layout.spacing_m)
        );
        // Corners share elements: 0.45 a triangle is what the office's small things come to.
        let elements = layout.grid_nodes as f64 + 0.45 * layout.curved_triangles as f64;
        let by_default = !Component::Radiosity.is_overridden(self.over);
        let (expected_error, error_basis) = if by_default {
            let basis = "median of surface irradiance: the tolerance asked for; at the default of 4 %, \
                         1.4 % was measured in a box and 2.1 % in the office";
            (ExpectedError::Median(self.tolerance), basis)
        } else {
            (ExpectedError::Unknown, "not measured for settings fixed by hand")
        };
        PlanLine {
            expected_error,
            error_basis: error_basis.into(),
            expected_seconds: elements * f64::from(settings.gather_rays) / RAYS_PER_SECOND,
            ..self.line(Component::Radiosity, true, words, "surfaces reflect diffusely".into())
        }
    }

    fn mirror(&self) -> PlanLine {
        let reflectors = Reflectors::new(&self.world.geometry);
        let (flat, curved) = (reflectors.list.len(), reflectors.curved);
        let MirrorSettings { depth, images } = MirrorSettings::of(self.over);
        let reason = match (flat, curved) {
            (0, 0) => "nothing is polished: no mirrored view".into(),
            (0, _) => "nothing polished is flat: curved things show a map of the light around them".into(),
            (_, 0) => format!("{} of polished material", counted(flat, "flat reflector")),
            _ => format!("{}; {curved} curved triangles show maps", counted(flat, "flat reflector")),
        };
        let used = flat > 0 && depth > 0;
        let words = match images {
            _ if !used => String::new(),
            None => format!("{} deep, at most {MOST_VIEWS} views", counted(depth as usize, "mirror")),
            Some(images) => format!(
                "{} deep, the first from {} an element",
                counted(depth as usize, "mirror"),
                counted(images as usize, "image-with-depth")
            ),
        };
        let points = match images {
            Some(_) if used => MirrorImages::automatic_points(&self.world.geometry),
            _ => 0,
        };
        let (expected_error, error_basis) = match (curved, used, images) {
            (0, false, _) => (ExpectedError::Exact, "nothing is sampled"),
            (0, true, None) => {
                (ExpectedError::Exact, "the same passes from a mirrored eye, to the depth stated")
            }
            (_, true, Some(_)) => {
                let basis =
                    "what no image has seen reflects as if dull, edges are as coarse as the images' pixels";
                (ExpectedError::Unknown, basis)
            }
            _ => (ExpectedError::Unknown, "the map of a curved thing is exact in its middle alone"),
        };
        PlanLine {
            expected_error,
            error_basis: error_basis.into(),
            expected_seconds: points as f64 / RAYS_PER_SECOND,
            ..self.line(Component::Mirror, used, words, reason)
        }
    }

    fn glossy(&self) -> PlanLine {
        if let Some(count) = light::wanted(self.over, &self.world.geometry) {
            let words = format!("{count} {}", GlossyMethod::Particles.words());
            let reason = "asked for".into();
            return PlanLine {
                expected_error: ExpectedError::Unknown,
                error_basis:
                    "lobes narrower than what lights them need very many particles; edges lose light".into(),
                expected_seconds: 3.0 * f64::from(count) / RAYS_PER_SECOND,
                ..self.line(Component::Glossy, true, words, reason)
            };
        }
        let reflectors = Reflectors::new(&self.world.geometry);
        let lobe_of = |material: u32| self.world.geometry.materials[material as usize].lobe();
        let lobes: Vec<Lobe> = reflectors.list.iter().filter_map(|r| lobe_of(r.material)).collect();
        let flat = lobes.len();
        let several: BTreeSet<[u32; 2]> = lobes.into_iter().map(key).collect();
        let method = self.over.glossy.unwrap_or_default();
        let used = flat > 0 && method != GlossyMethod::Sharp && MirrorSettings::of(self.over).depth > 0;
        let words = if used { method.words().into() } else { String::new() };
        let mut reason = match flat {
            0 => "nothing flat is glossy: no convolution".into(),
            n => format!("{} of rough polished material", counted(n, "flat reflector")),
        };
        if several.len() > MOST_LOBES {
            reason += &format!("; of {} lobes {MOST_LOBES} are blurred", several.len());
        }
        if self.world.geometry.is_specular() {
            let depth = environment::depth_of(self.over) as usize;
            reason += &format!("; maps hold {}", counted(depth, "glossy reflection"));
        }
        let left_out = environment::left_out(&self.world.geometry);
        if left_out > 0 {
            reason += &format!(
                "; {left_out} more than have maps of the light around them, shown as if dull in mirrors"
            );
        }
        let (expected_error, error_basis) = match used {
            true => (
                ExpectedError::Unknown,
                "what the mirror image does not show is missing: least far from contact and from grazing angles",
            ),
            false => (ExpectedError::Exact, "nothing is sampled"),
        };
        PlanLine {
            expected_error,
            error_basis: error_basis.into(),
            ..self.line(Component::Glossy, used, words, reason)
        }
    }

    fn volume(&self, settings: Option<&VolumeSettings>) -> PlanLine {
        let reason = match (self.over.volume, self.movable) {
            (Some(true), _) => "asked for".into(),
            (Some(false), _) => "switched off".into(),
            (None, 0) => "nothing can be moved: not built".into(),
            (None, n) => format!("lights {}", counted(n, "movable object")),
        };
        let line = |words| self.line(Component::IrradianceVolume, settings.is_some(), words, reason);
        let Some(settings) = settings else { return line(String::new()) };
        let grid = match settings.grid(self.world) {
            Ok(grid) => grid,
            Err(error) => {
                return PlanLine {
                    expected_error: ExpectedError::Unknown,
                    error_basis: "there is no such volume".into(),
                    ..line(format!("cannot be built: {error}"))
                };
            }
        };
        let bins = 2 * settings.bins_n * settings.bins_n;
        let (samples, spacing) = (grid.places().len(), grid.cell_size().max_element());
        let in_pockets = match settings.pocket_samples {
            0 => String::new(),
            most => format!(", and up to {most} more in pockets"),
        };
        let words = format!(
            "{samples} samples of {bins} bins, at most {} apart, {} in the {} cells near surfaces and lamps{in_pockets}",
            metres(spacing),
            metres(spacing / grid.inner() as f32),
            grid.second_level_grids(),
        );
        // Moments lie beside the irradiance and change nothing of it.
        let VolumeSettings { seed, moments, .. } = settings.clone();
        let as_measured = *settings == VolumeSettings { seed, moments, ..VolumeSettings::default() };
        let (expected_error, error_basis) = if as_measured {
            let basis = "median over points and directions in the air, measured in the office; larger where \
                         light changes within a cell";
            (ExpectedError::Median(VOLUME_ERROR), basis)
        } else {
            (ExpectedError::Unknown, "not measured for settings fixed by hand")
        };
        PlanLine {
            expected_error,
            error_basis: error_basis.into(),
            expected_seconds: (samples + settings.pocket_samples as usize) as f64 * f64::from(bins)
                / RAYS_PER_SECOND,
            ..line(words)
        }
    }
}

/// "1 ray", "2 rays".
fn counted(count: usize, of: &str) -> String {
    format!("{count} {of}{}", if count == 1 { "" } else { "s" })
}

/// A length to three digits.
fn metres(length_m: f32) -> String {
    match length_m {
        l if l >= 100.0 => format!("{l:.0} m"),
        l if l >= 10.0 => format!("{l:.1} m"),
        l if l >= 1.0 => format!("{l:.2} m"),
        l if l >= 0.1 => format!("{l:.3} m"),
        l => format!("{l:.4} m"),
    }
}
