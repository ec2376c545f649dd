//! Radial plots as SVG: three planes side by side, with rings, axes and units.

use crate::widgets::{
    number,
    radial_plot::{Plane, curve, rings},
    sphere_image::SphereValues,
};
use lumenscope_core::{irradiance_volume::probe::Quantity, math::colour::Channel};
use std::fmt::Write;

/// Width and height of a plot, pixels.
const SIDE: f64 = 300.0;
/// Radius of its outermost ring.
const RADIUS: f64 = 118.0;
/// Height of the title above it.
const TITLE: f64 = 24.0;

/// The plots of one quantity; of RGB, the luminous value and each channel.
pub fn draw(sphere: &SphereValues<'_>, quantity: Quantity, channel: Channel, smooth: bool) -> String {
    let (width, height) = (3.0 * SIDE, SIDE + TITLE);
    let mut svg = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" height=\"{height}\" \
         font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    for (i, plane) in Plane::ALL.into_iter().enumerate() {
        let centre = [(i as f64 + 0.5) * SIDE, TITLE + 0.5 * SIDE];
        plot(&mut svg, sphere, plane, centre, quantity, channel, smooth);
    }
    svg.push_str("</svg>\n");
    svg
}

fn plot(
    svg: &mut String,
    sphere: &SphereValues<'_>,
    plane: Plane,
    [x, y]: [f64; 2],
    quantity: Quantity,
    channel: Channel,
    smooth: bool,
) {
    let shown =
        Channel::ALL.into_iter().filter(|&c| c != Channel::Rgb && (channel == Channel::Rgb || c == channel));
    let curves: Vec<_> = shown.map(|c| (c, curve(sphere, plane, smooth, |v| c.measure(v)))).collect();
    let reach = curves.iter().flat_map(|(_, c)| c).fold(0.0f64, |m, p| m.max(p[0].hypot(p[1])));
    let (rings, outer) = rings(reach);
    let scale = RADIUS / outer;
    // Writing into a string cannot fail.
    let _ = writeln!(
        svg,
        "<text x=\"{x}\" y=\"16\" text-anchor=\"middle\">{} in {}, {}</text>",
        quantity.name(),
        quantity.unit(),
        plane.title()
    );
    for ring in &rings {
        let r = ring * scale;
        let _ = writeln!(svg, "<circle cx=\"{x}\" cy=\"{y}\" r=\"{r:.2}\" fill=\"none\" stroke=\"#ccc\"/>");
        let (at, label) = (y - r - 2.0, number::short(*ring as f32));
        let _ = writeln!(
            svg,
            "<text x=\"{:.1}\" y=\"{at:.1}\" fill=\"#888\" font-size=\"9\">{label}</text>",
            x + 3.0
        );
    }
    for (dx, dy) in [(RADIUS, 0.0), (0.0, RADIUS)] {
        let _ = writeln!(
            svg,
            "<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"#ccc\"/>",
            x - dx,
            y - dy,
            x + dx,
            y + dy
        );
    }
    let ends = plane.ends();
    let out = RADIUS + 16.0;
    for (name, [dx, dy]) in ends.into_iter().zip([[out, 0.0], [-out, 0.0], [0.0, -out], [0.0, out]]) {
        let (at_x, at_y) = (x + dx, y + dy + 4.0);
        let _ = writeln!(svg, "<text x=\"{at_x}\" y=\"{at_y}\" text-anchor=\"middle\">{name}</text>");
    }
    for (one, points) in curves {
        let path: Vec<String> =
            points.iter().map(|p| format!("{:.2},{:.2}", x + p[0] * scale, y - p[1] * scale)).collect();
        let _ = writeln!(
            svg,
            "<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"1.5\"><title>{}</title></polyline>",
            path.join(" "),
            stroke(one),
            one.name()
        );
    }
}

fn stroke(channel: Channel) -> &'static str {
    match channel {
        Channel::Rgb | Channel::Luminance => "#222",
        Channel::Red => "#c22",
        Channel::Green => "#282",
        Channel::Blue => "#22c",
    }
}
