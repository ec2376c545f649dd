//! What is seen through glass, and lit through it.

use super::*;
use lumenscope_core::superposition::{PassSettings, render};

#[test]
fn glass_shows_and_passes_what_the_specification_says() {
    let Some(context) = context() else { return };
    let mut gpu = Gpu::new(context);
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../scenes/glass/glass.ron");
    let scene = lumenscope_core::scene::import::load(&path).unwrap();
    let solution = lumenscope_tests::solved(scene, 0.3);
    gpu.upload(&solution);
    let camera = solution.scene.camera;
    for direct in [DirectQuality::Elements, DirectQuality::PerPixel(8)] {
        gpu.frame(&frame_settings(camera, direct));
        let settings = PassSettings { direct, ..PassSettings::default() };
        let (buffer, layers) = render(&solution, &camera, SIZE[0], SIZE[1], &settings);
        // What a mirror behind two faces shows is decided by less than a pixel: only its mean is held, below.
        let layer = [Layer::Direct, Layer::Indirect];
        compare_layers("glass", &layer, (&gpu.triangles(), &gpu.layers()), (&buffer, &layers));
        let [a, b] = [&gpu.layers(), &layers].map(|l| l.get(Layer::Mirror).mean());
        println!("bent and mirrored: {a} for {b}");
        assert!((a - b).abs().max_element() < 5e-3 * b.max_element(), "{a} for {b}");
    }
}
