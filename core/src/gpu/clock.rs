//! Where a frame's time goes on the device: a timestamp after each stage.

use super::{device::GpuError, readback};
use crate::mirror::MOST_VIEWS;

/// A part of a frame.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Stage {
    /// Which triangle each pixel sees.
    Visibility,
    /// The diffuse layers.
    Shading,
    /// Which triangles are seen in mirrors.
    MirroredVisibility,
    /// What they send to the mirrors.
    MirroredShading,
    /// Convolution of the mirror image, or the sum of particles.
    Convolution,
    /// Reflectance times what arrives.
    Modulation,
    /// From layers to display.
    Composite,
}

impl Stage {
    /// All, in the order of a frame.
    pub const ALL: [Self; 7] = [
        Self::Visibility,
        Self::Shading,
        Self::MirroredVisibility,
        Self::MirroredShading,
        Self::Convolution,
        Self::Modulation,
        Self::Composite,
    ];

    /// Name in tables and files.
    pub fn name(self) -> &'static str {
        match self {
            Self::Visibility => "visibility",
            Self::Shading => "shading",
            Self::MirroredVisibility => "mirrored_visibility",
            Self::MirroredShading => "mirrored_shading",
            Self::Convolution => "convolution",
            Self::Modulation => "modulation",
            Self::Composite => "composite",
        }
    }
}

/// Timestamps a frame, at most: two for each depth of mirrors, one for each stage, and the first.
const MOST_MARKS: u32 = 2 * MOST_VIEWS as u32 + Stage::ALL.len() as u32 + 1;

/// Timestamps of one frame.
pub struct StageClock {
    queries: wgpu::QuerySet,
    ticks: wgpu::Buffer,
    milliseconds_per_tick: f64,
    marks: Vec<Stage>,
}

impl StageClock {
    /// What a device must have for it.
    pub const FEATURES: wgpu::Features =
        wgpu::Features::TIMESTAMP_QUERY.union(wgpu::Features::TIMESTAMP_QUERY_INSIDE_ENCODERS);

    /// A clock; `None` where the device has no timestamps.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue) -> Option<Self> {
        if !device.features().contains(Self::FEATURES) {
            return None;
        }
        Some(Self {
            queries: device.create_query_set(&wgpu::QuerySetDescriptor {
                label: Some("stages"),
                ty: wgpu::QueryType::Timestamp,
                count: MOST_MARKS,
            }),
            ticks: device.create_buffer(&wgpu::BufferDescriptor {
                label: Some("stages"),
                size: 8 * u64::from(MOST_MARKS),
                usage: wgpu::BufferUsages::QUERY_RESOLVE | wgpu::BufferUsages::COPY_SRC,
                mapped_at_creation: false,
            }),
            milliseconds_per_tick: f64::from(queue.get_timestamp_period()) * 1e-6,
            marks: Vec::new(),
        })
    }

    /// Begins a frame.
    pub(crate) fn begin(&mut self, encoder: &mut wgpu::CommandEncoder) {
        self.marks.clear();
        encoder.write_timestamp(&self.queries, 0);
    }

    /// What was recorded since the last mark is a stage's.
    ///
    /// # Panics
    /// If a frame has more marks than mirrors can be deep.
    pub(crate) fn mark(&mut self, encoder: &mut wgpu::CommandEncoder, stage: Stage) {
        self.marks.push(stage);
        assert!((self.marks.len() as u32) < MOST_MARKS, "a frame of more than {MOST_MARKS} timestamps");
        encoder.write_timestamp(&self.queries, self.marks.len() as u32);
    }

    /// Ends a frame.
    pub(crate) fn end(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.resolve_query_set(&self.queries, 0..self.marks.len() as u32 + 1, &self.ticks, 0);
    }

    /// The stages of the last frame, in their order.
    pub fn stages(&self) -> &[Stage] {
        &self.marks
    }

    /// Milliseconds of each stage of the last submitted frame, in the order of [`Stage::ALL`]. It waits.
    ///
    /// # Errors
    /// [`GpuError::Readback`] if the device is lost.
    pub fn read(&self, device: &wgpu::Device, queue: &wgpu::Queue) -> Result<[f64; 7], GpuError> {
        let bytes = readback::buffer(device, queue, &self.ticks, 8 * (self.marks.len() as u64 + 1))?;
        let ticks: Vec<u64> = bytemuck::pod_collect_to_vec(&bytes);
        let mut spent = [0.0; 7];
        for (stage, between) in self.marks.iter().zip(ticks.windows(2)) {
            let ticks = between[1].saturating_sub(between[0]);
            spent[*stage as usize] += ticks as f64 * self.milliseconds_per_tick;
        }
        Ok(spent)
    }
}

/// Marks a stage where there is a clock.
pub(crate) fn mark(clock: &mut Option<StageClock>, encoder: &mut wgpu::CommandEncoder, stage: Stage) {
    if let Some(clock) = clock {
        clock.mark(encoder, stage);
    }
}
