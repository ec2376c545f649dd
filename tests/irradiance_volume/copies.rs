//! Two copies of one thing lit by two volumes at once.

use glam::{Affine3A, Vec3};
use lumenscope_core::{
    irradiance_volume::{IrradianceVolume, VolumeSettings, dynamic_object::Gloss, moments::Order},
    math::{part::Part, progress::Progress},
    scene::mesh::Mesh,
    superposition::{
        PassSettings, composite::DirectQuality, gbuffer::NO_TRIANGLE, layers::Layer, moved::MovedLight,
        render,
    },
    transport::{LightTransportSolution, guests::Visitor},
};
use lumenscope_tests::{box_room, cornell, cuboid, diffuse, solved};
use std::{f32::consts::PI, sync::Arc};

fn visitor(mesh: &Arc<Mesh>, at: Vec3, volume: &Arc<IrradianceVolume>, part: Part) -> Visitor {
    Visitor {
        parts: vec![(mesh.clone(), diffuse("copy", Vec3::splat(0.4), Vec3::ZERO))],
        world_from_object: Affine3A::from_translation(at),
        volume: volume.clone(),
        part,
        known: None,
    }
}

fn small_box() -> Arc<Mesh> {
    Arc::new(cuboid(Vec3::splat(-0.15), Vec3::splat(0.15), false))
}

/// The volume of a solution with other bins.
fn with_bins(solution: &LightTransportSolution, bins_n: u32) -> Arc<IrradianceVolume> {
    let present = solution.volume.as_ref().unwrap();
    let settings = VolumeSettings { bins_n, ..present.settings().clone() };
    let volume =
        IrradianceVolume::build(&solution.world, &*solution.radiosity, &settings, &Progress::silent());
    Arc::new(volume.unwrap())
}

#[test]
fn copies_in_a_furnace_shine_alike_from_any_volume() {
    let bare = solved(box_room(0.5, 10.0), 0.25);
    let (coarse, fine) = (with_bins(&bare, 2), with_bins(&bare, 9));
    let mesh = small_box();
    let copies = [
        visitor(&mesh, Vec3::new(-0.25, 0.0, -0.3), &coarse, Part::All),
        visitor(&mesh, Vec3::new(0.25, 0.0, -0.3), &fine, Part::All),
    ];
    let dressed = bare.with_guests(&copies);
    assert_eq!(dressed.guests.len(), 2);
    assert!(Arc::ptr_eq(&dressed.scene, &bare.scene), "the scene does not know of its guests");
    let camera = bare.scene.camera;
    for direct in [DirectQuality::Elements, DirectQuality::PerPixel(4)] {
        let settings = PassSettings { direct, ..PassSettings::default() };
        let (buffer, layers) = render(&dressed, &camera, 64, 48, &settings);
        let sum = layers.sum([0.0, 1.0, 1.0, 0.0, 0.0]);
        let mut seen = [0; 2];
        for (i, &t) in buffer.triangle.iter().enumerate().filter(|(_, t)| **t != NO_TRIANGLE) {
            let object = dressed.world.geometry.object[t as usize];
            let Some(copy) = dressed.guests.iter().position(|g| g.object == object) else { continue };
            seen[copy] += 1;
            // E = π L with L = 20 cd/m²; reflected ρ L. Radiance alike from everywhere is read from any bins.
            let error = (sum.pixels[i] / (0.4 * 20.0) - 1.0).abs().max_element();
            assert!(error < 5e-3, "copy {copy}: {}", sum.pixels[i]);
        }
        assert!(seen.iter().all(|s| *s > 40), "{seen:?}");
    }
}

#[test]
fn copies_take_the_part_asked_for_and_leave_the_rest_as_it_was() {
    let bare = solved(cornell(), 0.25);
    let volume = bare.volume.clone().unwrap();
    let (mesh, at) = (small_box(), Vec3::new(0.0, 1.4, 0.2));
    let light = |part| {
        let dressed = bare.with_guests(&[visitor(&mesh, at, &volume, part)]);
        MovedLight::new(&dressed, false).entries
    };
    let [all, direct, indirect] = [Part::All, Part::Direct, Part::Indirect].map(light);
    assert!(!all.is_empty());
    for i in 0..all.len() {
        let [a, d, n] = [&all, &direct, &indirect].map(|l| l[i][0]);
        assert_eq!([d[1], n[0]], [Vec3::ZERO; 2], "one part alone");
        assert_eq!(a, [d[0], n[1]], "both parts together");
    }
    // What does not see the copies is lit as before: the elements know nothing of them.
    let dressed = bare.with_guests(&[visitor(&mesh, at, &volume, Part::All)]);
    let settings = PassSettings { direct: DirectQuality::Elements, ..PassSettings::default() };
    let camera = bare.scene.camera;
    let (before, was) = render(&bare, &camera, 96, 80, &settings);
    let (after, is) = render(&dressed, &camera, 96, 80, &settings);
    let mut covered = 0;
    for i in 0..before.triangle.len() {
        if before.triangle[i] == after.triangle[i] {
            for layer in Layer::ALL {
                assert_eq!(was.get(layer).pixels[i], is.get(layer).pixels[i]);
            }
        } else {
            covered += 1;
        }
    }
    assert!(covered > 20, "{covered} pixels show the copy");
    // Nodes made once serve again.
    let again =
        Visitor { known: Some(dressed.guests[0].known.clone()), ..visitor(&mesh, at, &volume, Part::All) };
    assert_eq!(MovedLight::new(&bare.with_guests(&[again]), false).entries, all);
    assert!(all.iter().all(|e| e[0][1].max_element() < PI * 100.0));
}

#[test]
fn a_copy_whose_volume_holds_no_moment_stays_matt_where_others_shine() {
    let mut bare = solved(cornell(), 0.25);
    let plain = bare.volume.clone().unwrap();
    let order = Order::Finite(10);
    bare.volume = Some(Arc::new(plain.with_moments(&[order], &bare.world, &*bare.radiosity)));
    let (mesh, at) = (small_box(), Vec3::new(0.0, 1.4, 0.2));
    let dressed = bare.with_guests(&[visitor(&mesh, at, &plain, Part::All)]);
    let matt = MovedLight::new(&dressed, false);
    let gloss = Some(Gloss { order, eye: bare.scene.camera.eye });
    let shining = MovedLight::new(&dressed.with_gloss(gloss), false);
    let guest = dressed.guests[0].object;
    let of = |light: &MovedLight| {
        let first = light.lattices[light.first[&guest] as usize].0 as usize;
        light.entries[first..].to_vec()
    };
    assert_eq!(of(&shining), of(&matt));
    assert!(of(&shining).iter().any(|e| e[0][0].max_element() > 0.0));
}
