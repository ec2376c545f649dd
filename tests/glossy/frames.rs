//! Every method on a picture of the table that ships, with light of one's choice in the mirror image.

use super::setting::{ALPHAS, SHAPES};
use glam::{UVec2, Vec2, Vec3};
use lumenscope_core::{
    glossy::{
        GlossyMethod,
        pass::{GlossyFrame, Lobes, lobes},
    },
    math::random::hash2,
    mirror::{
        pass::MirrorImage,
        reflectors::{NO_REFLECTOR, Reflectors},
    },
    scene::{Scene, brdf::LobeShape, import, world::World},
    superposition::{
        PassSettings,
        gbuffer::{GBuffer, NO_TRIANGLE},
    },
};
use std::path::Path;

const SIZE: UVec2 = UVec2::new(160, 90);

/// The teapot's table with a lobe.
fn table(shape: LobeShape, alpha: f32) -> Scene {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/glossy/teapot.ron");
    let mut scene = import::load(&path).unwrap();
    for material in scene.materials.iter_mut().filter(|m| m.is_glossy()) {
        (material.roughness, material.lobe_shape) = (alpha.sqrt(), shape);
    }
    scene
}

/// Works on the scene's glossy pixels with a radiance by pixel in the mirror image.
fn with_frame<T>(scene: &Scene, radiance: impl Fn(u32) -> Vec3, work: impl FnOnce(&GlossyFrame) -> T) -> T {
    let (world, camera) = (World::new(scene), &scene.camera);
    let reflectors = Reflectors::new(&world.geometry);
    let lobes = lobes(&world, &reflectors, &Lobes::new());
    let buffer = GBuffer::new(&world, camera, SIZE, Vec2::splat(0.5));
    let count = (SIZE.x * SIZE.y) as usize;
    let mut image = MirrorImage {
        width: SIZE.x,
        height: SIZE.y,
        reflector: vec![NO_REFLECTOR; count],
        radiance: vec![Vec3::ZERO; count],
        distance: vec![0.0; count],
        views: 1,
        holes: 0,
    };
    for i in (0..count).filter(|i| buffer.triangle[*i] != NO_TRIANGLE) {
        let surface = buffer.surface(&world, camera, i).unwrap();
        image.reflector[i] = reflectors.of(surface.triangle);
        if image.reflector[i] != NO_REFLECTOR {
            image.radiance[i] = radiance(i as u32);
            let along = (buffer.position[i] - camera.eye).normalize();
            let met = world.accel.trace(&surface.mirrored(along));
            image.distance[i] = met.map_or(f32::INFINITY, |hit| hit.t);
        }
    }
    let settings = PassSettings::default();
    work(&GlossyFrame::new(&world, &reflectors, &lobes, &image, &buffer, camera, &settings))
}

fn each_lobe(mut test: impl FnMut(LobeShape, f32)) {
    SHAPES.into_iter().for_each(|shape| ALPHAS.into_iter().for_each(|alpha| test(shape, alpha)));
}

#[test]
fn constant_light_stays_constant_by_every_method_between_nodes_too() {
    each_lobe(|shape, alpha| {
        let light = Vec3::new(3.0, 2.0, 1.0);
        with_frame(
            &table(shape, alpha),
            |_| light,
            |frame| {
                for method in GlossyMethod::OF_IMAGE {
                    let found = frame.scattered(method);
                    let pixels: Vec<usize> = (0..found.len()).filter(|i| frame.point(*i).is_some()).collect();
                    assert!(pixels.len() > 4000, "{} glossy pixels", pixels.len());
                    for i in pixels {
                        // Asked for: 1e-3. Rounding of some hundred sums.
                        let error = ((found[i] - light) / light).abs().max_element();
                        assert!(error < 1e-4, "{shape:?}, α {alpha}, {}: {}", method.name(), found[i]);
                    }
                }
            },
        );
    });
}

#[test]
fn no_method_goes_beyond_what_it_sums_and_none_reflects_more_than_arrives() {
    each_lobe(|shape, alpha| {
        // From black to white by pixel, per channel.
        let noise = |i: u32| Vec3::from_array([1, 2, 3].map(|k| (hash2(i, k) & 255) as f32 / 255.0));
        with_frame(&table(shape, alpha), noise, |frame| {
            let [variant, half] =
                [GlossyMethod::Variant, GlossyMethod::VariantHalf].map(|method| frame.scattered(method));
            let between = variant.iter().zip(&half).filter(|(a, b)| a != b).count();
            assert!(alpha < 0.01 || between > 1000, "{shape:?}, α {alpha}: {between} pixels between nodes");
            for method in GlossyMethod::OF_IMAGE {
                let found = frame.scattered(method);
                for i in (0..found.len()).filter(|i| frame.point(*i).is_some()) {
                    let sound = found[i].min_element() >= -1e-6 && found[i].max_element() <= 1.0 + 1e-5;
                    assert!(sound, "{shape:?}, α {alpha}, {}: {}", method.name(), found[i]);
                    let reflected = frame.reflected(i, found[i]);
                    assert!(reflected.cmple(found[i] * (1.0 + 1e-5)).all(), "{reflected} of {}", found[i]);
                }
            }
        });
    });
}
