//! A probe: the light at one free point, in full.

use super::{
    VolumeError, VolumeSettings,
    cache::Met,
    direct::{Arrival, arrivals},
    moments::{Order, moment_by_definition, moment_of_arrivals},
    quadrature::{BLOCK, LANES, Quadrature},
    rays::{Targets, trace_point},
    received::Centres,
    solve::SurfaceLight,
};
use crate::{
    inspection::{Curve, NamedImage},
    math::{colour::luminance, image::LinearImage, part::Part, sphere_map::DirectionBins},
    scene::world::World,
};
use glam::{Vec2, Vec3};

/// Radiance and irradiance of every direction at one point.
#[derive(Clone, Debug, PartialEq)]
pub struct Probe {
    /// Where, m.
    pub position: Vec3,
    /// Layout of the bins.
    pub bins: DirectionBins,
    /// Radiance coming from each bin, emitters included, cd/m² per channel.
    pub radiance: Vec<Vec3>,
    /// Radiance coming from each bin after at least one bounce, cd/m² per channel.
    pub reflected_radiance: Vec<Vec3>,
    /// Direct irradiance of a surface facing each bin, lx per channel.
    pub direct: Vec<Vec3>,
    /// Indirect irradiance of a surface facing each bin, lx per channel.
    pub indirect: Vec<Vec3>,
    /// What arrives straight from the emitters.
    pub arrivals: Vec<Arrival>,
    /// Share of the rays that met the back of a single-sided surface: above ¼ the point is in a solid.
    pub back_face_fraction: f32,
}

/// What is shown of a probe.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, serde::Serialize, serde::Deserialize)]
pub enum Quantity {
    /// What arrives from each direction, cd/m².
    Radiance,
    /// What a surface facing each direction receives, lx.
    #[default]
    Irradiance,
}

impl Quantity {
    /// Name, in full.
    pub fn name(self) -> &'static str {
        match self {
            Self::Radiance => "radiance",
            Self::Irradiance => "irradiance",
        }
    }

    /// Unit.
    pub fn unit(self) -> &'static str {
        match self {
            Self::Radiance => "cd/m²",
            Self::Irradiance => "lx",
        }
    }
}

/// Numbers that sum a probe up, from luminance-weighted values.
#[derive(Clone, Copy, Debug, PartialEq, serde::Serialize)]
pub struct ProbeStatistics {
    /// Smallest illuminance over all directions, lx.
    pub min_lx: f32,
    /// Mean over all directions, lx.
    pub mean_lx: f32,
    /// Largest over all directions, lx.
    pub max_lx: f32,
    /// Direction of the largest.
    pub brightest: Vec3,
    /// On a horizontal surface facing up, lx.
    pub up_lx: f32,
    /// On a horizontal surface facing down, lx.
    pub down_lx: f32,
    /// Vector illuminance: its dot product with n is E(n) − E(−n), lx.
    pub vector_lx: Vec3,
    /// Largest radiance seen, cd/m².
    pub max_radiance: f32,
    /// Mean radiance seen, cd/m².
    pub mean_radiance: f32,
}

impl Probe {
    /// Samples the light at a point: `supersample` rays into each of 2`n`² bins.
    ///
    /// # Errors
    /// [`VolumeError::Setting`] when `n` or `supersample` is out of range.
    pub fn at(
        world: &World,
        light: &impl SurfaceLight,
        position: Vec3,
        n: u32,
        supersample: u32,
        seed: u64,
    ) -> Result<Self, VolumeError> {
        let settings =
            VolumeSettings { bins_n: n, supersample, seed, direct_samples: 64, ..VolumeSettings::default() };
        settings.check()?;
        Ok(Self::with(world, light, position, &settings, &Targets::default(), 0))
    }

    /// What a sample of a volume with these settings would hold at a point; `item` decorrelates points.
    pub fn with(
        world: &World,
        light: &impl SurfaceLight,
        position: Vec3,
        settings: &VolumeSettings,
        targets: &Targets,
        item: u32,
    ) -> Self {
        let bins = DirectionBins::new(settings.bins_n);
        let hits = trace_point(world, light, bins, settings, targets, position, item);
        let back_face_fraction = hits.back_face_fraction;
        let met = Met::new(bins, settings, vec![hits]);
        let seen = met.seen(world, light.radiosity(), &settings.ignored);
        let mut reflected_radiance = vec![Vec3::ZERO; bins.len()];
        met.reflected(0, &seen, &mut reflected_radiance);
        let mut radiance = reflected_radiance.clone();
        met.add_emitted(0, &seen, &mut radiance);

        let mut lanes = vec![[0.0; LANES]; bins.len()];
        for (lanes, l) in lanes.iter_mut().zip(&reflected_radiance) {
            for c in 0..3 {
                lanes[c * BLOCK] = l[c];
            }
        }
        let mut out = vec![[0.0; LANES]; bins.len()];
        Quadrature::new(bins).irradiance(&lanes, &mut out);
        let arrivals: Vec<Arrival> =
            world.emitters.list.iter().flat_map(|e| arrivals(world, e, position, settings)).collect();
        Self {
            position,
            bins,
            radiance,
            reflected_radiance,
            direct: Centres::new(bins).irradiance(&arrivals),
            indirect: out.iter().map(|o| Vec3::new(o[0], o[BLOCK], o[2 * BLOCK])).collect(),
            arrivals,
            back_face_fraction,
        }
    }

    /// Moment of an order towards each bin, lx per channel (Greger Eq. 4.8); order 1 is [`Self::irradiance`].
    pub fn moment(&self, order: Order, part: Part) -> Vec<Vec3> {
        if order == Order::IRRADIANCE {
            return self.irradiance(part);
        }
        if order == Order::Infinite {
            return moment_by_definition(self.bins, &self.values(Quantity::Radiance, part), order);
        }
        let mut sum = vec![Vec3::ZERO; self.bins.len()];
        if part != Part::Direct {
            sum = moment_by_definition(self.bins, &self.reflected_radiance, order);
        }
        if part != Part::Indirect {
            let direct = moment_of_arrivals(self.bins, self.arrivals.iter(), order);
            sum.iter_mut().zip(direct).for_each(|(s, d)| *s += d);
        }
        sum
    }

    /// Irradiance of a surface facing each bin, lx per channel.
    pub fn irradiance(&self, part: Part) -> Vec<Vec3> {
        match part {
            Part::Direct => self.direct.clone(),
            Part::Indirect => self.indirect.clone(),
            Part::All => self.direct.iter().zip(&self.indirect).map(|(d, i)| *d + *i).collect(),
        }
    }

    /// One value a bin. Radiance of the direct part is that of emitters seen.
    pub fn values(&self, quantity: Quantity, part: Part) -> Vec<Vec3> {
        match (quantity, part) {
            (Quantity::Irradiance, part) => self.irradiance(part),
            (Quantity::Radiance, Part::All) => self.radiance.clone(),
            (Quantity::Radiance, Part::Indirect) => self.reflected_radiance.clone(),
            (Quantity::Radiance, Part::Direct) => {
                self.radiance.iter().zip(&self.reflected_radiance).map(|(a, r)| *a - *r).collect()
            }
        }
    }

    /// Radial plots through the point in the planes xy, yz and zx: a point of a curve is direction times
    /// luminance of the value there, in the two axes that the plane is named after.
    pub fn radial_plots(&self, quantity: Quantity, part: Part) -> Vec<Curve> {
        const STEPS: usize = 180;
        let values = self.values(quantity, part);
        [("xy", Vec3::X, Vec3::Y), ("yz", Vec3::Y, Vec3::Z), ("zx", Vec3::Z, Vec3::X)]
            .map(|(name, across, along)| {
                let point = |i: usize| {
                    let angle = i as f32 / STEPS as f32 * std::f32::consts::TAU;
                    let d = Vec2::new(angle.cos(), angle.sin());
                    d * luminance(values[self.bins.bin(across * d.x + along * d.y)])
                };
                let axis = |c: char| format!("{} towards {c} ({})", quantity.name(), quantity.unit());
                let mut letters = name.chars();
                Curve {
                    name: format!("{} in the {name} plane", quantity.name()),
                    axes: std::array::from_fn(|_| axis(letters.next().unwrap_or('?'))),
                    points: (0..=STEPS).map(point).collect(),
                    radial: true,
                }
            })
            .into()
    }

    /// The two (u, v) squares of bins, unfolded: upper and lower hemisphere, row v = 0 on top.
    pub fn unfolded(&self, quantity: Quantity, part: Part) -> [NamedImage; 2] {
        let (n, values) = (self.bins.n(), self.values(quantity, part));
        let side = (n * n) as usize;
        [("upper", 0), ("lower", side)].map(|(name, first)| NamedImage {
            name: format!("{}, {name} hemisphere ({})", quantity.name(), quantity.unit()),
            image: LinearImage { width: n, height: n, pixels: values[first..first + side].to_vec() },
        })
    }

    /// Numbers that sum it up.
    pub fn statistics(&self, part: Part) -> ProbeStatistics {
        let irradiance: Vec<f32> = self.irradiance(part).into_iter().map(luminance).collect();
        let radiance: Vec<f32> = self.values(Quantity::Radiance, part).into_iter().map(luminance).collect();
        let mean = |v: &[f32]| (v.iter().map(|&x| f64::from(x)).sum::<f64>() / v.len() as f64) as f32;
        let mut brightest = 0;
        for (i, &e) in irradiance.iter().enumerate() {
            if e > irradiance[brightest] {
                brightest = i;
            }
        }
        let towards = |d: Vec3| irradiance[self.bins.bin(d)];
        let net = |d: Vec3| towards(d) - towards(-d);
        ProbeStatistics {
            min_lx: irradiance.iter().copied().fold(f32::INFINITY, f32::min),
            mean_lx: mean(&irradiance),
            max_lx: irradiance[brightest],
            brightest: self.bins.centre(brightest),
            up_lx: towards(Vec3::Y),
            down_lx: towards(Vec3::NEG_Y),
            vector_lx: Vec3::new(net(Vec3::X), net(Vec3::Y), net(Vec3::Z)),
            max_radiance: radiance.iter().copied().fold(0.0, f32::max),
            mean_radiance: mean(&radiance),
        }
    }
}

/// Radiance that an emitting side sends, the object's dimmer applied, cd/m².
pub(super) fn emission(world: &World, triangle: u32, uv: Vec2) -> Vec3 {
    let geometry = &world.geometry;
    let dimmer = geometry.dimmer[geometry.object[triangle as usize] as usize];
    geometry.material_of(triangle).emission_at(uv, &geometry.textures) * dimmer
}
