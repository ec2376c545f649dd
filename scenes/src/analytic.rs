//! Scenes whose light has a closed form, stated at the top of each RON file and held by the tests.

use crate::glb::{Material, Model, Parts};
use crate::shapes::{
    Shape,
    boxes::{cuboid, plain},
    round::icosphere,
    v,
};
use std::path::PathBuf;

/// The files of `analytic/`.
pub fn files() -> Vec<(PathBuf, Vec<u8>)> {
    let mut files = Vec::new();
    let mut add = |name: &str, model: &Model, ron: String| {
        files.push((PathBuf::from(format!("analytic/{name}.glb")), model.bytes()));
        files.push((PathBuf::from(format!("analytic/{name}.ron")), ron.into_bytes()));
    };
    for (name, note, lamps, emitted) in SPHERES {
        let comment = format!("{SPHERE_NOTE}{note}");
        let model = one("Sphere", sphere(), Material::new("Wall", [0.5; 3]).emitting([emitted; 3]));
        add(name, &model, ron(name, &comment, lamps, (0.0, 0.0, 0.9), 1.2));
    }
    for (digits, reflectance) in [("0_5", 0.5), ("0_9", 0.9), ("0_99", 0.99), ("0_999", 0.999)] {
        let name = format!("furnace_box_{digits}");
        let emitted = ((1.0 - reflectance) * 1e6f64).round() / 1e6;
        let comment = format!(
            "Unit cube seen from inside. Every wall reflects rho = {reflectance} and emits Le = 1 - rho =\n\
             // {emitted} cd/m2, so the radiance is Le / (1 - rho) = 1 cd/m2 everywhere and in every direction;\n\
             // irradiance pi lx, of which pi Le is direct."
        );
        let model = one("Walls", unit_room(), wall(reflectance, emitted));
        add(&name, &model, ron(&name, &comment, "", (0.3, 0.5, 0.45), 1.2));
    }
    add("parallel_plates", &plates(), ron("parallel_plates", PLATES_NOTE, "", (0.0, 0.5, 2.2), 0.9));
    let floor = one("Floor", floor(), Material::new("Floor", [0.5; 3]));
    add("point_over_floor", &floor, ron("point_over_floor", POINT_NOTE, POINT, (0.0, 2.0, 4.0), 0.9));
    add("rectangle_over_floor", &floor, ron("rectangle_over_floor", AREA_NOTE, AREA, (0.0, 2.0, 4.0), 0.9));
    add("four_walls", &four_walls(), FOUR_WALLS.to_owned());
    add("bright_wall_x", &bright_wall(), ron("bright_wall_x", BRIGHT_NOTE, "", (-0.45, 0.5, 0.0), 1.2));
    files
}

const SPHERE_NOTE: &str = "\
Sphere of radius r = 1 m seen from inside, reflectance rho = 0.5; 1280 triangles, scaled so that
// their area is exactly 4 pi r^2. Every point of a sphere sees every other with the same form factor
// dA / 4 pi r^2, so the interreflected irradiance is uniform: rho / (1 - rho) times the mean direct.
// ";

/// Name, closed form, lamps, emitted radiance.
const SPHERES: [(&str, &str, &str, f64); 3] = [
    (
        "furnace_sphere",
        "A point lamp of I = pi (1 - rho) / rho r^2 = pi cd at the centre gives E_direct = I / r^2,
// E = E_direct / (1 - rho) = 2 pi lx, and reflected radiance L = rho E / pi = 1 cd/m2 everywhere.",
        "Point(name: \"Lamp\", at: (0.0, 0.0, 0.0), intensity: (3.1415927, 3.1415927, 3.1415927)),",
        0.0,
    ),
    (
        "furnace_sphere_four_lamps",
        "Four point lamps of I = pi / 4 cd, 0.4 m from the centre: E = sum I cos(theta) / d^2
// + rho / (1 - rho) sum I / r^2. The indirect part is pi lx everywhere and the mean reflected radiance
// is 1 cd/m2.",
        "Point(name: \"Lamp 1\", at: (0.2309401, 0.2309401, 0.2309401), intensity: (0.7853982, 0.7853982, 0.7853982)),
        Point(name: \"Lamp 2\", at: (0.2309401, -0.2309401, -0.2309401), intensity: (0.7853982, 0.7853982, 0.7853982)),
        Point(name: \"Lamp 3\", at: (-0.2309401, 0.2309401, -0.2309401), intensity: (0.7853982, 0.7853982, 0.7853982)),
        Point(name: \"Lamp 4\", at: (-0.2309401, -0.2309401, 0.2309401), intensity: (0.7853982, 0.7853982, 0.7853982)),",
        0.0,
    ),
    (
        "furnace_sphere_emissive",
        "The wall emits Le = 1 - rho = 0.5 cd/m2, so the radiance is Le / (1 - rho) = 1 cd/m2 everywhere,
// irradiance pi lx, of which pi Le is direct.",
        "",
        0.5,
    ),
];

const PLATES_NOTE: &str = "\
Two unit squares 1 m apart, facing each other. The upper one emits Le = 1000 cd/m2 and reflects
// nothing, so all light is direct. Mean irradiance of the lower: F pi Le with the form factor of equal
// parallel rectangles, X = Y = 1: F = 2/(pi X Y) [ln sqrt((1+X^2)(1+Y^2)/(1+X^2+Y^2))
// + X sqrt(1+Y^2) atan(X/sqrt(1+Y^2)) + Y sqrt(1+X^2) atan(Y/sqrt(1+X^2)) - X atan X - Y atan Y]
// = 0.199825, hence 627.77 lx. At its centre: 2 Le [2 a/sqrt(a^2+h^2) atan(a/sqrt(a^2+h^2))] with
// a = 0.5, h = 1, that is 4 x 0.5 / sqrt(1.25) x atan(0.5 / sqrt(1.25)) x 1000 = 752.27 lx.";

const POINT_NOTE: &str = "\
A point lamp of I = 100 cd 1 m over a floor of 4 x 4 m: E = I cos(theta) / d^2 = 100 / (1 + x^2 + z^2)^1.5
// lx; 100 lx under the lamp. Nothing reflects light back to the floor.";
const POINT: &str = "Point(name: \"Lamp\", at: (0.0, 1.0, 0.0), intensity: (100.0, 100.0, 100.0)),";

const AREA_NOTE: &str = "\
A lamp of 1 x 0.5 m, 1.5 m over a floor of 4 x 4 m, radiance L = 1000 cd/m2, shining down. Under its
// centre, with half sides a = 0.5, b = 0.25 and h = 1.5:
// E = 2 L [a/sqrt(a^2+h^2) atan(b/sqrt(a^2+h^2)) + b/sqrt(b^2+h^2) atan(a/sqrt(b^2+h^2))] = 203.63 lx.";
const AREA: &str = "\
area(name: \"Lamp\", corner: (-0.5, 1.5, -0.25), edge_u: (1.0, 0.0, 0.0), edge_v: (0.0, 0.0, 0.5),
        radiance: (1000.0, 1000.0, 1000.0)),";

const BRIGHT_NOTE: &str = "\
A unit room whose wall at +x emits 1 cd/m2; nothing reflects. At the centre it fills a sixth of the sphere:
// radiance 1 towards any point of the wall, 0 elsewhere. A receiver facing +x there gets
// E = 4 a/sqrt(a^2+h^2) atan(a/sqrt(a^2+h^2)) with a = h = 0.5, that is 1.7408 lx; one facing -x gets 0.";

const FOUR_WALLS: &str = "\
// A room of 2 m between four walls of constant radiance, as in Fig. 3.1 of Greger 1996: 4 cd/m2 on the left
// (-x), 3 at the back (-z), 2 on the right, 1 at the front; floor and ceiling are black, nothing reflects. At
// the centre a wall fills a side of a cube: a plane facing it sees 4 a/sqrt(a^2+h^2) atan(a/sqrt(a^2+h^2)) =
// 1.7408 sr of it weighted by the cosine, one at a right angle to it (pi - 1.7408)/4 = 0.3502 sr. So facing
// left E = 4 x 1.7408 + (3 + 1) x 0.3502 = 8.364 lx, right 4.882, back 7.324, front 3.842, up 3.502 lx.
(
    models: [(file: \"four_walls.glb\")],
    camera: Some((
        eye: (0.7, 0.1, 0.9),
        target: (-0.6, 0.0, -1.0),
        up: (0.0, 1.0, 0.0),
        vertical_fov: 1.4,
    )),
    plan: (volume: Some(true)),
)
";

fn ron(name: &str, comment: &str, lamps: &str, eye: (f64, f64, f64), fov: f64) -> String {
    // Area lamps stand in another list of the schema.
    let lamps = match lamps.strip_prefix("area") {
        Some(area) => format!("    area_lamps: [\n        {area}\n    ],\n"),
        None if lamps.is_empty() => String::new(),
        None => format!("    lamps: [\n        {lamps}\n    ],\n"),
    };
    let (x, y, z) = eye;
    let height = if name.starts_with("furnace_sphere") || name.contains("_over_") { 0.0 } else { 0.5 };
    let (tx, tz) = if name == "bright_wall_x" { (0.5, 0.0) } else { (0.0, 0.0) };
    format!(
        "// {comment}\n(\n    models: [(file: \"{model}.glb\")],\n{lamps}    camera: Some((\n        \
         eye: ({x:?}, {y:?}, {z:?}),\n        target: ({tx:?}, {height:?}, {tz:?}),\n        \
         up: (0.0, 1.0, 0.0),\n        vertical_fov: {fov:?},\n    )),\n)\n",
        model = name
    )
}

fn wall(reflectance: f64, emitted: f64) -> Material {
    Material::new("Wall", [reflectance; 3]).emitting([emitted; 3])
}

fn one(name: &str, shape: Shape, material: Material) -> Model {
    let mut model = Model::default();
    let material = model.material(material);
    model.stand(name, Parts::of(material, shape));
    model
}

/// A sphere seen from inside whose triangles have the area of the unit sphere.
fn sphere() -> Shape {
    let mut shape = icosphere(3);
    let area: f64 = shape
        .triangles
        .iter()
        .map(|t| {
            let [a, b, c] = t.map(|i| shape.positions[i as usize]);
            0.5 * (b - a).cross(c - a).length()
        })
        .sum();
    let scale = (4.0 * std::f64::consts::PI / area).sqrt();
    shape.positions.iter_mut().for_each(|p| *p *= scale);
    shape.inverted()
}

/// The unit cube on the floor, seen from inside.
fn unit_room() -> Shape {
    cuboid(v(-0.5, 0.0, -0.5), v(0.5, 1.0, 0.5)).inverted()
}

fn floor() -> Shape {
    plain([v(-2.0, 0.0, 2.0), v(2.0, 0.0, 2.0), v(2.0, 0.0, -2.0), v(-2.0, 0.0, -2.0)])
}

fn plates() -> Model {
    let mut model = Model::default();
    let lower = model.material(Material::new("Lower", [0.5; 3]));
    let upper = model.material(Material::new("Upper", [0.0; 3]).emitting([1000.0; 3]));
    let plate = |y: f64| [v(-0.5, y, 0.5), v(0.5, y, 0.5), v(0.5, y, -0.5), v(-0.5, y, -0.5)];
    model.stand("Lower plate", Parts::of(lower, plain(plate(0.0))));
    let mut facing_down = plate(1.0);
    facing_down.reverse();
    model.stand("Upper plate", Parts::of(upper, plain(facing_down)));
    model
}

/// The unit room with a wall of its own at +x.
fn bright_wall() -> Model {
    let mut model = Model::default();
    let black = model.material(Material::new("Black", [0.0; 3]));
    let bright = model.material(Material::new("Bright", [0.0; 3]).emitting([1.0; 3]));
    let room = unit_room();
    let (mut walls, mut lit) = (room.clone(), room);
    let at_x = |shape: &Shape, t: &[u32; 3]| t.iter().all(|&i| shape.positions[i as usize].x > 0.499);
    let all = lit.triangles.clone();
    lit.triangles = all.iter().copied().filter(|t| at_x(&walls, t)).collect();
    walls.triangles = all.iter().copied().filter(|t| !at_x(&lit, t)).collect();
    model.stand("Black walls", Parts::of(black, walls.compact()));
    model.stand("Bright wall", Parts::of(bright, lit.compact()));
    model
}

/// Four emitting walls, a black floor and a black ceiling, seen from inside.
fn four_walls() -> Model {
    let mut model = Model::default();
    let mut wall = |name: &'static str, radiance: f64, corners: [[f64; 3]; 4]| {
        let material = model.material(Material::new(name, [0.0; 3]).emitting([radiance; 3]));
        model.stand(name, Parts::of(material, plain(corners.map(|[x, y, z]| v(x, y, z)))));
    };
    let (l, h) = (-1.0, 1.0);
    wall("Left, 4 cd/m2", 4.0, [[l, l, h], [l, l, l], [l, h, l], [l, h, h]]);
    wall("Right, 2 cd/m2", 2.0, [[h, l, l], [h, l, h], [h, h, h], [h, h, l]]);
    wall("Back, 3 cd/m2", 3.0, [[l, l, l], [h, l, l], [h, h, l], [l, h, l]]);
    wall("Front, 1 cd/m2", 1.0, [[h, l, h], [l, l, h], [l, h, h], [h, h, h]]);
    wall("Floor", 0.0, [[l, l, h], [h, l, h], [h, l, l], [l, l, l]]);
    wall("Ceiling", 0.0, [[l, h, l], [h, h, l], [h, h, h], [l, h, h]]);
    model
}
