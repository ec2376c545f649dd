//! `probe`: the spheres at one point.

use super::{Common, parse_point, radial_svg, render::auto_display, solve};
use crate::widgets::resolutions::ROWS;
use anyhow::bail;
use clap::{Args, ValueEnum};
use glam::{Mat3, Vec3};
use lumenscope_core::{
    io::{png::write_png, probe::write_probe},
    irradiance_volume::{
        lobe,
        moments::Order,
        probe::{Probe, Quantity},
    },
    math::{
        colour::{Channel, luminance},
        image::LinearImage,
        part::Part,
        sphere_map::DirectionBins,
        sphere_values::SphereValues,
    },
};
use std::path::PathBuf;

/// Options of `probe`.
#[derive(Args)]
pub struct Options {
    /// Scene file.
    scene: PathBuf,
    /// Point, m.
    #[arg(long, value_parser = parse_point, allow_hyphen_values = true)]
    at: Vec3,
    /// Folder for `probe.exr` (map and bins), `probe.json`, and for radiance and irradiance each the
    /// ball, the 3-D lobe and the radial plots.
    #[arg(long)]
    out: PathBuf,
    /// Bins over the sphere: 2n² for a whole n, such as 162, 578, 1682, 3362, 4802.
    #[arg(long, default_value_t = 1682)]
    bins: u32,
    /// Interpolate between bins in pictures, plots and the map.
    #[arg(long)]
    smooth: bool,
    /// What of the light is shown in pictures and plots; files hold all of it.
    #[arg(long, value_enum, default_value_t = Light::All)]
    part: Light,
    /// What of the colours is shown in pictures and plots.
    #[arg(long, value_enum, default_value_t = Colours::Rgb)]
    channel: Colours,
    /// Sample the point at every resolution of the thesis too, and say in `probe.json` how far the
    /// irradiance of each is from the finest.
    #[arg(long)]
    resolutions: bool,
    /// Orders of moments, 1 to 10000 or inf, such as 2,10,inf: layers of `probe.exr`, and of each a ball and a lobe,
    /// `moment_10.png` and `moment_10_lobe.png`.
    #[arg(long, value_delimiter = ',')]
    moment: Vec<Order>,
}

/// Part of the light.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
pub(super) enum Light {
    All,
    Direct,
    Indirect,
}

/// What of the colours is shown.
#[derive(Clone, Copy, Debug, PartialEq, Eq, ValueEnum)]
enum Colours {
    Rgb,
    Luminance,
    Red,
    Green,
    Blue,
}

/// Side of the pictures, pixels.
const PIXELS: usize = 512;

/// Rays a bin.
const SUPERSAMPLE: u32 = 4;

/// The lobe is seen from here: right, front and above.
const LOBE_SIDE: Vec3 = Vec3::new(0.5, 0.45, 0.75);

/// Probes and writes.
///
/// # Errors
/// One line naming the file and the cause.
pub fn run(options: &Options, common: &Common) -> anyhow::Result<()> {
    let n = (f64::from(options.bins) / 2.0).sqrt().round() as u32;
    if n == 0 || 2 * n * n != options.bins {
        bail!("--bins {}: not 2n² for a whole n; the nearest is {}", options.bins, 2 * n.max(1) * n.max(1));
    }
    solve::output_folder(&options.out)?;
    let loaded = solve::load(&options.scene, common)?;
    let solution = solve::solve(&loaded, false)?;
    let at = |n| Probe::at(&solution.world, &*solution.radiosity, options.at, n, SUPERSAMPLE, common.seed);
    let probe = at(n)?;
    write_probe(&options.out.join("probe.exr"), &probe, &options.moment, options.smooth)?;
    for quantity in [Quantity::Radiance, Quantity::Irradiance] {
        pictures(options, &probe, quantity)?;
    }
    let finer: Vec<Probe> =
        if options.resolutions { ROWS.into_iter().map(at).collect::<Result<_, _>>()? } else { Vec::new() };
    let mut report = report(options, &probe, &finer);
    if !options.moment.is_empty() {
        let moments = options.moment.iter().map(|&order| moment(options, &probe, order));
        let moments = moments.collect::<anyhow::Result<serde_json::Map<_, _>>>()?;
        report["moments_lx"] = moments.into();
    }
    let text = serde_json::to_string_pretty(&report)?;
    println!("{text}");
    solve::write(&options.out.join("probe.json"), &text)
}

fn pictures(options: &Options, probe: &Probe, quantity: Quantity) -> anyhow::Result<()> {
    let values = probe.values(quantity, options.part.part());
    let sphere = SphereValues { bins: probe.bins, values: &values };
    sphere_and_lobe(options, quantity.name(), &sphere)?;
    let svg = radial_svg::draw(&sphere, quantity, options.channel.channel(), options.smooth);
    solve::write(&options.out.join(format!("{}_radial.svg", quantity.name())), &svg)
}

/// The sphere of a moment as pictures; its order, and its luminance along the axes, lx.
fn moment(options: &Options, probe: &Probe, order: Order) -> anyhow::Result<(String, serde_json::Value)> {
    let values = probe.moment(order, options.part.part());
    let (bins, name) = (probe.bins, String::from(order));
    sphere_and_lobe(options, &format!("moment_{name}"), &SphereValues { bins, values: &values })?;
    Ok((name, along_axes(bins, &values).into()))
}

fn sphere_and_lobe(options: &Options, name: &str, sphere: &SphereValues) -> anyhow::Result<()> {
    let channel = options.channel.channel();
    let values = sphere.values;
    let side = PIXELS as u32;
    let file = |end: &str| options.out.join(format!("{name}{end}"));
    // Exposed for the bins themselves: each covers as much of the sphere as any other.
    let shown = LinearImage {
        width: values.len() as u32,
        height: 1,
        pixels: values.iter().map(|v| channel.of(*v)).collect(),
    };
    let display = auto_display(&shown);
    let colour = |v: Vec3| {
        let [r, g, b, _] = display.pixel(channel.of(v));
        [r, g, b]
    };
    let ball = sphere.ball(Mat3::IDENTITY, PIXELS, options.smooth, colour);
    write_png(&file(".png"), side, side, &on_black(ball))?;
    let mesh = lobe::lobe(sphere, options.smooth, |v| channel.measure(v));
    let reach = values.iter().map(|v| channel.measure(*v)).fold(0.0f32, f32::max);
    let picture = lobe::picture(&mesh, looking_from(LOBE_SIDE), PIXELS, reach, colour);
    Ok(write_png(&file("_lobe.png"), side, side, &on_black(picture))?)
}

fn on_black(pixels: Vec<[u8; 4]>) -> Vec<[u8; 4]> {
    pixels.into_iter().map(|[r, g, b, _]| [r, g, b, 255]).collect()
}

/// Right, up and towards the viewer, for a viewer on `side` of what is seen, y up.
pub fn looking_from(side: Vec3) -> Mat3 {
    let towards = side.normalize();
    let right = Vec3::Y.cross(towards).normalize_or(Vec3::X);
    Mat3::from_cols(right, towards.cross(right), towards)
}

/// Luminance of the values towards the six ends of the axes.
fn along_axes(bins: DirectionBins, values: &[Vec3]) -> serde_json::Map<String, serde_json::Value> {
    let axes = [
        ("+x", Vec3::X),
        ("-x", Vec3::NEG_X),
        ("+y", Vec3::Y),
        ("-y", Vec3::NEG_Y),
        ("+z", Vec3::Z),
        ("-z", Vec3::NEG_Z),
    ];
    let of = |d: Vec3| serde_json::json!(luminance(values[bins.bin(d)]));
    axes.iter().map(|(name, d)| ((*name).to_owned(), of(*d))).collect()
}

fn report(options: &Options, probe: &Probe, finer: &[Probe]) -> serde_json::Value {
    let bins: DirectionBins = probe.bins;
    let at = |part: Part| along_axes(bins, &probe.irradiance(part));
    let mut report = serde_json::json!({
        "at_m": options.at.to_array(), "bins": options.bins, "bin_sr": bins.solid_angle(),
        "irradiance_lx": { "all": at(Part::All), "direct": at(Part::Direct), "indirect": at(Part::Indirect) },
        "statistics": probe.statistics(options.part.part()),
    });
    if let Some(finest) = finer.last() {
        let best = finest.irradiance(options.part.part());
        let best = SphereValues { bins: finest.bins, values: &best };
        let row = |p: &Probe| {
            let values = p.irradiance(options.part.part());
            let off = SphereValues { bins: p.bins, values: &values }.relative_difference(&best);
            serde_json::json!({ "bins": p.bins.len(), "relative_rms_difference": off })
        };
        report["resolutions"] = finer.iter().map(row).collect();
    }
    report
}

impl Light {
    pub(super) fn part(self) -> Part {
        match self {
            Self::All => Part::All,
            Self::Direct => Part::Direct,
            Self::Indirect => Part::Indirect,
        }
    }
}

impl Colours {
    fn channel(self) -> Channel {
        match self {
            Self::Rgb => Channel::Rgb,
            Self::Luminance => Channel::Luminance,
            Self::Red => Channel::Red,
            Self::Green => Channel::Green,
            Self::Blue => Channel::Blue,
        }
    }
}
