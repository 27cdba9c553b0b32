//! [`Run`]: the variables of one run of FIRE.

use crate::forces::assembly::Assembly;
use crate::relax::column_operations::Products;
use crate::relax::fire::settings::Fire;
use crate::relax::outcome::Cost;

/// First time step over the largest one \[1\].
const FIRST_STEP: f64 = 0.1;

/// One run of FIRE.
pub(super) struct Run<'a> {
    pub(super) settings: &'a Fire,
    pub(super) evaluation_count: usize,
    pub(super) step_count: usize,
    /// \[time\]
    pub(super) time_step: f64,
    /// The largest time step that the contacts allow \[time\].
    pub(super) largest_step: f64,
    /// α.
    pub(super) mixing: f64,
    /// Steps since the last restart.
    pub(super) downhill: usize,
    /// Restarts since the last step downhill.
    pub(super) uphill: usize,
    /// Energy at the last restart, and the scale of its rounding \[energy\].
    pub(super) rest_energy: f64,
    pub(super) rest_scale: f64,
    /// Whether a check of the residual is due.
    pub(super) due: bool,
    /// The products at the present state, if the last step has computed them.
    pub(super) present_products: Option<Products>,
    /// Work space for the rows of the stiffness bound.
    row: Vec<f64>,
}

impl<'a> Run<'a> {
    /// A run from rest at the present state.
    pub(super) fn new<const D: usize>(settings: &'a Fire, assembly: &Assembly<D>) -> Self {
        let mut run = Run {
            settings,
            evaluation_count: 0,
            step_count: 0,
            time_step: 0.0,
            largest_step: 0.0,
            mixing: settings.mixing,
            downhill: 0,
            uphill: 0,
            rest_energy: f64::INFINITY,
            rest_scale: f64::INFINITY,
            due: true,
            present_products: None,
            row: Vec::new(),
        };
        run.set_largest_step(assembly);
        run.time_step = FIRST_STEP * run.largest_step;
        run
    }

    /// Sets the largest time step from the present stiffness.
    pub(super) fn set_largest_step<const D: usize>(&mut self, assembly: &Assembly<D>) {
        let mut bound = assembly.stiffness_bound(&mut self.row);
        if bound == 0.0 {
            // Without contacts: the stiffness of a contact with an overlap of 0.1 % of a radius.
            let (law, radius) = (assembly.law(), assembly.radii()[0]);
            let overlap = 1e-3 * radius;
            bound = 2.0 * law.stiffness(law.force(law.coefficient(radius, radius), overlap), overlap);
        }
        self.largest_step = self.settings.time_step_fraction * 2.0 / bound.sqrt();
    }

    /// What the run has cost so far.
    pub(super) fn cost(&self) -> Cost {
        Cost { step_count: self.step_count, force_evaluation_count: self.evaluation_count, ..Cost::default() }
    }
}
