//! The only file that names every room: one row a view, for the program, the command line and the tour.

use crate::{
    glossy::{
        inspect::KernelView, inspect_maps::maps, inspect_point::KernelPoint, particles::inspect::density,
    },
    inspection::InspectionScene,
    irradiance_volume::{
        IrradianceVolume,
        difference::Difference,
        inspect::{self as volume, VolumeView},
        inspect_sampling as sampling, lighting,
        lobe::lobe_scene,
        placement::{self, Measurement, requirement::Requirement},
        probe::{Probe, Quantity},
        self_occlusion, slice,
    },
    math::part::Part,
    mirror::{
        MirrorSettings, images::inspect::images as mirror_images, inspect as mirror, reflectors::Reflectors,
    },
    radiosity::{
        inspect as radiosity, inspect_elements, inspect_exchange as exchange, inspect_light,
        inspect_lightmap::{self, Shown},
        lightmap::LightmapReport,
    },
    transport::LightTransportSolution,
};
use glam::Vec3;

/// One inspection view.
pub struct ViewRow {
    /// Name in sessions, on the command line and in `screenshots/`: `room.view`.
    pub id: &'static str,
    /// Systems it shows, as in the README's table.
    pub systems: &'static [&'static str],
    /// Title on screen.
    pub title: &'static str,
    /// What it shows, with its equation.
    pub tooltip: &'static str,
    /// Makes it; `None` when the solution has nothing to show it with.
    pub build: fn(&ViewInput) -> Option<InspectionScene>,
}

/// What views are made from.
pub struct ViewInput<'a> {
    /// The light.
    pub solution: &'a LightTransportSolution,
    /// The probe that is open.
    pub probe: Option<&'a Probe>,
    /// The point of a surface that was clicked, m, and its normal.
    pub point: Option<(Vec3, Vec3)>,
    /// The element that was clicked.
    pub element: Option<u32>,
    /// How the volume is shown.
    pub volume: &'a VolumeView,
    /// The volume that the solution's is compared with.
    pub against: Option<&'a IrradianceVolume>,
    /// Illuminance where it is measured, and what is asked of it.
    pub placement: Option<(&'a Measurement, &'a Requirement)>,
    /// The lightmap that is held against the light.
    pub lightmap: Option<&'a LightmapReport>,
}

/// Radius of an open probe's spheres, as a share of the scene's diagonal.
const PROBE_RADIUS: f32 = 0.02;

/// How far off a clicked surface a sample's rays start, m.
const PROBE_OFF_M: f32 = 0.02;

/// Farthest a probe's lobe reaches, as a share of the scene's diagonal.
const LOBE_REACH: f32 = 0.05;

/// Every view, room by room.
pub const VIEWS: &[ViewRow] = &[
    ViewRow {
        id: "irradiance_volume.spheres",
        systems: &["G2", "G3", "G5", "G8"],
        title: "Volume samples",
        tooltip: "A sphere at every sample of the irradiance volume. Its colour in direction ω is the irradiance E(ω) = ∫ L(ω') max(0, ω·ω') dω' of a surface facing that way, or the radiance L(ω) that arrives from there.",
        build: |input| {
            let s = input.solution;
            Some(volume::volume_spheres(
                s.volume.as_ref()?,
                &s.world,
                &*s.radiosity,
                input.volume,
                input.against,
            ))
        },
    },
    ViewRow {
        id: "irradiance_volume.grid",
        systems: &["G5"],
        title: "Volume grid",
        tooltip: "Cells of the bilevel grid. First-level cells that hold geometry are divided again; how finely is drawn where a slice is chosen.",
        build: |input| Some(volume::grid_lines(input.solution.volume.as_ref()?, input.volume)),
    },
    ViewRow {
        id: "irradiance_volume.slice",
        systems: &["G5", "G8"],
        title: "Volume slice",
        tooltip: "A plane through the irradiance volume in false colour: the mean over all directions that a surface may face, ¼ ∫ L dω in lx, the mean spherical illuminance.",
        build: |input| Some(slice::volume_slice(input.solution.volume.as_ref()?, input.volume)),
    },
    ViewRow {
        id: "irradiance_volume.difference",
        systems: &["G9", "G11"],
        title: "Difference of volumes",
        tooltip: "A sphere at every sample of the irradiance volume, coloured by how much more irradiance it has than the volume it is compared with: E_A(n) − E_B(n) in lx on the side that faces n; red where A has more, blue where B has.",
        build: |input| {
            let difference =
                Difference::new(input.solution.volume.as_ref()?, input.against?, input.volume.part);
            Some(volume::difference_spheres(&difference, input.volume))
        },
    },
    ViewRow {
        id: "irradiance_volume.difference_slice",
        systems: &["G9", "G11"],
        title: "Difference of volumes, slice",
        tooltip: "A plane through the difference of two irradiance volumes in false colour: ¼ ∫ (L_A − L_B) dω in lx; red where A has more, blue where B has.",
        build: |input| {
            let difference =
                Difference::new(input.solution.volume.as_ref()?, input.against?, input.volume.part);
            Some(slice::difference_slice(&difference, input.volume))
        },
    },
    ViewRow {
        id: "irradiance_volume.lighting",
        systems: &["G5", "G6"],
        title: "Samples that light a point",
        tooltip: "The cell of the irradiance volume that holds the clicked point, and its samples with their shares: E(n) = Σ w E_sample(n), w trilinear and without samples in solids or behind walls. A sphere's volume goes with its share; grey lines lead to samples that are left out.",
        build: |input| {
            let (volume, (position, normal)) = (input.solution.volume.as_ref()?, input.point?);
            let part = input.volume.part;
            Some(lighting::scene(volume, &volume.lighting(position, normal, part), part))
        },
    },
    ViewRow {
        id: "irradiance_volume.rays",
        systems: &["G1", "G14"],
        title: "Rays of a sample",
        tooltip: "The rays that a sample of the irradiance volume sends, from the open spheres or else the clicked point: one through the middle of each of 2n² equal-area bins (at most n = 9 is drawn), followed through mirrors until the cut-off, and in orange those aimed at elements brighter than twice the mean.",
        build: |input| {
            let s = input.solution;
            let settings = s.volume.as_ref()?.settings();
            let at = input.probe.map(|p| p.position).or(input.point.map(|(p, n)| p + PROBE_OFF_M * n))?;
            Some(sampling::rays(&s.world, &*s.radiosity, settings, at))
        },
    },
    ViewRow {
        id: "irradiance_volume.cell_errors",
        systems: &["G14"],
        title: "Error of interpolation by cell",
        tooltip: "A cube in each first-level cell of the irradiance volume, coloured by how wrong trilinear interpolation is at its centre and the centres of its faces: the mean over directions of |E − E_exact| / max(E_exact, 5 % of the mean), %. Refining by tolerance divides the worst.",
        build: |input| {
            let s = input.solution;
            let settings = s.volume.as_ref()?.settings();
            sampling::cell_error_scene(&s.world, &*s.radiosity, settings).ok()
        },
    },
    ViewRow {
        id: "irradiance_volume.self_occlusion",
        systems: &["G15"],
        title: "Self-occlusion of movable objects",
        tooltip: "How much of the cosine-weighted hemisphere over each node a movable object leaves open to its surroundings, V = ∫ visible cos θ dω / π in %: its indirect light from the volume is V E.",
        build: |input| {
            let s = input.solution;
            (!s.dynamic_objects.is_empty())
                .then(|| self_occlusion::scene(&s.dynamic_objects, &s.world.geometry))
        },
    },
    ViewRow {
        id: "irradiance_volume.bases",
        systems: &["G6"],
        title: "Error of the basis",
        tooltip: "A sphere at every sample of the irradiance volume, coloured by how far the basis in use is from the exact sum over the sample's radiance, |E − E_exact| / max(E_exact, 5 % of its mean), for a surface facing that way. The notes give every basis: bins with interpolation, the nearest bin, nine spherical harmonics. The plan's line of the irradiance volume chooses the basis.",
        build: |input| {
            let s = input.solution;
            s.volume.as_ref()?.basis_scene(&s.world, &*s.radiosity, input.volume)
        },
    },
    ViewRow {
        id: "irradiance_volume.probe",
        systems: &["G2", "G3"],
        title: "Probe spheres",
        tooltip: "The irradiance sphere at the picked point, standing in the scene.",
        build: |input| {
            let (low, high) = input.solution.world.geometry.bounds();
            Some(volume::probe_scene(
                input.probe?,
                Quantity::Irradiance,
                input.volume.part,
                PROBE_RADIUS * (high - low).length(),
            ))
        },
    },
    ViewRow {
        id: "irradiance_volume.placement",
        systems: &["G10"],
        title: "Illuminance where it is measured",
        tooltip: "Illuminance E = ∫ L(ω) max(0, n·ω) dω in lx on the measuring plane or object's top chosen under Placement, with lines of equal illuminance; that of the required mean is red.",
        build: |input| input.placement.map(|(measured, wanted)| placement::inspect::scene(measured, wanted)),
    },
    ViewRow {
        id: "irradiance_volume.lobe",
        systems: &["G2", "G3"],
        title: "Probe lobe",
        tooltip: "The irradiance at the picked point as a solid: in every direction n, its surface is E(n) = ∫ L(ω) max(0, n·ω) dω away from the point, in lx. With the axes: x red, y green, z blue.",
        build: |input| {
            let (low, high) = input.solution.world.geometry.bounds();
            let reach_m = LOBE_REACH * (high - low).length();
            Some(lobe_scene(input.probe?, Quantity::Irradiance, input.volume.part, reach_m))
        },
    },
    ViewRow {
        id: "mirror.reflectors",
        systems: &["B7"],
        title: "Flat reflectors",
        tooltip: "Outlines of the flat pieces of polished material, with how many mirrored views the scene's camera needs of each: orange where there are any. A reflector that faces away or is out of the picture needs none.",
        build: |input| {
            let s = input.solution;
            Some(mirror::reflectors(&s.world.geometry, MirrorSettings::of(&s.scene.plan), &s.scene.camera))
        },
    },
    ViewRow {
        id: "mirror.reflectance",
        systems: &["B10"],
        title: "Reflectance by angle",
        tooltip: "How much each polished material reflects, from the normal (the middle of its map) to grazing (the rim): the Fresnel equation of an index fitted to the reflectance at normal incidence, per channel.",
        build: |input| mirror::reflectance(&input.solution.world.geometry),
    },
    ViewRow {
        id: "mirror.images",
        systems: &["B8", "B9", "B11"],
        title: "Images-with-depth",
        tooltip: "Where pictures with depth are taken behind every flat reflector that the scene's camera sees, with the pyramids of the two nearest to the mirrored eye in orange; beside the scene what those two show of the mirrors, reprojected point by point, with the holes that they leave in magenta.",
        build: |input| mirror_images(input.solution),
    },
    ViewRow {
        id: "glossy.kernel",
        systems: &["B13", "B14", "B15"],
        title: "Kernel of a glossy surface",
        tooltip: "Where the lobe of the glossy point under the pointer meets the scene, coloured by f(ω, ω') cos θ' over its peak; the lobe as a solid; under Kernel the kernel as an image, its lobe, and its spectrum with the sampling it needs. Before anything glossy is pointed at, the point is that of the flat glossy surface nearest to the open probe, else the middle of the largest.",
        build: |input| {
            let (world, eye) = (&input.solution.world, input.solution.scene.camera.eye);
            let point = KernelPoint::near(
                &world.geometry,
                &Reflectors::new(&world.geometry),
                eye,
                input.probe.map(|p| p.position),
            )?;
            Some(KernelView::new(world, point, eye).scene)
        },
    },
    ViewRow {
        id: "glossy.maps",
        systems: &["B17"],
        title: "Maps of the light around reflectors",
        tooltip: "What curved reflectors show, and flat glossy ones where a mirror shows them: the radiance around their middle as a picture from -z over +x, blurred by their lobe; and in the scene the largest one's, each direction at the distance that the map has for it, in cd/m².",
        build: |input| {
            let s = input.solution;
            maps(&s.scene, &s.world.geometry, &s.environments)
        },
    },
    ViewRow {
        id: "glossy.particles",
        systems: &["B12"],
        title: "Particles of light",
        tooltip: "Particles that the emitters send, each with its share of their flux, as squares where they meet what reflects, coloured by how many there are a square metre: what object-space glossy reflection is made from.",
        build: |input| density(&input.solution.world, input.solution.provenance.seed),
    },
    ViewRow {
        id: "radiosity.elements",
        systems: &["B2"],
        title: "Radiosity elements",
        tooltip: "What radiosity B = ρ E is solved on, over the picture: the area that each node of a grid stands for in chequers, leaves of quadtrees, and triangles that are lit at their corners; coloured by level, how often their side was halved from the usual spacing.",
        build: |input| Some(inspect_elements::elements(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.irradiance",
        systems: &["B2", "B3"],
        title: "Surface irradiance",
        tooltip: "Irradiance E in lx at every element, interpolated over the surface: light without reflectance.",
        build: |input| {
            Some(radiosity::irradiance(&input.solution.radiosity, &input.solution.world, Part::All))
        },
    },
    ViewRow {
        id: "radiosity.radiosity",
        systems: &["B2"],
        title: "Radiosity",
        tooltip: "Radiosity B = ρ E in lx of every element, the light that leaves it without what it emits: what the others gather.",
        build: |input| Some(inspect_light::radiosity(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.gradient",
        systems: &["B2"],
        title: "Gradient of irradiance",
        tooltip: "|∇E| in lx/m along the surface, from differences between elements: where light changes fast, and elements should be fine.",
        build: |input| Some(inspect_light::gradient(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.seams",
        systems: &["B3", "B5"],
        title: "Seams between charts",
        tooltip: "Edges across which a smooth surface goes on from one chart of elements to another, coloured by how far the light jumps there: |E_a − E_b| / max(E_a, E_b) in per cent.",
        build: |input| Some(inspect_light::seams(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.residual",
        systems: &["B2"],
        title: "Radiosity residual",
        tooltip: "How far each element is from balance: |B − ρ (E_direct + Σ T B)| in lx after the last sweep.",
        build: |input| Some(radiosity::residual(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.edges",
        systems: &["B2", "B3"],
        title: "Edges and T-vertices",
        tooltip: "Edges between elements, coloured by level: leaves of quadtrees where the plan subdivides, else cells of grids, and triangles that are lit at their corners. Red crosses are T-vertices, corners inside an edge of a coarser neighbour.",
        build: |input| Some(inspect_elements::edges(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.texel_density",
        systems: &["B3"],
        title: "Texel density",
        tooltip: "Texels a metre of the light on surfaces: 1/√A of a grid's cell, or of the area a vertex element stands for.",
        build: |input| Some(exchange::texel_density(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.second_difference",
        systems: &["B4"],
        title: "Mach bands",
        tooltip: "Second difference of irradiance between texels, the sum of four neighbours less four times the texel, in lx: where bilinear lookup creases and the eye sees bands.",
        build: |input| Some(exchange::second_difference(&input.solution.radiosity, &input.solution.world)),
    },
    ViewRow {
        id: "radiosity.links",
        systems: &["B2"],
        title: "Exchange of light",
        tooltip: "Lines from the element that was clicked to those it takes most light from: B/N for each of its N gather rays that met one of radiosity B, in lx.",
        build: |input| exchange::links(&input.solution.radiosity, input.element?),
    },
    ViewRow {
        id: "radiosity.lightmap",
        systems: &["B3"],
        title: "Lightmap on its surfaces",
        tooltip: "The lightmap that is open, in lx on the surfaces it was baked for; green lines are its seams.",
        build: |input| on_scene(input, Shown::Light),
    },
    ViewRow {
        id: "radiosity.lightmap_difference",
        systems: &["B3"],
        title: "Lightmap less our light",
        tooltip: "The lightmap that is open less our irradiance at its texels, in lx by luminance: red where it has more.",
        build: |input| on_scene(input, Shown::Difference),
    },
    ViewRow {
        id: "radiosity.lightmap_error",
        systems: &["B3"],
        title: "Lightmap less the path tracer",
        tooltip: "The lightmap that is open less what the path tracer finds at its texels, in lx by luminance: red where it has more. Shown once it was held against the path tracer.",
        build: |input| {
            input.lightmap.filter(|l| !l.traced.is_empty())?;
            on_scene(input, Shown::Error)
        },
    },
    ViewRow {
        id: "radiosity.lightmap_faults",
        systems: &["B3"],
        title: "Faults of the lightmap",
        tooltip: "The texels of the lightmap that is open which something is wrong with, on their surfaces: leaks, dark ones, overlaps, seams, what is stretched or far from the others' density.",
        build: |input| Some(inspect_lightmap::faults(input.lightmap?, &input.solution.world)),
    },
];

fn on_scene(input: &ViewInput, shown: Shown) -> Option<InspectionScene> {
    let (world, spacing_m) = (&input.solution.world, input.solution.radiosity.transport().map.spacing_m);
    Some(inspect_lightmap::on_surfaces(input.lightmap?, world, spacing_m, shown))
}

/// The view with this id.
pub fn view(id: &str) -> Option<&'static ViewRow> {
    VIEWS.iter().find(|v| v.id == id)
}
