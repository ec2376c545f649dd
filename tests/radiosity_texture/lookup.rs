//! Bicubic lookup on grids of elements, as pictures may have it.

use glam::{Vec2, Vec3};
use lumenscope_core::{
    math::{image::LinearImage, part::Part, progress::Progress, random::Rng},
    radiosity::{
        RadiositySettings, RadiositySolution,
        lookup::{Lookup, SideMap, blend, mitchell},
        surface_map::{BURIED, Element},
        texture::{RadiosityTexture, display::Filter},
    },
    scene::world::World,
};

const SIDE: u32 = 9;

/// A triangle over one half of a grid whose barycentric weights are coordinates in it, and its nodes.
fn grid() -> (SideMap, Vec<Element>) {
    let last = (SIDE - 1) as f32;
    let side = SideMap::grid(0, SIDE, SIDE, [Vec2::ZERO, Vec2::X * last, Vec2::Y * last]);
    (side, vec![Element::default(); (SIDE * SIDE) as usize])
}

/// Value at a place in grid coordinates.
fn at(values: &[Vec3], elements: &[Element], place: Vec2) -> f32 {
    let barycentric = place / (SIDE - 1) as f32;
    mitchell(&grid().0, barycentric, elements, [values])[0].x
}

fn random_values() -> Vec<Vec3> {
    (0..SIDE * SIDE).map(|i| Vec3::splat(10.0 + 90.0 * Rng::new(3, i.into()).next_f32())).collect()
}

#[test]
fn constants_come_back_and_so_do_straight_slopes_inside() {
    let (_, nodes) = grid();
    let constant = vec![Vec3::splat(7.0); nodes.len()];
    let slope: Vec<Vec3> =
        (0..SIDE * SIDE).map(|i| Vec3::splat((3 + 2 * (i % SIDE) + i / SIDE) as f32)).collect();
    for i in 0..400 {
        let place = Rng::new(5, i).next_vec2() * (SIDE - 1) as f32;
        assert!((at(&constant, &nodes, place) - 7.0).abs() < 1e-5);
        // Beyond the border its outermost nodes stand again, which bends a slope in the outermost cells.
        if place.min_element() >= 1.0 && place.max_element() <= (SIDE - 2) as f32 {
            let wanted = 3.0 + 2.0 * place.x + place.y;
            assert!((at(&slope, &nodes, place) - wanted).abs() < 1e-4, "{place}");
        }
    }
}

#[test]
fn values_and_slopes_are_continuous_across_nodes() {
    let (side, nodes) = grid();
    let values = random_values();
    let bilinear = |place: Vec2| blend(&side, place / (SIDE - 1) as f32).sum(&values).x;
    let bicubic = |place: Vec2| at(&values, &nodes, place);
    // The second derivative is below 8 times the range of 90 a cell², so over two steps of h slopes differ by less
    // than 1440 h; f32 adds 2e-5 / h to each.
    let h = 1e-2;
    let mut creases: (f32, f32) = (0.0, 0.0);
    for i in 1..SIDE - 1 {
        for (axis, other) in [(Vec2::X, Vec2::Y), (Vec2::Y, Vec2::X)] {
            let node = axis * i as f32 + other * 3.37;
            let crease = |f: &dyn Fn(Vec2) -> f32| {
                let [below, here, above] = [-h, 0.0, h].map(|d| f(node + axis * d));
                ((above - here) - (here - below)).abs() / h
            };
            creases = (creases.0.max(crease(&bilinear)), creases.1.max(crease(&bicubic)));
        }
    }
    println!("largest jump of the slope, lx a cell: bilinear {:.1}, bicubic {:.2}", creases.0, creases.1);
    assert!(creases.1 < 1440.0 * h && creases.0 > 3.0 * creases.1, "{creases:?}");
    let jump = |h: f32| {
        let node = Vec2::new(4.0, 3.37);
        let [below, here, above] = [-h, 0.0, h].map(|d| bicubic(node + Vec2::X * d));
        ((above - here) - (here - below)).abs() / h
    };
    // A crease would stay as the step shrinks; a bend shrinks with it.
    assert!(jump(0.02) < 0.4 * jump(0.08) + 0.01, "{} {}", jump(0.02), jump(0.08));
}

#[test]
fn a_grid_is_looked_up_as_a_texture_is() {
    let (_, nodes) = grid();
    let values = random_values();
    let texture =
        RadiosityTexture::at_vertices(LinearImage { width: SIDE, height: SIDE, pixels: values.clone() });
    for i in 0..200 {
        let p = Rng::new(8, i).next_vec2();
        let wanted = texture.sample(p, Filter::Mitchell).x;
        // Rounding of coordinates up to 8 in f32.
        assert!((at(&values, &nodes, p * (SIDE - 1) as f32) - wanted).abs() < 1e-3);
    }
}

#[test]
fn nothing_is_negative_beside_a_bright_node_and_no_halo_surrounds_what_is_buried() {
    let (_, mut nodes) = grid();
    let bright = (4 * SIDE + 4) as usize;
    let mut values = vec![Vec3::ZERO; nodes.len()];
    values[bright] = Vec3::splat(100.0);
    let row = |values: &[Vec3], nodes: &[Element]| -> Vec<f32> {
        (0..=80).map(|i| at(values, nodes, Vec2::new(0.1 * i as f32, 4.0))).collect()
    };
    let seen = row(&values, &nodes);
    // The kernel's own 8/9 at the node, squared.
    assert!((seen[40] - 100.0 * 64.0 / 81.0).abs() < 1e-3 && seen.iter().all(|v| *v >= 0.0), "{seen:?}");

    let mut values = vec![Vec3::splat(50.0); nodes.len()];
    for y in 0..SIDE {
        values[(y * SIDE + 5) as usize] = Vec3::ZERO;
    }
    let open = |row: &[f32]| row[..40].iter().fold(0.0f32, |worst, v| worst.max((v - 50.0).abs()));
    let halo = open(&row(&values, &nodes));
    (0..SIDE).for_each(|y| nodes[(y * SIDE + 5) as usize].flags = BURIED);
    let without = open(&row(&values, &nodes));
    assert!(halo > 1.0 && without < 1e-3, "{halo} {without}");
}

#[test]
fn a_solution_shows_both_ways_and_hardly_differs_where_light_is_smooth() {
    let world = World::new(&lumenscope_tests::cornell());
    let settings = RadiositySettings { element_spacing_m: Some(0.1), ..RadiositySettings::default() };
    let solution = RadiositySolution::solve(&world, &settings, &Progress::silent()).expect("solves");
    let (mut sum, mut off) = (0.0, 0.0);
    for i in 0..2000 {
        let mut rng = Rng::new(21, i);
        let triangle = (rng.next_f32() * world.geometry.len() as f32) as u32;
        let p = rng.next_vec2();
        let barycentric = if p.element_sum() > 1.0 { Vec2::ONE - p } else { p };
        let of = |lookup| solution.shown(triangle, barycentric, false, Part::Indirect, lookup).x;
        let (bilinear, bicubic) = (of(Lookup::Bilinear), of(Lookup::Mitchell));
        assert!(bicubic.is_finite() && bicubic >= 0.0);
        assert_eq!(bilinear, solution.irradiance(triangle, barycentric, false, Part::Indirect).x);
        (sum, off) = (sum + bilinear, off + (bicubic - bilinear).abs());
        let all = solution.shown(triangle, barycentric, false, Part::All, Lookup::Mitchell);
        let direct = solution.shown(triangle, barycentric, false, Part::Direct, Lookup::Mitchell);
        assert!((all.x - direct.x - bicubic).abs() <= 1e-5 * all.x);
    }
    println!("mean difference {:.2} % of the mean", 100.0 * off / sum);
    assert!(off > 0.0 && off < 0.05 * sum, "{off} of {sum}");
}
