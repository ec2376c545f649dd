//! Where illuminance is measured, and what is asked of it: the part of a document that placement needs.

use lumenscope_core::{
    irradiance_volume::placement::{Measurement, grid::MeasuringGrid, requirement::Requirement},
    scene::{MeasuringPlane, Scene, geometry::Geometry},
};
use serde::{Deserialize, Serialize};
use std::fmt::Write as _;

/// The view that shows a measurement in the scene.
pub const PLACEMENT: &str = "irradiance_volume.placement";

/// Where illuminance is measured.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Site {
    /// A plane of the scene file, by its index there.
    Plane(usize),
    /// The document's own plane.
    Own,
    /// The top of an object, by its index.
    Top(usize),
}

/// Where illuminance is measured, and what is asked of it.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(default)]
pub struct Placement {
    /// Where; `None` measures nothing.
    pub site: Option<Site>,
    /// The document's own plane, for [`Site::Own`].
    pub own: MeasuringPlane,
    /// What is asked.
    pub requirement: Requirement,
    /// Illuminance kept in use over that of new, clean lamps.
    pub maintenance_factor: f32,
    /// How many times finer than EN 12464-1 asks the grid is, along each edge.
    pub finer: u32,
}

impl Default for Placement {
    fn default() -> Self {
        Self {
            site: None,
            own: own_plane(glam::Vec3::new(0.0, 0.75, 0.0)),
            requirement: Requirement::default(),
            maintenance_factor: 1.0,
            finer: 3,
        }
    }
}

/// A level plane of a desk's size around a point.
pub fn own_plane(middle: glam::Vec3) -> MeasuringPlane {
    let (u, v) = (glam::Vec3::X * 1.6, glam::Vec3::Z * -0.8);
    MeasuringPlane { name: "Own plane".into(), corner: middle - 0.5 * (u + v), edge_u: u, edge_v: v }
}

impl Placement {
    /// Why it cannot be taken for a scene, if it cannot.
    pub fn problem(&self, scene: &Scene) -> Option<&'static str> {
        /// As far as a scene's own coordinates may reach.
        const FARTHEST_M: f32 = 1e5;
        let own = &self.own;
        let missing = match self.site {
            Some(Site::Plane(i)) => i >= scene.planes.len(),
            Some(Site::Top(i)) => i >= scene.objects.len(),
            Some(Site::Own) | None => false,
        };
        if missing {
            return Some("the scene has no such plane or object");
        }
        let near = |v: glam::Vec3| v.is_finite() && v.abs().max_element() <= FARTHEST_M;
        if ![own.corner, own.edge_u, own.edge_v].into_iter().all(near)
            || own.edge_u.cross(own.edge_v).normalize_or_zero() == glam::Vec3::ZERO
        {
            return Some("the plane to be measured has no area");
        }
        if !self.requirement.is_finite() {
            return Some("what is asked of the light is not a number");
        }
        if !(0.01..=1.0).contains(&self.maintenance_factor) {
            return Some("a maintenance factor lies between 0.01 and 1");
        }
        (!(1..=16).contains(&self.finer)).then_some("the grid can be 1 to 16 times finer than asked for")
    }

    /// Name and points of what is measured.
    pub fn grid(&self, scene: &Scene, geometry: &Geometry) -> Option<(String, MeasuringGrid)> {
        match self.site? {
            Site::Plane(i) => {
                let plane = scene.planes.get(i)?;
                Some((plane.name.clone(), MeasuringGrid::on_plane(plane, self.finer)))
            }
            Site::Own => Some((self.own.name.clone(), MeasuringGrid::on_plane(&self.own, self.finer))),
            Site::Top(i) => {
                let name = format!("Top of {}", scene.objects.get(i)?.name);
                Some((name, MeasuringGrid::on_top(geometry, i, self.finer)?))
            }
        }
    }
}

/// Every point measured: position in m, illuminance in lx.
pub fn csv(measured: &Measurement) -> String {
    let mut text = String::from("u,v,x,y,z,E_lx\n");
    let nx = measured.grid.nx as usize;
    for (i, (point, value)) in measured.grid.points.iter().zip(&measured.values).enumerate() {
        if let (Some(p), Some(e)) = (point, value) {
            // Writing to a string cannot fail.
            let _ = writeln!(text, "{},{},{},{},{},{e}", i % nx, i / nx, p.x, p.y, p.z);
        }
    }
    text
}
