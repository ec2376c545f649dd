//! A small house with a music room: the scene for mirrors at speed.
//!
//! After the house of Bastos 1999, §6.6.5, which has 140,000 polygons and five flat reflectors: here the
//! lacquered floor of the music room, the lid of the grand piano, the top of its bench, a mirrored door and
//! a framed mirror facing it. Most triangles are in the turned balusters of the stair next door, which the
//! mirrors see through an arch: what a frame needs of them is for culling to find out.

mod furniture;
mod lamps;
mod palette;
mod piano;
mod shell;
mod stair;

use crate::glb::{Model, Parts};
use crate::office::{furniture::bookcase, things::plant};
use crate::shapes::{boxes::quad, v};
use furniture::{
    candlestick, curtain, curtain_rod, frame, framed, pillar_table, sofa, spindle_chair, table, vase,
};
use glam::DVec2;
use palette::Palette;
use std::{fmt::Write as _, path::PathBuf};

/// The models of the two rooms, `house/house.ron` and the walk through it, `house/path.csv`.
pub fn files() -> Vec<(PathBuf, Vec<u8>)> {
    vec![
        ("house/music_room.glb".into(), model(music_room).bytes()),
        ("house/living_room.glb".into(), model(living_room).bytes()),
        ("house/house.ron".into(), RON.as_bytes().to_vec()),
        ("house/path.csv".into(), path().into_bytes()),
    ]
}

const RON: &str = "\
// A small house on a bright afternoon, 10 x 6 m: a music room with a grand piano and, through an arch, a
// living room with a stair. Five flat reflectors: the lacquered floor, the piano's lid, the bench's top,
// the mirrored door and the framed mirror. Five lamps of 420 to 6500 lm, and the garden in the windows.
(
    models: [(file: \"music_room.glb\"), (file: \"living_room.glb\")],
    movable: [\"Piano lamp\", \"Torchiere\", \"Table lamp\"],
    camera: Some((
        eye: (-0.95, 1.58, 1.62),
        target: (-3.25, 0.86, -1.30),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 1.0,
    )),
    planes: [
        (name: \"Music\", corner: (-3.2, 1.05, -0.9), edge_u: (0.9, 0.0, 0.0), edge_v: (0.0, 0.3, -0.08)),
    ],
)
";

/// Places on the walk: seconds, eye, target, m.
const WALK: [[f64; 7]; 12] = [
    [0.0, 4.3, 1.65, 2.5, 1.6, 1.4, -1.6],
    [4.0, 2.9, 1.62, 2.0, 0.6, 1.3, -0.4],
    [8.0, 1.5, 1.60, 1.1, -1.6, 1.1, -0.4],
    [12.0, 0.2, 1.60, 0.5, -2.6, 0.9, -0.9],
    [16.0, -0.8, 1.62, 1.2, -3.0, 0.9, -1.2],
    [20.0, -1.6, 1.66, 1.9, -3.1, 0.9, -0.9],
    [24.0, -3.0, 1.62, 2.1, -4.5, 1.3, -0.2],
    [28.0, -4.0, 1.60, 1.5, -2.4, 0.9, -0.6],
    [32.0, -4.1, 1.70, 0.6, -1.6, 1.0, 0.6],
    [36.0, -3.4, 1.65, 1.6, -0.4, 1.1, 1.7],
    [40.0, -1.9, 1.62, 1.5, -0.2, 1.2, 0.4],
    [44.0, -0.6, 1.60, 0.4, 2.2, 1.3, -1.6],
];

fn path() -> String {
    let mut text = String::from("seconds,eye_x,eye_y,eye_z,target_x,target_y,target_z\n");
    for row in WALK {
        let row: Vec<String> = row.iter().map(f64::to_string).collect();
        let _ = writeln!(text, "{}", row.join(","));
    }
    text
}

fn model(room: fn(&mut Model, &Palette)) -> Model {
    let mut model = Model::default();
    let palette = Palette::new(&mut model);
    room(&mut model, &palette);
    model.tidied()
}

fn music_room(model: &mut Model, palette: &Palette) {
    shell::music_room(model, palette);
    piano::add(model, palette, v(-2.75, 0.0, -0.42));
    // The framed mirror over a console on the left wall.
    let size = DVec2::new(1.30, 0.95);
    let wall = -shell::X;
    let (y, z) = (1.62, 0.55);
    let edge = model.mesh(frame(palette.gilt, size, true));
    model.place("Mirror frame", edge, [wall, y, z], 90.0);
    let glass = model.mesh(Parts::of(palette.mirror_glass, framed(size, false)));
    model.place("Framed mirror", glass, [wall, y, z], 90.0);
    let console = model.mesh(table(palette.walnut, v(1.35, 0.84, 0.40), 0.032));
    model.place("Console", console, [wall + 0.22, 0.0, z], 90.0);
    let vase = model.mesh(vase(palette.cobalt));
    model.place("Vase", vase, [wall + 0.22, 0.841, z - 0.48], 0.0);
    let stick = model.mesh(candlestick(palette));
    model.place("Candlestick left", stick, [wall + 0.22, 0.841, z + 0.10], 0.0);
    model.place("Candlestick right", stick, [wall + 0.20, 0.841, z - 0.20], 0.0);
    let lamp = lamps::table_lamp(model, palette, "Console lamp light", palette.porcelain, 620.0);
    model.place("Console lamp", lamp, [wall + 0.23, 0.841, z + 0.46], 0.0);
    // Curtains at both windows.
    let drape = model.mesh(curtain(palette.curtain, 0.44, 2.46));
    let rail = model.mesh(curtain_rod(palette.brass, 1.95));
    for (k, x) in [-3.75, -1.75].into_iter().enumerate() {
        model.place(format!("Curtain rod {}", k + 1), rail, [x, 2.60, -shell::Z + 0.10], 0.0);
        for (side, dx) in [("left", -0.72), ("right", 0.72)] {
            let at = [x + dx, 0.125, -shell::Z + 0.10];
            model.place(format!("Curtain {} {side}", k + 1), drape, at, 0.0);
        }
    }
    let pendant = lamps::pendant(model, palette);
    model.place("Pendant", pendant, [-2.6, shell::LOW, 0.5], 0.0);
    let lamp = lamps::piano_lamp(model, palette);
    model.place("Piano lamp", lamp, [-2.28, 1.001, -1.10], -14.0);
    let tall = model.mesh(plant(palette.pot, 44, 1.15, 9));
    model.place("Palm", tall, [-4.5, 0.0, -2.45], 30.0);
    let chair = model.mesh(spindle_chair(palette.walnut));
    model.place("Listener's chair left", chair, [-4.35, 0.0, 1.95], 118.0);
    model.place("Listener's chair right", chair, [-3.45, 0.0, 2.45], 160.0);
    let side = model.mesh(pillar_table(palette.walnut, 0.27, 0.62));
    model.place("Small table", side, [-4.0, 0.0, 2.5], 0.0);
    painting(model, palette, 0, [1.1, 0.82], [-2.0, 1.62, shell::Z], 180.0);
    painting(model, palette, 2, [0.5, 0.66], [-0.08, 1.68, -2.05], -90.0);
}

fn painting(model: &mut Model, palette: &Palette, which: usize, size: [f64; 2], at: [f64; 3], turn: f64) {
    let names = ["Painting of hills", "Painting of bars", "Painting of rings"];
    let size = DVec2::from(size);
    let mut parts = frame(palette.gilt, size, false);
    parts.add(palette.paintings[which], framed(size, true));
    let mesh = model.mesh(parts);
    model.place(names[which], mesh, at, turn);
}

fn living_room(model: &mut Model, palette: &Palette) {
    shell::living_room(model, palette);
    stair::add(model, palette);
    let rug =
        quad([v(1.0, 0.004, 2.3), v(3.4, 0.004, 2.3), v(3.4, 0.004, 0.5), v(1.0, 0.004, 0.5)], DVec2::ONE);
    model.stand("Rug", Parts::of(palette.rug, rug));
    let [petrol, rust, mustard] = palette.upholstery;
    let long = model.mesh(sofa(petrol, mustard, palette.walnut, 1.95));
    model.place("Sofa", long, [2.2, 0.0, 2.42], 180.0);
    let short = model.mesh(sofa(rust, palette.curtain, palette.walnut, 0.95));
    model.place("Armchair", short, [0.95, 0.0, 0.35], 60.0);
    let low = model.mesh(table(palette.oak, v(1.05, 0.44, 0.6), 0.03));
    model.place("Coffee table", low, [2.2, 0.0, 1.35], 0.0);
    let stick = model.mesh(candlestick(palette));
    model.place("Candlestick", stick, [2.45, 0.441, 1.3], 0.0);
    let bowl = model.mesh(vase(palette.porcelain));
    model.place("Jar", bowl, [1.95, 0.441, 1.42], 0.0);
    let shelves = model.mesh(bookcase(palette.walnut, &palette.covers, 5));
    for (name, x) in [("Bookcase left", 0.72), ("Bookcase right", 4.3)] {
        model.place(name, shelves, [x, 0.0, shell::Z - 0.17], 180.0);
    }
    let dining = model.mesh(pillar_table(palette.oak, 0.52, 0.74));
    model.place("Round table", dining, [4.25, 0.0, 0.35], 0.0);
    let chair = model.mesh(spindle_chair(palette.oak));
    for (k, (dx, dz, turn)) in
        [(-0.72, 0.1, 98.0), (0.05, 0.74, 176.0), (0.1, -0.74, 4.0)].into_iter().enumerate()
    {
        model.place(format!("Chair {}", k + 1), chair, [4.25 + dx, 0.0, 0.35 + dz], turn);
    }
    let fern = model.mesh(plant(palette.pot, 18, 0.45, 21));
    model.place("Fern", fern, [4.25, 0.741, 0.35], 10.0);
    let torchiere = lamps::torchiere(model, palette);
    model.place("Torchiere", torchiere, [0.42, 0.0, -1.75], 0.0);
    let side = model.mesh(pillar_table(palette.walnut, 0.27, 0.62));
    model.place("Lamp table", side, [3.55, 0.0, 2.2], 0.0);
    let lamp = lamps::table_lamp(model, palette, "Table lamp light", palette.cobalt, 620.0);
    model.place("Table lamp", lamp, [3.55, 0.621, 2.2], 0.0);
    painting(model, palette, 1, [0.8, 0.8], [2.2, 1.95, shell::Z], 180.0);
}
