//! One step of the method of [`super::coefficients`]: stages, error, and the bounds that determine the number of
//! stages.

use crate::forces::damped::damped_forces;
use crate::neighbours::for_each_pair::{MovedPair, for_each_pair};
use crate::packing::PackingError;
use crate::relax::dynamics::implicit::inertia::Inertia;
use crate::relax::dynamics::implicit::motion::ImplicitMotion;
use crate::relax::dynamics::implicit::rkc::coefficients::{Chebyshev, Stiffness};
use crate::relax::dynamics::implicit::rkc::stages::{Stages, estimated_error};
use crate::vector::{Vector, larger};

impl<const D: usize> ImplicitMotion<D> {
    /// Stability requirement of stabilised steps, valid while no contact with a gap above [`ImplicitMotion::margin`]
    /// closes. None for gradient flow, and if stiff forces are undamped: an undamped contact, sites, or loads.
    ///
    /// ```text
    /// λ ≤ 2 max_i μ_i        μ_i the largest eigenvalue of Σ_j c_ij n n, half for a contact with a held disk
    /// ρ = max F'(δ_ij)/c_ij
    /// ```
    ///
    /// This follows from (x_i − x_j)² ≤ 2 x_i² + 2 x_j². With six contacts per disk it is about half of Gershgorin's
    /// bound, which adds the c_ij as if all n were parallel.
    pub(crate) fn stiffness(&mut self) -> Option<Stiffness> {
        if self.assembly.has_on_site_forces() || self.inertia != Inertia::Massive {
            return None;
        }
        let assembly = &self.assembly;
        let (pairs, law, mobile) = (assembly.pairs(), assembly.law(), assembly.mobile_count());
        let blocks = &mut self.rkc_stages.blocks;
        blocks.clear();
        blocks.resize(assembly.len(), [[0.0; D]; D]);
        let mut ratio = 0.0;
        for_each_pair(
            pairs,
            &assembly.displacements,
            &mut |&MovedPair { pair, ends, separation, distance, overlap, coefficient }| {
                if overlap + self.margin <= 0.0 {
                    return;
                }
                let damping = self.damping.damping(self.damping_coefficient[pair], overlap.max(0.0));
                if overlap > 0.0 {
                    let force = law.force(coefficient, overlap);
                    ratio = larger(law.stiffness(force, overlap) / damping, ratio);
                }
                let (i, j) = (ends.0 as usize, ends.1 as usize);
                let weight = if j < mobile { damping } else { 0.5 * damping } / (distance * distance);
                for a in 0..D {
                    for b in 0..D {
                        let value = weight * separation[a] * separation[b];
                        blocks[i][a][b] += value;
                        blocks[j][a][b] += value;
                    }
                }
            },
        );
        let decay = 2.0 * blocks[..mobile].iter().map(largest_eigenvalue).fold(0.0, larger);
        (ratio.is_finite() && decay.is_finite()).then_some(Stiffness { decay, ratio })
    }

    /// One explicit step of length h \[time\] with this number of stages; [`ImplicitMotion::take_back`] undoes it.
    /// Returns false if a disk would move farther than the smallest radius: the step must then be taken back.
    ///
    /// Afterwards the net forces are those at the end of the step, but the elastic forces in
    /// [`ImplicitMotion::assembly`] are not. [`ImplicitMotion::evaluate`] computes them. The method does not apply to
    /// gradient flow or to laws with sites.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn stabilised_step(&mut self, time_step: f64, stage_count: usize) -> Result<bool, PackingError> {
        let mut stages = std::mem::take(&mut self.rkc_stages);
        self.taken_back = false;
        self.remember();
        let method = match stages.method.take() {
            Some(method) if method.stages.len() == stage_count.max(2) => method,
            _ => Chebyshev::new(stage_count),
        };
        let moved = self.apply_stages(time_step, &method, &mut stages);
        stages.method = Some(method);
        self.rkc_stages = stages;
        moved
    }

    fn apply_stages(
        &mut self,
        time_step: f64,
        method: &Chebyshev,
        stages: &mut Stages<D>,
    ) -> Result<bool, PackingError> {
        let mobile = self.assembly.mobile_count();
        stages.begin(&self.velocities, self.assembly.len());
        let start_dissipation = self.dissipation;
        let (mut work, mut earlier_work) = (0.0, 0.0);
        self.all_forces[..mobile].copy_from_slice(&self.before.net_forces);
        for terms in &method.stages {
            let slopes = [terms.slope, terms.start_slope].map(|factor| time_step * factor);
            let start = (self.velocities.as_flattened(), self.before.net_forces.as_flattened());
            let forces = self.all_forces.as_flattened();
            let displacements = self.assembly.displacements[..mobile].as_flattened_mut();
            let (change, farthest) = stages.advance(terms, slopes, start, forces, displacements);
            let next_work = terms.last * work
                + terms.earlier * earlier_work
                + slopes[0] * self.dissipation
                + slopes[1] * start_dissipation;
            (earlier_work, work) = (work, next_work);
            // The bounds are per component.
            let longest = (D as f64).sqrt();
            if farthest * longest > self.smallest_radius {
                return Ok(false);
            }
            if self.assembly.update_list(change * longest)? {
                self.set_damping_coefficients();
            }
            self.work.evaluation_count += 1;
            self.dissipation = damped_forces(
                (self.assembly.law(), &self.damping),
                self.assembly.pairs(),
                &self.damping_coefficient,
                &self.assembly.displacements,
                &stages.velocity,
                &mut self.all_forces,
            );
        }
        self.net_forces.copy_from_slice(&self.all_forces[..mobile]);
        self.velocities.copy_from_slice(&stages.velocity[..mobile]);
        self.moved.copy_from_slice(&stages.moved);
        self.dissipated += work;
        self.time += time_step;
        Ok(true)
    }

    /// Estimated error of the last stabilised step for each mobile disk, in the norm of [`ImplicitMotion::error`]
    /// \[length\].
    ///
    /// ```text
    /// (4/5) (y − y') + (2/5) h (f(y) + f(y'))
    /// ```
    ///
    /// # Source
    /// Sommeijer, Shampine, Verwer (1997), eq. (2.9).
    pub fn stabilised_error(&self, time_step: f64, disk: usize) -> f64 {
        let velocities = [self.before.velocities[disk], self.velocities[disk]];
        let forces = [self.before.net_forces[disk], self.net_forces[disk]];
        estimated_error(time_step, self.moved[disk], velocities, forces)
    }
}

/// Largest eigenvalue of a symmetric matrix; for D > 2 an upper bound.
///
/// # Source
/// Wolkowicz, Styan (1980), Linear Algebra Appl. 29, 471, theorem 2.1: m + s √(D − 1), where m and s are the mean and
/// the standard deviation of the eigenvalues.
fn largest_eigenvalue<const D: usize>(matrix: &[Vector<D>; D]) -> f64 {
    let mean = (0..D).map(|d| matrix[d][d]).sum::<f64>() / D as f64;
    let mut squares = 0.0;
    for (a, row) in matrix.iter().enumerate() {
        for (b, &value) in row.iter().enumerate() {
            let away = if a == b { value - mean } else { value };
            squares += away * away;
        }
    }
    mean + (squares / D as f64 * (D as f64 - 1.0)).sqrt()
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::forces::damped::add_damping;
    use crate::io::read_packing;
    use crate::law::damping::{ConstantDamping, ContactDamping};
    use crate::law::power_laws::Hertzian;
    use crate::vector::{dot, scaled};

    fn stored() -> ImplicitMotion<2> {
        let file = concat!(env!("CARGO_MANIFEST_DIR"), "/fixtures/packings/hertz_N1000_p100.xyz");
        let packing = read_packing::<2>(file).expect("a stored packing");
        let (law, damping) = (Hertzian::default(), ContactDamping::Constant(ConstantDamping { rate: 500.0 }));
        ImplicitMotion::new(&packing, &law, &damping, Inertia::Massive).expect("no coincidence")
    }

    #[test]
    fn the_bound_on_decays_holds_and_is_half_of_gershgorins() {
        let mut motion = stored();
        let bound = motion.stiffness().expect("every contact is damped").decay;
        // Lower bound on the largest eigenvalue, by the power method from a velocity that is not a mode.
        let count = motion.assembly.len();
        let mut x: Vec<Vector<2>> = (0..count).map(|i| [(7.0 * i as f64).sin(), (11.0 * i as f64).cos()]).collect();
        let mut value = 0.0;
        for _ in 0..300 {
            let mut forces = vec![[0.0; 2]; count];
            let at = &motion.assembly.displacements;
            let coefficients = &motion.damping_coefficient;
            let power = add_damping(&motion.damping, motion.assembly.pairs(), coefficients, at, &x, &mut forces);
            value = power / x.iter().map(|x| dot(*x, *x)).sum::<f64>();
            let length = forces.iter().map(|f| dot(*f, *f)).sum::<f64>().sqrt();
            x = forces.iter().map(|f| scaled(-1.0 / length, *f)).collect();
        }
        let (assembly, rate) = (&motion.assembly, 500.0);
        let rows = assembly.row_bound(&mut Vec::new(), Some(&|_, _, _| rate));
        assert!(value <= bound && bound < 1.4 * value, "{value}, bound {bound}");
        assert!(bound < 0.6 * rows, "{bound}, rows {rows}");
    }

    #[test]
    fn the_largest_eigenvalue_is_exact_in_two_dimensions_and_a_bound_in_three() {
        // 3 ± √(1 + 4); 1, 2 and 4, where m = 7/3, s = √(14)/3: (7 + √28)/3.
        assert!((largest_eigenvalue(&[[4.0, 2.0], [2.0, 2.0]]) - (3.0 + 5f64.sqrt())).abs() < 1e-14);
        let bound = largest_eigenvalue(&[[1.0, 0.0, 0.0], [0.0, 2.0, 0.0], [0.0, 0.0, 4.0]]);
        assert!((bound - (7.0 + 28f64.sqrt()) / 3.0).abs() < 1e-14 && bound >= 4.0, "{bound}");
    }
}
