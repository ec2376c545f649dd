//! Curves over two logarithmic axes, as SVG and as PNG: laid out once, drawn twice.

use super::{page::Page, solve};
use crate::widgets::number;
use lumenscope_core::measure::chart::{Point, front};
use std::{fmt::Write, path::Path};

const WIDTH: f64 = 520.0;
const HEIGHT: f64 = 380.0;
const LEFT: f64 = 62.0;
const TOP: f64 = 66.0;
const GAP: f64 = 76.0;
const FOOT: f64 = 52.0;
const ROW: f64 = 18.0;
/// Pixels of the PNG a unit of the layout.
const SCALE: f64 = 2.0;

const INK: [u8; 3] = [34, 34, 34];
const FAINT: [u8; 3] = [222, 222, 222];
const GREY: [u8; 3] = [140, 140, 140];
/// Okabe and Ito's colours, which the colour-blind tell apart, then darker ones.
const COLOURS: [[u8; 3]; 12] = [
    [0, 114, 178],
    [213, 94, 0],
    [0, 158, 115],
    [204, 121, 167],
    [230, 159, 0],
    [86, 180, 233],
    [110, 60, 20],
    [90, 90, 90],
    [120, 30, 140],
    [150, 160, 20],
    [0, 70, 60],
    [170, 0, 30],
];

/// One picture: panels side by side; axes of the same name have the same range.
pub struct Plot {
    /// Heading.
    pub title: String,
    /// Names of the lines; a line has the same number and colour in every panel.
    pub names: Vec<String>,
    /// The panels.
    pub panels: Vec<Panel>,
}

/// One pair of axes.
pub struct Panel {
    /// Heading.
    pub title: String,
    /// What x and y are, with units.
    pub axes: [String; 2],
    /// The points of each line, in order; points that are not positive are left out.
    pub lines: Vec<Vec<Point>>,
    /// A level of y and what it is.
    pub level: Option<(f64, String)>,
    /// Whether the Pareto front of all lines is marked.
    pub front: bool,
}

enum Mark {
    Line {
        ends: [Point; 2],
        ink: [u8; 3],
        dashed: bool,
    },
    Dot {
        at: Point,
        ink: [u8; 3],
        ring: bool,
    },
    /// Share of the text that lies left of the place.
    Text {
        at: Point,
        left: f64,
        words: String,
        ink: [u8; 3],
    },
}

impl Plot {
    /// Writes `NAME.svg` and `NAME.png` into a folder.
    ///
    /// # Errors
    /// One line naming the file and the cause.
    pub fn write(&self, folder: &Path, name: &str) -> anyhow::Result<()> {
        let (marks, size) = self.layout();
        solve::write(&folder.join(format!("{name}.svg")), &svg(&marks, size))?;
        let page = page(&marks, size);
        let path = folder.join(format!("{name}.png"));
        page.write(&path)
    }

    /// Every mark, and width and height.
    fn layout(&self) -> (Vec<Mark>, Point) {
        let widest = self.names.iter().map(|n| n.chars().count()).max().unwrap_or(0) as f64 * 8.0 + 48.0;
        let width = LEFT + self.panels.len().max(1) as f64 * (WIDTH + GAP);
        let columns = ((width / widest) as usize).max(1);
        let extra = usize::from(self.panels.iter().any(|p| p.front));
        let rows = (self.names.len() + extra).div_ceil(columns) as f64;
        let mut marks = vec![text([LEFT, 22.0], 0.0, &self.title)];
        for (i, panel) in self.panels.iter().enumerate() {
            let corner = [LEFT + i as f64 * (WIDTH + GAP), TOP];
            panel.draw(&mut marks, corner, [0, 1].map(|axis| self.range(axis, &panel.axes[axis])));
        }
        let top = TOP + HEIGHT + FOOT;
        for (i, name) in self.names.iter().map(String::as_str).chain(["Pareto front"]).enumerate() {
            let at = [LEFT + (i % columns) as f64 * widest, top + (i / columns) as f64 * ROW];
            let middle = [at[0] + 12.0, at[1] - 4.0];
            if i == self.names.len() {
                if extra == 1 {
                    marks.push(Mark::Dot { at: middle, ink: INK, ring: true });
                    marks.push(text([at[0] + 32.0, at[1]], 0.0, name));
                }
                continue;
            }
            let ink = COLOURS[i % COLOURS.len()];
            marks.push(Mark::Line {
                ends: [[at[0], middle[1]], [at[0] + 24.0, middle[1]]],
                ink,
                dashed: false,
            });
            marks.push(Mark::Dot { at: middle, ink, ring: false });
            marks.push(text([at[0] + 32.0, at[1]], 0.0, name));
        }
        (marks, [width, top + rows * ROW])
    }

    /// Logarithms of the smallest and the largest value along axes of a name, a little apart.
    fn range(&self, axis: usize, name: &str) -> Point {
        let panels = self.panels.iter().filter(|p| p.axes[axis] == name);
        let levels = panels.clone().filter_map(|p| p.level.as_ref()).map(|l| l.0).filter(|_| axis == 1);
        let points = panels.flat_map(|p| p.lines.iter().flatten()).filter(|p| positive(p));
        let values = points.map(|p| p[axis]).chain(levels).filter(|v| *v > 0.0);
        let [low, high] = values.fold([f64::INFINITY, 0.0], |[a, b], v| [v.min(a), v.max(b)]);
        if low > high {
            return [0.0, 1.0];
        }
        let spare = (0.05 * (high / low).log10()).max(0.05);
        [low.log10() - spare, high.log10() + spare]
    }
}

impl Panel {
    fn draw(&self, marks: &mut Vec<Mark>, [left, top]: Point, [xs, ys]: [Point; 2]) {
        let share = |v: f64, [low, high]: Point| (v.log10() - low) / (high - low);
        let place = |p: &Point| [left + share(p[0], xs) * WIDTH, top + (1.0 - share(p[1], ys)) * HEIGHT];
        marks.push(text([left, top - 24.0], 0.0, &self.title));
        marks.push(text([left - 40.0, top - 8.0], 0.0, &self.axes[1]));
        marks.push(text([left + 0.5 * WIDTH, top + HEIGHT + 32.0], 0.5, &self.axes[0]));
        for (value, words) in ticks(xs) {
            let x = left + share(value, xs) * WIDTH;
            marks.push(line([[x, top], [x, top + HEIGHT]], FAINT));
            marks.push(text([x, top + HEIGHT + 15.0], 0.5, &words));
        }
        for (value, words) in ticks(ys) {
            let y = top + (1.0 - share(value, ys)) * HEIGHT;
            marks.push(line([[left, y], [left + WIDTH, y]], FAINT));
            marks.push(text([left - 6.0, y + 4.0], 1.0, &words));
        }
        for ends in
            [[[left, top + HEIGHT], [left + WIDTH, top + HEIGHT]], [[left, top], [left, top + HEIGHT]]]
        {
            marks.push(line(ends, INK));
        }
        if let Some((level, words)) = &self.level {
            let y = place(&[1.0, *level])[1];
            marks.push(Mark::Line { ends: [[left, y], [left + WIDTH, y]], ink: GREY, dashed: true });
            marks.push(Mark::Text {
                at: [left + WIDTH, y - 4.0],
                left: 1.0,
                words: words.clone(),
                ink: GREY,
            });
        }
        for (points, ink) in self.lines.iter().zip(COLOURS.iter().cycle()) {
            let places: Vec<Point> = points.iter().filter(|p| positive(p)).map(place).collect();
            marks.extend(places.windows(2).map(|w| line([w[0], w[1]], *ink)));
            marks.extend(places.iter().map(|&at| Mark::Dot { at, ink: *ink, ring: false }));
        }
        if self.front {
            let all: Vec<Point> = self.lines.concat();
            marks.extend(front(&all).into_iter().map(|i| Mark::Dot {
                at: place(&all[i]),
                ink: INK,
                ring: true,
            }));
        }
    }
}

fn positive(p: &Point) -> bool {
    p.iter().all(|v| v.is_finite() && *v > 0.0)
}

fn line(ends: [Point; 2], ink: [u8; 3]) -> Mark {
    Mark::Line { ends, ink, dashed: false }
}

fn text(at: Point, left: f64, words: &str) -> Mark {
    Mark::Text { at, left, words: words.into(), ink: INK }
}

/// Powers of ten within a range of logarithms; twice and five times them too where they are few.
fn ticks([low, high]: Point) -> Vec<(f64, String)> {
    let steps: &[f64] = if high - low < 3.2 { &[1.0, 2.0, 5.0] } else { &[1.0] };
    (low.floor() as i32..=high.ceil() as i32)
        .flat_map(|power| steps.iter().map(move |s| s * 10f64.powi(power)))
        .filter(|v| (low..=high).contains(&v.log10()))
        .map(|v| (v, number::tick(v as f32).replace(".00e", "e")))
        .collect()
}

fn svg(marks: &[Mark], [width, height]: Point) -> String {
    let mut out = format!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {width} {height}\" width=\"{width}\" \
         height=\"{height}\" font-family=\"sans-serif\" font-size=\"12\">\n\
         <rect width=\"100%\" height=\"100%\" fill=\"white\"/>\n"
    );
    let css = |[r, g, b]: [u8; 3]| format!("#{r:02x}{g:02x}{b:02x}");
    for mark in marks {
        // Writing into a string cannot fail.
        let _ = match mark {
            Mark::Line { ends: [[x1, y1], [x2, y2]], ink, dashed } => writeln!(
                out,
                "<line x1=\"{x1:.2}\" y1=\"{y1:.2}\" x2=\"{x2:.2}\" y2=\"{y2:.2}\" stroke=\"{}\"{}/>",
                css(*ink),
                if *dashed { " stroke-dasharray=\"6 4\"" } else { "" }
            ),
            Mark::Dot { at: [x, y], ink, ring } => {
                let (radius, fill, stroke) =
                    if *ring { (6.0, "none".to_owned(), css(*ink)) } else { (3.5, css(*ink), css(*ink)) };
                writeln!(
                    out,
                    "<circle cx=\"{x:.2}\" cy=\"{y:.2}\" r=\"{radius}\" fill=\"{fill}\" stroke=\"{stroke}\"/>"
                )
            }
            Mark::Text { at: [x, y], left, words, ink } => {
                let anchor = if *left == 0.0 {
                    "start"
                } else if *left == 1.0 {
                    "end"
                } else {
                    "middle"
                };
                let words = words.replace('&', "&amp;").replace('<', "&lt;");
                writeln!(
                    out,
                    "<text x=\"{x:.2}\" y=\"{y:.2}\" text-anchor=\"{anchor}\" fill=\"{}\">{words}</text>",
                    css(*ink)
                )
            }
        };
    }
    out.push_str("</svg>\n");
    out
}

fn page(marks: &[Mark], [width, height]: Point) -> Page {
    let mut page = Page::new((width * SCALE) as usize, (height * SCALE) as usize);
    page.pixels.fill([255; 4]);
    let place = |[x, y]: Point| [(x * SCALE) as f32, (y * SCALE) as f32];
    for mark in marks {
        match mark {
            Mark::Line { ends: [a, b], ink, dashed: false } => page.line(place(*a), place(*b), *ink),
            Mark::Line { ends: [a, b], ink, dashed: true } => {
                let dashes = ((b[0] - a[0]).hypot(b[1] - a[1]) / 10.0).max(1.0) as usize;
                for i in 0..dashes {
                    let [from, to] = [i as f64, i as f64 + 0.6]
                        .map(|t| [0, 1].map(|axis| a[axis] + (b[axis] - a[axis]) * t / dashes as f64));
                    page.line(place(from), place(to), *ink);
                }
            }
            Mark::Dot { at, ink, ring } => {
                let (outer, inner) = if *ring { (6.5 * SCALE, 5.5 * SCALE) } else { (3.5 * SCALE, 0.0) };
                let [x, y] = at.map(|v| v * SCALE);
                let reach = outer.ceil() as i64;
                for dy in -reach..=reach {
                    for dx in -reach..=reach {
                        let distance = (dx as f64).hypot(dy as f64);
                        let (px, py) = (x as i64 + dx, y as i64 + dy);
                        if (inner..=outer).contains(&distance) && px >= 0 && py >= 0 {
                            page.put(px as usize, py as usize, *ink);
                        }
                    }
                }
            }
            Mark::Text { at, left, words, ink } => {
                let wide = 8.0 * words.chars().count() as f64;
                let x = ((at[0] - left * wide) * SCALE).max(0.0);
                page.text(x as usize, ((at[1] - 8.0) * SCALE).max(0.0) as usize, SCALE as usize, words, *ink);
            }
        }
    }
    page
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn ticks_are_round_and_few() {
        let words = |range| ticks(range).into_iter().map(|t| t.1).collect::<Vec<_>>().join(" ");
        assert_eq!(words([-1.05, 1.1]), "0.1 0.2 0.5 1 2 5 10");
        assert_eq!(words([-2.0, 3.0]), "0.01 0.1 1 10 100 1000");
        assert_eq!(words([-5.05, -0.95]), "1e-5 1e-4 0.001 0.01 0.1");
    }

    #[test]
    fn every_point_is_drawn_in_both_files_and_the_front_is_ringed() {
        let lines = vec![vec![[1.0, 4.0], [2.0, 2.0], [4.0, 3.0]], vec![[1.5, 1.0], [f64::NAN, 1.0]]];
        let axes = ["cost, s".into(), "error, %".into()];
        let panel = Panel { title: "a".into(), axes, lines, level: Some((2.0, "goal".into())), front: true };
        let plot = Plot { title: "b".into(), names: vec!["x".into(), "y<".into()], panels: vec![panel] };
        let (marks, size) = plot.layout();
        let text = svg(&marks, size);
        // Four points and two in the legend; of the front two, and one in the legend.
        assert_eq!(text.matches("r=\"3.5\"").count(), 6);
        assert_eq!(text.matches("r=\"6\"").count(), 3);
        assert!(text.contains("y&lt;") && text.contains("error, %") && text.contains("goal"));
        let page = page(&marks, size);
        let coloured = |ink: [u8; 3]| page.pixels.iter().filter(|p| p[..3] == ink).count();
        assert!(COLOURS[..2].iter().all(|c| coloured(*c) > 100));
    }
}
