//! [`Trace`]: what a relaxer reports while it works.

/// A listener to a relaxer; `()` ignores everything and costs nothing.
pub trait Trace {
    /// Whether it listens. The caller then leaves out work that only a listener needs.
    fn is_active(&self) -> bool {
        true
    }

    /// Called at every check of the residual.
    fn checked(&mut self, check: &Check);

    /// Called after every check. True ends the relaxer, with [`Stop::Interrupted`](crate::relax::Stop::Interrupted).
    fn interrupted(&mut self) -> bool {
        false
    }
}

/// The state of a relaxation at one check.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Check {
    /// Steps taken so far.
    pub step_count: usize,
    /// Elastic energy, including that of the sites if the law has them; it may then be negative \[energy\].
    pub energy: f64,
    /// Kinetic energy \[energy\].
    pub kinetic_energy: f64,
    /// Relative residual, with the backbone of the last refresh \[1\].
    pub residual: f64,
    /// Time step \[time\].
    pub time_step: f64,
    /// Whether the relaxer restarts from rest here. The energies at restarts never increase.
    pub restart: bool,
}

impl Trace for () {
    fn is_active(&self) -> bool {
        false
    }

    fn checked(&mut self, _check: &Check) {}
}

impl<F: FnMut(&Check)> Trace for F {
    fn checked(&mut self, check: &Check) {
        self(check);
    }
}
