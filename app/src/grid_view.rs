//! The texture of the surface that was clicked, stage by stage: what is asked for, and the work behind it.

use anyhow::Result;
use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{image::LinearImage, progress::Progress},
    measure::grid_texture::{GridReference, GridTexture, Stage, StageError, StageSettings},
    radiosity::surface_map::Element,
    transport::LightTransportSolution,
};
use serde::{Deserialize, Serialize};
use std::sync::Arc;

/// A point of a surface, by its triangle's number.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct SurfacePoint {
    /// Triangle.
    pub triangle: u32,
    /// Barycentric weights of corners 1 and 2.
    pub barycentric: Vec2,
    /// Whether it is on the triangle's back.
    pub back: bool,
}

impl SurfacePoint {
    /// Where it is, m, and the normal of the side it is on; `None` where the scene has no such triangle.
    pub fn place(&self, solution: &LightTransportSolution) -> Option<(Vec3, Vec3)> {
        let geometry = &solution.world.geometry;
        if self.triangle as usize >= geometry.len() || !self.barycentric.is_finite() {
            return None;
        }
        let into = geometry.area_normal(self.triangle) * if self.back { 1.0 } else { -1.0 };
        let surface = geometry.surface(self.triangle, self.barycentric, into);
        Some((surface.position, surface.normal))
    }

    /// The element nearest to it; `None` where the scene has no such triangle, or nothing is solved there.
    pub fn element(&self, solution: &LightTransportSolution) -> Option<u32> {
        let radiosity = &solution.radiosity;
        // Copies put into the scene have triangles, but no elements.
        if 2 * self.triangle as usize + 1 >= radiosity.sides().len() || !self.barycentric.is_finite() {
            return None;
        }
        let element = radiosity.element_at(self.triangle, self.barycentric, self.back);
        ((element as usize) < radiosity.elements().len()).then_some(element)
    }
}

/// A texture that is wanted.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridRequest {
    /// A point of its surface.
    pub surface: SurfacePoint,
    /// How its stages are made.
    pub settings: StageSettings,
    /// Whether the path tracer says what they should be.
    pub traced: bool,
}

/// A texture at its three stages.
#[derive(Clone, Debug)]
pub struct GridView {
    /// The grid.
    pub grid: Arc<GridTexture>,
    /// Its stages.
    pub stages: [Stage; 3],
    /// What they should be, as far as that is known.
    pub reference: Option<Traced>,
}

/// Irradiance by the path tracer.
#[derive(Clone, Debug)]
pub struct Traced {
    /// At the points that are judged, lx.
    pub image: LinearImage,
    /// Paths a point.
    pub paths: u32,
    /// Median of its standard error over max(E, 5 % of the mean).
    pub noise: f64,
    /// How far each stage is from it; `None` where that cannot be said.
    pub errors: [Option<StageError>; 3],
}

/// A texture in the making.
pub struct GridWork {
    solution: Arc<LightTransportSolution>,
    grid: Arc<GridTexture>,
    /// Side of the triangle: the inside of a tube is another texture than its outside.
    back: bool,
    settings: StageSettings,
    reference: Option<GridReference>,
}

impl GridWork {
    /// Begins, or goes on with what is known of the same grid in the same light; `None` where the surface has no
    /// grid.
    pub fn new(
        known: Option<Self>,
        solution: &Arc<LightTransportSolution>,
        request: &GridRequest,
    ) -> Option<Self> {
        let element = request.surface.element(solution)?;
        let Element { chart, object, .. } = solution.radiosity.elements()[element as usize];
        let same = |w: &Self| {
            (w.grid.chart, w.grid.object, w.back) == (chart, object, request.surface.back)
                && Arc::ptr_eq(&w.solution.radiosity, &solution.radiosity)
                && Arc::ptr_eq(&w.solution.world, &solution.world)
        };
        let (grid, reference) = match known.filter(same) {
            Some(work) => (work.grid, work.reference),
            None => (Arc::new(GridTexture::of_element(&solution.radiosity, &solution.world, element)?), None),
        };
        let reference = request.traced.then(|| reference.unwrap_or_else(|| GridReference::new(&grid, SEED)));
        let back = request.surface.back;
        Some(Self { solution: solution.clone(), grid, back, settings: request.settings, reference })
    }

    /// Whether there is more to trace.
    pub fn wants_more(&self) -> bool {
        self.reference.as_ref().is_some_and(|r| !r.is_done())
    }

    /// Traces some more.
    ///
    /// # Errors
    /// If the work was cancelled; what was traced before stays.
    pub fn more(&mut self, progress: &Progress) -> Result<GridView> {
        progress.begin("irradiance of a texture");
        if let Some(reference) = &mut self.reference {
            reference.more(&self.grid, &self.solution.world, progress)?;
        }
        Ok(self.view())
    }

    /// What is known so far.
    pub fn view(&self) -> GridView {
        let stages = self.grid.stages(&self.settings);
        let traced = self.reference.as_ref().filter(|r| r.paths() > 0).map(|reference| {
            let image = reference.mean(&self.grid);
            let errors = std::array::from_fn(|i| self.grid.judge(&stages[i], &image).ok());
            Traced { paths: reference.paths(), noise: reference.noise(&self.grid), image, errors }
        });
        GridView { grid: self.grid.clone(), stages, reference: traced }
    }
}

const SEED: u64 = 1;
