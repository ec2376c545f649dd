//! Lists of pixels that a pass has work for: twin of `shaders/mirror/work.wgsl`.
//!
//! Most pixels show no mirror, and of those that do few show a mirror in it. A pass over the whole picture
//! costs where nothing is to be done almost what it costs where something is; a list costs what it holds.

/// Words of a list's head: workgroups to dispatch (x, 1, 1) and its length.
const HEAD: u64 = 4;
/// Lists: of depth 1, of even depth, of odd depth, of what reflects without a view.
const LISTS: u64 = 4;
/// Pixels of a row that one invocation sorts into lists.
pub(super) const RUN: u32 = 8;

/// A list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum List {
    /// Pixels to follow at a depth, from 1.
    Depth(u32),
    /// Pixels that reflect and have no view.
    WithoutView,
}

impl List {
    pub fn number(self) -> u64 {
        match self {
            Self::Depth(..=1) => 0,
            Self::WithoutView => 3,
            Self::Depth(depth) => 1 + u64::from(depth % 2),
        }
    }
}

/// The lists of a picture.
pub(super) struct Work {
    /// Heads, then the lists.
    pub lists: wgpu::Buffer,
    empty: wgpu::Buffer,
    dispatch: wgpu::Buffer,
    /// Number of each list that is followed.
    pub steps: [wgpu::Buffer; LISTS as usize],
}

impl Work {
    /// Lists for a picture of a size.
    pub fn new(device: &wgpu::Device, queue: &wgpu::Queue, [width, height]: [u32; 2]) -> Self {
        use wgpu::BufferUsages as Usage;
        let buffer = |label, words: u64, usage| {
            device.create_buffer(&wgpu::BufferDescriptor {
                label: Some(label),
                size: 4 * words,
                usage,
                mapped_at_creation: false,
            })
        };
        let pixels = u64::from(width) * u64::from(height);
        let lists = Usage::STORAGE | Usage::COPY_SRC | Usage::COPY_DST;
        let empty = buffer("empty lists", LISTS * HEAD, Usage::COPY_SRC | Usage::COPY_DST);
        queue.write_buffer(&empty, 0, bytemuck::cast_slice(&[[0u32, 1, 1, 0]; LISTS as usize]));
        let steps = [0u32, 1, 2, 3].map(|list| {
            let step = buffer("list", 4, Usage::UNIFORM | Usage::COPY_DST);
            queue.write_buffer(&step, 0, bytemuck::cast_slice(&[list, 0, 0, 0]));
            step
        });
        Self {
            lists: buffer("lists of pixels", LISTS * (HEAD + pixels), lists),
            empty,
            dispatch: buffer("dispatch", HEAD, Usage::INDIRECT | Usage::COPY_DST),
            steps,
        }
    }

    /// Empties all lists.
    pub fn clear(&self, encoder: &mut wgpu::CommandEncoder) {
        encoder.copy_buffer_to_buffer(&self.empty, 0, &self.lists, 0, Some(4 * LISTS * HEAD));
    }

    /// Empties one.
    pub fn clear_list(&self, encoder: &mut wgpu::CommandEncoder, list: List) {
        encoder.copy_buffer_to_buffer(&self.empty, 0, &self.lists, 4 * HEAD * list.number(), Some(4 * HEAD));
    }

    /// What to dispatch for a list.
    pub fn dispatch(&self, encoder: &mut wgpu::CommandEncoder, list: List) -> &wgpu::Buffer {
        encoder.copy_buffer_to_buffer(
            &self.lists,
            4 * HEAD * list.number(),
            &self.dispatch,
            0,
            Some(4 * HEAD),
        );
        &self.dispatch
    }
}
