//! Other settings for a scene that is already lit: what they change is solved again, the rest stays.

use super::{LiveTransport, SolveError, SolveSettings};
use crate::{
    glossy::{
        environment::{LOBE_DIRECTIONS, depth_of},
        particles::light::{self, ParticleLight},
    },
    irradiance_volume::IrradianceVolume,
    math::progress::Progress,
    mirror::{MirrorSettings, images::MirrorImages},
    radiosity::{RadiositySettings, RadiositySolution},
    scene::Scene,
    transport::{
        LightTransportSolution,
        solution::{Provenance, State},
    },
};
use std::{sync::Arc, time::Instant};

impl LiveTransport {
    /// The settled solution of `scene` with other settings; `show` receives what is worth showing on
    /// the way.
    ///
    /// Where this solution is settled and everything stands and shines as it did, only what the
    /// settings change is solved: the volume alone for settings of the volume, direct light and sweeps
    /// over the cached transport for the shadow rays. Otherwise everything is.
    ///
    /// # Errors
    /// [`SolveError`] when a room fails or the work is cancelled; this solution stays as it is.
    pub fn with_settings(
        &self,
        scene: Arc<Scene>,
        settings: SolveSettings,
        progress: &Progress,
        show: &mut dyn FnMut(&LightTransportSolution),
    ) -> Result<Self, SolveError> {
        let settled = !self.unsettled && self.coarse.is_empty() && self.current.moved_objects.is_empty();
        if !settled || !stands_and_shines_alike(&self.current.scene, &scene) {
            return Self::solve(scene, settings, progress, show);
        }
        let mut current = self.current.clone();
        current.scene = scene.clone();
        current.provenance.state = State::Refining;
        let kept = self.settings.radiosity == settings.radiosity;
        if !kept {
            let start = Instant::now();
            current.radiosity = Arc::new(self.radiosity(&settings.radiosity, progress)?);
            stage(&mut current.provenance, "radiosity", start);
        }
        let depth = depth_of(&scene.plan);
        if !kept || depth != depth_of(&self.current.scene.plan) {
            let (world, light) = (&current.world, &current.radiosity);
            current.environments = Arc::new(current.environments.relit(world, light, LOBE_DIRECTIONS, depth));
        }
        if MirrorSettings::of(&scene.plan).images.is_none() {
            current.mirror_images = None;
        } else if current.mirror_images.is_none() {
            let start = Instant::now();
            current.mirror_images = Some(Arc::new(MirrorImages::automatic(&current.world, progress)?));
            stage(&mut current.provenance, "mirror", start);
        }
        let count = light::wanted(&scene.plan, &current.world.geometry);
        if count != light::wanted(&self.current.scene.plan, &current.world.geometry) {
            let start = Instant::now();
            let seed = settings.radiosity.seed;
            let sent = count.map(|count| ParticleLight::new(&current.world, count, seed, progress));
            current.particles = sent.transpose()?.map(Arc::new);
            stage(&mut current.provenance, "glossy", start);
        }
        if !kept || self.settings.volume != settings.volume {
            if !kept {
                show(&current);
            }
            current.volume = match &settings.volume {
                Some(volume) => {
                    progress.begin("irradiance volume");
                    let start = Instant::now();
                    let light = &*current.radiosity;
                    let held = current.volume.as_deref().filter(|_| kept);
                    let built = match held.and_then(|v| v.asked_otherwise(volume, &current.world, light)) {
                        Some(built) => built,
                        None => IrradianceVolume::build(&current.world, light, volume, progress)?,
                    };
                    stage(&mut current.provenance, "irradiance volume", start);
                    Some(Arc::new(built))
                }
                None => None,
            };
        }
        current.provenance.state = State::Settled;
        current.provenance.revision += 1;
        show(&current);
        Ok(Self::settled(settings, scene, current))
    }

    /// Light on surfaces with other settings, through the cached transport where it holds for them.
    fn radiosity(
        &self,
        settings: &RadiositySettings,
        progress: &Progress,
    ) -> Result<RadiositySolution, SolveError> {
        let RadiositySettings { shadow_rays, tolerance, max_sweeps, .. } = *settings;
        let gathered = RadiositySettings { shadow_rays, tolerance, max_sweeps, ..self.settings.radiosity };
        let world = &self.current.world;
        progress.begin("radiosity");
        Ok(if gathered == *settings {
            RadiositySolution::light(world, self.current.radiosity.transport().clone(), settings, progress)?
        } else {
            RadiositySolution::solve(world, settings, progress)?
        })
    }
}

fn stage(provenance: &mut Provenance, name: &str, from: Instant) {
    provenance.stage_seconds.retain(|(other, _)| other != name);
    provenance.stage_seconds.push((name.to_owned(), from.elapsed().as_secs_f64()));
}

/// Whether everything in two scenes of the same things stands in one place and is dimmed alike.
fn stands_and_shines_alike(a: &Scene, b: &Scene) -> bool {
    let objects = a.objects.iter().zip(&b.objects);
    let lamps = a.lamps.iter().zip(&b.lamps);
    a.objects.len() == b.objects.len()
        && a.lamps.len() == b.lamps.len()
        && objects
            .into_iter()
            .all(|(a, b)| (a.world_from_object, a.dimmer) == (b.world_from_object, b.dimmer))
        && lamps.into_iter().all(|(a, b)| (a.world_from_lamp, a.dimmer) == (b.world_from_lamp, b.dimmer))
}
