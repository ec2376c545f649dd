//! What one frame shows, and the uniforms it becomes.

use crate::{
    math::{
        false_colour::FalseColour,
        random::{fold, r2_point},
    },
    scene::camera::Camera,
    superposition::{
        composite::{DirectQuality, Display, ToneCurve, white_luminance},
        layers::{COUNT, Weights},
        overlay,
    },
};
use bytemuck::{Pod, Zeroable};
use glam::{UVec2, Vec2, Vec3, Vec4};

/// What one frame shows.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FrameSettings {
    /// From where.
    pub camera: Camera,
    /// Width and height in pixels.
    pub size: [u32; 2],
    /// Weight of each layer, in the order of [`crate::superposition::layers::Layer::ALL`].
    pub weights: Weights,
    /// From radiance to display.
    pub display: Display,
    /// How direct light is evaluated.
    pub direct: DirectQuality,
    /// Number of the frame: frames differ in their shadow rays. 0 starts over when accumulating.
    pub frame_index: u32,
    /// Whether this frame joins the running mean of those before it, with jittered pixels; otherwise
    /// it replaces them. Start with `frame_index` 0 after any change of camera, size or solution.
    pub accumulate: bool,
    /// Object to outline.
    pub highlighted: Option<u32>,
    /// Seed of every random number.
    pub seed: u64,
}

impl Default for FrameSettings {
    fn default() -> Self {
        Self {
            camera: Camera::default(),
            size: [640, 360],
            weights: [1.0; COUNT],
            display: Display::default(),
            direct: DirectQuality::PerPixel(4),
            frame_index: 0,
            accumulate: false,
            highlighted: None,
            seed: 1,
        }
    }
}

/// `Frame` of `shaders/shared/frame.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Frame {
    /// Eye, m.
    pub eye: Vec3,
    /// Number of the frame.
    pub frame: u32,
    /// Unit direction through the middle of the picture.
    pub forward: Vec3,
    /// Shadow rays an area emitter.
    pub samples: u32,
    /// Unit direction to the right.
    pub right: Vec3,
    /// Emitters.
    pub emitter_count: u32,
    /// Unit direction upwards in the picture.
    pub up: Vec3,
    /// Trees.
    pub tree_count: u32,
    /// Slopes of the picture's right and upper edge.
    pub half_size: Vec2,
    /// Size in pixels.
    pub size: UVec2,
    /// Place inside the pixels that rays go through.
    pub subpixel: Vec2,
    /// Seed.
    pub seed: u32,
    /// Frames already in the running mean.
    pub accumulated: u32,
    /// Distance that becomes depth 1, m.
    pub near: f32,
    /// Object outlined, or `u32::MAX`.
    pub highlighted: u32,
    /// Width of lines, pixels.
    pub line_width: f32,
    /// Share of their distance that lines and meshes are drawn nearer.
    pub depth_bias: f32,
}

impl Frame {
    /// The uniform of a frame that joins `accumulated` others.
    pub fn new(settings: &FrameSettings, [emitter_count, tree_count]: [u32; 2], accumulated: u32) -> Self {
        let camera = &settings.camera;
        let view = camera.view_from_world();
        let row = |i: usize| view.row(i).truncate();
        let size = UVec2::from(settings.size);
        let half = (0.5 * camera.vertical_fov).tan();
        let seed = fold(settings.seed);
        Self {
            eye: camera.eye,
            frame: settings.frame_index,
            forward: -row(2),
            samples: match settings.direct {
                DirectQuality::Elements => 0,
                DirectQuality::PerPixel(samples) => samples,
            },
            right: row(0),
            emitter_count,
            up: row(1),
            tree_count,
            half_size: Vec2::new(half * size.x as f32 / size.y as f32, half),
            size,
            subpixel: if settings.accumulate {
                r2_point(settings.frame_index, seed)
            } else {
                Vec2::splat(0.5)
            },
            seed,
            accumulated,
            near: overlay::NEAR,
            highlighted: settings.highlighted.unwrap_or(u32::MAX),
            line_width: overlay::LINE_WIDTH,
            depth_bias: overlay::DEPTH_BIAS,
        }
    }
}

/// `Composite` of `shaders/superposition/composite.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct Composite {
    /// Weights of emitted, direct and indirect light.
    pub weights: Vec3,
    /// 1 / luminance that becomes display 1, m²/cd.
    pub exposure: f32,
    /// 0 linear, 1 filmic.
    pub tone: u32,
    /// Whether luminance is shown as false colour.
    pub false_colour: u32,
    /// Whether the shader encodes sRGB.
    pub encode: u32,
    /// Layers there are: three where nothing is specular.
    pub layer_count: u32,
    /// Weights of mirrored and glossy light.
    pub specular_weights: Vec2,
    /// Nothing.
    pub padding: [u32; 2],
}

impl Composite {
    /// The uniform of a display; `encode` where the target does not encode sRGB itself.
    pub fn new(weights: Weights, display: &Display, encode: bool, layer_count: u32) -> Self {
        Self {
            weights: Vec3::from_slice(&weights),
            exposure: 1.0 / white_luminance(display.ev100),
            tone: match display.tone {
                ToneCurve::Linear => 0,
                ToneCurve::Filmic => 1,
            },
            false_colour: display.false_colour.is_some().into(),
            encode: encode.into(),
            layer_count,
            specular_weights: Vec2::new(weights[3], weights[4]),
            padding: [0; 2],
        }
    }
}

/// `FalseColour` of `shaders/shared/false_colour.wgsl`.
#[repr(C)]
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
pub struct FalseColourTable {
    /// Value at the dark end.
    pub low: f32,
    /// Value at the bright end.
    pub high: f32,
    /// Whether equal steps are equal ratios.
    pub logarithmic: u32,
    /// Nothing.
    pub padding: u32,
    /// Linear RGB.
    pub palette: [Vec4; 256],
}

impl FalseColourTable {
    /// The uniform of a false colour.
    pub fn new(colour: &FalseColour) -> Self {
        Self {
            low: colour.low,
            high: colour.high,
            logarithmic: colour.logarithmic.into(),
            padding: 0,
            palette: colour.palette.table().map(|c| c.extend(1.0)),
        }
    }
}
