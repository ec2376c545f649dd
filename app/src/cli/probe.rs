//! `probe`: the spheres at one point.

use super::{
    Common,
    page::{INK, Page},
    parse_point, radial_svg,
    render::auto_display,
    solve,
};
use crate::widgets::{moments, resolutions::ROWS};
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
        false_colour::{FalseColour, Palette},
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
    /// ball, both hemispheres unfolded, the 3-D lobe and the radial plots.
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
    /// Luminance in false colour in pictures, from 0 to the largest.
    #[arg(long)]
    false_colour: bool,
    /// Sample the point at every resolution of the thesis too, and say in `probe.json` how far the
    /// irradiance of each is from the finest.
    #[arg(long)]
    resolutions: bool,
    /// Orders of moments, 1 to 10000 or inf, such as 2,10,inf: layers of `probe.exr`, and of each a ball and a lobe,
    /// `moment_10.png` and `moment_10_lobe.png`, and the weights of all in `weights.png`.
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
        weights(&options.moment).write(&options.out.join("weights.png"))?;
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
    let reach = values.iter().map(|v| channel.measure(*v)).fold(0.0f32, f32::max);
    let mut display = auto_display(&shown);
    if options.false_colour {
        display.false_colour = Some(FalseColour::over([0.0, reach.max(f32::MIN_POSITIVE)], Palette::Viridis));
    }
    let colour = |v: Vec3| {
        let [r, g, b, _] = display.pixel(channel.of(v));
        [r, g, b]
    };
    unfolded(sphere, colour).write(&file("_unfolded.png"))?;
    let ball = sphere.ball(Mat3::IDENTITY, PIXELS, options.smooth, colour);
    write_png(&file(".png"), side, side, &on_black(ball))?;
    let mesh = lobe::lobe(sphere, options.smooth, |v| channel.measure(v));
    let picture = lobe::picture(&mesh, looking_from(LOBE_SIDE), PIXELS, reach, colour);
    Ok(write_png(&file("_lobe.png"), side, side, &on_black(picture))?)
}

/// Both hemispheres as the squares their bins are a grid on.
fn unfolded(sphere: &SphereValues, colour: impl Fn(Vec3) -> [u8; 3]) -> Page {
    const SIDE: usize = 256;
    const HEAD: usize = 28;
    let flat = sphere.unfolded();
    let (width, n) = (flat.width as usize, flat.height as usize);
    let mut page = Page::new(2 * SIDE, HEAD + SIDE);
    page.text(8, 8, 1, "upper, y ≥ 0", INK);
    page.text(SIDE + 8, 8, 1, "lower, y < 0", INK);
    for (y, x) in (0..SIDE).flat_map(|y| (0..2 * SIDE).map(move |x| (y, x))) {
        page.put(x, HEAD + y, colour(flat.pixels[y * n / SIDE * width + x * width / (2 * SIDE)]));
    }
    page
}

/// The weight of radiance by its angle to the direction asked, each curve scaled to 1 in its middle.
fn weights(orders: &[Order]) -> Page {
    const SIZE: [usize; 2] = [360, 200];
    const INKS: [[u8; 3]; 5] = [INK, [230, 120, 60], [90, 200, 120], [90, 150, 240], [220, 200, 80]];
    let [left, top] = [48, 32];
    let mut page = Page::new(left + SIZE[0] + 110, top + SIZE[1] + 32);
    page.text(8, 8, 1, "weight / largest, by angle to the direction asked", INK);
    let place = |degrees: f64, weight: f64| {
        let across = (degrees + 90.0) / 180.0 * SIZE[0] as f64;
        [left as f32 + across as f32, top as f32 + ((1.0 - weight) * SIZE[1] as f64) as f32]
    };
    for degrees in [-90.0, -45.0, 0.0, 45.0, 90.0] {
        page.line(place(degrees, 0.0), place(degrees, 1.0), [70, 70, 74]);
        let [x, y] = place(degrees, 0.0);
        page.text(x as usize - 12, y as usize + 8, 1, &format!("{degrees}°"), INK);
    }
    for weight in [0.0, 0.5, 1.0] {
        page.line(place(-90.0, weight), place(90.0, weight), [70, 70, 74]);
        let [_, y] = place(-90.0, weight);
        page.text(8, y as usize - 4, 1, &format!("{weight:.1}"), INK);
    }
    for (i, order) in orders.iter().enumerate() {
        let ink = INKS[i % INKS.len()];
        for ends in moments::curve(*order).windows(2) {
            page.line(place(ends[0][0], ends[0][1]), place(ends[1][0], ends[1][1]), ink);
        }
        page.text(left + SIZE[0] + 12, top + 16 * i, 1, &format!("n = {order}"), ink);
    }
    page
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
