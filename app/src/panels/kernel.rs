//! The kernel of the glossy surface under the pointer: its image, its lobe, its spectrum, its numbers.

use super::edit_view;
use crate::{
    command::Command,
    pipeline::KERNEL,
    session::Session,
    widgets::{
        beside,
        value_table::{self, Row},
    },
};
use egui::{RichText, Ui};
use lumenscope_core::{
    glossy::inspect::{KernelNumbers, KernelView},
    scene::brdf::LobeShape,
};

/// Height of the image and of the plots, points.
const HEIGHT: f32 = 92.0;

/// Shows the kernel, or says how to get one.
pub fn show(ui: &mut Ui, session: &Session, kernel: Option<&KernelView>, out: &mut Vec<Command>) {
    let on = session.document.view.shows(KERNEL);
    edit_view(&session.document.view, out, |view| {
        let mut follow = on;
        if ui.checkbox(&mut follow, "Kernel under the pointer").changed() {
            view.show(KERNEL, follow);
        }
    });
    if !on {
        ui.weak(
            "Switch it on and point at something glossy: where its lobe draws light from, and how finely.",
        );
        return;
    }
    let Some(kernel) = kernel else {
        ui.weak("Point at something glossy: polished, but no ideal mirror.");
        return;
    };
    let scene = &kernel.scene;
    ui.horizontal_top(|ui| {
        scene.images.iter().for_each(|image| beside::picture(ui, image, HEIGHT));
        ui.vertical(|ui| value_table::show(ui, "kernel", &rows(&kernel.numbers)));
    });
    let (lobes, spectra): (Vec<_>, Vec<_>) = scene.curves.iter().partition(|c| c.radial);
    for (name, curves) in [
        ("Lobe in the plane of incidence", lobes),
        ("Spectrum in that plane and across it, by cycles a radian", spectra),
    ] {
        ui.label(RichText::new(name).small());
        beside::plot(ui, name, &curves, HEIGHT, false);
    }
}

/// The numbers by name, as they are shown and copied.
pub fn rows(numbers: &KernelNumbers) -> Vec<Row> {
    let n = numbers;
    vec![
        Row::one(
            "Samples needed",
            n.samples_a_radian(),
            "1/rad",
            "Two a cycle of the highest frequency that passes",
        ),
        Row::one("One every", n.spacing_degrees(), "°", "Angle from one sample of the light to the next"),
        Row::one(
            "Band in the plane",
            n.band[0],
            "1/rad",
            "Highest frequency that passes in the plane of incidence, cycles a radian",
        ),
        Row::one(
            "Band across it",
            n.band[1],
            "1/rad",
            "Highest frequency that passes across the plane of incidence, cycles a radian",
        ),
        Row::one(
            "Support",
            n.support_degrees,
            "°",
            "Angle from the mirrored direction within which 95 % of the light comes",
        ),
        Row::one(
            "Footprint",
            n.footprint_m,
            "m",
            "Diameter of the support where the mirrored direction meets the scene",
        ),
        Row::one("Distance", n.reach_m, "m", "How far away that is"),
        Row::one("Seen at", n.view_degrees, "°", "Angle between view and normal"),
        Row::one(
            match n.lobe.shape() {
                LobeShape::Ggx => "Roughness, GGX",
                LobeShape::Phong => "Roughness, Phong",
            },
            n.roughness,
            "",
            "√α, as in glTF; Phong's exponent is (1/α² − 1) / 2",
        ),
        Row::one(
            "Lobe's albedo",
            n.albedo,
            "",
            "∫ f cos θ dω with F = 1: what the lobe keeps of uniform light",
        ),
    ]
}
