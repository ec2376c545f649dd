//! The light as the view wants it: movable objects shining, single bounces picked out. Made once.

use super::request::{Lit, Same};
use lumenscope_core::{
    irradiance_volume::dynamic_object::{Detail, Gloss},
    reference::expression::Expression,
    scene::lookup::Reconstruction,
    transport::LightTransportSolution,
};
use std::sync::{
    Arc,
    mpsc::{Receiver, TryRecvError, channel},
};

/// How movable objects shine, and how finely those that moved ask the volume; as the solution has it without.
pub type Moving = (Option<Gloss>, Option<Detail>);

/// A solution, how its movable objects are lit, and which bounces are picked out.
type How = (Same<LightTransportSolution>, Moving, Option<Expression>);

/// The light that is shown, and what is on its way.
#[derive(Default)]
pub struct Shown {
    known: Option<(How, Arc<Lit>)>,
    coming: Option<(How, Receiver<Arc<Lit>>)>,
}

impl Shown {
    /// The light of a solution as it is wanted. Bounces and reconstruction take some time, too long for the window's own thread:
    /// until they are there, what was shown last stays.
    pub fn lit(
        &mut self,
        ctx: &egui::Context,
        solution: &Arc<LightTransportSolution>,
        moving: Moving,
        bounces: Option<&Expression>,
    ) -> Arc<Lit> {
        if let Some((how, receiver)) = self.coming.take() {
            match receiver.try_recv() {
                Ok(lit) => self.known = Some((how, lit)),
                Err(TryRecvError::Empty) => self.coming = Some((how, receiver)),
                Err(TryRecvError::Disconnected) => {}
            }
        }
        let how = (Same(Some(solution.clone())), moving, bounces.cloned());
        if let Some((_, lit)) = self.known.as_ref().filter(|(known, _)| *known == how) {
            return lit.clone();
        }
        let reconstructed = solution.reconstruction() != Reconstruction::Stored;
        let make = {
            let (solution, bounces) = (solution.clone(), bounces.cloned());
            move || {
                let of_paths = bounces.and_then(|b| solution.with_paths(&b)).map(|(of_paths, _)| of_paths);
                if of_paths.is_none() && moving == (None, None) && !reconstructed {
                    return Lit::new(solution);
                }
                let light = of_paths.unwrap_or_else(|| (*solution).clone());
                Lit::new(Arc::new(light.with_gloss(moving.0).with_detail(moving.1).reconstructed()))
            }
        };
        if bounces.is_none() && !reconstructed {
            let lit = make();
            self.known = Some((how, lit.clone()));
            return lit;
        }
        if self.coming.is_none() {
            let (sender, receiver) = channel();
            let ctx = ctx.clone();
            let spawned = std::thread::Builder::new().name("bounces".into()).spawn(move || {
                // Nobody waits once the window is closed.
                let _ = sender.send(make());
                ctx.request_repaint();
            });
            if spawned.is_ok() {
                self.coming = Some((how, receiver));
            }
        }
        self.known.as_ref().map_or_else(|| Lit::new(solution.clone()), |(_, lit)| lit.clone())
    }

    /// Whether something else is about to be shown.
    pub fn is_coming(&self) -> bool {
        self.coming.is_some()
    }
}
