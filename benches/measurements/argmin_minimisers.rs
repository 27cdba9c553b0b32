//! The minimisers of argmin on the energy of a packing, beside the ones here: work, allocations, and how deep they get.
//!
//! ```text
//! cargo run --release --features measurements --example argmin_minimisers
//! ```
//!
//! A stored packing inflated by 0.1 in a circle. Lengths are measured so that Gershgorin's bound on the stiffness is 1, since
//! argmin tries a step of 1 first. One call of its cost and one of its gradient at the same point count as one evaluation (the
//! second finds the first's result). "Vectors" are those that argmin's operators and clones make anew. The residual is the
//! largest net force on the backbone of the state that L-BFGS here ends in, over the mean contact force; a mark is the number
//! of evaluations after which it was first met. Time and vectors are per evaluation.

use std::cell::{Cell, RefCell};
use std::error::Error;
use std::time::Instant;

use argmin::core::{CostFunction, Executor, Gradient, IterState, Solver, State};
use argmin::solver::conjugategradient::NonlinearConjugateGradient;
use argmin::solver::conjugategradient::beta::PolakRibierePlus;
use argmin::solver::linesearch::{HagerZhangLineSearch, MoreThuenteLineSearch};
use argmin::solver::quasinewton::LBFGS;
use argmin_math::{
    ArgminAdd, ArgminDot, ArgminL1Norm, ArgminL2Norm, ArgminMinMax, ArgminMul, ArgminScaledAdd, ArgminSignum,
    ArgminSub, ArgminZeroLike,
};
use jamscope::forces::Assembly;
use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::{ForceLimit, NonlinearConjugateGradients, QuasiNewton, Relaxer, RelaxerChoice};
use jamscope::vector::{Vector, larger, norm, scaled};

thread_local! {
    /// Vectors made by argmin's operators and clones.
    static MADE: Cell<usize> = const { Cell::new(0) };
}

/// A vector that counts how often it is made.
#[derive(Debug)]
struct Column(Vec<f64>);

impl Column {
    fn made(values: impl Iterator<Item = f64>) -> Self {
        MADE.set(MADE.get() + 1);
        Column(values.collect())
    }

    fn zip(&self, other: &Self, f: impl Fn(f64, f64) -> f64) -> Self {
        Column::made(self.0.iter().zip(&other.0).map(|(&a, &b)| f(a, b)))
    }
}

impl Clone for Column {
    fn clone(&self) -> Self {
        Column::made(self.0.iter().copied())
    }
}
impl ArgminAdd<Column, Column> for Column {
    fn add(&self, other: &Column) -> Column {
        self.zip(other, |a, b| a + b)
    }
}
impl ArgminAdd<f64, Column> for Column {
    fn add(&self, other: &f64) -> Column {
        Column::made(self.0.iter().map(|a| a + other))
    }
}
impl ArgminSub<Column, Column> for Column {
    fn sub(&self, other: &Column) -> Column {
        self.zip(other, |a, b| a - b)
    }
}
impl ArgminSub<f64, Column> for Column {
    fn sub(&self, other: &f64) -> Column {
        Column::made(self.0.iter().map(|a| a - other))
    }
}
impl ArgminMul<Column, Column> for Column {
    fn mul(&self, other: &Column) -> Column {
        self.zip(other, |a, b| a * b)
    }
}
impl ArgminMul<f64, Column> for Column {
    fn mul(&self, other: &f64) -> Column {
        Column::made(self.0.iter().map(|a| a * other))
    }
}
impl ArgminScaledAdd<Column, f64, Column> for Column {
    fn scaled_add(&self, factor: &f64, other: &Column) -> Column {
        self.zip(other, |a, b| a + factor * b)
    }
}
impl ArgminDot<Column, f64> for Column {
    fn dot(&self, other: &Column) -> f64 {
        self.0.iter().zip(&other.0).map(|(a, b)| a * b).sum()
    }
}
impl ArgminL1Norm<f64> for Column {
    fn l1_norm(&self) -> f64 {
        self.0.iter().map(|a| a.abs()).sum()
    }
}
impl ArgminL2Norm<f64> for Column {
    fn l2_norm(&self) -> f64 {
        self.dot(self).sqrt()
    }
}
impl ArgminSignum for Column {
    fn signum(self) -> Self {
        Column(self.0.into_iter().map(f64::signum).collect())
    }
}
impl ArgminZeroLike for Column {
    fn zero_like(&self) -> Self {
        Column::made(self.0.iter().map(|_| 0.0))
    }
}
impl ArgminMinMax for Column {
    fn min(x: &Self, y: &Self) -> Self {
        x.zip(y, f64::min)
    }
    fn max(x: &Self, y: &Self) -> Self {
        x.zip(y, f64::max)
    }
}

/// Calls allowed to argmin: its line searches have no limit of their own and go on for ever where energies cannot tell.
const CALL_LIMIT: usize = 20_000;

/// Residuals whose first time is noted.
const MARKS: [f64; 3] = [1e-4, 1e-8, 1e-12];

/// The energy of a packing as argmin sees it.
struct Energy {
    state: RefCell<Evaluated>,
    /// Whether each mobile disk counts for the residual.
    backbone: Vec<bool>,
    /// Gershgorin's bound at the start: energies are divided by it.
    stiffness: f64,
}

struct Evaluated {
    assembly: Assembly<2>,
    /// What anchors have taken over so far.
    taken: Vec<Vector<2>>,
    at: Vec<f64>,
    energy: f64,
    evaluation_count: usize,
    call_count: usize,
    lowest: f64,
    marks: [Option<usize>; 3],
}

impl Energy {
    fn new(start: &Packing<2>, backbone: &[bool]) -> Result<Self, Box<dyn Error>> {
        let assembly = Assembly::new(start, &Hertzian::default())?;
        let mobile = assembly.mobile_count();
        let stiffness = assembly.stiffness_bound(&mut Vec::new());
        let backbone = assembly.order()[..mobile].iter().map(|&disk| backbone[disk as usize]).collect();
        let state = Evaluated {
            taken: vec![[0.0; 2]; mobile],
            at: Vec::new(),
            energy: f64::NAN,
            evaluation_count: 0,
            call_count: 0,
            lowest: f64::INFINITY,
            marks: [None; 3],
            assembly,
        };
        Ok(Energy { state: RefCell::new(state), backbone, stiffness })
    }

    /// Brings the assembly to a point, unless it is there.
    fn go(&self, point: &Column) -> Result<(), argmin::core::Error> {
        let state = &mut *self.state.borrow_mut();
        state.call_count += 1;
        if state.call_count > CALL_LIMIT {
            return Err(argmin::core::Error::msg("no end in sight"));
        }
        if state.at == point.0 {
            return Ok(());
        }
        state.at.clone_from(&point.0);
        let mobile = state.taken.len();
        for (disk, x) in point.0.as_chunks::<2>().0.iter().enumerate() {
            state.assembly.displacements[disk] = [x[0] - state.taken[disk][0], x[1] - state.taken[disk][1]];
        }
        let before = state.assembly.displacements[..mobile].to_vec();
        if state.assembly.update_list(f64::INFINITY)? {
            for (disk, before) in before.iter().enumerate() {
                for (d, x) in before.iter().enumerate() {
                    state.taken[disk][d] += x - state.assembly.displacements[disk][d];
                }
            }
        }
        let totals = state.assembly.evaluate_totals();
        state.energy = totals.energy;
        state.evaluation_count += 1;
        let forces = state.assembly.forces[..mobile].iter().zip(&self.backbone);
        let largest = forces.filter(|&(_, &member)| member).fold(0.0, |most, (&force, _)| larger(norm(force), most));
        // A trial step that blows the packing apart leaves no force and is no result.
        let residual = if largest > 0.0 { largest / totals.mean_contact_force() } else { f64::INFINITY };
        state.lowest = state.lowest.min(residual);
        for (mark, limit) in state.marks.iter_mut().zip(MARKS) {
            if mark.is_none() && residual <= limit {
                *mark = Some(state.evaluation_count);
            }
        }
        Ok(())
    }
}

impl CostFunction for &Energy {
    type Param = Column;
    type Output = f64;
    fn cost(&self, point: &Column) -> Result<f64, argmin::core::Error> {
        self.go(point)?;
        Ok(self.state.borrow().energy / self.stiffness)
    }
}

impl Gradient for &Energy {
    type Param = Column;
    type Gradient = Column;
    fn gradient(&self, point: &Column) -> Result<Column, argmin::core::Error> {
        self.go(point)?;
        let state = self.state.borrow();
        let mobile = self.backbone.len();
        let down = state.assembly.forces[..mobile].iter().flat_map(|&force| scaled(-1.0 / self.stiffness, force));
        Ok(Column::made(down))
    }
}

fn main() -> Result<(), Box<dyn Error>> {
    println!(
        "{:<18} {:<24} {:>6} {:>11} {:>26} {:>8} {:>9} {:>8}  end",
        "packing", "minimiser", "steps", "evaluations", "of which to 1e-4, -8, -12", "lowest", "us each", "vectors"
    );
    for name in ["hertz_N1000_p100", "hertz_N1000_p10"] {
        let packing = read_packing::<2>(format!("{}/fixtures/packings/{name}.xyz", env!("CARGO_MANIFEST_DIR")))?;
        let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
        let circle = Circle::cut(&packing, 0, 0.48 * side)?;
        let start = circle.packing.with_radius(circle.centre, 0.6)?;
        let law = Hertzian::default();
        let mut backbone = Vec::new();
        for limit in [1e-8, 1e-12] {
            let limit = ForceLimit::Relative(limit);
            for choice in [
                RelaxerChoice::QuasiNewton(QuasiNewton { limit, memory: 10, ..QuasiNewton::default() }),
                RelaxerChoice::ConjugateGradients(NonlinearConjugateGradients { limit, ..Default::default() }),
            ] {
                let outcome = choice.relax(start.clone(), &law, &mut ())?;
                if backbone.is_empty() {
                    backbone = ContactNetwork::new(&outcome.state, &law)?.backbone;
                }
                let cost = outcome.cost;
                println!(
                    "{name:<18} {:<24} {:>6} {:>11} {:>26} {:>8.1e} {:>9.1} {:>8}  {:?}",
                    format!("{} here", choice.name()),
                    cost.step_count,
                    cost.force_evaluation_count,
                    "",
                    outcome.residual.relative(),
                    1e6 * cost.seconds / cost.force_evaluation_count as f64,
                    0,
                    outcome.stop
                );
            }
        }
        let more = MoreThuenteLineSearch::new;
        run(
            name,
            "L-BFGS, More-Thuente",
            &start,
            &backbone,
            LBFGS::new(more(), 10).with_tolerance_grad(0.0)?.with_tolerance_cost(0.0)?,
        )?;
        let hager = HagerZhangLineSearch::new();
        run(
            name,
            "L-BFGS, Hager-Zhang",
            &start,
            &backbone,
            LBFGS::new(hager, 10).with_tolerance_grad(0.0)?.with_tolerance_cost(0.0)?,
        )?;
        let fine = more().with_c(1e-4, 0.1)?;
        run(
            name,
            "gradients, More-Thuente",
            &start,
            &backbone,
            NonlinearConjugateGradient::new(fine, PolakRibierePlus::new()),
        )?;
        let hager = HagerZhangLineSearch::new();
        run(
            name,
            "gradients, Hager-Zhang",
            &start,
            &backbone,
            NonlinearConjugateGradient::new(hager, PolakRibierePlus::new()),
        )?;
    }
    Ok(())
}

/// Lets a solver of argmin work and prints what it did.
fn run<S>(name: &str, what: &str, start: &Packing<2>, backbone: &[bool], solver: S) -> Result<(), Box<dyn Error>>
where
    S: for<'a> Solver<&'a Energy, IterState<Column, Column, (), (), (), f64>>,
{
    let energy = Energy::new(start, backbone)?;
    let begin = {
        let state = energy.state.borrow();
        state.assembly.displacements[..backbone.len().min(state.taken.len())].as_flattened().to_vec()
    };
    MADE.set(0);
    let clock = Instant::now();
    let result =
        Executor::new(&energy, solver).configure(|state| state.param(Column(begin)).max_iters(CALL_LIMIT as u64)).run();
    let seconds = clock.elapsed().as_secs_f64();
    let (steps, end) = match &result {
        Ok(result) => (result.state.get_iter(), format!("{:?}", result.state.get_termination_reason())),
        // The solver is lost with its count of steps.
        Err(error) => (0, error.to_string()),
    };
    let state = energy.state.borrow();
    let marks: Vec<String> =
        state.marks.iter().map(|mark| mark.map_or("-".into(), |count| count.to_string())).collect();
    println!(
        "{name:<18} {what:<24} {steps:>6} {:>11} {:>26} {:>8.1e} {:>9.1} {:>8.1}  {end}",
        state.evaluation_count,
        marks.join(", "),
        state.lowest,
        1e6 * seconds / state.evaluation_count as f64,
        MADE.get() as f64 / state.evaluation_count as f64,
    );
    Ok(())
}
