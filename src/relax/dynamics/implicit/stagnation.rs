//! [`Stagnation`]: detection of a motion that does not come to rest.

/// Number of steps after which a motion stagnates, if its residual has not fallen by 10 % and damping has removed less
/// than half of its initial kinetic energy.
const STAGNATION_STEPS: usize = 3000;

/// The half in [`STAGNATION_STEPS`].
const STAGNATION_LOSS: f64 = 0.5;

/// Detects a motion that does not come to rest.
pub(crate) struct Stagnation {
    /// The lowest residual so far.
    residual: f64,
    /// Steps, kinetic energy and work of damping when the count began.
    since: (usize, f64, f64),
}

impl Default for Stagnation {
    fn default() -> Self {
        Stagnation { residual: f64::INFINITY, since: (0, 0.0, 0.0) }
    }
}

impl Stagnation {
    /// Whether the residual has not fallen for too long, while damping has removed little of the kinetic energy.
    pub(crate) fn is_reached(
        &mut self,
        step_count: usize,
        (kinetic_energy, dissipated): (f64, f64),
        residual: f64,
    ) -> bool {
        let (first_step, first_energy, first_work) = self.since;
        let nearer = residual < 0.9 * self.residual;
        let over = step_count - first_step >= STAGNATION_STEPS;
        if over && !nearer && dissipated - first_work < STAGNATION_LOSS * first_energy {
            return true;
        }
        if nearer {
            self.residual = residual;
        }
        if nearer || over {
            self.since = (step_count, kinetic_energy, dissipated);
        }
        false
    }
}
