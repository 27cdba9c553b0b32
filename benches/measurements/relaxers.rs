//! What each relaxer needs from the same start, and whether it ends in the same minimum.
//!
//! ```text
//! cargo run --release --features measurements --example relaxers -- [NAME] ...          (stored Hertzian packings, four centres each)
//! ```
//!
//! The centre of each packing is inflated by 0.1 in a circle with a held rim and the rest relaxed to 10⁻⁸ and to 10⁻¹² of the
//! mean contact force. Evaluations, factorisations and seconds are sums over the centres; the residual is the largest of
//! them. The last columns hold the backbone against that of the staged relaxer to the same limit: in how many of the centres no
//! disk of it is farther than 10⁻⁶ away, and the largest distance in those.

#[path = "scenes/distance.rs"]
mod distance;
#[path = "scenes/inflated.rs"]
mod inflated;
#[path = "scenes/stored.rs"]
mod stored;

use std::error::Error;

use jamscope::law::Hertzian;
use jamscope::packing::Packing;
use jamscope::relax::{
    Cost, Fire, ForceLimit, NonlinearConjugateGradients, QuasiNewton, Relaxer, RelaxerChoice, Staged, StepBack, Stop,
    Uphill,
};
use jamscope::vector::larger;

use distance::distance;
use stored::{named, starts};

/// Distance up to which two states count as one: minima that differ do so by far more, rounding by far less.
const SAME: f64 = 1e-6;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    println!(
        "{:<17} {:>6} {:<20} {:>11} {:>7} {:>8} {:>9} {:>5} {:>9}  stop",
        "packing", "limit", "relaxer", "evaluations", "factor.", "seconds", "residual", "same", "apart"
    );
    for name in named(&arguments) {
        let starts = starts(name)?;
        for limit in [1e-8, 1e-12] {
            table(name, &starts, limit)?;
        }
    }
    Ok(())
}

fn relaxers(limit: f64) -> Vec<(String, RelaxerChoice)> {
    let limit = ForceLimit::Relative(limit);
    let fire = Fire { limit, ..Fire::default() };
    let back = Fire { uphill: Uphill::StepBack(StepBack::default()), ..fire };
    let gradients = NonlinearConjugateGradients { limit, ..NonlinearConjugateGradients::default() };
    let mut relaxers = vec![
        ("FIRE".into(), RelaxerChoice::Fire(fire)),
        ("FIRE, step back".into(), RelaxerChoice::Fire(back)),
        // The other numbers of FIRE 2.0 too. Source: Guénolé et al. (2020), table 1.
        ("FIRE 2.0".into(), RelaxerChoice::Fire(Fire { delay: 20, mixing: 0.25, ..back })),
        ("conjugate gradients".into(), RelaxerChoice::ConjugateGradients(gradients)),
    ];
    for memory in [5, 10, 30] {
        let quasi_newton = QuasiNewton { limit, memory, ..QuasiNewton::default() };
        relaxers.push((format!("L-BFGS, m = {memory}"), RelaxerChoice::QuasiNewton(quasi_newton)));
    }
    relaxers
}

fn table(name: &str, starts: &[Packing<2>], limit: f64) -> Result<(), Box<dyn Error>> {
    let staged = RelaxerChoice::Staged(Staged { limit: ForceLimit::Relative(limit), ..Staged::default() });
    let ends = row(name, "FIRE, then Newton", starts, &staged, &[])?;
    for (what, relaxer) in relaxers(limit) {
        row(name, &what, starts, &relaxer, &ends)?;
    }
    Ok(())
}

/// Relaxes all starts and prints what that took; where they ended.
fn row(
    name: &str,
    what: &str,
    starts: &[Packing<2>],
    relaxer: &RelaxerChoice,
    references: &[Packing<2>],
) -> Result<Vec<Packing<2>>, Box<dyn Error>> {
    let law = Hertzian::default();
    let (mut cost, mut residual, mut stops, mut ends) = (Cost::default(), 0.0f64, Vec::new(), Vec::new());
    for start in starts {
        let outcome = relaxer.relax(start.clone(), &law, &mut ())?;
        cost = cost.plus(outcome.cost);
        residual = larger(residual, outcome.residual.relative());
        if !matches!(outcome.stop, Stop::Converged(_)) {
            stops.push(format!("{:?}", outcome.stop));
        }
        ends.push(outcome.state);
    }
    let mut apart = Vec::new();
    for (end, reference) in ends.iter().zip(references) {
        apart.push(distance(end, reference)?);
    }
    let same: Vec<f64> = apart.into_iter().filter(|&apart| apart <= SAME).collect();
    let stops = if stops.is_empty() { "all converged".to_string() } else { stops.join(", ") };
    println!(
        "{name:<17} {:>6.0e} {what:<20} {:>11} {:>7} {:>8.2} {residual:>9.1e} {:>5} {:>9.1e}  {stops}",
        relaxer.limit().value(),
        cost.force_evaluation_count,
        cost.factorisation_count,
        cost.seconds,
        if references.is_empty() { "-".into() } else { format!("{}/{}", same.len(), starts.len()) },
        same.iter().copied().fold(0.0, f64::max),
    );
    Ok(ends)
}
