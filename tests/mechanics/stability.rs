//! How long a step of damped dynamics may be, explicit and implicit, and whether energy is accounted for on the way.

use std::path::PathBuf;

use jamscope::forces::damped::add_damping;
use jamscope::inflation::Circle;
use jamscope::io::read_packing;
use jamscope::law::damping::{ConstantDamping, ContactDamping};
use jamscope::law::{Hertzian, PairLaw};
use jamscope::linear::hessian::{Hessian, Members, Prestress};
use jamscope::network::ContactNetwork;
use jamscope::packing::Packing;
use jamscope::relax::implicit::{ImplicitMotion, Inertia, Stepped};
use jamscope::relax::{ForceLimit, Motion, Newton, Relaxer};
use jamscope::vector::{Vector, difference, larger, norm, scaled, sum};
use rand::{RngExt, SeedableRng};
use rand_pcg::Pcg64;

/// γ of either law.
const RATE: f64 = 500.0;

/// A circle of a stored packing around its first backbone disk, at rest inside its held rim, without rattlers: one that is
/// pushed flies, however little, and a step of 600 units of time takes it far.
fn at_rest(name: &str, share: f64) -> Packing<2> {
    let file = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join(format!("fixtures/packings/{name}.xyz"));
    let packing = read_packing::<2>(file).expect("a stored packing");
    let law = Hertzian::default();
    let centre = ContactNetwork::new(&packing, &law).expect("no coincidence").backbone.iter().position(|&is| is);
    let side = packing.domain().lengths().expect("periodic")[0];
    let circle = Circle::cut(&packing, centre.expect("jammed"), share * side).expect("a circle in the box").packing;
    let network = ContactNetwork::new(&circle, &law).expect("no coincidence");
    let stays = |&disk: &usize| network.backbone[disk] || circle.held()[disk];
    let kept: Vec<usize> = (0..circle.len()).filter(stays).collect();
    let positions = kept.iter().map(|&disk| circle.positions()[disk]).collect();
    let radii = kept.iter().map(|&disk| circle.radii()[disk]).collect();
    let held = kept.iter().map(|&disk| circle.held()[disk]).collect();
    let circle =
        Packing::new(*circle.domain(), positions, radii).and_then(|rigid| rigid.with_held(held)).expect("valid");
    let newton = Newton { limit: ForceLimit::Relative(1e-12), ..Newton::default() };
    newton.relax(circle, &law, &mut ()).expect("no coincidence").converged().expect("at rest").into_inner()
}

/// The linear motion about a state at rest: its matrices on the mobile disks, in working order.
struct Linear {
    motion: Motion<2>,
    hessian: Hessian<2>,
    damping: ContactDamping,
    coefficients: Vec<f64>,
}

impl Linear {
    fn new(packing: &Packing<2>, damping: ContactDamping) -> Self {
        let motion = Motion::new(packing, &Hertzian::default(), &damping).expect("no coincidence");
        let hessian = Hessian::of(&motion.assembly, Members::Mobile, Prestress::Included);
        let (pairs, radii) = (motion.assembly.pairs(), motion.assembly.radii());
        let of_pair = |(&i, &j): (&u32, &u32)| damping.coefficient(radii[i as usize], radii[j as usize]);
        let coefficients = pairs.first.iter().zip(&pairs.second).map(of_pair).collect();
        Linear { motion, hessian, damping, coefficients }
    }

    fn mobile(&self) -> usize {
        self.motion.assembly.mobile_count()
    }

    /// K x.
    fn stiffness(&self, x: &[f64]) -> Vec<f64> {
        let mut product = vec![0.0; x.len()];
        self.hessian.matrix().multiply(x, &mut product);
        product
    }

    /// Γ x: minus the damping forces at the velocities x, which are linear in them.
    fn damping(&self, x: &[f64]) -> Vec<f64> {
        let assembly = &self.motion.assembly;
        let mut velocities = vec![[0.0; 2]; assembly.len()];
        velocities.as_flattened_mut()[..x.len()].copy_from_slice(x);
        let mut forces = vec![[0.0; 2]; assembly.len()];
        let at = &assembly.displacements;
        add_damping(&self.damping, assembly.pairs(), &self.coefficients, at, &velocities, &mut forces);
        forces.as_flattened()[..x.len()].iter().map(|force| -force).collect()
    }

    /// The x that makes x·(a Γ + b K)x largest, of length 1, by power iteration.
    fn stiffest(&self, a: f64, b: f64, x: &mut Vec<f64>, count: usize) {
        for _ in 0..count {
            let (damped, stiff) = (self.damping(x), self.stiffness(x));
            let product: Vec<f64> = damped.iter().zip(&stiff).map(|(d, s)| a * d + b * s).collect();
            let length = inner(&product, &product).sqrt();
            *x = product.iter().map(|value| value / length).collect();
        }
    }

    /// The h at which the largest eigenvalue of hΓ + h²K/4 is 1.
    fn limit(&self) -> f64 {
        let mut x = noise(self.mobile()).concat();
        let mut step = 1e-4;
        for _ in 0..8 {
            self.stiffest(step, 0.25 * step * step, &mut x, 400);
            let (damping, stiffness) = (inner(&x, &self.damping(&x)), inner(&x, &self.stiffness(&x)));
            step = 2.0 * ((damping * damping + stiffness).sqrt() - damping) / stiffness;
        }
        step
    }

    /// h λ_Γ + h² λ_K/4 = 1 with the largest eigenvalue of either matrix.
    fn separate_limit(&self) -> f64 {
        let mut x = noise(self.mobile()).concat();
        self.stiffest(1.0, 0.0, &mut x, 3000);
        let damping = inner(&x, &self.damping(&x));
        let mut x = noise(self.mobile()).concat();
        self.stiffest(0.0, 1.0, &mut x, 3000);
        let stiffness = inner(&x, &self.stiffness(&x));
        2.0 * ((damping * damping + stiffness).sqrt() - damping) / stiffness
    }

    /// x·Kx/2 + v²/2 of a motion, x counted from rest: the energy above rest to second order, without cancellation.
    fn energy(&self, displacements: &[Vector<2>], velocities: &[Vector<2>]) -> f64 {
        let mobile = self.mobile();
        let rest = &self.motion.assembly.displacements;
        let x: Vec<f64> = (0..mobile).flat_map(|disk| difference(displacements[disk], rest[disk])).collect();
        let v = velocities[..mobile].as_flattened();
        0.5 * (inner(&x, &self.stiffness(&x)) + inner(v, v))
    }

    /// Whether a small motion about rest grows in the second half of so many explicit steps.
    fn grows(&self, time_step: f64, step_count: usize) -> bool {
        let mut motion = self.motion.clone();
        disturb(&mut motion.assembly.displacements, self.mobile(), 1e-6 * overlap(&self.motion));
        motion.step(0.0).expect("no coincidence");
        let start = self.energy(&motion.assembly.displacements, &motion.velocities);
        let mut half = 0.0;
        for step in 0..step_count {
            if step == step_count / 2 {
                half = self.energy(&motion.assembly.displacements, &motion.velocities);
            }
            motion.step(time_step).expect("no coincidence");
            if motion.kinetic_energy() > 1e3 * start {
                return true;
            }
        }
        self.energy(&motion.assembly.displacements, &motion.velocities) > half
    }
}

fn inner(a: &[f64], b: &[f64]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a * b).sum()
}

fn noise(count: usize) -> Vec<Vector<2>> {
    let mut draw = Pcg64::seed_from_u64(1);
    (0..count).map(|_| std::array::from_fn(|_| draw.random_range(-1.0..1.0))).collect()
}

fn disturb(displacements: &mut [Vector<2>], mobile: usize, size: f64) {
    for (displacement, noise) in displacements.iter_mut().zip(noise(mobile)) {
        *displacement = sum(*displacement, scaled(size, noise));
    }
}

/// Mean overlap by force, α Σu / ΣF.
fn overlap(motion: &Motion<2>) -> f64 {
    let totals = motion.assembly.clone().evaluate_totals();
    Hertzian::default().exponent() * totals.energy / totals.force_sum
}

fn the_limit_is_that_of_theory(packing: &Packing<2>, damping: ContactDamping) {
    let mut linear = Linear::new(packing, damping);
    let (theory, separate, rows) = (linear.limit(), linear.separate_limit(), linear.motion.stable_step());
    // A sum of maxima is no less than the maximum of a sum, and rows no less than eigenvalues. Power iteration is short of
    // the eigenvalue by less than 0.871 ln n / k = 0.2 % in the mean (Kuczyński, Woźniakowski 1992), n = 1400 rows, k = 3200.
    assert!(rows < separate && separate < 1.002 * theory, "{rows} {separate} {theory}");
    let step_count = 2000;
    let (mut stable, mut unstable) = (rows, 2.0 * theory);
    assert!(!linear.grows(stable, step_count) && linear.grows(unstable, step_count));
    while unstable - stable > 2e-4 * stable {
        let middle = 0.5 * (stable + unstable);
        if linear.grows(middle, step_count) {
            unstable = middle;
        } else {
            stable = middle;
        }
    }
    // A mode d above the limit is multiplied by −(1 + 4d/3) a step if damping rules, by more if stiffness does: its energy is
    // above that of all n others after k steps for (8/3) d k > ln n, d = 0.14 %. Bisection and power iteration add 0.2 % each.
    assert!((stable / theory - 1.0).abs() < 5e-3, "bisected {stable}, theory {theory}");
}

#[test]
fn the_longest_explicit_step_is_that_of_theory_with_either_damping() {
    for name in ["hertz_N1000_p1", "hertz_N1000_p800"] {
        let packing = at_rest(name, 0.3);
        the_limit_is_that_of_theory(&packing, ContactDamping::Constant(ConstantDamping { rate: RATE }));
        the_limit_is_that_of_theory(&packing, Hertzian::default().viscoelastic(RATE));
    }
}

fn long_implicit_steps_end_at_rest(packing: &Packing<2>, damping: ContactDamping) {
    let mut linear = Linear::new(packing, damping);
    let (mobile, bound) = (linear.mobile(), linear.motion.stable_step());
    let overlap = overlap(&linear.motion);
    let mut motion =
        ImplicitMotion::new(packing, &Hertzian::default(), &damping, Inertia::Massive).expect("no coincidence");
    disturb(&mut motion.assembly.displacements, mobile, 1e-2 * overlap);
    let mut before = motion.evaluate().energy;
    for _ in 0..20 {
        let Stepped::Moved(totals) = motion.step(1e6 * bound).expect("no coincidence") else {
            panic!("the matrix of a minimum is positive definite")
        };
        let energy = totals.energy + motion.kinetic_energy();
        // Rounding of a sum over contacts.
        assert!(energy <= before * (1.0 + 1e-13), "{before} to {energy}");
        before = energy;
    }
    let way =
        |disk: usize| norm(difference(motion.assembly.displacements[disk], linear.motion.assembly.displacements[disk]));
    let apart = (0..mobile).map(way).fold(0.0, larger);
    // Both are at rest to rounding: forces to 10⁻¹² of the mean, over soft modes some 10³ times softer than a contact.
    assert!(apart < 1e-8 * overlap, "{apart:e} apart, overlap {overlap:e}");
}

#[test]
fn an_implicit_step_a_million_times_as_long_loses_energy_and_ends_in_the_same_minimum() {
    for name in ["hertz_N1000_p1", "hertz_N1000_p800"] {
        let packing = at_rest(name, 0.3);
        long_implicit_steps_end_at_rest(&packing, ContactDamping::Constant(ConstantDamping { rate: RATE }));
        long_implicit_steps_end_at_rest(&packing, Hertzian::default().viscoelastic(RATE));
    }
}

/// |energy lost − work of damping| over the energy lost, of a motion without contact changes in so many steps.
fn balance(packing: &Packing<2>, damping: ContactDamping, time: f64, step_count: usize, implicit: bool) -> f64 {
    let linear = Linear::new(packing, damping);
    let size = 0.03 * overlap(&linear.motion);
    let time_step = time / step_count as f64;
    let (lost, dissipated) = if implicit {
        let mut motion =
            ImplicitMotion::new(packing, &Hertzian::default(), &damping, Inertia::Massive).expect("no coincidence");
        disturb(&mut motion.assembly.displacements, linear.mobile(), size);
        let first = motion.evaluate();
        let mut last = first;
        for _ in 0..step_count {
            let Stepped::Moved(totals) = motion.step(time_step).expect("no coincidence") else { panic!("no step") };
            assert_eq!(totals.contact_count, first.contact_count);
            last = totals;
        }
        (first.energy - last.energy - motion.kinetic_energy(), motion.dissipated)
    } else {
        let mut motion = linear.motion.clone();
        disturb(&mut motion.assembly.displacements, linear.mobile(), size);
        motion.step(0.0).expect("no coincidence");
        let first = motion.assembly.evaluate_totals();
        for _ in 0..step_count {
            motion.step(time_step).expect("no coincidence");
        }
        let last = motion.assembly.evaluate_totals();
        assert_eq!(last.contact_count, first.contact_count);
        (first.energy - last.energy - motion.kinetic_energy(), motion.dissipated)
    };
    ((lost - dissipated) / lost).abs()
}

fn orders(packing: &Packing<2>, damping: ContactDamping, implicit: bool) -> Vec<f64> {
    let bound = Linear::new(packing, damping).motion.stable_step();
    let errors: Vec<f64> =
        [16, 32, 64, 128].iter().map(|&count| balance(packing, damping, 4.0 * bound, count, implicit)).collect();
    errors.windows(2).map(|pair| (pair[0] / pair[1]).log2()).collect()
}

#[test]
fn the_energy_balance_converges_with_the_order_of_the_scheme() {
    let packing = at_rest("hertz_N1000_p800", 0.16);
    for (implicit, order) in [(false, 2.0), (true, 3.0)] {
        let constant = orders(&packing, ContactDamping::Constant(ConstantDamping { rate: RATE }), implicit);
        let viscoelastic = orders(&packing, Hertzian::default().viscoelastic(RATE), implicit);
        for found in [constant, viscoelastic] {
            // Steps of 1/4 to 1/32 of the bound: the next term of the error is a share h √λ_K of the first, at most 0.5, 0.25,
            // 0.12 for the stiffest modes, so halving changes the order by log₂(1.5/1.25) = 0.26, 0.16, 0.08 at most.
            for (found, off) in found.iter().zip([0.26, 0.16, 0.08]) {
                assert!((found - order).abs() < off, "order {found} for {order}");
            }
        }
    }
}
