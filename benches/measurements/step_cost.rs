//! How long the three kinds of steps of implicit dynamics take, by which [`ImplicitDynamics`] chooses among them.
//!
//! ```text
//! cargo run --release --features measurements --example step_cost -- PACKING ...
//! ```
//!
//! The smallest backbone disk of seed 1 becomes the middle of a circle with a held rim, grows by 0.1 and is held; constant
//! damping, γ = 500. After 500 explicit steps the three kinds take turns, each from there on: explicit steps (velocity Verlet, 0.9
//! of their bound), stabilised steps of 8 stages, implicit steps of 40 explicit ones. A line a packing has the least time
//! of an explicit step, a stage and an implicit step, and how many stages the other two are worth.
//!
//! [`ImplicitDynamics`]: jamscope::relax::ImplicitDynamics

use std::error::Error;
use std::time::Instant;

use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::io::read_packing;
use jamscope::law::Hertzian;
use jamscope::law::damping::{ConstantDamping, ContactDamping};
use jamscope::packing::Packing;
use jamscope::relax::Motion;
use jamscope::relax::implicit::{ImplicitMotion, Inertia};

/// Explicit steps before anything is measured.
const FIRST_STEPS: usize = 500;

/// Turns; the least time of each kind counts.
const TURNS: usize = 40;

/// Explicit steps, and stages, of a turn.
const EXPLICIT_COUNT: usize = 16;

/// Stages of a stabilised step.
const STAGE_COUNT: usize = 8;

fn main() -> Result<(), Box<dyn Error>> {
    let (law, damping) = (Hertzian::default(), ContactDamping::Constant(ConstantDamping { rate: 500.0 }));
    for path in std::env::args().skip(1) {
        let start = inflated(&read_packing::<2>(&path)?)?;
        let mut explicit = Motion::new(&start, &law, &damping)?;
        let step = 0.9 * explicit.stable_step();
        for _ in 0..FIRST_STEPS {
            explicit.step(step)?;
        }
        let placed = explicit.assembly.placed(start);
        let implicit = || -> Result<_, Box<dyn Error>> {
            let mut motion = ImplicitMotion::new(&placed, &law, &damping, Inertia::Massive)?;
            motion.margin = 4e-3;
            Ok(motion)
        };
        let (mut stabilised, mut implicit) = (implicit()?, implicit()?);
        // The first ones make buffers and the analysis.
        for _ in 0..3 {
            let _ = implicit.step(40.0 * step)?;
            let _ = stabilised.stabilised_step(10.0 * step, STAGE_COUNT)?;
        }
        let mut least = [f64::INFINITY; 3];
        for _ in 0..TURNS {
            let times = [
                seconds(EXPLICIT_COUNT, || Ok(explicit.step(step)?))?,
                seconds(EXPLICIT_COUNT / STAGE_COUNT, || {
                    let _ = stabilised.stabilised_step(10.0 * step, STAGE_COUNT)?;
                    Ok(())
                })? / STAGE_COUNT as f64,
                seconds(1, || {
                    let _ = implicit.step(40.0 * step)?;
                    Ok(())
                })?,
            ];
            least.iter_mut().zip(times).for_each(|(least, time)| *least = least.min(time));
        }
        let [explicit_step, stage, implicit_step] = least;
        println!(
            "{path}: {} mobile, explicit step {:.4} ms, stage {:.4} ms, implicit step {:.3} ms; in stages {:.2} and {:.0}",
            stabilised.velocities.len(),
            1e3 * explicit_step,
            1e3 * stage,
            1e3 * implicit_step,
            explicit_step / stage,
            implicit_step / stage,
        );
    }
    Ok(())
}

/// Seconds of one of so many calls.
fn seconds(count: usize, mut call: impl FnMut() -> Result<(), Box<dyn Error>>) -> Result<f64, Box<dyn Error>> {
    let before = Instant::now();
    for _ in 0..count {
        call()?;
    }
    Ok(before.elapsed().as_secs_f64() / count as f64)
}

/// The packing cut to a circle around a small disk of its backbone, which has grown by 0.1.
fn inflated(packing: &Packing<2>) -> Result<Packing<2>, Box<dyn Error>> {
    let chosen = choose_centre(packing, &Hertzian::default(), Centre::Backbone, 1)?;
    let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
    let circle = Circle::cut(packing, chosen, 0.486 * side)?;
    let radius = circle.packing.radii()[circle.centre];
    Ok(circle.packing.with_radius(circle.centre, radius + 0.1)?)
}
