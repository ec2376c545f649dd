//! Progress of long work, and its cancellation.

use std::sync::{
    Arc, Mutex,
    atomic::{AtomicBool, AtomicU32, Ordering},
};

/// Shared between the worker that does something long and whoever watches it. Cheap to clone.
#[derive(Clone, Debug, Default)]
pub struct Progress(Arc<State>);

#[derive(Debug, Default)]
struct State {
    permille: AtomicU32,
    cancelled: AtomicBool,
    stage: Mutex<String>,
}

/// The work was cancelled.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("cancelled")]
pub struct Cancelled;

impl Progress {
    /// Progress nobody watches.
    pub fn silent() -> Self {
        Self::default()
    }

    /// Begins a stage, at zero.
    pub fn begin(&self, stage: &str) {
        if let Ok(mut name) = self.0.stage.lock() {
            stage.clone_into(&mut name);
        }
        self.0.permille.store(0, Ordering::Relaxed);
    }

    /// Says how much of the stage is done, in [0, 1].
    ///
    /// # Errors
    /// [`Cancelled`] when the watcher has asked to stop; pass it on at once.
    pub fn report(&self, done: f32) -> Result<(), Cancelled> {
        self.0.permille.fetch_max((done.clamp(0.0, 1.0) * 1000.0) as u32, Ordering::Relaxed);
        if self.is_cancelled() { Err(Cancelled) } else { Ok(()) }
    }

    /// Asks the worker to stop.
    pub fn cancel(&self) {
        self.0.cancelled.store(true, Ordering::Relaxed);
    }

    /// Whether a stop was asked for.
    pub fn is_cancelled(&self) -> bool {
        self.0.cancelled.load(Ordering::Relaxed)
    }

    /// Name of the stage, and how much of it is done in [0, 1].
    pub fn state(&self) -> (String, f32) {
        let stage = self.0.stage.lock().map(|s| s.clone()).unwrap_or_default();
        (stage, self.0.permille.load(Ordering::Relaxed) as f32 / 1000.0)
    }
}
