//! Numbers of an irradiance sphere: irradiance from the six sides, scalar, vector, cylindrical.

use super::{sphere_image::SphereValues, value_table::Row};
use glam::Vec3;
use lumenscope_core::math::colour::luminance;

/// Numbers of the light at one point; all in lx.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SphereNumbers {
    /// Illuminance of planes facing +x, −x, +y, −y, +z, −z.
    pub six: [f32; 6],
    /// ∫ L dω.
    pub scalar: f32,
    /// ∫ L ω dω.
    pub vector: Vec3,
    /// Mean over all upright planes: 1/π ∫ L sin θ dω.
    pub cylindrical: f32,
}

impl SphereNumbers {
    /// Reads an irradiance sphere, lamps without a surface included.
    ///
    /// As E(n) = ∫ L max(0, n·ω) dω, the integral of E over all n is π ∫ L dω, and E(n) − E(−n) is the
    /// vector's component along n.
    pub fn new(irradiance: &SphereValues<'_>) -> Self {
        let e = |n: Vec3| luminance(irradiance.smooth(n));
        let six = [Vec3::X, Vec3::NEG_X, Vec3::Y, Vec3::NEG_Y, Vec3::Z, Vec3::NEG_Z].map(e);
        let solid_angle = f64::from(irradiance.bins.solid_angle());
        let sum: f64 = irradiance.values.iter().map(|v| f64::from(luminance(*v)) * solid_angle).sum();
        const AROUND: u32 = 72;
        let around: f64 = (0..AROUND)
            .map(|i| {
                let (sin, cos) = (std::f32::consts::TAU * i as f32 / AROUND as f32).sin_cos();
                f64::from(e(Vec3::new(cos, 0.0, sin)))
            })
            .sum();
        Self {
            six,
            scalar: (sum / std::f64::consts::PI) as f32,
            vector: Vec3::new(six[0] - six[1], six[2] - six[3], six[4] - six[5]),
            cylindrical: (around / f64::from(AROUND)) as f32,
        }
    }

    /// The rows of a table.
    pub fn rows(&self) -> Vec<Row> {
        const PLANE: &str = "Irradiance of a plane facing this way: E(n) = ∫ L(ω) max(0, n·ω) dω";
        let [px, nx, py, ny, pz, nz] = self.six;
        let mut rows: Vec<Row> =
            [("E up (+y)", py), ("E down (-y)", ny), ("E +x", px), ("E -x", nx), ("E +z", pz), ("E -z", nz)]
                .into_iter()
                .map(|(name, value)| Row::one(name, value, "lx", PLANE))
                .collect();
        rows.push(Row::one(
            "E cylindrical",
            self.cylindrical,
            "lx",
            "Mean over all upright planes, how well faces are lit: 1/π ∫ L(ω) sin θ dω",
        ));
        rows.push(Row::one("E scalar", self.scalar, "lx", "Light from everywhere: ∫ L(ω) dω"));
        rows.push(Row {
            name: "E vector",
            values: self.vector.to_array().to_vec(),
            unit: "lx (x y z)",
            meaning: "Where the light comes from, net: ∫ L(ω) ω dω",
        });
        let ratio = if self.scalar > 0.0 { self.vector.length() / self.scalar } else { 0.0 };
        rows.push(Row::one(
            "|vector| / scalar",
            ratio,
            "",
            "How directed the light is: 0 from all sides alike, 1 from one direction",
        ));
        rows
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use lumenscope_core::math::sphere_map::DirectionBins;
    use std::f32::consts::PI;

    #[test]
    fn constant_radiance_gives_the_closed_forms() {
        let bins = DirectionBins::new(17);
        let values = vec![Vec3::splat(3.0 * PI); bins.len()];
        let numbers = SphereNumbers::new(&SphereValues { bins, values: &values });
        for e in numbers.six {
            assert!((e / (3.0 * PI) - 1.0).abs() < 1e-5, "{e}");
        }
        assert!((numbers.scalar / (12.0 * PI) - 1.0).abs() < 1e-4);
        assert!(numbers.vector.length() < 1e-3);
        assert!((numbers.cylindrical / (3.0 * PI) - 1.0).abs() < 1e-5);
    }

    #[test]
    fn one_distant_lamp_gives_the_closed_forms() {
        let bins = DirectionBins::new(41);
        let values: Vec<Vec3> =
            (0..bins.len()).map(|b| Vec3::splat(500.0 * bins.centre(b).x.max(0.0))).collect();
        let numbers = SphereNumbers::new(&SphereValues { bins, values: &values });
        // Bilinear values of 2 · 41² bins of a cosine: within 1 %.
        assert!((numbers.six[0] / 500.0 - 1.0).abs() < 0.01);
        assert!((numbers.scalar / 500.0 - 1.0).abs() < 0.01);
        assert!((numbers.vector - Vec3::X * 500.0).length() < 5.0);
        assert!((numbers.cylindrical / (500.0 / PI) - 1.0).abs() < 0.01);
    }
}
