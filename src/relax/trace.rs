//! [`Trace`]: what a relaxer reports while it works.

/// What a relaxer tells while it works; `()` hears nothing and costs nothing.
pub trait Trace {
    /// Whether anything listens; lets the caller leave out what only a listener needs.
    const ACTIVE: bool = true;

    /// Called at every look at the residual.
    fn look(&mut self, look: &Look);

    /// Asked after every look: whether the relaxer is to end here, with [`Stop::Interrupted`].
    fn interrupted(&mut self) -> bool {
        false
    }
}

/// One look at a relaxation.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Look {
    /// Steps taken so far.
    pub step_count: usize,
    /// Elastic energy, with that of the sites where the law has one: it may be negative then \[energy\].
    pub energy: f64,
    /// Kinetic energy \[energy\].
    pub kinetic_energy: f64,
    /// Relative residual, with the backbone of the last refresh \[1\].
    pub residual: f64,
    /// Time step \[time\].
    pub time_step: f64,
    /// The relaxer restarted from rest here; its energies at restarts never increase.
    pub restart: bool,
}

impl Trace for () {
    const ACTIVE: bool = false;
    fn look(&mut self, _look: &Look) {}
}

impl<F: FnMut(&Look)> Trace for F {
    fn look(&mut self, look: &Look) {
        self(look);
    }
}
