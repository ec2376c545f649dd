//! The shader library: every program as the WGSL files it is made of, in order.
//!
//! Files are joined, never rewritten; a variant is another entry point.

use crate::radiosity::lookup::Lookup;

/// One program: what a shader module is made from.
#[derive(Clone, Copy, Debug)]
pub struct Program {
    /// Its name, for labels and messages.
    pub name: &'static str,
    /// Files it begins with.
    begins: &'static [&'static str],
    /// Its own files.
    files: &'static [&'static str],
}

macro_rules! wgsl {
    ($path:literal) => {
        include_str!(concat!("../../../shaders/", $path))
    };
}

/// What the programs that shade surfaces begin with.
const SHADING: &[&str] = &[
    wgsl!("shared/random.wgsl"),
    wgsl!("shared/frame.wgsl"),
    wgsl!("shared/scene.wgsl"),
    wgsl!("shared/reflection.wgsl"),
    wgsl!("shared/rays.wgsl"),
    wgsl!("shared/glass.wgsl"),
    wgsl!("shared/direct.wgsl"),
    wgsl!("shared/elements.wgsl"),
    wgsl!("glossy/environment.wgsl"),
    wgsl!("shared/layers.wgsl"),
    wgsl!("superposition/terms.wgsl"),
];

/// Which triangle each pixel sees.
pub const VISIBILITY: Program = Program {
    name: "visibility",
    begins: &[],
    files: &[wgsl!("shared/frame.wgsl"), wgsl!("shared/scene.wgsl"), wgsl!("superposition/visibility.wgsl")],
};

/// The layers.
pub const SHADE: Program =
    Program { name: "shade", begins: SHADING, files: &[wgsl!("superposition/shade.wgsl")] };

/// Which triangle each pixel sees by way of mirrors.
pub const MIRROR_VISIBILITY: Program = Program {
    name: "mirror visibility",
    begins: &[],
    files: &[
        wgsl!("shared/frame.wgsl"),
        wgsl!("shared/scene.wgsl"),
        wgsl!("mirror/views.wgsl"),
        wgsl!("mirror/visibility.wgsl"),
    ],
};

/// What arrives by way of mirrors.
pub const MIRROR_FOLLOW: Program = Program {
    name: "mirror follow",
    begins: SHADING,
    files: &[
        wgsl!("mirror/views.wgsl"),
        wgsl!("mirror/state.wgsl"),
        wgsl!("mirror/work.wgsl"),
        wgsl!("mirror/follow.wgsl"),
    ],
};

/// Mirrored views from images-with-depth.
pub const MIRROR_SPLAT: Program = Program {
    name: "mirror splat",
    begins: &[],
    files: &[
        wgsl!("shared/frame.wgsl"),
        wgsl!("mirror/views.wgsl"),
        wgsl!("mirror/work.wgsl"),
        wgsl!("mirror/splat.wgsl"),
    ],
};

/// The glossy layer.
pub const GLOSSY: Program = Program {
    name: "glossy",
    begins: &[],
    files: &[
        wgsl!("shared/frame.wgsl"),
        wgsl!("shared/scene.wgsl"),
        wgsl!("shared/reflection.wgsl"),
        wgsl!("shared/layers.wgsl"),
        wgsl!("mirror/views.wgsl"),
        wgsl!("mirror/state.wgsl"),
        wgsl!("glossy/lobes.wgsl"),
        wgsl!("glossy/lobe.wgsl"),
        wgsl!("glossy/pyramid.wgsl"),
        wgsl!("glossy/convolve.wgsl"),
        wgsl!("glossy/invariant.wgsl"),
        wgsl!("glossy/half.wgsl"),
    ],
};

/// The glossy layer by particles.
pub const PARTICLES: Program = Program {
    name: "particles",
    begins: SHADING,
    files: &[wgsl!("glossy/lobe.wgsl"), wgsl!("glossy/particles.wgsl")],
};

/// From layers to display.
pub const COMPOSITE: Program = Program {
    name: "composite",
    begins: &[],
    files: &[
        wgsl!("shared/frame.wgsl"),
        wgsl!("shared/false_colour.wgsl"),
        wgsl!("superposition/composite.wgsl"),
    ],
};

/// What a view shows.
pub const INSPECTION: Program = Program {
    name: "inspection",
    begins: &[],
    files: &[
        wgsl!("shared/frame.wgsl"),
        wgsl!("shared/false_colour.wgsl"),
        wgsl!("shared/sphere_map.wgsl"),
        wgsl!("superposition/inspection.wgsl"),
    ],
};

/// Every program.
pub const ALL: [Program; 9] = [
    VISIBILITY,
    SHADE,
    MIRROR_VISIBILITY,
    MIRROR_FOLLOW,
    MIRROR_SPLAT,
    GLOSSY,
    PARTICLES,
    COMPOSITE,
    INSPECTION,
];

/// Overridable constants of the programs that shade.
///
/// `general` is what `SceneTables::is_general` says of the scene.
pub(crate) fn constants(general: bool, needs: Needs) -> [(&'static str, f64); 3] {
    let flag = |on: bool| f64::from(u8::from(on));
    [
        ("general", flag(general)),
        ("mitchell", flag(needs.lookup == Lookup::Mitchell)),
        ("glass", flag(needs.glass)),
    ]
}

/// What a solution needs of the programs that shade: pipelines are made anew where it changes.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(crate) struct Needs {
    /// How radiosity is looked up.
    pub lookup: Lookup,
    /// Whether light passes through anything.
    pub glass: bool,
}

impl Program {
    /// Its whole source.
    pub fn source(&self) -> String {
        [self.begins, self.files].concat().join("\n")
    }

    /// Compiles it.
    pub fn module(&self, device: &wgpu::Device) -> wgpu::ShaderModule {
        device.create_shader_module(wgpu::ShaderModuleDescriptor {
            label: Some(self.name),
            source: wgpu::ShaderSource::Wgsl(self.source().into()),
        })
    }
}
