//! Undo and redo of the document's edits; one drag is one step.
//!
//! A step holds the edits before and after it, so that undoing returns exactly what was there: the
//! edits are a few placements, and a difference would save nothing worth a way to go wrong.

use crate::document::Edits;
use lumenscope_core::scene::Target;
use undo::{Edit, Merged, Record};

/// What a step changes: steps of one drag merge only when they change the same thing.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Key {
    /// Where a target stands.
    Place(Target),
    /// How far it is dimmed.
    Dim(Target),
    /// Where illuminance is measured, and what is asked of it.
    Placement,
    /// Overrides of the plan.
    Plan,
    /// Models added.
    Added,
}

/// The steps so far.
#[derive(Debug)]
pub struct History {
    record: Record<Step>,
    drag: u64,
}

#[derive(Debug)]
struct Step {
    before: Edits,
    after: Edits,
    key: Key,
    drag: Option<u64>,
}

impl Default for History {
    fn default() -> Self {
        Self { record: Record::new(), drag: 0 }
    }
}

impl History {
    /// Replaces `edits` by `after`, as one step with the drag it belongs to.
    pub fn edit(&mut self, edits: &mut Edits, after: Edits, key: Key, dragging: bool) {
        if !dragging {
            self.end_drag();
        }
        let step = Step { before: edits.clone(), after, key, drag: dragging.then_some(self.drag) };
        self.record.edit(edits, step);
    }

    /// Ends the drag: the next edit is its own step.
    pub fn end_drag(&mut self) {
        self.drag += 1;
    }

    /// Steps back; false at the beginning.
    pub fn undo(&mut self, edits: &mut Edits) -> bool {
        self.end_drag();
        self.record.undo(edits).is_some()
    }

    /// Steps forward; false at the end.
    pub fn redo(&mut self, edits: &mut Edits) -> bool {
        self.end_drag();
        self.record.redo(edits).is_some()
    }

    /// Whether there is a step to take back.
    pub fn can_undo(&self) -> bool {
        self.record.can_undo()
    }

    /// Whether there is a step to make again.
    pub fn can_redo(&self) -> bool {
        self.record.can_redo()
    }

    /// Number of steps that can be taken back.
    pub fn depth(&self) -> usize {
        self.record.head()
    }
}

impl Edit for Step {
    type Target = Edits;
    type Output = ();

    fn edit(&mut self, edits: &mut Edits) {
        edits.clone_from(&self.after);
    }

    fn undo(&mut self, edits: &mut Edits) {
        edits.clone_from(&self.before);
    }

    fn merge(&mut self, other: Self) -> Merged<Self> {
        if self.drag.is_some() && self.drag == other.drag && self.key == other.key {
            self.after = other.after;
            Merged::Yes
        } else {
            Merged::No(other)
        }
    }
}
