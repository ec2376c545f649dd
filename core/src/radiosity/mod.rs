//! Radiosity: diffuse interreflection on surfaces, solved once, shown from anywhere.
//!
//! Elements lie on the surfaces ([`surface_map`]); what each sees is cached as hit numbers
//! ([`gather`]); direct light is kept per emitter; [`solve`] sweeps until the bound of the error is
//! below tolerance. A changed lamp costs its own shadow rays and a few sweeps, no new visibility. What
//! noise the rays leave is [`smooth`]ed away where it can be told from light.
//!
//! The picture takes *direct* light exactly at each point and only *indirect* light from elements,
//! because shadows and lamps' falloff are sharper than any element while interreflection is not.
//! Limits: indirect light varies no faster than the element spacing (contact shadows of bounced
//! light are lost), it is kept for the Lambertian part of surfaces alone (what lobes pass on to those is
//! `specular`), and the cached transport holds for where the objects stood when it was gathered.

pub mod atlas;
mod atlas_triangles;
pub mod balance;
mod bounces;
mod charts;
mod direct_light;
pub mod faults;
mod footprint;
pub mod gather;
pub mod inspect;
pub mod inspect_elements;
pub mod inspect_exchange;
pub mod inspect_light;
pub mod inspect_lightmap;
mod layout;
pub mod lightmap;
pub mod lookup;
pub mod reconstruct;
mod rims;
pub mod shared_edges;
mod shown;
pub mod smooth;
pub mod solve;
mod specular;
pub mod subdivide;
pub mod surface_map;
pub mod texels;
pub mod texture;

use crate::{
    math::progress::{Cancelled, Progress},
    mirror::thrown::Images,
    scene::{Target, world::World},
};
use direct_light::{EmitterLight, Lighting};
use gather::{Gathering, Transport};
use glam::Vec3;
use lookup::SideMap;
use rayon::prelude::*;
use solve::Convergence;
use std::sync::Arc;
use subdivide::{Draft, Subdivision};
use surface_map::{Element, SurfaceMap};

/// What a solve is made with.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize, serde::Deserialize)]
pub struct RadiositySettings {
    /// Distance between elements, m; chosen from the scene when not given.
    pub element_spacing_m: Option<f32>,
    /// Quadtrees on flat regions, split a posteriori from this spacing on; `None` solves uniform grids.
    #[serde(default)]
    pub subdivision: Option<Subdivision>,
    /// Gather rays an element; on quadtrees of one that stands for a finest leaf, others by the root of their area.
    pub gather_rays: u32,
    /// Shadow rays an area emitter and element, where it is partly hidden.
    pub shadow_rays: u32,
    /// Width of the smoothing of indirect light, in standard errors of the gather; 0 leaves it rough.
    pub smoothing: f32,
    /// Bound of the mean error of the sweeps, relative to the mean irradiance.
    pub tolerance: f32,
    /// Sweeps after which a solve is given up.
    pub max_sweeps: u32,
    /// Seed of every random number.
    pub seed: u64,
}

impl Default for RadiositySettings {
    fn default() -> Self {
        Self {
            element_spacing_m: None,
            subdivision: None,
            gather_rays: 96,
            shadow_rays: 16,
            smoothing: 1.0,
            tolerance: 2e-4,
            max_sweeps: 200,
            seed: 1,
        }
    }
}

/// Shadow rays of a draft that decides where to subdivide.
const DRAFT_SHADOW_RAYS: u32 = 2;
/// Tolerance of its sweeps.
const DRAFT_TOLERANCE: f32 = 0.02;

/// Why there is no radiosity solution.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum RadiosityError {
    /// The user stopped it.
    #[error("radiosity was cancelled")]
    Cancelled,
    /// The sweeps did not converge: a reflectance of 1 or more, or values that are not finite.
    #[error(
        "radiosity did not converge: error bound {error_bound} of the mean irradiance after {sweeps} sweeps \
         (is a reflectance 1 or more?)"
    )]
    NotConverged {
        /// Bound of the relative error.
        error_bound: f32,
        /// Sweeps done.
        sweeps: u32,
    },
    /// The spacing is too fine for the scene.
    #[error("{elements} elements at a spacing of {spacing_m} m; at most {most} are allowed")]
    TooManyElements {
        /// Elements wanted.
        elements: usize,
        /// Elements allowed.
        most: usize,
        /// Spacing, m.
        spacing_m: f32,
    },
    /// The spacing is too fine for the length of a flat region.
    #[error(
        "{nodes} elements or more along a surface at a spacing of {spacing_m} m; at most {most} are allowed"
    )]
    TooLong {
        /// Elements wanted along it, at least.
        nodes: u32,
        /// Elements allowed.
        most: u32,
        /// Spacing, m.
        spacing_m: f32,
    },
    /// The spacing is not a positive number.
    #[error("element spacing must be positive, got {spacing_m} m")]
    BadSpacing {
        /// Spacing, m.
        spacing_m: f32,
    },
}

impl From<Cancelled> for RadiosityError {
    fn from(_: Cancelled) -> Self {
        Self::Cancelled
    }
}

/// Irradiance on every surface element of a scene.
#[derive(Clone, Debug, Default)]
pub struct RadiositySolution {
    /// Direct irradiance of each element, lx per channel.
    pub direct: Vec<Vec3>,
    /// Indirect irradiance of each element, lx per channel.
    pub indirect: Vec<Vec3>,
    /// Of it, what came from an emitter by way of specular lobes alone.
    passed_on: Vec<Vec3>,
    /// The same as gathered, where the next sweeps start.
    gathered: Vec<Vec3>,
    radiosity: Vec<Vec3>,
    transport: Arc<Transport>,
    lights: Vec<EmitterLight>,
    settings: RadiositySettings,
    convergence: Convergence,
}

impl RadiositySolution {
    /// Lays out elements, gathers their transport, lights them and sweeps to convergence.
    ///
    /// # Errors
    /// Every [`RadiosityError`].
    pub fn solve(
        world: &World,
        settings: &RadiositySettings,
        progress: &Progress,
    ) -> Result<Self, RadiosityError> {
        progress.begin("laying out elements");
        let levels = settings.subdivision.map_or(0, |s| s.levels.min(subdivide::MOST_LEVELS));
        let map = SurfaceMap::subdivided(&world.geometry, settings.element_spacing_m, levels)?;
        let mut gathering = Gathering::new(world, map, settings.gather_rays, settings.seed, progress)?;
        if let Some(subdivision) = settings.subdivision.filter(|_| levels > 0) {
            let coarse = RadiositySettings {
                shadow_rays: settings.shadow_rays.min(DRAFT_SHADOW_RAYS),
                tolerance: settings.tolerance.max(DRAFT_TOLERANCE),
                ..*settings
            };
            let transport = Arc::new(gathering.clone().transport(world));
            let draft = Draft::new(&Self::light(world, transport, &coarse, progress)?);
            for level in 0..levels {
                let asks = draft.asks(&gathering, &subdivision);
                if !gathering.subdivide(world, level, subdivision.restricted, asks, progress)? {
                    break;
                }
            }
        }
        let transport = gathering.transport(world);
        Self::light(world, Arc::new(transport), settings, progress)
    }

    /// Lights a transport that is already there.
    ///
    /// # Errors
    /// [`RadiosityError::Cancelled`], [`RadiosityError::NotConverged`].
    pub fn light(
        world: &World,
        transport: Arc<Transport>,
        settings: &RadiositySettings,
        progress: &Progress,
    ) -> Result<Self, RadiosityError> {
        let (images, RadiositySettings { shadow_rays, seed, .. }) = (Images::new(&world.geometry), *settings);
        let lighting =
            Lighting { world, transport: &transport, images: &images, shadow_rays, moving: false, seed };
        let emitters = world.emitters.list.iter();
        let lights: Vec<EmitterLight> =
            emitters.map(|e| EmitterLight::new(&lighting, e, progress)).collect::<Result<_, _>>()?;
        progress.begin("interreflection");
        let start = vec![Vec3::ZERO; transport.map.elements.len()];
        let solution = Self::converge(transport, lights, &start, *settings, settings.max_sweeps, progress)?;
        let Convergence { error_bound, sweeps, converged, .. } = solution.convergence;
        if converged { Ok(solution) } else { Err(RadiosityError::NotConverged { error_bound, sweeps }) }
    }

    /// The solution after targets of `world` were moved or dimmed since this one.
    ///
    /// A dimmed emitter costs a factor; one that moved, or is named by `retrace` because what shadows
    /// it moved, costs new shadow rays. The transport is kept, so objects that only reflect leave no
    /// trace in indirect light. Sweeps start from this solution and stop after `max_sweeps`;
    /// [`Self::convergence`] says how far they came.
    pub fn relight(&self, world: &World, retrace: &[Target], shadow_rays: u32, max_sweeps: u32) -> Self {
        let (images, seed) = (Images::new(&world.geometry), self.settings.seed);
        let moving = shadow_rays < self.settings.shadow_rays;
        let lighting =
            Lighting { world, transport: &self.transport, images: &images, shadow_rays, moving, seed };
        let known = self.lights.len() == world.emitters.len();
        let lights = world
            .emitters
            .list
            .iter()
            .enumerate()
            .map(|(i, emitter)| {
                let unlit = || EmitterLight::unlit(world, emitter);
                let light = self.lights.get(i).filter(|_| known).cloned().unwrap_or_else(unlit);
                let again = retrace.contains(&emitter.target());
                light.follow(&lighting, emitter, again)
            })
            .collect();
        // Nobody cancels silent progress.
        Self::converge(
            self.transport.clone(),
            lights,
            &self.gathered,
            self.settings,
            max_sweeps,
            &Progress::silent(),
        )
        .unwrap_or_else(|_| self.clone())
    }

    fn converge(
        transport: Arc<Transport>,
        lights: Vec<EmitterLight>,
        start: &[Vec3],
        settings: RadiositySettings,
        max_sweeps: u32,
        progress: &Progress,
    ) -> Result<Self, RadiosityError> {
        let mut direct = vec![Vec3::ZERO; transport.map.elements.len()];
        let mut passed_on = direct.clone();
        let mut chance = vec![0.0; direct.len()];
        lights.iter().for_each(|light| light.add_to(&mut direct, &mut passed_on, &mut chance));
        let light = solve::Light { direct: &direct, passed_on: &passed_on };
        let (mut gathered, convergence) =
            solve::indirect(&transport, light, start, settings.tolerance, max_sweeps, progress)?;
        transport.fill(&mut direct);
        transport.fill(&mut gathered);
        let reflected = |indirect: &[Vec3]| reflected(&transport.map.elements, &direct, indirect);
        let (mut indirect, mut radiosity) = (gathered.clone(), reflected(&gathered));
        if settings.smoothing > 0.0 {
            let mut variances = smooth::variances(&transport, &radiosity);
            variances.iter_mut().zip(&chance).for_each(|(v, c)| *v += c);
            indirect = smooth::smooth(&transport, &gathered, &variances, settings.smoothing);
            transport.fill(&mut indirect);
            radiosity = reflected(&indirect);
        }
        Ok(Self {
            direct,
            passed_on,
            indirect,
            gathered,
            radiosity,
            transport,
            lights,
            settings,
            convergence,
        })
    }

    /// Radiosity B = ρE of each element, lx per channel; what elements emit is not in it.
    pub fn radiosity(&self) -> &[Vec3] {
        &self.radiosity
    }

    /// How much one more sweep would change what each element gathered, lx per channel.
    pub fn residual(&self) -> Vec<Vec3> {
        let mut again = self.transport.gather(&reflected(self.elements(), &self.direct, &self.gathered));
        again.iter_mut().zip(&self.passed_on).for_each(|(a, p)| *a += *p);
        self.transport.fill(&mut again);
        again.iter().zip(&self.gathered).map(|(a, g)| (*a - *g).abs()).collect()
    }

    /// The elements.
    pub fn elements(&self) -> &[Element] {
        &self.transport.map.elements
    }

    /// Records from triangle sides to elements, for [`lookup::blend`] and its twin.
    pub fn sides(&self) -> &[SideMap] {
        &self.transport.map.sides
    }

    /// What every element sees.
    pub fn transport(&self) -> &Arc<Transport> {
        &self.transport
    }

    /// What it was solved with.
    pub fn settings(&self) -> &RadiositySettings {
        &self.settings
    }

    /// How the sweeps went.
    pub fn convergence(&self) -> Convergence {
        self.convergence
    }

    /// Bytes held, the shared transport included.
    pub fn bytes(&self) -> usize {
        let tables = size_of_val(&self.direct[..]) * 5;
        self.transport.bytes() + tables + self.lights.iter().map(EmitterLight::bytes).sum::<usize>()
    }
}

/// Radiosity B = ρ(E_d + E_i) of elements, lx per channel.
fn reflected(elements: &[Element], direct: &[Vec3], indirect: &[Vec3]) -> Vec<Vec3> {
    let irradiance = direct.par_iter().zip(indirect);
    elements.par_iter().zip(irradiance).map(|(e, (d, i))| e.reflectance * (*d + *i)).collect()
}
