//! Changing how the scene is looked at: what a new view asks for, and what it outdates.

use super::{Compare, Effect, Session, View};
use crate::{
    document::exists,
    light_paths::{LightPaths, is_dull},
};

impl Session {
    pub(super) fn look(&mut self, mut view: View) -> Vec<Effect> {
        if !view.is_finite() {
            self.log.warn("a view with numbers that cannot be drawn was left out");
            return Vec::new();
        }
        let scene = self.scene.as_deref();
        view.selected = view.selected.filter(|&t| scene.is_some_and(|s| exists(s, t)));
        view.copies = view.copies.filter(|c| scene.is_some_and(|s| c.fits(s)));
        let new_paths = self.look_at_paths(&mut view);
        let old = std::mem::replace(&mut self.document.view, view);
        let view = &self.document.view;
        let mut effects = Vec::new();
        let finer = (view.probe_resolutions && !old.probe_resolutions)
            || (view.moments() != old.moments() && view.moments().is_some());
        if view.probe != old.probe || view.probe_bins_n != old.probe_bins_n || finer {
            if view.probe.is_none() {
                self.probe = None;
            }
            effects.push(Effect::Probe);
        }
        let picked = view.surface != old.surface;
        if view.volume != old.volume || view.views != old.views || (picked && !view.views.is_empty()) {
            effects.push(Effect::Inspect);
        }
        if picked {
            // What was shown is another surface's.
            self.texture = None;
            self.texture_awaited = view.surface.is_some();
        }
        if picked || view.stages != old.stages || view.traced_texture != old.traced_texture {
            effects.push(Effect::Texture);
        }
        effects.extend((view.copies != old.copies).then_some(Effect::Copies));
        let moved = view.camera != old.camera || new_paths;
        let asked = view.compare != Compare::Picture && old.compare == Compare::Picture;
        if moved {
            effects.extend(self.outdate_reference());
        } else if asked && self.scene.is_some() && self.light_paths.traced().is_ok() {
            effects.push(Effect::Reference);
        }
        effects
    }

    /// Lets weights follow the light-path expression of a new view, and the expression give way to weights
    /// set by hand; whether another light is meant now. What cannot be read changes nothing.
    fn look_at_paths(&mut self, view: &mut View) -> bool {
        let old = &self.document.view;
        let mut other = false;
        if view.paths != old.paths {
            let dull = self.scene.as_deref().is_some_and(is_dull);
            self.light_paths = LightPaths::read(&view.paths, dull);
            view.weights = self.light_paths.weights().unwrap_or(view.weights);
            other = self.light_paths.traced().is_ok();
        } else if view.weights != old.weights && !view.paths.is_empty() {
            view.paths.clear();
            self.light_paths = LightPaths::All;
            other = true;
        }
        if view.compare.is_comparison() && !self.light_paths.is_comparable() {
            view.compare = Compare::Reference;
        }
        other
    }

    pub(super) fn outdate_reference(&mut self) -> Option<Effect> {
        let had = self.reference.take().is_some();
        let shown = self.document.view.compare != Compare::Picture;
        if shown && self.light_paths.traced().is_ok() {
            Some(Effect::Reference)
        } else {
            (had || shown).then_some(Effect::DropReference)
        }
    }
}
