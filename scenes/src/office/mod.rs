//! The default scene: an open-plan office of 8 × 6 × 2.8 m in the evening.
//!
//! Most light comes from an uplighter by way of the ceiling, so that what one sees is indirect light;
//! felt dividers in strong colours show it bleeding from surface to surface. Everything stands 1 or
//! 2 mm clear of its neighbours, so that no two faces coincide and no solid reaches into another.

pub(crate) mod furniture;
pub(crate) mod lamps;
pub(crate) mod palette;
mod room;
pub(crate) mod things;

use crate::glb::{Model, Parts};
use crate::shapes::{boxes::block, v};
use furniture::DESK;
use palette::Palette;
use std::path::PathBuf;

/// Lift of things that stand on a desk, m.
const ON_DESK: f64 = DESK;

/// `office/office.glb` and `office/office.ron`.
pub fn files() -> Vec<(PathBuf, Vec<u8>)> {
    vec![("office/office.glb".into(), model().bytes()), ("office/office.ron".into(), RON.as_bytes().to_vec())]
}

const RON: &str = "\
// An open-plan office in the evening, 8 x 6 x 2.8 m: a halogen uplighter (10000 lm) that lights the room
// by way of the ceiling, a luminous ceiling panel (about 2800 lm), a desk lamp (600 lm), dusk outside.
(
    models: [(file: \"office.glb\")],
    movable: [\"Desk lamp\", \"Uplighter\", \"Chair\", \"Mug\"],
    camera: Some((
        eye: (2.85, 1.60, 2.60),
        target: (-0.72, 0.97, -0.75),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 0.96,
    )),
    planes: [
        (name: \"Desk\", corner: (-0.64, 0.76, 0.42), edge_u: (1.6, 0.0, 0.0), edge_v: (0.0, 0.0, -0.8)),
        (name: \"Desks\", corner: (-2.36, 0.76, 0.42), edge_u: (3.32, 0.0, 0.0), edge_v: (0.0, 0.0, -1.72)),
        (name: \"Room at 0.85 m\", corner: (-3.9, 0.85, 2.9), edge_u: (7.8, 0.0, 0.0), edge_v: (0.0, 0.0, -5.8)),
    ],
)
";

/// Middle of the group of four desks.
const GROUP: [f64; 2] = [-0.70, -0.44];

fn model() -> Model {
    let mut model = Model::default();
    let palette = Palette::new(&mut model);
    room::add(&mut model, &palette);
    desks(&mut model, &palette);
    dividers(&mut model, &palette);
    chairs(&mut model, &palette);
    walls(&mut model, &palette);
    let uplighter = lamps::uplighter(&mut model, &palette);
    model.place("Uplighter", uplighter, [-2.62, 0.0, -2.0], 0.0);
    let desk_lamp = lamps::desk_lamp(&mut model, &palette);
    model.place("Desk lamp", desk_lamp, [0.78, ON_DESK, -0.20], 150.0);
    model
}

fn desks(model: &mut Model, palette: &Palette) {
    let desk = model.mesh(furniture::desk(palette));
    let monitor = model.mesh(things::monitor(palette));
    let keyboard = model.mesh(things::keyboard(palette));
    let mouse = model.mesh(things::mouse(palette));
    let papers = model.mesh(things::papers(palette));
    let pencils = model.mesh(things::pencils(palette));
    let white_mug = model.mesh(things::mug(palette, palette.stoneware));
    let [gx, gz] = GROUP;
    // Middle, turn; a desk's user sits at its +z.
    let places = [
        ("A", gx + 0.86, gz + 0.46, 0.0),
        ("B", gx - 0.86, gz + 0.46, 0.0),
        ("C", gx - 0.86, gz - 0.46, 180.0),
        ("D", gx + 0.86, gz - 0.46, 180.0),
        ("E", 2.75, -2.46, 180.0),
    ];
    for (name, x, z, turn) in places {
        let side = if turn == 0.0 { 1.0 } else { -1.0 };
        let at = |dx: f64, dz: f64| [x + side * dx, ON_DESK, z + side * dz];
        model.place(format!("Desk {name}"), desk, [x, 0.0, z], turn);
        model.place(format!("Monitor {name}"), monitor, at(-0.12, -0.16), turn + 6.0);
        model.place(format!("Keyboard {name}"), keyboard, at(-0.10, 0.17), turn);
        model.place(format!("Mouse {name}"), mouse, at(0.22, 0.18), turn - 8.0);
        if name != "D" {
            model.place(format!("Papers {name}"), papers, at(-0.52, 0.10), turn + 11.0);
        }
        if name < "C" {
            model.place(format!("Pencils {name}"), pencils, at(-0.62, -0.24), turn);
        }
        if name == "C" || name == "E" {
            model.place(format!("Mug {name}"), white_mug, at(0.38, -0.02), turn + 40.0);
        }
    }
    let mug = model.mesh(things::mug(palette, palette.turquoise));
    model.place("Mug", mug, [gx + 0.86 + 0.42, ON_DESK, gz + 0.46 + 0.24], -35.0);
}

fn dividers(model: &mut Model, palette: &Palette) {
    let [gx, gz] = GROUP;
    let [red, yellow, blue, green] = palette.dividers;
    let (long, short, height) = (1.66, 0.80, 1.22);
    let mut stand = |name: &str, felt, width, x: f64, z: f64, turn| {
        let mesh = model.mesh(furniture::divider(palette, felt, width, height));
        model.place(name, mesh, [x, 0.0, z], turn);
    };
    stand("Red divider", red, long, gx + 0.87, gz, 0.0);
    stand("Yellow divider", yellow, long, gx - 0.87, gz, 0.0);
    stand("Blue divider", blue, short, gx, gz + 0.46, 90.0);
    stand("Green divider", green, short, gx, gz - 0.46, 90.0);
    stand("Blue divider at the window", blue, 1.2, 1.75, -2.36, 90.0);
}

fn chairs(model: &mut Model, palette: &Palette) {
    let orange = model.mesh(furniture::chair(palette, palette.orange));
    let slate = model.mesh(furniture::chair(palette, palette.slate));
    model.place("Chair", orange, [1.15, 0.0, 1.02], 38.0);
    let [gx, gz] = GROUP;
    let places =
        [("B", gx - 0.90, gz + 1.22, 8.0), ("D", gx + 0.92, gz - 1.28, 200.0), ("E", 2.80, -1.62, 12.0)];
    for (name, x, z, turn) in places {
        model.place(format!("Slate chair {name}"), slate, [x, 0.0, z], turn);
    }
}

/// What stands along the walls, and the rug.
fn walls(model: &mut Model, palette: &Palette) {
    for (name, seed, z) in [("Bookcase left", 21, 0.72), ("Bookcase right", 8, -0.42)] {
        let bookcase = model.mesh(furniture::bookcase(palette.shelf, &palette.covers, seed));
        model.place(name, bookcase, [-room::X + 0.18, 0.0, z], 90.0);
    }
    let cabinet = model.mesh(things::cabinet(palette));
    model.place("Cabinet", cabinet, [-1.55, 0.0, -room::Z + 0.26], 0.0);
    let pot = [palette.clay, palette.earth, palette.leaf];
    let small = model.mesh(things::plant(pot, 16, 0.42, 17));
    model.place("Small plant", small, [-1.20, 0.722, -room::Z + 0.25], 0.0);
    let mug = model.mesh(things::mug(palette, palette.dividers[0]));
    model.place("Red mug", mug, [-1.78, 0.721, -room::Z + 0.28], 60.0);
    let plant = model.mesh(things::plant(pot, 44, 1.15, 4));
    model.place("Plant", plant, [0.62, 0.0, -room::Z + 0.48], 20.0);
    let basket = model.mesh(things::basket(palette));
    model.place("Waste-paper basket", basket, [1.42, 0.0, 0.18], 0.0);
    let clock = model.mesh(things::clock(palette));
    model.place("Clock", clock, [-0.40, 2.12, -room::Z], 0.0);
    let rug = block(v(GROUP[0], 0.0005, GROUP[1]), v(5.0, 0.001, 3.9), 0.0004);
    model.stand("Rug", Parts::of(palette.rug, rug));
}
