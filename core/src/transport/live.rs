//! A solution that follows the user: what a change touches is redone, the rest is kept.
//!
//! Light transport is linear in what is emitted, and its operator depends on geometry alone. So the
//! gather hits of radiosity and volume are cached once; a lamp that moves or dims costs its own direct
//! light and some sweeps over the cache. An object that moves leaves the cache a little wrong: at
//! once it shadows direct light and is itself lit from the volume; once it rests, everything is
//! solved anew. Not a full solve a step: that is a hundred times the work for a difference that is
//! mostly below what the eye sees while things move.

mod settings;

use super::{
    LightTransportSolution,
    solution::{Provenance, State},
};
use crate::{
    glossy::{
        environment::{Environments, LOBE_DIRECTIONS, depth_of},
        particles::light::{self, ParticleLight},
    },
    irradiance_volume::{
        IrradianceVolume, VolumeError, VolumeSettings,
        dynamic_object::{Detail, DynamicObject},
    },
    math::progress::{Cancelled, Progress},
    mirror::{MirrorSettings, images::MirrorImages},
    radiosity::{RadiosityError, RadiositySettings, RadiositySolution},
    scene::{Scene, Target, world::World},
};
use std::{collections::BTreeMap, sync::Arc, time::Instant};

/// What to solve, and how well.
#[derive(Clone, Debug, PartialEq)]
pub struct SolveSettings {
    /// Light on surfaces.
    pub radiosity: RadiositySettings,
    /// Light in the air; `None` where the scene has nothing to light with it.
    pub volume: Option<VolumeSettings>,
    /// Whether a coarse solution is shown first, for a window that should not stay dark.
    pub preview: bool,
}

/// Why there is no solution.
#[derive(Debug, thiserror::Error)]
pub enum SolveError {
    /// Radiosity failed.
    #[error(transparent)]
    Radiosity(#[from] RadiosityError),
    /// The volume failed.
    #[error(transparent)]
    Volume(#[from] VolumeError),
    /// The user stopped it.
    #[error(transparent)]
    Cancelled(#[from] Cancelled),
}

impl SolveError {
    /// Whether the user stopped it.
    pub fn is_cancelled(&self) -> bool {
        matches!(
            self,
            Self::Cancelled(_)
                | Self::Radiosity(RadiosityError::Cancelled)
                | Self::Volume(VolumeError::Cancelled(_))
        )
    }
}

/// Shadow rays an area emitter and element while something moves.
const MOVING_SHADOW_RAYS: u32 = 2;
/// Sweeps of the interreflection while something moves; each starts from the last solution.
const MOVING_SWEEPS: u32 = 3;

/// Directions of a lobe that a texel of a map is the mean of while something moves.
const MOVING_DIRECTIONS: u32 = 12;

/// Queries of the volume for one part of the light on all moved objects while something moves: some
/// milliseconds on one thread.
const MOVING_QUERIES: usize = 12_000;

/// Rays an element of the solution that is shown first.
const PREVIEW_RAYS: u32 = 32;
/// Elements across the diagonal of the scene in the solution that is shown first.
const PREVIEW_ELEMENTS: f32 = 40.0;

/// Settings of the solution that is shown first: a few per cent of the work.
fn coarse_radiosity(world: &World, settings: &RadiositySettings) -> RadiositySettings {
    let (low, high) = world.geometry.bounds();
    let spacing = (high - low).length() / PREVIEW_ELEMENTS;
    RadiositySettings {
        gather_rays: settings.gather_rays.min(PREVIEW_RAYS),
        shadow_rays: settings.shadow_rays.min(MOVING_SHADOW_RAYS),
        element_spacing_m: Some(settings.element_spacing_m.unwrap_or(0.0).max(spacing)),
        ..*settings
    }
}

/// Nodes and self-occlusion of everything that may be moved; lattices are half as wide as the volume's
/// finest cells.
fn dynamic_objects(
    solution: &LightTransportSolution,
    progress: &Progress,
) -> Result<BTreeMap<u32, DynamicObject>, Cancelled> {
    let (world, mut made) = (&solution.world, BTreeMap::new());
    let Some(volume) = &solution.volume else { return Ok(made) };
    let spacing = 0.5 * volume.grid().cell_size().min_element() / volume.grid().inner() as f32;
    let count = world.geometry.movable.len();
    for object in 0..count {
        progress.report(object as f32 / count as f32)?;
        if world.geometry.movable[object] && !world.geometry.object_triangles[object].is_empty() {
            let mut known = DynamicObject::new(&solution.scene, &world.geometry, object, Some(spacing));
            known.occlude(world, object, solution.provenance.seed);
            made.insert(object as u32, known);
        }
    }
    Ok(made)
}

/// The latest solution, and how to bring it up to date.
pub struct LiveTransport {
    settings: SolveSettings,
    solved: Arc<Scene>,
    current: LightTransportSolution,
    /// Images-with-depth of the scene that was solved.
    taken: Option<Arc<MirrorImages>>,
    /// Emitters whose shadow rays are coarse.
    coarse: Vec<Target>,
    /// Whether sweeps or shadow rays were cut short.
    unsettled: bool,
}

impl LiveTransport {
    /// Solves a scene from nothing. `show` receives every stage worth showing, the last one settled.
    ///
    /// # Errors
    /// [`SolveError`], with nothing kept, when a room fails or the work is cancelled.
    pub fn solve(
        scene: Arc<Scene>,
        settings: SolveSettings,
        progress: &Progress,
        show: &mut dyn FnMut(&LightTransportSolution),
    ) -> Result<Self, SolveError> {
        Self::solve_with(scene, settings, None, progress, show)
    }

    /// The same with images-with-depth that were taken before something moved.
    fn solve_with(
        scene: Arc<Scene>,
        settings: SolveSettings,
        taken: Option<Arc<MirrorImages>>,
        progress: &Progress,
        show: &mut dyn FnMut(&LightTransportSolution),
    ) -> Result<Self, SolveError> {
        let mut provenance =
            Provenance { seed: settings.radiosity.seed, state: State::Refining, ..Provenance::default() };
        let stage = |name: &str, from: Instant, provenance: &mut Provenance| {
            provenance.stage_seconds.push((name.to_owned(), from.elapsed().as_secs_f64()));
            provenance.revision += 1;
        };
        progress.begin("rays");
        let start = Instant::now();
        let world = Arc::new(World::new(&scene));
        stage("rays", start, &mut provenance);
        progress.report(1.0)?;

        progress.begin("radiosity");
        let mut current = LightTransportSolution {
            scene: scene.clone(),
            world,
            radiosity: Arc::default(),
            volume: None,
            moved_objects: Vec::new(),
            dynamic_objects: Arc::default(),
            guests: Arc::default(),
            environments: Arc::default(),
            mirror_images: None,
            particles: None,
            detail: Detail::Fine,
            gloss: None,
            provenance,
        };
        let depth = depth_of(&scene.plan);
        if settings.preview {
            let start = Instant::now();
            let coarse = coarse_radiosity(&current.world, &settings.radiosity);
            current.radiosity = Arc::new(RadiositySolution::solve(&current.world, &coarse, progress)?);
            current.environments = Arc::new(Environments::new(&current.world, &current.radiosity, depth));
            stage("preview", start, &mut current.provenance);
            show(&current);
        }
        let start = Instant::now();
        let radiosity = RadiositySolution::solve(&current.world, &settings.radiosity, progress)?;
        current.radiosity = Arc::new(radiosity);
        current.environments = Arc::new(Environments::new(&current.world, &current.radiosity, depth));
        stage("radiosity", start, &mut current.provenance);
        if MirrorSettings::of(&scene.plan).images.is_some() {
            show(&current);
            let start = Instant::now();
            let images = taken.unwrap_or_default().followed(&current.world, u64::MAX, progress)?;
            current.mirror_images = images.map(Arc::new);
            stage("mirror", start, &mut current.provenance);
        }
        if let Some(count) = light::wanted(&scene.plan, &current.world.geometry) {
            show(&current);
            let start = Instant::now();
            let seed = settings.radiosity.seed;
            current.particles = Some(Arc::new(ParticleLight::new(&current.world, count, seed, progress)?));
            stage("glossy", start, &mut current.provenance);
        }
        if let Some(volume) = &settings.volume {
            show(&current);
            progress.begin("irradiance volume");
            let start = Instant::now();
            current.volume = Some(Arc::new(IrradianceVolume::build(
                &current.world,
                &*current.radiosity,
                volume,
                progress,
            )?));
            stage("irradiance volume", start, &mut current.provenance);
            progress.begin("dynamic objects");
            let start = Instant::now();
            current.dynamic_objects = Arc::new(dynamic_objects(&current, progress)?);
            stage("dynamic objects", start, &mut current.provenance);
        }
        current.provenance.state = State::Settled;
        show(&current);
        Ok(Self::settled(settings, scene, current))
    }

    /// Of light that is solved in full for a scene.
    fn settled(settings: SolveSettings, solved: Arc<Scene>, current: LightTransportSolution) -> Self {
        let taken = current.mirror_images.clone();
        Self { settings, solved, taken, current, coarse: Vec::new(), unsettled: false }
    }

    /// The latest solution.
    pub fn current(&self) -> &LightTransportSolution {
        &self.current
    }

    /// Brings the solution to a scene whose placements or dimmers changed, at once and coarsely.
    ///
    /// Lamps and emissive objects are relit through the cached transport. An object that moved casts
    /// its shadow in the direct light of every emitter; its own transport waits for [`Self::refine`]. Images-with-depth
    /// are kept, and the rays traced anew that meet what moved.
    pub fn follow(&mut self, scene: Arc<Scene>) -> &LightTransportSolution {
        let start = Instant::now();
        let mut world = (*self.current.world).clone();
        let changed = world.follow(&scene);
        let relit = self.lights_touched(&scene, &changed);
        self.current.scene = scene;
        self.current.world = Arc::new(world);
        let world = &self.current.world;
        let stale = |images: &Arc<MirrorImages>| !images.hold(&world.geometry);
        if let Some(taken) =
            self.taken.as_ref().filter(|_| self.current.mirror_images.as_ref().is_some_and(stale))
        {
            self.current.mirror_images = Some(taken.moved(world));
        }
        self.relight(&changed, &relit, MOVING_SHADOW_RAYS, MOVING_SWEEPS, &relit);
        if let Some(particles) = &self.current.particles
            && let Some(count) = light::wanted(&self.current.scene.plan, &self.current.world.geometry)
        {
            self.current.particles = Some(Arc::new(particles.followed(&self.current.world, count)));
        }
        for target in relit {
            if !self.coarse.contains(&target) {
                self.coarse.push(target);
            }
        }
        self.unsettled |= !changed.is_empty();
        self.current.moved_objects = self.moved_objects();
        self.current.detail = self.moving_detail();
        let settled = !self.unsettled && self.current.moved_objects.is_empty();
        self.finish("follow", start, if settled { State::Settled } else { State::Refining });
        &self.current
    }

    /// One step towards the settled solution: full-quality direct light first, then, if an object
    /// has moved, a new transport. `None` when there is nothing left to do.
    ///
    /// # Errors
    /// [`SolveError`] when the new transport fails or is cancelled; the current solution stays.
    pub fn refine(&mut self, progress: &Progress) -> Result<Option<&LightTransportSolution>, SolveError> {
        if self.unsettled {
            let start = Instant::now();
            if let Some(particles) = &self.current.particles {
                let world = &self.current.world;
                let count = light::wanted(&self.current.scene.plan, &world.geometry).unwrap_or(1);
                self.current.particles = Some(Arc::new(particles.settled(world, count, progress)?));
            }
            self.unsettled = false;
            let mut targets = std::mem::take(&mut self.coarse);
            if targets.iter().any(|t| matches!(t, Target::Object(_))) {
                targets = self.all_emitters();
            }
            let RadiositySettings { shadow_rays, max_sweeps, .. } = self.settings.radiosity;
            self.relight(&targets, &targets, shadow_rays, max_sweeps, &[]);
            self.current.detail = Detail::Fine;
            let state = if self.current.moved_objects.is_empty() { State::Settled } else { State::Refining };
            self.finish("relight", start, state);
            return Ok(Some(&self.current));
        }
        if self.current.moved_objects.is_empty() {
            return Ok(None);
        }
        let revision = self.current.provenance.revision;
        let settings = SolveSettings { preview: false, ..self.settings.clone() };
        let (scene, taken) = (self.current.scene.clone(), self.taken.clone());
        let solved = Self::solve_with(scene, settings, taken, progress, &mut |_| {})?;
        *self = solved;
        self.current.provenance.revision += revision;
        Ok(Some(&self.current))
    }

    /// Emitters whose shadow rays a change makes stale at once: those that moved, and all of them when
    /// an object that does not emit moved. What the body of a lamp shadows in the light of others
    /// waits for [`Self::refine`].
    fn lights_touched(&self, scene: &Scene, changed: &[Target]) -> Vec<Target> {
        let moved = |&&t: &&Target| scene.placement(t) != self.current.scene.placement(t);
        let moved: Vec<Target> = changed.iter().filter(moved).copied().collect();
        if moved.iter().all(|t| scene.emits(*t)) { moved } else { self.all_emitters() }
    }

    fn all_emitters(&self) -> Vec<Target> {
        let mut all: Vec<Target> = self.current.world.emitters.list.iter().map(|e| e.target()).collect();
        all.sort_unstable();
        all.dedup();
        all
    }

    fn relight(
        &mut self,
        changed: &[Target],
        retrace: &[Target],
        shadow_rays: u32,
        max_sweeps: u32,
        moving: &[Target],
    ) {
        let world = &self.current.world;
        let radiosity = Arc::new(self.current.radiosity.relight(world, retrace, shadow_rays, max_sweeps));
        if let Some(volume) = &self.current.volume {
            self.current.volume = Some(Arc::new(volume.relight_moving(world, &*radiosity, changed, moving)));
        }
        let directions = if max_sweeps == MOVING_SWEEPS { MOVING_DIRECTIONS } else { LOBE_DIRECTIONS };
        let depth = depth_of(&self.current.scene.plan);
        let maps = self.current.environments.relit(world, &radiosity, directions, depth);
        self.current.environments = Arc::new(maps);
        self.current.radiosity = radiosity;
    }

    /// Objects away from where the transport was solved.
    fn moved_objects(&self) -> Vec<u32> {
        let pairs = self.current.scene.objects.iter().zip(&self.solved.objects).enumerate();
        pairs
            .filter(|(_, (now, then))| now.world_from_object != then.world_from_object)
            .map(|(i, _)| i as u32)
            .collect()
    }

    /// The finest level at which all moved objects together stay within the budget.
    fn moving_detail(&self) -> Detail {
        let moved = &self.current.moved_objects;
        let known = moved.iter().filter_map(|o| self.current.dynamic_objects.get(o));
        known.map(|d| d.within(MOVING_QUERIES / moved.len())).min().unwrap_or(Detail::Fine)
    }

    fn finish(&mut self, stage: &str, start: Instant, state: State) {
        let provenance = &mut self.current.provenance;
        provenance.state = state;
        provenance.revision += 1;
        provenance.stage_seconds = vec![(stage.to_owned(), start.elapsed().as_secs_f64())];
    }
}
