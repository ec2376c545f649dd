//! Shells: triangles joined by shared positions. Are they closed, wound alike and the right way out?

use super::Finding;
use crate::scene::{Scene, geometry::Geometry};
use glam::{DVec3, Vec3};
use std::collections::{BTreeMap, HashMap};

/// What the edges and the volume of one shell say.
#[derive(Default)]
struct Shell {
    open_edges: u32,
    /// Edges whose two triangles run along them the same way.
    clashing_edges: u32,
    crowded_edges: u32,
    /// Six times the volume enclosed, m³; negative when the front is inside.
    volume6: f64,
    /// Point that the volume is measured about, m.
    about: DVec3,
    low: Vec3,
    high: Vec3,
    single_sided: bool,
    opposed_normals: u32,
}

/// Reports open, badly wound and inside-out shells of every object.
pub fn check(scene: &Scene, geometry: &Geometry, findings: &mut Vec<Finding>) {
    let points = points_of_interest(scene, geometry);
    for (index, object) in scene.objects.iter().enumerate() {
        let mut open = 0;
        let mut clashing = 0;
        let mut crowded = 0;
        let mut opposed = 0;
        for shell in shells(geometry, geometry.object_triangles[index].clone()) {
            open += shell.open_edges;
            clashing += shell.clashing_edges;
            crowded += shell.crowded_edges;
            opposed += shell.opposed_normals;
            if shell.open_edges == 0 && shell.clashing_edges == 0 && shell.single_sided {
                findings.extend(inside_out(&shell, &object.name, index, &points));
            }
        }
        let name = &object.name;
        if clashing > 0 {
            let what = format!("{clashing} edges join triangles wound opposite ways");
            findings.push(Finding::warning(name, what, "some of its normals are flipped; make them agree"));
        }
        if opposed > 0 {
            let what = format!("{opposed} triangles have shading normals that point to their back");
            findings.push(Finding::warning(name, what, "recompute its normals"));
        }
        if open > 0 {
            let what = format!("{open} open edges");
            findings.push(Finding::note(name, what, "light passes where a closed shell was meant"));
        }
        if crowded > 0 {
            let what = format!("{crowded} edges join more than two triangles");
            findings.push(Finding::note(name, what, "inside and outside are not defined there"));
        }
    }
}

/// Objects with a side that no light can reach: closed shells all, solids with their front outside or rooms
/// with their front inside. A solid holds nothing else, a room does.
pub fn with_dark_sides(scene: &Scene, geometry: &Geometry) -> Vec<usize> {
    let points = points_of_interest(scene, geometry);
    let has_dark_side = |index: usize| {
        let shells = shells(geometry, geometry.object_triangles[index].clone());
        shells.iter().all(|shell| {
            let faults =
                shell.open_edges + shell.clashing_edges + shell.crowded_edges + shell.opposed_normals;
            faults == 0 && shell.volume6 != 0.0 && shell.is_room(index, &points) == (shell.volume6 < 0.0)
        })
    };
    (0..scene.objects.len()).filter(|&index| has_dark_side(index)).collect()
}

impl Shell {
    /// Whether it is around something else than the object it belongs to: a room, whose front is inside.
    fn is_room(&self, object: usize, points: &[(Option<usize>, Vec3)]) -> bool {
        points.iter().any(|&(owner, p)| owner != Some(object) && self.holds(p))
    }

    fn holds(&self, p: Vec3) -> bool {
        p.cmpgt(self.low).all() && p.cmplt(self.high).all()
    }
}

/// The camera, the lamps and the middle of every object; with the object that each belongs to.
fn points_of_interest(scene: &Scene, geometry: &Geometry) -> Vec<(Option<usize>, Vec3)> {
    let mut points = vec![(None, scene.camera.eye)];
    points.extend(scene.lamps.iter().map(|l| (None, l.position())));
    for (index, range) in geometry.object_triangles.iter().enumerate() {
        let corners = range.clone().flat_map(|t| geometry.positions[t as usize]);
        let bounds = corners.fold(None, |b: Option<(Vec3, Vec3)>, p| {
            Some(b.map_or((p, p), |(low, high)| (low.min(p), high.max(p))))
        });
        points.extend(bounds.map(|(low, high)| (Some(index), 0.5 * (low + high))));
    }
    points
}

fn inside_out(shell: &Shell, name: &str, object: usize, points: &[(Option<usize>, Vec3)]) -> Option<Finding> {
    if shell.volume6 < 0.0 && !shell.is_room(object, points) {
        let what = "closed shell with its front inside".into();
        return Some(Finding::warning(name, what, "flip its normals: its outside is black"));
    }
    if shell.volume6 > 0.0 && shell.holds(points[0].1) {
        let what = "closed shell around the camera with its front outside".into();
        return Some(Finding::warning(name, what, "flip its normals: its inside is black"));
    }
    None
}

fn shells(geometry: &Geometry, triangles: std::ops::Range<u32>) -> Vec<Shell> {
    let mut vertex_of: HashMap<[u32; 3], u32> = HashMap::new();
    let corners: Vec<[u32; 3]> = triangles
        .clone()
        .map(|t| {
            geometry.positions[t as usize].map(|p| {
                let next = vertex_of.len() as u32;
                // Adding zero makes −0 and 0 the same position.
                *vertex_of.entry((p + Vec3::ZERO).to_array().map(f32::to_bits)).or_insert(next)
            })
        })
        .collect();
    let mut parent: Vec<u32> = (0..vertex_of.len() as u32).collect();
    for [a, b, c] in &corners {
        for other in [b, c] {
            let (x, y) = (root(&mut parent, *a), root(&mut parent, *other));
            parent[x.max(y) as usize] = x.min(y);
        }
    }
    let mut shells: BTreeMap<u32, Shell> = BTreeMap::new();
    let mut edges: HashMap<(u32, u32), [u32; 2]> = HashMap::new();
    for (t, corner) in triangles.zip(&corners) {
        let positions = geometry.positions[t as usize];
        let shell = shells.entry(root(&mut parent, corner[0])).or_insert_with(|| Shell {
            about: positions[0].as_dvec3(),
            low: positions[0],
            high: positions[0],
            single_sided: true,
            ..Shell::default()
        });
        // About a fixed point of the shell, so that far-away shells keep their digits.
        let [a, b, c]: [DVec3; 3] = positions.map(|p| p.as_dvec3() - shell.about);
        shell.volume6 += a.dot(b.cross(c));
        for p in positions {
            shell.low = shell.low.min(p);
            shell.high = shell.high.max(p);
        }
        shell.single_sided &= !geometry.material_of(t).double_sided;
        let face = geometry.area_normal(t);
        shell.opposed_normals += u32::from(geometry.normals[t as usize].iter().all(|n| n.dot(face) < 0.0));
        for (from, to) in [(corner[0], corner[1]), (corner[1], corner[2]), (corner[2], corner[0])] {
            let way = usize::from(from > to);
            edges.entry((from.min(to), from.max(to))).or_default()[way] += 1;
        }
    }
    for (&(vertex, _), &[forward, backward]) in &edges {
        let Some(shell) = shells.get_mut(&root(&mut parent, vertex)) else { continue };
        match (forward, backward) {
            (1, 1) => {}
            (1, 0) | (0, 1) => shell.open_edges += 1,
            (2, 0) | (0, 2) => shell.clashing_edges += 1,
            _ => shell.crowded_edges += 1,
        }
    }
    shells.into_values().collect()
}

fn root(parent: &mut [u32], mut vertex: u32) -> u32 {
    while parent[vertex as usize] != vertex {
        parent[vertex as usize] = parent[parent[vertex as usize] as usize];
        vertex = parent[vertex as usize];
    }
    vertex
}
