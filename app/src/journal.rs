//! The log: what happened, in the order it happened.

use std::time::Instant;

/// How much a line matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something was done.
    Info,
    /// Something is not as the user may expect.
    Warning,
    /// Something could not be done.
    Error,
}

/// One line.
#[derive(Clone, Debug)]
pub struct Line {
    /// How much it matters.
    pub severity: Severity,
    /// What happened.
    pub text: String,
    /// Seconds since the program began.
    pub seconds: f64,
    /// How many times it happened in a row.
    pub times: u32,
}

/// Lines, oldest first; the oldest go once there are many.
#[derive(Debug)]
pub struct Journal {
    began: Instant,
    lines: Vec<Line>,
}

impl Default for Journal {
    fn default() -> Self {
        Self { began: Instant::now(), lines: Vec::new() }
    }
}

impl Journal {
    const MOST_LINES: usize = 1000;

    /// All lines, oldest first.
    pub fn lines(&self) -> &[Line] {
        &self.lines
    }

    /// Notes something done.
    pub fn info(&mut self, text: impl Into<String>) {
        self.add(Severity::Info, text.into());
    }

    /// Notes something that is not as the user may expect.
    pub fn warn(&mut self, text: impl Into<String>) {
        self.add(Severity::Warning, text.into());
    }

    /// Notes something that could not be done.
    pub fn error(&mut self, text: impl Into<String>) {
        self.add(Severity::Error, text.into());
    }

    /// Forgets everything.
    pub fn clear(&mut self) {
        self.lines.clear();
    }

    fn add(&mut self, severity: Severity, text: String) {
        let seconds = self.began.elapsed().as_secs_f64();
        if let Some(last) = self.lines.last_mut()
            && last.severity == severity
            && last.text == text
        {
            last.times += 1;
            last.seconds = seconds;
            return;
        }
        if self.lines.len() == Self::MOST_LINES {
            self.lines.remove(0);
        }
        self.lines.push(Line { severity, text, seconds, times: 1 });
    }
}
