//! The sphere inspector.

use crate::window::Window;
use egui_kittest::kittest::Queryable;
use lumenscope::{command::Command, export::Export};
use lumenscope_core::io::probe::LAYERS;

#[test]
fn the_spheres_are_seen_at_every_resolution_as_plots_lobes_and_files() {
    let mut window = Window::on_room();
    window.wait_picture();
    window.harness.get_by_label("viewport").click();
    window.wait("the spheres", |app| app.session().probe.is_some());
    for bins in ["162", "1682", "4802"] {
        window.click(bins);
        let wanted: usize = bins.parse().unwrap();
        window.wait("finer spheres", |app| {
            app.session().probe.as_ref().is_some_and(|p| p.bins.len() == wanted)
        });
    }
    assert_eq!(window.view().probe_bins_n, 49);
    window.click("3-D lobe");
    window.harness.run_steps(3);
    window.harness.get_by_label("3-D radial plot");
    window.click("Smooth");
    window.harness.run_steps(3);
    window.keep("lobe");
    window.click("Resolutions");
    window.wait("every resolution", |app| app.session().resolutions.len() == 5);
    let bins: Vec<usize> = window.app().session().resolutions.iter().map(|p| p.bins.len()).collect();
    assert_eq!(bins, [162, 578, 1682, 3362, 4802]);
    window.harness.run_steps(3);
    window.keep("resolutions");
    window.harness.get_by_label("finest");

    window.click("Moments");
    window.wait("the moments", |app| app.session().moments.is_some());
    window.click("Another order");
    window.wait("one order more", |app| app.session().moments.as_ref().is_some_and(|m| m.of.len() == 7));
    window.harness.run_steps(3);
    window.keep("moments");
    for order in ["1", "30", "100", "∞"] {
        window.harness.get_by_label(&format!("moment of order {order}"));
    }

    let file = window.folder.path().join("spheres.exr");
    window.run(Command::Export(Export::Spheres, file.clone()));
    window.wait("the spheres' file", |app| !app.is_busy());
    let layers = lumenscope_core::io::exr::read_layers(&file).unwrap();
    assert!(LAYERS.iter().all(|(name, ..)| layers.iter().any(|l| l.0 == *name)));
    assert!(layers.iter().any(|l| l.0 == "moment_30_all_lx"), "the moments that are open too");
}
