//! [`Restless`]: when a motion counts as one that does not come to rest.

/// Steps in which the residual has not fallen by a tenth and damping has taken less than half of the kinetic energy there was,
/// after which the motion counts as one that does not come to rest.
const RESTLESS_AFTER: usize = 3000;

/// Share of the kinetic energy meant there.
const RESTLESS_LOSS: f64 = 0.5;

/// Watches for a motion that does not come to rest.
pub(crate) struct Restless {
    /// The lowest residual so far.
    residual: f64,
    /// Steps, kinetic energy and work of damping when the watch last began anew.
    since: (usize, f64, f64),
}

impl Default for Restless {
    fn default() -> Self {
        Restless { residual: f64::INFINITY, since: (0, 0.0, 0.0) }
    }
}

impl Restless {
    /// Whether for too long neither the residual has fallen nor damping has taken much of what moves.
    pub(crate) fn after(&mut self, step_count: usize, (kinetic_energy, dissipated): (f64, f64), residual: f64) -> bool {
        let (first_step, first_energy, first_work) = self.since;
        let nearer = residual < 0.9 * self.residual;
        let over = step_count - first_step >= RESTLESS_AFTER;
        if over && !nearer && dissipated - first_work < RESTLESS_LOSS * first_energy {
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
