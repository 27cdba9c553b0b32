//! How long a step of damped dynamics may be, explicit and implicit, from p = 0.01 to 3000; and the energy balance on the way.
//!
//! ```text
//! cargo run --release --features measurements --example stability_map
//! ```
//!
//! Stored Hertzian packings of 1000 disks and two of 400 prepared at p = 0.01 and 3000, cut to a circle with a held rim, at
//! rest to 10⁻¹², without rattlers; either damping law with γ = 500. Three tables:
//!
//! 1. The longest stable step of the explicit scheme, by bisection: does a motion of 10⁻⁶ of the mean overlap grow from the
//!    1000th to the 2000th step? Beside it h with λ_max(hΓ + h²K/4) = 1; h with h λ_Γ + h² λ_K/4 = 1 from the largest eigenvalues
//!    of both matrices; the same from Gershgorin's rows, as the relaxer takes it; and the share of damping in the first sum.
//! 2. Implicit steps of 1 to 10⁶ times the last: whether the energy ever grew in so many steps from a state disturbed by
//!    10⁻⁴ of the mean overlap, what is left of it above rest, and how far from rest the disks end, over the mean overlap.
//! 3. |energy lost − work of damping| over the energy lost, after 500 of those steps from an inflated start, rattlers included.

use std::error::Error;

use jamscope::forces::damped::add_damping;
use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::io::read_packing;
use jamscope::law::damping::{ConstantDamping, ContactDamping};
use jamscope::law::{Hertzian, PairLaw};
use jamscope::linear::{Hessian, Members, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::implicit::{ImplicitMotion, Inertia, Stepped};
use jamscope::relax::{ForceLimit, Motion, Newton, Relaxer, Staged};
use jamscope::vector::{Vector, difference, larger, norm, scaled, sum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

const STORED: [&str; 5] = ["p005", "p1", "p10", "p100", "p800"];
const PREPARED: [f64; 2] = [0.01, 3000.0];
const LIMIT: ForceLimit = ForceLimit::Relative(1e-12);
const RATE: f64 = 500.0;

/// Noise on every coordinate before implicit steps, over the mean overlap \[1\].
const DISTURBANCE: f64 = 1e-4;

type Failure = Box<dyn Error>;

fn main() -> Result<(), Failure> {
    let law = Hertzian::default();
    let mut packings = Vec::new();
    for pressure in PREPARED {
        let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
        let preparation =
            Preparation { disk_count: 400, mixture, target, tolerance: 0.1, seed: 1, ..Preparation::default() };
        packings.push(prepare_with::<2>(&preparation, &law, &Staged::default(), &mut ())?.packing.into_inner());
    }
    let folder = format!("{}/fixtures/packings", env!("CARGO_MANIFEST_DIR"));
    for (place, name) in STORED.iter().enumerate() {
        packings.insert(1 + place, read_packing(format!("{folder}/hertz_N1000_{name}.xyz"))?);
    }
    let starts = packings.iter().map(Start::new).collect::<Result<Vec<_>, _>>()?;
    println!(
        "{:>8} {:>6} {:>13} {:>10} {:>10} {:>10} {:>10} {:>8}",
        "p", "disks", "damping", "bisected", "theory", "separate", "rows", "share"
    );
    for start in &starts {
        longest_step(start, "constant", ContactDamping::Constant(ConstantDamping { rate: RATE }))?;
        longest_step(start, "viscoelastic", law.viscoelastic(RATE))?;
    }
    println!(
        "\n{:>8} {:>13} {:>8} {:>6} {:>6} {:>7} {:>9} {:>9}",
        "p", "damping", "step", "steps", "grew", "refused", "left", "apart"
    );
    for start in &starts {
        long_steps(start, "constant", ContactDamping::Constant(ConstantDamping { rate: RATE }))?;
        long_steps(start, "viscoelastic", law.viscoelastic(RATE))?;
    }
    println!("\n{:>8} {:>13} {:>9} {:>8} {:>9} {:>9}", "p", "damping", "scheme", "step", "steps", "error");
    for start in &starts {
        balances(start, "constant", ContactDamping::Constant(ConstantDamping { rate: RATE }))?;
        balances(start, "viscoelastic", law.viscoelastic(RATE))?;
    }
    Ok(())
}

/// A packing at rest without rattlers, and an inflated one.
struct Start {
    pressure: f64,
    rest: Packing<2>,
    inflated: Packing<2>,
}

impl Start {
    fn new(packing: &Packing<2>) -> Result<Self, Failure> {
        let law = Hertzian::default();
        let volume = packing.domain().volume().ok_or("the packing is not periodic")?;
        let pressure = ContactNetwork::new(packing, &law)?.pressure(volume);
        let chosen = choose_centre(packing, &law, Centre::Backbone, 1)?;
        let circle = Circle::cut(packing, chosen, 0.45 * volume.sqrt())?;
        let radius = circle.packing.radii()[circle.centre];
        let inflated = circle.packing.clone().with_radius(circle.centre, radius + 0.1)?;
        let circle = circle.packing;
        let network = ContactNetwork::new(&circle, &law)?;
        let kept: Vec<usize> =
            (0..circle.len()).filter(|&disk| network.backbone[disk] || circle.held()[disk]).collect();
        let positions = kept.iter().map(|&disk| circle.positions()[disk]).collect();
        let corrections = kept.iter().map(|&disk| circle.corrections()[disk]).collect();
        let radii = kept.iter().map(|&disk| circle.radii()[disk]).collect();
        let held = kept.iter().map(|&disk| circle.held()[disk]).collect();
        let rigid = Packing::new(*circle.domain(), positions, radii)?.with_corrections(corrections)?.with_held(held)?;
        let rest = Newton { limit: LIMIT, ..Newton::default() }.relax(rigid, &law, &mut ())?.state;
        Ok(Start { pressure, rest, inflated })
    }
}

/// The linear motion about a state at rest: its matrices on the mobile disks, in working order.
struct Linear {
    motion: Motion<2>,
    hessian: Hessian<2>,
    damping: ContactDamping,
    /// Mean overlap by force, α Σu / ΣF.
    overlap: f64,
}

impl Linear {
    fn new(packing: &Packing<2>, damping: ContactDamping) -> Result<Self, Failure> {
        let law = Hertzian::default();
        let mut motion = Motion::new(packing, &law, &damping)?;
        let totals = motion.assembly.evaluate_totals();
        let hessian = Hessian::of(&motion.assembly, Members::Mobile, Prestress::Included);
        Ok(Linear { motion, hessian, damping, overlap: law.exponent() * totals.energy / totals.force_sum })
    }

    fn stiffness(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        self.hessian.matrix().multiply(x, &mut product);
        product
    }

    /// Γ x: minus the damping forces at the velocities x.
    fn damping(&self, x: &[f64]) -> Vec<f64> {
        let mut velocities = vec![[0.0; 2]; self.motion.assembly.len()];
        velocities.as_flattened_mut()[..x.len()].copy_from_slice(x);
        let mut forces = vec![[0.0; 2]; velocities.len()];
        damp(&self.motion, &self.damping, &velocities, &mut forces);
        forces.as_flattened()[..x.len()].iter().map(|force| -force).collect()
    }

    /// x·Γx and x·Kx of the x of length 1 that makes a x·Γx + b x·Kx largest, by power iteration from x.
    fn stiffest(&self, a: f64, b: f64, x: &mut Vec<f64>, count: usize) -> (f64, f64) {
        for _ in 0..count {
            let (damped, stiff) = (self.damping(x), self.stiffness(x));
            *x = damped.iter().zip(&stiff).map(|(damped, stiff)| a * damped + b * stiff).collect();
            let length = inner(x, x).sqrt();
            x.iter_mut().for_each(|value| *value /= length);
        }
        (inner(x, &self.damping(x)), inner(x, &self.stiffness(x)))
    }

    /// x·Kx/2 + v²/2, x counted from rest: the energy above rest to second order, without cancellation.
    fn energy(&self, displacements: &[Vector<2>], velocities: &[Vector<2>]) -> f64 {
        let mobile = self.motion.assembly.mobile_count();
        let rest = &self.motion.assembly.displacements;
        let x: Vec<f64> = (0..mobile).flat_map(|disk| difference(displacements[disk], rest[disk])).collect();
        let v = velocities[..mobile].as_flattened();
        0.5 * (inner(&x, &self.stiffness(&x)) + inner(v, v))
    }

    fn grows(&self, time_step: f64) -> Result<bool, Failure> {
        let mut motion = self.motion.clone();
        disturb(&mut motion.assembly.displacements[..self.motion.assembly.mobile_count()], 1e-6 * self.overlap);
        motion.step(0.0)?;
        let start = self.energy(&motion.assembly.displacements, &motion.velocities);
        let mut half = 0.0;
        for step in 0..2000 {
            if step == 1000 {
                half = self.energy(&motion.assembly.displacements, &motion.velocities);
            }
            motion.step(time_step)?;
            if motion.kinetic_energy() > 1e3 * start {
                return Ok(true);
            }
        }
        Ok(self.energy(&motion.assembly.displacements, &motion.velocities) > half)
    }
}

fn longest_step(start: &Start, name: &str, damping: ContactDamping) -> Result<(), Failure> {
    let mut linear = Linear::new(&start.rest, damping)?;
    let mobile = linear.motion.assembly.mobile_count();
    let step_of = |damping: f64, stiffness: f64| 2.0 * ((damping * damping + stiffness).sqrt() - damping) / stiffness;
    let (mut x, mut theory, mut share) = (noise(mobile).concat(), 1e-4, 0.0);
    for _ in 0..8 {
        let (damped, stiff) = linear.stiffest(theory, 0.25 * theory * theory, &mut x, 400);
        theory = step_of(damped, stiff);
        share = theory * damped;
    }
    let (largest_damping, _) = linear.stiffest(1.0, 0.0, &mut noise(mobile).concat(), 3000);
    let (_, largest_stiffness) = linear.stiffest(0.0, 1.0, &mut noise(mobile).concat(), 3000);
    let (separate, rows) = (step_of(largest_damping, largest_stiffness), linear.motion.stable_step());
    let (mut stable, mut unstable) = (rows, 2.0 * theory);
    while unstable - stable > 2e-4 * stable {
        let middle = 0.5 * (stable + unstable);
        *(if linear.grows(middle)? { &mut unstable } else { &mut stable }) = middle;
    }
    println!(
        "{:>8.3} {mobile:>6} {name:>13} {stable:>10.3e} {theory:>10.3e} {separate:>10.3e} {rows:>10.3e} {share:>8.3}",
        start.pressure
    );
    Ok(())
}

fn long_steps(start: &Start, name: &str, damping: ContactDamping) -> Result<(), Failure> {
    let mut linear = Linear::new(&start.rest, damping)?;
    let (mobile, bound) = (linear.motion.assembly.mobile_count(), linear.motion.stable_step());
    for (times, step_count) in [(1.0, 1000), (1e2, 1000), (1e4, 100), (1e6, 20)] {
        let mut motion = ImplicitMotion::new(&start.rest, &Hertzian::default(), &damping, Inertia::Massive)?;
        disturb(&mut motion.assembly.displacements[..mobile], DISTURBANCE * linear.overlap);
        let mut before = motion.evaluate().energy;
        let first = linear.energy(&motion.assembly.displacements, &motion.velocities);
        let (mut grew, mut refused) = (0, 0);
        for _ in 0..step_count {
            // Refused: contacts that opened have left the matrix indefinite; the relaxer would take half of the step.
            let Stepped::Moved(totals) = motion.step(times * bound)? else {
                refused += 1;
                continue;
            };
            let energy = totals.energy + motion.kinetic_energy();
            // Rounding of a sum over contacts.
            grew += usize::from(energy > before * (1.0 + 1e-13));
            before = energy;
        }
        let left = linear.energy(&motion.assembly.displacements, &motion.velocities) / first;
        let rest = &linear.motion.assembly.displacements;
        let way = |disk: usize| norm(difference(motion.assembly.displacements[disk], rest[disk]));
        let apart = (0..mobile).map(way).fold(0.0, larger) / linear.overlap;
        println!(
            "{:>8.3} {name:>13} {times:>8.0e} {step_count:>6} {grew:>6} {refused:>7} {left:>9.1e} {apart:>9.1e}",
            start.pressure
        );
    }
    Ok(())
}

fn balances(start: &Start, name: &str, damping: ContactDamping) -> Result<(), Failure> {
    let bound = Linear::new(&start.rest, damping)?.motion.stable_step();
    let time = 500.0 * bound;
    let line = |scheme: &str, share: f64, steps: usize, lost: f64, work: f64| {
        let error = ((lost - work) / lost).abs();
        println!("{:>8.3} {name:>13} {scheme:>9} {share:>8.3} {steps:>9} {error:>9.1e}", start.pressure);
    };
    for share in [0.5, 0.25, 0.125] {
        let mut motion = Motion::new(&start.inflated, &Hertzian::default(), &damping)?;
        let first = motion.assembly.evaluate_totals().energy;
        let step_count = (time / (share * bound)) as usize;
        let (mut work, mut before, mut forces) = (0.0, 0.0, vec![[0.0; 2]; motion.assembly.len()]);
        for _ in 0..step_count {
            motion.step(share * bound)?;
            let power = damp(&motion, &damping, &motion.velocities, &mut forces);
            work += 0.5 * share * bound * (before + power);
            before = power;
        }
        let energy = motion.assembly.evaluate_totals().energy + motion.kinetic_energy();
        line("explicit", share, step_count, first - energy, work);
    }
    for share in [4.0, 2.0, 1.0, 0.5] {
        let mut motion = ImplicitMotion::new(&start.inflated, &Hertzian::default(), &damping, Inertia::Massive)?;
        let first = motion.evaluate().energy;
        let step_count = (time / (share * bound)) as usize;
        let mut energy = first;
        let mut refused = 0;
        for _ in 0..step_count {
            match motion.step(share * bound)? {
                Stepped::Moved(totals) => energy = totals.energy + motion.kinetic_energy(),
                _ => refused += 1,
            }
        }
        if refused == 0 {
            line("implicit", share, step_count, first - energy, motion.dissipated);
        } else {
            println!("{:>8.3} {name:>13}  implicit {share:>8.3} {step_count:>9} refused", start.pressure);
        }
    }
    Ok(())
}

/// Adds damping forces; the power they take.
fn damp(motion: &Motion<2>, damping: &ContactDamping, velocities: &[Vector<2>], forces: &mut [Vector<2>]) -> f64 {
    let (pairs, radii) = (motion.assembly.pairs(), motion.assembly.radii());
    let of_pair = |(&i, &j): (&u32, &u32)| damping.coefficient(radii[i as usize], radii[j as usize]);
    let coefficients: Vec<f64> = pairs.first.iter().zip(&pairs.second).map(of_pair).collect();
    add_damping(damping, pairs, &coefficients, &motion.assembly.displacements, velocities, forces)
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn noise(count: usize) -> Vec<Vector<2>> {
    let mut draw = Pcg64::seed_from_u64(1);
    (0..count).map(|_| std::array::from_fn(|_| draw.random_range(-1.0..1.0))).collect()
}

fn disturb(displacements: &mut [Vector<2>], size: f64) {
    let noise = noise(displacements.len());
    for (displacement, noise) in displacements.iter_mut().zip(noise) {
        *displacement = sum(*displacement, scaled(size, noise));
    }
}
