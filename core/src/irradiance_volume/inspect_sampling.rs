//! How a volume samples: the rays of one point, and which cells interpolation serves badly.

use super::{
    SurfaceLight, VolumeError, VolumeSettings,
    adaptive::cell_errors,
    rays::{Targets, chain},
};
use crate::{
    inspection::{ColouredMesh, InspectionScene, Legend, Line, robust_range},
    math::{
        progress::Progress,
        random::{fold, hash2},
        sphere_map::DirectionBins,
    },
    scene::world::World,
};
use glam::{UVec3, Vec3};

/// Most rows of bins a hemisphere whose rays are drawn: more would hide the scene.
const MOST_ROWS: u32 = 9;

/// Most aimed rays that are drawn.
const MOST_AIMED: u32 = 64;

/// Display colours of rays: to a dull surface, by way of mirrors, out of the scene or to a back, aimed.
const DULL: Vec3 = Vec3::new(0.25, 0.4, 0.6);
const MIRRORED: Vec3 = Vec3::new(0.2, 0.8, 0.75);
const LOST: Vec3 = Vec3::new(0.5, 0.1, 0.1);
const AIMED: Vec3 = Vec3::new(0.95, 0.55, 0.1);

/// The rays that a sample at a point would send: one through the middle of each bin, followed through mirrors,
/// and those aimed at bright surfaces.
pub fn rays(
    world: &World,
    light: &impl SurfaceLight,
    settings: &VolumeSettings,
    position: Vec3,
) -> InspectionScene {
    let bins = DirectionBins::new(settings.bins_n.min(MOST_ROWS));
    let mut scene = InspectionScene::default();
    let (mut mirrors, mut lost) = (0, 0);
    for bin in 0..bins.len() {
        let places = chain(world, settings.specular_cutoff, position, bins.centre(bin));
        let Some((places, lit)) = places else {
            lost += 1;
            continue;
        };
        mirrors += places.len().saturating_sub(2);
        lost += usize::from(!lit);
        let colour = match (lit, places.len()) {
            (false, _) => LOST,
            (true, 2) => DULL,
            (true, _) => MIRRORED,
        };
        scene.lines.extend(places.windows(2).map(|ends| Line { ends: [ends[0], ends[1]], colour }));
    }
    let targets = if settings.informed_rays > 0 { Targets::new(light) } else { Targets::default() };
    let points = targets.aim(position, settings.informed_rays.min(MOST_AIMED), hash2(0, fold(settings.seed)));
    let mut met = 0;
    for point in &points {
        let ray = crate::scene::accel::Ray::between(position, *point);
        let hidden = world.accel.occluded(&ray);
        met += usize::from(!hidden);
        scene.lines.push(Line { ends: [position, *point], colour: if hidden { LOST } else { AIMED } });
    }
    scene.notes = vec![
        format!(
            "{} rays, one a bin of {} (the volume has {}): blue to dull surfaces, green by way of {mirrors} mirrors, \
             red lost ({lost})",
            bins.len(),
            bins.len(),
            2 * settings.bins_n * settings.bins_n
        ),
        format!(
            "{} of {} rays aimed at {} bright elements, orange; {met} meet what they are aimed at",
            points.len(),
            settings.informed_rays,
            targets.len()
        ),
    ];
    scene
}

/// Error of interpolation in each first-level cell as a cube in its middle, %, and how many a tolerance would
/// divide.
///
/// # Errors
/// [`VolumeError`] for settings out of range and bounds that are not finite.
pub fn cell_error_scene(
    world: &World,
    light: &impl SurfaceLight,
    settings: &VolumeSettings,
) -> Result<InspectionScene, VolumeError> {
    let grid = settings.grid(world)?;
    let errors = cell_errors(world, light, settings, &grid, &Progress::silent())?;
    let (low, _) = grid.bounds();
    let (size, cell) = (grid.size(), grid.cell_size());
    let mut mesh = ColouredMesh::default();
    for (c, error) in (0u32..).zip(&errors) {
        let at = UVec3::new(c % size.x, c / size.x % size.y, c / (size.x * size.y));
        let middle = low + (at.as_vec3() + 0.5) * cell;
        let half = 0.5 * cell.min_element() * error.clamp(0.02, 1.0).cbrt() * 0.3;
        let first = mesh.positions.len() as u32;
        for i in 0..8 {
            let side = |bit: u32| if i >> bit & 1 == 1 { half } else { -half };
            mesh.positions.push(middle + Vec3::new(side(0), side(1), side(2)));
            mesh.values.push(Vec3::splat(100.0 * error));
        }
        for [a, b, c, d] in
            [[0, 2, 6, 4], [1, 5, 7, 3], [0, 4, 5, 1], [2, 3, 7, 6], [0, 1, 3, 2], [4, 6, 7, 5]]
        {
            mesh.triangles.push([first + a, first + b, first + c]);
            mesh.triangles.push([first + a, first + c, first + d]);
        }
    }
    let [_, high] = robust_range(errors.iter().map(|e| 100.0 * e));
    let over = |tolerance: f32| errors.iter().filter(|e| **e > tolerance).count();
    Ok(InspectionScene {
        meshes: vec![mesh],
        legend: Some(Legend {
            quantity: "error of interpolation in a cell".into(),
            unit: "%".into(),
            range: [0.0, high],
            names: &[],
        }),
        notes: vec![format!(
            "{} cells; a tolerance of 5 % would divide {}, of 10 % {}, of 20 % {}",
            errors.len(),
            over(0.05),
            over(0.1),
            over(0.2)
        )],
        ..InspectionScene::default()
    })
}
