//! Next-event estimation: one sample of the light that comes straight from the emitters.
//!
//! Points are drawn as [`crate::scene::light_sample`] says. Not the ratio estimator of
//! [`crate::scene::direct`]: that one is quieter but only consistent, and the reference has to be
//! unbiased at any number of samples.

use crate::{
    math::colour::luminance,
    scene::{
        direct::{self, Receiver},
        emitters::{AreaEmitter, Emitter},
        geometry::Surface,
        lamp::LampKind,
        light_sample::{AreaPoint, LightSample},
        world::World,
    },
};
use glam::{Vec2, Vec3};
use std::f32::consts::{FRAC_1_PI, PI};

/// With at most this many emitters the first vertex of a path samples each of them.
pub const SAMPLE_ALL: usize = 8;

/// Share of the choices that ignores the emitters' flux.
const UNIFORM_SHARE: f32 = 0.1;

/// Which emitters a vertex samples.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Selection {
    /// Each of them once.
    All,
    /// One, chosen with probability nearly in proportion to flux.
    One,
}

/// The emitters that are switched on, and how probable each is to be chosen.
#[derive(Clone, Debug)]
pub struct LightSampler {
    choices: Vec<Choice>,
    /// (object, material) of each area emitter and its place in `choices`, sorted.
    areas: Vec<((u32, u32), u32)>,
}

#[derive(Clone, Copy, Debug)]
struct Choice {
    emitter: usize,
    probability: f32,
    cumulative: f32,
}

impl LightSampler {
    /// Lists the emitters of a world that give light.
    pub fn new(world: &World) -> Self {
        let (low, high) = world.geometry.bounds();
        let cross_section = 0.25 * PI * (high - low).length_squared();
        let power = |e: &Emitter| match e {
            Emitter::Lamp { lamp, .. } => match lamp.kind {
                LampKind::Directional { illuminance } => luminance(illuminance) * lamp.dimmer * cross_section,
                _ => e.flux(),
            },
            Emitter::Area(_) => e.flux(),
        };
        let lit: Vec<(usize, f32)> = world
            .emitters
            .list
            .iter()
            .enumerate()
            .map(|(i, e)| (i, power(e)))
            .filter(|&(_, p)| p > 0.0 && p.is_finite())
            .collect();
        let total: f32 = lit.iter().map(|&(_, p)| p).sum();
        let mut cumulative = 0.0;
        let choices: Vec<Choice> = lit
            .iter()
            .map(|&(emitter, p)| {
                let probability = (1.0 - UNIFORM_SHARE) * p / total + UNIFORM_SHARE / lit.len() as f32;
                cumulative += probability;
                Choice { emitter, probability, cumulative }
            })
            .collect();
        let mut areas: Vec<_> = choices
            .iter()
            .enumerate()
            .filter_map(|(place, choice)| match &world.emitters.list[choice.emitter] {
                Emitter::Area(area) => Some((world.geometry.emitter_of(area.triangles[0]), place as u32)),
                Emitter::Lamp { .. } => None,
            })
            .collect();
        areas.sort_unstable();
        Self { choices, areas }
    }

    /// How the first vertex of a path should select.
    pub fn first_selection(&self) -> Selection {
        if self.choices.len() <= SAMPLE_ALL { Selection::All } else { Selection::One }
    }

    /// One sample of the direct irradiance, lx, by light sampling, weighted against cosine sampling
    /// with the balance heuristic. `pick` in [0, 1) chooses the emitter where one is chosen, and
    /// `point` gives the position on the n-th emitter.
    ///
    /// For area emitters: Lₑ cos θ / (p_light + p_cosine), both densities per solid angle; it never
    /// exceeds π Lₑ, however near the emitter. For lamps the closed form over the probability.
    pub fn sample(
        &self,
        world: &World,
        receiver: &Receiver,
        selection: Selection,
        pick: f32,
        mut point: impl FnMut(usize) -> Vec2,
    ) -> Vec3 {
        match selection {
            Selection::All => self.choices.iter().enumerate().fold(Vec3::ZERO, |sum, (n, choice)| {
                sum + contribution(world, choice.emitter, receiver, 1.0, point(n))
            }),
            Selection::One => {
                let Some(n) = self.chosen(pick) else { return Vec3::ZERO };
                let choice = self.choices[n];
                contribution(world, choice.emitter, receiver, choice.probability, point(n))
            }
        }
    }

    /// Sum over the emitters selected of what `take` makes of one point of each, in the order of
    /// [`LightSampler::sample`].
    pub fn sum(
        &self,
        world: &World,
        receiver: &Receiver,
        selection: Selection,
        pick: f32,
        mut point: impl FnMut(usize) -> Vec2,
        take: impl Fn(&LightSample) -> [Vec3; 2],
    ) -> [Vec3; 2] {
        let mut sum = [Vec3::ZERO; 2];
        let mut add = |n: usize, probability: f32, u: Vec2| {
            if let Some(sample) = LightSample::new(
                world,
                &world.emitters.list[self.choices[n].emitter],
                receiver,
                probability,
                u,
            ) {
                let [a, b] = take(&sample);
                sum = [sum[0] + a, sum[1] + b];
            }
        };
        match selection {
            Selection::All => (0..self.choices.len()).for_each(|n| add(n, 1.0, point(n))),
            Selection::One => {
                if let Some(n) = self.chosen(pick) {
                    add(n, self.choices[n].probability, point(n));
                }
            }
        }
        sum
    }

    /// The choice that a number in [0, 1) stands for.
    fn chosen(&self, pick: f32) -> Option<usize> {
        let wanted = pick * self.choices.last()?.cumulative;
        Some(self.choices.partition_point(|c| c.cumulative <= wanted).min(self.choices.len() - 1))
    }

    /// Density per solid angle with which [`LightSampler::sample`] proposes the direction that hits
    /// an emissive `surface` at distance `t` along the unit vector `wi`; zero for a surface it never proposes.
    pub fn density(&self, world: &World, surface: &Surface, wi: Vec3, t: f32, selection: Selection) -> f32 {
        let key = world.geometry.emitter_of(surface.triangle);
        let Ok(found) = self.areas.binary_search_by_key(&key, |a| a.0) else { return 0.0 };
        let choice = self.choices[self.areas[found].1 as usize];
        let Emitter::Area(area) = &world.emitters.list[choice.emitter] else { return 0.0 };
        let probability = if selection == Selection::All { 1.0 } else { choice.probability };
        let cosine = surface.geometric_normal.dot(wi).abs();
        if cosine > 0.0 { probability * t * t / (area.area() * cosine) } else { 0.0 }
    }
}

/// Contribution of one emitter chosen with `probability`, lx.
fn contribution(world: &World, emitter: usize, receiver: &Receiver, probability: f32, u: Vec2) -> Vec3 {
    let emitter = &world.emitters.list[emitter];
    match emitter {
        Emitter::Lamp { lamp, .. } => {
            let to_lamp = match lamp.kind {
                LampKind::Directional { .. } => -lamp.axis(),
                _ => lamp.position() - receiver.position,
            };
            if receiver.geometric_normal.dot(to_lamp) <= 0.0 {
                return Vec3::ZERO;
            }
            direct::irradiance(world, emitter, receiver, 1, 0) / probability
        }
        Emitter::Area(area) => area_contribution(world, area, receiver, probability, u),
    }
}

fn area_contribution(
    world: &World,
    area: &AreaEmitter,
    receiver: &Receiver,
    probability: f32,
    u: Vec2,
) -> Vec3 {
    let Some(seen) = AreaPoint::new(world, area, receiver, probability, u) else { return Vec3::ZERO };
    let cosine = receiver.normal.dot(seen.wi);
    if cosine <= 0.0 {
        return Vec3::ZERO;
    }
    if seen.radiance == Vec3::ZERO {
        return Vec3::ZERO;
    }
    let (share, panes) = world.straight(&seen.ray);
    // What is hit by way of a pane is not counted.
    let hit = if panes { 0.0 } else { cosine * FRAC_1_PI };
    share * seen.radiance * (cosine / (seen.density + hit))
}
