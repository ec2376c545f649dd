//! What the checks find in scenes with a planted fault.

use super::*;

fn warnings(scene: &Scene) -> Vec<String> {
    check(scene).iter().filter(|f| f.severity == Severity::Warning).map(|f| f.to_string()).collect()
}

fn assert_warns(scene: &Scene, object: &str, words: &str) {
    let found = warnings(scene);
    let hits = found.iter().filter(|w| w.starts_with(&format!("warning: {object}: ")) && w.contains(words));
    assert_eq!(hits.count(), 1, "\"{words}\" about \"{object}\" in {found:#?}");
    assert!(found.iter().all(|w| !w.contains('\n')));
}

#[test]
fn a_sound_scene_has_no_warnings() {
    let scene = scene_of(vec![ground("floor", 0.0, 0.0), cube("box", Vec3::new(0.2, 0.5, 0.2), true)]);
    assert_eq!(warnings(&scene), Vec::<String>::new());
    // A room: closed, front inside, with the camera, the lamp and a box in it.
    let (mut room, object) = cube("room", Vec3::ZERO, false);
    room.positions.iter_mut().for_each(|p| *p = *p * 10.0 - Vec3::splat(5.0));
    let scene = scene_of(vec![(room, object), cube("box", Vec3::new(0.2, 0.5, 0.2), true)]);
    assert_eq!(warnings(&scene), Vec::<String>::new());
}

#[test]
fn checks_find_flipped_and_open_shells() {
    let at = Vec3::new(0.2, 0.5, 0.2);
    assert_warns(&scene_of(vec![cube("box", at, false)]), "box", "its front inside");
    assert_warns(&scene_of(vec![cube("box", at, false)]), "box", "black back");

    let (mut one_flipped, object) = cube("box", at, true);
    one_flipped.triangles[3].swap(1, 2);
    let scene = scene_of(vec![(one_flipped, object)]);
    assert_warns(&scene, "box", "3 edges join triangles wound opposite ways");
    assert_warns(&scene, "box", "1 triangles have shading normals that point to their back");

    let (mut open, object) = cube("box", at, true);
    open.triangles.pop();
    let findings = check(&scene_of(vec![(open, object)]));
    assert_eq!(findings.len(), 1, "{findings:?}");
    assert_eq!((findings[0].severity, findings[0].object.as_str()), (Severity::Note, "box"));
    assert_eq!(findings[0].what, "3 open edges");

    let (mut floor, object) = ground("floor", 0.0, 0.0);
    floor.triangles.iter_mut().for_each(|t| t.swap(1, 2));
    floor.normals.iter_mut().for_each(|n| *n = -*n);
    assert_warns(&scene_of(vec![(floor, object)]), "floor", "100 % of what the camera and the lamps see");

    let (mut room, object) = cube("room", Vec3::ZERO, true);
    room.positions.iter_mut().for_each(|p| *p = *p * 10.0 - Vec3::splat(5.0));
    assert_warns(&scene_of(vec![(room, object)]), "room", "around the camera with its front outside");
}

#[test]
fn checks_find_coincident_faces() {
    // Overlapping by half, at the same height; neighbours that only touch do not count.
    let scene = scene_of(vec![ground("a", 0.0, 0.0), ground("b", 0.5, 0.0), ground("c", 1.5, 0.0)]);
    let found = warnings(&scene);
    assert_eq!(found.len(), 1, "{found:?}");
    assert_warns(&scene, "a", "coincide with those of \"b\"");
    let apart = scene_of(vec![ground("a", 0.0, 0.0), ground("b", 0.5, 0.01)]);
    assert_eq!(warnings(&apart), Vec::<String>::new());
}

#[test]
fn checks_find_materials_emitters_and_units() {
    let plain = || scene_of(vec![ground("floor", 0.0, 0.0)]);
    let mut white = plain();
    white.materials[0].reflectance = Vec3::splat(0.95);
    assert_warns(&white, "floor", "reflects 0.950");
    white.materials[0].reflectance = Vec3::new(1.2, 0.0, 0.0);
    assert_warns(&white, "floor", "will not settle");

    let mut dark = plain();
    dark.lamps[0].kind = LampKind::Point { intensity: Vec3::ZERO };
    assert_warns(&dark, "bulb", "lamp of no light");
    dark.lamps.clear();
    assert_warns(&dark, "planted", "nothing emits light");
    dark.materials[0].emission = Vec3::ONE;
    assert_eq!(warnings(&dark), Vec::<String>::new());
    dark.textures.push(Arc::new(LinearImage::new(2, 2)));
    dark.materials[0].emission_texture = Some(0);
    assert_warns(&dark, "floor", "emission texture is black");

    for scale in [1e-3, 1e4] {
        let mut scene = plain();
        scene.objects[0].world_from_object = Affine3A::from_scale(Vec3::splat(scale));
        assert_warns(&scene, "planted", "check the unit");
    }
    assert_warns(&Scene { name: "nothing".into(), ..Scene::default() }, "nothing", "no triangles");
}
