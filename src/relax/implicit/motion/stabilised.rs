//! One step of the stabilised explicit method of [`super::super::chebyshev`]: stages, error, and the bounds that set how many.

use crate::contact::PairLaw;
use crate::contact::damping::DampingLaw;
use crate::contact::forces::{add_damping, geometry};
use crate::packing::PackingError;
use crate::relax::implicit::chebyshev::{Chebyshev, Stiffness};
use crate::relax::implicit::motion::{ImplicitMotion, Inertia, Stepped};
use crate::relax::implicit::tableau::ROS34PW2;
use crate::vector::{Vector, difference, dot, larger, scaled, sum};

/// Buffers of the stages of a step.
#[derive(Debug, Clone, Default)]
pub(super) struct Chain<const D: usize> {
    method: Option<Chebyshev>,
    /// Ways since the start of the step after the last stage, and after the one before it.
    way: Vec<Vector<D>>,
    earlier_way: Vec<Vector<D>>,
    /// Velocities of all disks likewise; held ones rest.
    velocity: Vec<Vector<D>>,
    earlier_velocity: Vec<Vector<D>>,
    /// Sums of c n n over the contacts of a disk.
    blocks: Vec<[Vector<D>; D]>,
}

impl<const D: usize, L: PairLaw, C: DampingLaw> ImplicitMotion<D, L, C> {
    /// Bounds for stabilised steps while no contact closes that is farther away than [`ImplicitMotion::margin`]. None without
    /// masses, and where something is stiff that no damping goes with: a contact without damping, or sites.
    ///
    /// ```text
    /// λ ≤ 2 max_i μ_i        μ_i the largest eigenvalue of Σ_j c_ij n n, a contact with a held disk by half
    /// ρ = max F'(δ_ij)/c_ij
    /// ```
    ///
    /// Since (x_i − x_j)² ≤ 2 x_i² + 2 x_j². In disks of six contacts about half of Gershgorin's rows, which add the c_ij
    /// as if all n were parallel.
    pub(in crate::relax::implicit) fn stiffness(&mut self) -> Option<Stiffness> {
        if L::ON_SITE || self.inertia != Inertia::Massive {
            return None;
        }
        let assembly = &self.assembly;
        let (pairs, law, mobile) = (assembly.pairs(), assembly.law(), assembly.mobile_count());
        let blocks = &mut self.chain.blocks;
        blocks.clear();
        blocks.resize(assembly.len(), [[0.0; D]; D]);
        let mut ratio = 0.0;
        for pair in 0..pairs.len() {
            let (apart, distance, overlap) = geometry(pairs, pair, &assembly.displacements);
            if overlap + self.margin <= 0.0 {
                continue;
            }
            let damping = self.damping.damping(self.damping_coefficient[pair], overlap.max(0.0));
            if overlap > 0.0 {
                let force = law.force(pairs.coefficient[pair], overlap);
                ratio = larger(law.stiffness(force, overlap) / damping, ratio);
            }
            let (i, j) = (pairs.first[pair] as usize, pairs.second[pair] as usize);
            let weight = if j < mobile { damping } else { 0.5 * damping } / (distance * distance);
            for a in 0..D {
                for b in 0..D {
                    let value = weight * apart[a] * apart[b];
                    blocks[i][a][b] += value;
                    blocks[j][a][b] += value;
                }
            }
        }
        let decay = 2.0 * blocks[..mobile].iter().map(largest_eigenvalue).fold(0.0, larger);
        (ratio.is_finite() && decay.is_finite()).then_some(Stiffness { decay, ratio })
    }

    /// One explicit step of length h \[time\] in this many stages; [`ImplicitMotion::take_back`] undoes it.
    ///
    /// # Errors
    /// Two disks with the same centre.
    pub fn stabilised_step(&mut self, time_step: f64, stage_count: usize) -> Result<Stepped<D>, PackingError> {
        let mut chain = std::mem::take(&mut self.chain);
        self.taken_back = false;
        self.remember();
        let method = match chain.method.take() {
            Some(method) if method.stages.len() == stage_count.max(2) => method,
            _ => Chebyshev::new(stage_count),
        };
        let stepped = self.chain_of_stages(time_step, &method, &mut chain);
        chain.method = Some(method);
        self.chain = chain;
        stepped
    }

    fn chain_of_stages(
        &mut self,
        time_step: f64,
        method: &Chebyshev,
        chain: &mut Chain<D>,
    ) -> Result<Stepped<D>, PackingError> {
        let (mobile, count) = (self.assembly.mobile_count(), self.assembly.len());
        for way in [&mut chain.way, &mut chain.earlier_way] {
            way.clear();
            way.resize(mobile, [0.0; D]);
        }
        for velocity in [&mut chain.velocity, &mut chain.earlier_velocity] {
            velocity.clear();
            velocity.extend_from_slice(&self.velocities);
            velocity.resize(count, [0.0; D]);
        }
        let start_dissipation = self.before.dissipation;
        let (mut work, mut earlier_work, mut dissipation) = (0.0, 0.0, start_dissipation);
        for (index, terms) in method.stages.iter().enumerate() {
            let [slope, start_slope] = [terms.slope, terms.start_slope].map(|factor| time_step * factor);
            let (start_velocities, start_forces) = (&self.velocities, &self.before.net_forces);
            let forces = if index == 0 { start_forces } else { &self.assembly.forces };
            let (mut longest, mut farthest) = (0.0f64, 0.0f64);
            for disk in 0..mobile {
                let (v, a) = (start_velocities[disk], start_forces[disk]);
                let (last_way, last_velocity) = (chain.way[disk], chain.velocity[disk]);
                let (earlier_way, earlier_velocity) = (chain.earlier_way[disk], chain.earlier_velocity[disk]);
                let mut way = [0.0; D];
                let mut velocity = [0.0; D];
                for d in 0..D {
                    way[d] = terms.last * last_way[d]
                        + terms.earlier * earlier_way[d]
                        + slope * last_velocity[d]
                        + start_slope * v[d];
                    velocity[d] = terms.start * v[d]
                        + terms.last * last_velocity[d]
                        + terms.earlier * earlier_velocity[d]
                        + slope * forces[disk][d]
                        + start_slope * a[d];
                }
                let change = difference(way, last_way);
                longest = larger(dot(change, change), longest);
                farthest = larger(dot(way, way), farthest);
                self.assembly.displacements[disk] = sum(self.assembly.displacements[disk], change);
                chain.earlier_way[disk] = way;
                chain.earlier_velocity[disk] = velocity;
            }
            std::mem::swap(&mut chain.way, &mut chain.earlier_way);
            std::mem::swap(&mut chain.velocity, &mut chain.earlier_velocity);
            let next_work = terms.last * work
                + terms.earlier * earlier_work
                + slope * dissipation
                + start_slope * start_dissipation;
            (earlier_work, work) = (work, next_work);
            if farthest.is_nan() || farthest.sqrt() > self.smallest_radius {
                return Ok(Stepped::TooFar);
            }
            if self.assembly.keep_listed(longest.sqrt())? {
                self.set_damping_coefficients();
            }
            if index + 1 < method.stages.len() {
                self.work.evaluation_count += 1;
                self.assembly.evaluate();
                let mut forces = std::mem::take(&mut self.assembly.forces);
                dissipation = add_damping(
                    &self.damping,
                    self.assembly.pairs(),
                    &self.damping_coefficient,
                    &self.assembly.displacements,
                    &chain.velocity,
                    &mut forces,
                );
                self.assembly.forces = forces;
            }
        }
        self.velocities.copy_from_slice(&chain.velocity[..mobile]);
        self.moved.copy_from_slice(&chain.way);
        self.dissipated += work;
        self.time += time_step;
        Ok(Stepped::Moved(self.evaluate()))
    }

    /// Estimated error of the last stabilised step for each mobile disk, in the measure of [`ImplicitMotion::error`]
    /// \[length\].
    ///
    /// ```text
    /// (4/5) (y − y') + (2/5) h (f(y) + f(y'))
    /// ```
    ///
    /// # Source
    /// Sommeijer, Shampine, Verwer (1997), eq. (2.9).
    pub fn stabilised_error(&self, time_step: f64, disk: usize) -> f64 {
        let (v, end_v) = (self.before.velocities[disk], self.velocities[disk]);
        let slopes = sum(v, end_v);
        let way = sum(scaled(-0.8, self.moved[disk]), scaled(0.4 * time_step, slopes));
        let forces = sum(self.before.net_forces[disk], self.net_forces[disk]);
        let kick = sum(scaled(0.8, difference(v, end_v)), scaled(0.4 * time_step, forces));
        let scale = time_step * ROS34PW2.diagonal;
        (dot(way, way) + scale * scale * dot(kick, kick)).sqrt()
    }
}

/// Largest eigenvalue of a symmetric matrix, of D > 2 rows a bound on it from above.
///
/// # Source
/// Wolkowicz, Styan (1980), Linear Algebra Appl. 29, 471, theorem 2.1: m + s √(D − 1), m and s mean and deviation of the
/// eigenvalues.
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
