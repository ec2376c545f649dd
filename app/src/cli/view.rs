//! `view`: what the window's views show, as pictures with their legends and as numbers.

use super::{
    Common,
    framed::Ground,
    parse_point, parse_size,
    probe::Light,
    render::{self, Backend, auto_display},
    screenshots::{element_looked_at, point_looked_at, probed, without_main_emitter},
    solve,
    volume::ignored,
};
use crate::lightmaps::{JudgedLightmap, LightmapFile};
use anyhow::{Context, bail};
use clap::{Args, ValueEnum};
use glam::Vec3;
use lumenscope_core::{
    inspection::{
        Curve, InspectionScene,
        colours::{ColourRange, ColourScale, ColourSettings},
    },
    io::png,
    irradiance_volume::{
        IrradianceVolume,
        inspect::{ColourBy, VolumeView},
        moments::Order,
        placement::{
            MeasureSettings, Measurement,
            requirement::{PRESETS, Preset, Requirement},
        },
        probe::{Probe, Quantity},
    },
    math::{colour::srgb8, false_colour::Palette},
    registry::{VIEWS, ViewInput, ViewRow, view},
    superposition::{
        composite::{self, DirectQuality},
        pass::{self, PassSettings},
    },
    transport::LightTransportSolution,
};
use std::path::PathBuf;

/// Options of `view`.
#[derive(Args)]
pub struct Options {
    /// Scene file; without one the views are listed.
    scene: Option<PathBuf>,
    /// Views by their names, with commas; all of them by default.
    #[arg(long, value_delimiter = ',')]
    view: Vec<String>,
    /// Folder for `NAME.png`, with the legend beside the picture, and `NAME.json` with range, notes and curves.
    #[arg(long, default_value = "lumenscope-out")]
    out: PathBuf,
    /// List the views and what they show.
    #[arg(long)]
    list: bool,
    /// Size of the picture without the legend.
    #[arg(long, default_value = "960x540", value_parser = parse_size)]
    size: [u32; 2],
    /// Point of the open probe, m; the element nearest to it is the one that is picked.
    #[arg(long, value_parser = parse_point)]
    at: Option<Vec3>,
    /// Where the eye is, m; the scene's camera by default.
    #[arg(long, value_parser = parse_point)]
    eye: Option<Vec3>,
    /// What it looks at, m.
    #[arg(long, value_parser = parse_point)]
    target: Option<Vec3>,
    /// Palette.
    #[arg(long, value_enum, default_value_t = PaletteName::Viridis)]
    palette: PaletteName,
    /// Ends of the colours, in the view's unit.
    #[arg(long, value_parser = parse_range, allow_hyphen_values = true, conflicts_with = "percentiles")]
    range: Option<[f32; 2]>,
    /// Percentiles at the ends of the colours, as 2,98.
    #[arg(long, value_parser = parse_range)]
    percentiles: Option<[f32; 2]>,
    /// Equal steps of colour are equal differences, or equal ratios; as the values ask by default.
    #[arg(long, value_enum)]
    steps: Option<Steps>,
    /// What spheres of the volume are coloured by.
    #[arg(long, value_enum, default_value_t = By::Light)]
    colour_by: By,
    /// Radiance instead of irradiance on spheres of the volume.
    #[arg(long)]
    radiance: bool,
    /// Part of the light in views of the volume.
    #[arg(long, value_enum, default_value_t = Light::All)]
    part: Light,
    /// Only what is at one place along an axis, m, in views of the volume: y=1.2.
    #[arg(long, value_parser = parse_slice, allow_hyphen_values = true)]
    slice: Option<(u8, f32)>,
    /// Radius of a sphere as a share of its cell.
    #[arg(long, default_value_t = 0.1)]
    sphere: f32,
    /// Order of the moment on spheres of the volume, 1 to 10000 or inf; one that the plan's volume holds.
    #[arg(long, default_value = "1")]
    moment: Order,
    /// Volume that views of differences and errors hold the present one against, as `lumenscope volume` writes it.
    #[arg(long, conflicts_with = "ignore")]
    against: Option<PathBuf>,
    /// Objects, lamps and materials without whose light it is that volume; without both, the main emitter.
    #[arg(long, value_delimiter = ',')]
    ignore: Vec<String>,
    /// Lightmap that is held against the light: `.exr` or `.hdr` with irradiance in lx, or `.png`.
    #[arg(long)]
    map: Option<PathBuf>,
    /// Irradiance of white in a `.png`, or of 1 in the others, lx.
    #[arg(long, default_value_t = 1.0)]
    white: f32,
}

/// [`Palette`] by its name.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum PaletteName {
    Viridis,
    Inferno,
    Turbo,
    /// The light's own colour, white at the high end.
    Natural,
}

/// [`ColourScale`] by its name.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum Steps {
    Linear,
    Log,
}

/// [`ColourBy`] by its name.
#[derive(Clone, Copy, PartialEq, Eq, ValueEnum)]
enum By {
    Light,
    Luminance,
    Validity,
    Age,
    Distance,
    /// Relative difference to the volume of `--against`.
    Error,
}

/// Shadow rays of the picture's frames.
const FRAMES: u32 = 8;

/// Solves, and writes what views show.
///
/// # Errors
/// One line naming the file or option and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let Some(scene) = options.scene.as_ref().filter(|_| !options.list) else {
        VIEWS.iter().for_each(|row| println!("{:<36} {}: {}", row.id, row.title, row.tooltip));
        return Ok(());
    };
    let rows = options
        .view
        .iter()
        .map(|id| {
            view(id).with_context(|| format!("--view {id}: there is no such view; `view --list` lists them"))
        })
        .collect::<anyhow::Result<Vec<&ViewRow>>>()?;
    let settings = options.colours();
    if !settings.is_usable() {
        bail!("--range and --percentiles go from a lower to a higher end, percentiles within 0 to 100");
    }
    if !(options.sphere > 0.0 && options.sphere <= 0.5) {
        bail!("--sphere {}: a share of a cell above 0 and up to 0.5", options.sphere);
    }
    let against = options.against.as_deref().map(IrradianceVolume::load).transpose()?;
    let file =
        options.map.as_ref().map(|path| LightmapFile { path: path.clone(), white: options.white, paths: 0 });
    if let Some(file) = &file {
        file.read()?;
    }
    solve::output_folder(&options.out)?;
    let mut loaded = solve::load(scene, common)?;
    let camera = &mut std::sync::Arc::make_mut(&mut loaded.scene).camera;
    camera.eye = options.eye.unwrap_or(camera.eye);
    camera.target = options.target.unwrap_or(camera.target);
    if camera.eye.distance(camera.target) < 1e-6 {
        bail!("--eye and --target are the same point");
    }
    let ignored = match options.ignore.as_slice() {
        [] => None,
        names => Some(ignored(&loaded.scene, names)?),
    };
    let solution = solve::solve(&loaded, true)?;
    let held = solution.volume.as_ref().is_some_and(|v| v.orders().contains(&options.moment));
    if !held && options.moment != Order::IRRADIANCE {
        bail!(
            "--moment {}: the volume does not hold it; name it in the plan's volume_moments",
            options.moment
        );
    }
    let without = |volume: &IrradianceVolume| {
        let ignored = ignored.as_ref()?;
        volume.ignoring(&solution.world, &*solution.radiosity, ignored.clone())
    };
    let against = against.or_else(|| without(solution.volume.as_ref()?));
    let judged = file.map(|f| solve::watched(|p| JudgedLightmap::new(&f, &solution, p))).transpose()?;
    let (layers, _) = render::picture(&solution, options.size, FRAMES, Backend::Auto, common.seed)?;
    let sum = layers.total();
    let pixels = composite::display(&sum, &auto_display(&sum));
    let ground = ground(&solution, pixels, options.size);
    let mut shown = Shown::new(&solution, options.at)?;
    shown.against = against.or(shown.against);
    let volume = options.volume();
    let input =
        ViewInput { lightmap: judged.as_ref().map(|l| &l.report), volume: &volume, ..shown.input(&solution) };
    let wanted: Vec<&ViewRow> = if rows.is_empty() { VIEWS.iter().collect() } else { rows.clone() };
    for row in wanted {
        match (row.build)(&input) {
            Some(made) => options.write(row, &ground, &made, &settings)?,
            None if rows.is_empty() => {}
            None => bail!("--view {}: this scene has nothing to show in it: {}", row.id, row.tooltip),
        }
    }
    Ok(())
}

impl Options {
    fn colours(&self) -> ColourSettings {
        ColourSettings {
            palette: match self.palette {
                PaletteName::Viridis => Palette::Viridis,
                PaletteName::Inferno => Palette::Inferno,
                PaletteName::Turbo => Palette::Turbo,
                PaletteName::Natural => Palette::Natural,
            },
            range: match (self.range, self.percentiles) {
                (Some(range), _) => ColourRange::Given(range),
                (None, Some(percentiles)) => ColourRange::Percentiles(percentiles),
                (None, None) => ColourRange::Automatic,
            },
            scale: match self.steps {
                None => ColourScale::Automatic,
                Some(Steps::Linear) => ColourScale::Linear,
                Some(Steps::Log) => ColourScale::Logarithmic,
            },
        }
    }

    fn volume(&self) -> VolumeView {
        VolumeView {
            colour_by: match self.colour_by {
                By::Light => ColourBy::Light,
                By::Luminance => ColourBy::Luminance,
                By::Validity => ColourBy::Validity,
                By::Age => ColourBy::Age,
                By::Distance => ColourBy::Distance,
                By::Error => ColourBy::Error,
            },
            quantity: if self.radiance { Quantity::Radiance } else { Quantity::Irradiance },
            moment: self.moment,
            part: self.part.part(),
            invalid: self.colour_by == By::Validity,
            size: self.sphere,
            slice: self.slice,
            ..VolumeView::default()
        }
    }

    fn write(
        &self,
        row: &ViewRow,
        ground: &Ground,
        made: &InspectionScene,
        settings: &ColourSettings,
    ) -> anyhow::Result<()> {
        let colours = made.colours(settings);
        let file = |end: &str| self.out.join(format!("{}{end}", row.id));
        // A view that found nothing to mark is a picture too: it says so.
        if !made.is_beside_the_scene() || (made.images.is_empty() && made.curves.is_empty()) {
            let page = ground.framed(row.title, made, &colours);
            page.write(&file(".png"))?;
            eprintln!("{}", file(".png").display());
        }
        for (i, named) in made.images.iter().enumerate() {
            let pixels: Vec<[u8; 3]> = named.image.pixels.iter().map(|p| srgb8(*p)).collect();
            png::write_png(&file(&format!("_{i}.png")), named.image.width, named.image.height, &pixels)?;
        }
        let curve = |c: &Curve| {
            let points: Vec<[f32; 2]> = c.points.iter().map(|p| p.to_array()).collect();
            serde_json::json!({ "name": c.name, "axes": c.axes, "points": points })
        };
        let report = serde_json::json!({
            "view": row.id,
            "title": row.title,
            "shows": row.tooltip,
            "quantity": made.legend.as_ref().map(|l| &l.quantity),
            "unit": made.legend.as_ref().map(|l| &l.unit),
            "kinds": made.legend.as_ref().map(|l| l.names),
            "found": made.legend.as_ref().map(|l| l.range),
            "colours_from": colours.low,
            "colours_to": colours.high,
            "logarithmic": colours.logarithmic,
            "notes": made.notes,
            "images": made.images.iter().map(|i| &i.name).collect::<Vec<_>>(),
            "curves": made.curves.iter().map(curve).collect::<Vec<_>>(),
        });
        solve::write(&file(".json"), &serde_json::to_string_pretty(&report)?)
    }
}

/// What views are drawn over: a picture of a solution's camera.
pub(super) fn ground(solution: &LightTransportSolution, pixels: Vec<[u8; 4]>, size: [u32; 2]) -> Ground<'_> {
    let camera = &solution.scene.camera;
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let (buffer, _) = pass::render(solution, camera, size[0], size[1], &settings);
    Ground { pixels, buffer, camera }
}

/// What the views of a solution are made from, besides itself, where nobody has picked anything.
pub(super) struct Shown {
    probe: Probe,
    point: Option<(Vec3, Vec3)>,
    element: Option<u32>,
    volume: VolumeView,
    placement: Option<(Measurement, Requirement)>,
    against: Option<IrradianceVolume>,
}

impl Shown {
    /// A probe and an element at a point, or before the camera; the first plane measured; the volume without the
    /// main emitter to compare with.
    ///
    /// # Errors
    /// Where the probe cannot be sampled.
    pub(super) fn new(solution: &LightTransportSolution, at: Option<Vec3>) -> anyhow::Result<Self> {
        let place = at.unwrap_or_else(|| probed(solution));
        let element = match at {
            None => element_looked_at(solution),
            Some(at) => nearest_element(solution, at),
        };
        let plane = solution.scene.planes.first().map_or("", |p| &p.name);
        let measured = super::placement::measured(solution, plane, 3, &MeasureSettings::default()).ok();
        let writing = PRESETS.iter().find(|p| p.mean_lx == Some(500.0)).map(Preset::requirement);
        Ok(Self {
            probe: Probe::at(&solution.world, &*solution.radiosity, place, 17, 1, 1)?,
            point: match element {
                Some(element) if at.is_some() => {
                    let element = &solution.radiosity.elements()[element as usize];
                    Some((element.position, element.normal))
                }
                _ => point_looked_at(solution),
            },
            element,
            volume: VolumeView { size: 0.1, ..VolumeView::default() },
            placement: measured.zip(writing),
            against: without_main_emitter(solution),
        })
    }

    /// The input of views.
    pub(super) fn input<'a>(&'a self, solution: &'a LightTransportSolution) -> ViewInput<'a> {
        ViewInput {
            solution,
            probe: Some(&self.probe),
            point: self.point,
            element: self.element,
            volume: &self.volume,
            against: self.against.as_ref(),
            placement: self.placement.as_ref().map(|(measured, wanted)| (measured, wanted)),
            lightmap: None,
        }
    }
}

fn nearest_element(solution: &LightTransportSolution, at: Vec3) -> Option<u32> {
    let elements = solution.radiosity.elements();
    let away = |i: &u32| elements[*i as usize].position.distance_squared(at);
    let shown = (0..elements.len() as u32).filter(|&i| elements[i as usize].is_shown());
    shown.min_by(|a, b| away(a).total_cmp(&away(b)))
}

/// `LOW,HIGH`.
fn parse_range(text: &str) -> Result<[f32; 2], String> {
    let parsed =
        text.split_once(',').and_then(|(a, b)| Some([a.trim().parse().ok()?, b.trim().parse().ok()?]));
    let finite = |r: &[f32; 2]| r.iter().all(|v| v.is_finite());
    parsed.filter(finite).ok_or_else(|| format!("`{text}` is not LOW,HIGH"))
}

/// `AXIS=METRES`.
fn parse_slice(text: &str) -> Result<(u8, f32), String> {
    let parsed = text.split_once('=').and_then(|(axis, at)| {
        let axis = ["x", "y", "z"].iter().position(|a| *a == axis.trim())?;
        Some((axis as u8, at.trim().parse::<f32>().ok().filter(|v| v.is_finite())?))
    });
    parsed.ok_or_else(|| format!("`{text}` is not x=, y= or z= and a place in metres"))
}
