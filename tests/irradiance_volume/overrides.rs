//! Settings of the volume that a scene's file fixes, and what the plan makes of them.

use lumenscope_core::{
    irradiance_volume::{Basis, VolumeSettings, moments::Order, trust::Repair},
    scene::{file::PlanOverrides, world::World},
    superposition::plan::{Component, ExpectedError, Plan},
};
use lumenscope_tests::{add_point_lamp, cornell};

#[test]
fn every_setting_of_the_volume_can_be_fixed_by_the_scene() {
    let over = PlanOverrides {
        volume: Some(true),
        volume_samples: Some([4, 5, 6]),
        volume_second_level: Some(4),
        volume_target_samples: Some(900),
        volume_pocket_samples: Some(50),
        volume_refine_tolerance: Some(0.1),
        volume_refine_geometry: Some(true),
        volume_bins_n: Some(9),
        volume_supersample: Some(2),
        volume_informed_rays: Some(64),
        volume_specular_cutoff: Some(0.1),
        volume_back_face_limit: Some(0.5),
        volume_ignored: Some(vec!["lamp 0".into(), "red".into()]),
        volume_basis: Some(Basis::Harmonics),
        volume_repair: Some(Repair::Dilate),
        volume_guard: Some(false),
        volume_moments: Some(vec![Order::Finite(4)]),
        ..PlanOverrides::default()
    };
    assert_eq!(over.problem(), None);
    let mut scene = cornell();
    add_point_lamp(&mut scene, glam::Vec3::Y, glam::Vec3::ONE);
    scene.plan = over.clone();
    let made = VolumeSettings::overridden(&scene, 7);
    let usual = VolumeSettings::default();
    assert_eq!((made.samples, made.second_level, made.target_samples), (Some([4, 5, 6]), 4, 900));
    assert_eq!(made.pocket_samples, 50);
    assert_eq!((made.refine_tolerance, made.refine_geometry, made.bins_n), (Some(0.1), true, 9));
    assert_eq!((made.supersample, made.informed_rays, made.seed), (2, 64, 7));
    assert_eq!((made.specular_cutoff, made.back_face_limit, made.guard), (0.1, 0.5, false));
    assert_eq!(made.moments, [Order::Finite(4)]);
    let red = scene.materials.iter().position(|m| m.name == "red").unwrap() as u32;
    assert!(made.ignored.lamps.contains(&0) && made.ignored.materials.contains(&red));
    assert!(made.basis != usual.basis && made.repair != usual.repair);
    let plan = Plan::new(&scene, &World::new(&scene), 0.04, 7);
    assert_eq!((plan.solve.volume.as_ref(), &plan.volume), (Some(&made), &made));
    assert_eq!(Component::IrradianceVolume.freed(&over), PlanOverrides::default());
    let bad = PlanOverrides { volume_specular_cutoff: Some(f32::NAN), ..PlanOverrides::default() };
    assert_eq!(bad.problem().unwrap().0, "volume_specular_cutoff");
}

#[test]
fn an_error_is_as_measured_only_at_the_settings_it_was_measured_at() {
    let scene = cornell();
    let error = |plan: PlanOverrides| {
        let mut scene = scene.clone();
        scene.plan = plan;
        let plan = Plan::new(&scene, &World::new(&scene), 0.04, 1);
        plan.lines.iter().find(|l| l.component == Component::IrradianceVolume).unwrap().expected_error
    };
    assert!(matches!(error(PlanOverrides::default()), ExpectedError::Median(_)));
    let built = PlanOverrides { volume: Some(true), ..PlanOverrides::default() };
    assert!(matches!(error(built), ExpectedError::Median(_)));
    let moments = PlanOverrides { volume_moments: Some(vec![Order::Finite(2)]), ..PlanOverrides::default() };
    assert!(matches!(error(moments), ExpectedError::Median(_)), "they lie beside the irradiance");
    for plan in [
        PlanOverrides { volume_bins_n: Some(5), ..PlanOverrides::default() },
        PlanOverrides { volume_guard: Some(false), ..PlanOverrides::default() },
        PlanOverrides { volume_informed_rays: Some(0), ..PlanOverrides::default() },
        PlanOverrides { volume_target_samples: Some(100), ..PlanOverrides::default() },
        PlanOverrides { volume_pocket_samples: Some(200), ..PlanOverrides::default() },
    ] {
        assert_eq!(error(plan.clone()), ExpectedError::Unknown, "{plan:?}");
    }
}
