//! A generated cinder-block wall put into a picture after the solve, streamed by and lit from the volume.

use anyhow::{Context as _, Result, bail};
use glam::{UVec2, Vec3};
use lumenscope_core::{
    math::progress::Progress,
    scene::camera::Camera,
    superposition::{
        gbuffer::GBuffer,
        layers::Layers,
        pass::PassSettings,
        streamed::{StreamCounts, StreamedPicture, Strip},
    },
    transport::LightTransportSolution,
};
use lumenscope_scenes::wall::Wall;
use std::time::{Duration, Instant};

/// Triangles of a wall at least, as many as the thesis's model of a building had.
pub const POLYGONS: u32 = 612_000;

/// A wall, and how it is drawn.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallSettings {
    /// Triangles at least.
    pub polygons: u32,
    /// Lower left corner seen from its front, m.
    pub corner: Vec3,
    /// Its edge along the courses, m.
    pub edge_u: Vec3,
    /// Its edge upwards, m; the front looks along `edge_u × edge_v`.
    pub edge_v: Vec3,
    /// Diffuse reflectance of all channels.
    pub reflectance: f32,
    /// Rows of quadrilaterals held at a time.
    pub rows: u32,
    /// Shadow rays an area emitter and pixel for its direct light; 0 takes that from the volume too.
    pub shadow_rays: u32,
}

/// What drawing a wall took.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct WallReport {
    /// What came by.
    pub counts: StreamCounts,
    /// Time spent generating it.
    pub generating: Duration,
    /// Time spent on its direct light at pixels.
    pub direct: Duration,
    /// Pixels in which it shows.
    pub pixels: usize,
}

impl WallSettings {
    /// A wall along the left side of a scene, as high as that is.
    pub fn beside(solution: &LightTransportSolution) -> Self {
        let (low, high) = solution.world.geometry.bounds();
        let clearance = 0.002 * (high - low).x;
        Self {
            polygons: POLYGONS,
            corner: Vec3::new(low.x + clearance, low.y, high.z),
            edge_u: Vec3::NEG_Z * (high - low).z,
            edge_v: Vec3::Y * (high - low).y,
            reflectance: 0.55,
            rows: 8,
            shadow_rays: 16,
        }
    }

    /// Whether it can be drawn.
    ///
    /// # Errors
    /// Where it has no area, or does not reflect from nothing to less than all light.
    pub fn check(&self) -> Result<()> {
        if self.edge_u.cross(self.edge_v).length() < 1e-6 {
            bail!("the wall's edges {} and {} span no area", self.edge_u, self.edge_v);
        }
        if !(0.0..1.0).contains(&self.reflectance) {
            bail!("the wall's reflectance {} must lie between 0 and 1", self.reflectance);
        }
        Ok(())
    }

    /// Puts the wall into the layers of a picture that `camera` took of a solution.
    ///
    /// # Errors
    /// Where it is [no wall](Self::check), there is no volume to light it, or the work was cancelled.
    pub fn draw(
        &self,
        solution: &LightTransportSolution,
        camera: &Camera,
        layers: &mut Layers,
        progress: &Progress,
    ) -> Result<WallReport> {
        self.check()?;
        let volume = solution.volume.as_deref().context("the plan built no volume to light the wall")?;
        progress.begin("wall");
        let size = UVec2::new(layers.images[0].width, layers.images[0].height);
        let buffer = GBuffer::new(&solution.world, camera, size, PassSettings::default().subpixel());
        let (u, v) = (self.edge_u.as_dvec3(), self.edge_v.as_dvec3());
        let wall = Wall::new(self.corner.as_dvec3(), u, v, self.polygons);
        let mut streamed = StreamedPicture::new(&buffer, camera, volume, Vec3::splat(self.reflectance));
        let start = Instant::now();
        for strip in wall.strips(self.rows) {
            progress.report(streamed.counts().polygons as f32 / self.polygons.max(1) as f32)?;
            streamed.draw(&Strip {
                positions: &strip.positions,
                normals: &strip.normals,
                triangles: &strip.triangles,
            });
        }
        let streaming = start.elapsed();
        progress.begin("light on the wall");
        let start = Instant::now();
        streamed.composite(layers, &solution.world, self.shadow_rays, progress)?;
        let counts = streamed.counts();
        Ok(WallReport {
            counts,
            generating: streaming.saturating_sub(counts.shading + counts.drawing),
            direct: start.elapsed(),
            pixels: streamed.pixels(),
        })
    }
}
