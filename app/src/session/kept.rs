//! Volumes kept to be compared with.

use super::{Against, Effect, Session};
use crate::copies::CopyVolume;
use lumenscope_core::irradiance_volume::IrradianceVolume;
use std::sync::Arc;

/// A volume kept to be compared with.
#[derive(Clone)]
pub struct Kept {
    /// What it is, as the panel lists it.
    pub name: String,
    /// The volume.
    pub volume: Arc<IrradianceVolume>,
}

/// A volume and what it is called on screen.
#[derive(Clone, Copy)]
pub struct NamedVolume<'a> {
    /// Name.
    pub name: &'a str,
    /// The volume.
    pub volume: &'a Arc<IrradianceVolume>,
}

impl Session {
    /// Keeps a volume and compares with it; `source` is where its light comes from.
    pub fn keep(&mut self, volume: Arc<IrradianceVolume>, source: &str) {
        self.kept_so_far += 1;
        let (samples, bins) = (volume.samples().len(), volume.bins().len());
        let name = format!("{}: {source}, {samples} × {bins}", self.kept_so_far);
        self.kept.push(Kept { name, volume: Arc::new(volume.detached()) });
        self.document.view.volume.against = Against::Kept(self.kept.len() - 1);
    }

    /// The volume that is shown and the one it is compared with; `None` where either is not at hand.
    pub fn two_volumes(&self) -> Option<[NamedVolume<'_>; 2]> {
        let of = |volume| match volume {
            CopyVolume::Kept(n) => self.kept.get(n).map(|k| NamedVolume { name: &k.name, volume: &k.volume }),
            CopyVolume::Present => {
                let volume = self.solution.as_ref()?.volume.as_ref()?;
                Some(NamedVolume { name: "present volume", volume })
            }
        };
        let view = &self.document.view.volume;
        let against = match view.against {
            Against::Kept(n) => CopyVolume::Kept(n),
            Against::Present => CopyVolume::Present,
            Against::Ignoring => return None,
        };
        Some([of(view.of)?, of(against)?])
    }

    /// Forgets the volume with a number; what named it names the present one, and later ones count one less.
    pub(super) fn forget(&mut self, number: usize) -> Vec<Effect> {
        if number >= self.kept.len() {
            return Vec::new();
        }
        self.kept.remove(number);
        let view = &mut self.document.view;
        view.volume.against = match view.volume.against {
            Against::Kept(n) => renumbered(n, number).map_or(Against::Ignoring, Against::Kept),
            other => other,
        };
        if let CopyVolume::Kept(n) = view.volume.of {
            view.volume.of = renumbered(n, number).map_or(CopyVolume::Present, CopyVolume::Kept);
        }
        let mut effects = vec![Effect::Inspect];
        for light in view.copies.iter_mut().flat_map(|c| &mut c.lights) {
            if let CopyVolume::Kept(n) = light.volume {
                light.volume = renumbered(n, number).map_or(CopyVolume::Present, CopyVolume::Kept);
                effects = vec![Effect::Inspect, Effect::Copies];
            }
        }
        effects
    }
}

/// The number of what had the number `n` before `gone` was taken away; `None` for that itself.
fn renumbered(n: usize, gone: usize) -> Option<usize> {
    (n != gone).then_some(if n > gone { n - 1 } else { n })
}
