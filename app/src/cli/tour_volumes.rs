//! The tour's pictures of other volumes: path-traced, from panoramas, of moments that glossy things shine by.

use super::tour::{GRAIN, Tour};
use crate::{
    command::Command,
    copies::CopyVolume,
    export::Export,
    pipeline::VolumeSource,
    session::{View, VolumeView},
};
use anyhow::Context;
use glam::Vec3;
use lumenscope_core::{
    irradiance_volume::{inspect::ColourBy, moments::Order},
    scene::file::PlanOverrides,
};
use std::fmt::Write as _;

/// Places of panoramas in the Cornell box, m: a lattice of two an axis.
const NODES: [[f32; 2]; 3] = [[-0.2, 0.2], [0.12, 0.45], [-0.45, -0.1]];

impl Tour {
    /// In the Cornell box, with a coarse volume.
    pub(super) fn volumes(&mut self) -> anyhow::Result<()> {
        let shining = Order::Finite(100);
        self.run(Command::Plan(PlanOverrides {
            volume_target_samples: Some(300),
            volume_bins_n: Some(9),
            volume_moments: Some(vec![shining]),
            ..PlanOverrides::default()
        }));
        self.settled()?;
        self.click("Views");
        self.error()?;
        self.panoramas()?;
        self.click("Layers");
        self.view(|view| *view = View { camera: view.camera, gloss: Some(shining), ..View::default() });
        self.photograph("glossy_object", GRAIN)?;
        self.view(|view| *view = View { camera: view.camera, ..View::default() });
        Ok(())
    }

    /// How far the volume is from one that the path tracer lit.
    fn error(&mut self) -> anyhow::Result<()> {
        self.run(Command::CompareWith(VolumeSource::Reference));
        self.wait("a traced volume", |app| app.session().kept.len() == 1 && !app.is_busy())?;
        self.view(|view| {
            let shown =
                VolumeView { shown: true, colour_by: ColourBy::Error, size: 0.2, ..VolumeView::default() };
            view.volume = VolumeView { against: view.volume.against, ..shown };
        });
        self.wait("its error", |app| app.session().inspection.is_some() && !app.is_busy())?;
        self.view(|view| view.probe = Some((Vec3::new(0.1, 0.3, -0.2), Vec3::Y)));
        self.wait("the spheres", |app| app.session().probe.is_some() && !app.is_busy())?;
        self.click("Volumes");
        self.tall(true);
        self.photograph("volume_error", GRAIN)?;
        self.tall(false);
        Ok(())
    }

    /// A volume from eight panoramas that the program renders itself.
    fn panoramas(&mut self) -> anyhow::Result<()> {
        let folder = self.scratch.clone();
        let mut list = String::from("[");
        for i in 0..8 {
            let at = Vec3::from_array([0, 1, 2].map(|axis| NODES[axis][i >> axis & 1]));
            let name = format!("{i}.exr");
            self.view(|view| view.probe = Some((at, Vec3::Y)));
            self.wait("the spheres", |app| app.session().probe.is_some() && !app.is_busy())?;
            let file = folder.join(&name);
            self.run(Command::Export(Export::Panorama, file.clone()));
            self.wait("a panorama", |app| !app.is_busy() && file.exists())?;
            // Writing to a string cannot fail.
            let _ = write!(list, "(position: ({}, {}, {}), file: \"{name}\"),", at.x, at.y, at.z);
        }
        let nodes = folder.join("nodes.ron");
        std::fs::write(&nodes, list + "]").with_context(|| format!("cannot write {}", nodes.display()))?;
        self.run(Command::CompareWith(VolumeSource::Panoramas(nodes)));
        self.wait("a volume from panoramas", |app| app.session().kept.len() == 2 && !app.is_busy())?;
        self.view(|view| {
            view.probe = None;
            let of = CopyVolume::Kept(1);
            view.volume = VolumeView { shown: true, of, size: 0.2, ..VolumeView::default() };
        });
        self.wait("its spheres", |app| app.session().inspection.is_some() && !app.is_busy())?;
        self.photograph("volume_panoramas", GRAIN)
    }
}
