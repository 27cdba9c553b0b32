//! [`ScreenedSource`]: a force or a force dipole at the centre of a held circle, in a screened medium.

use crate::reference::Annulus;
use crate::reference::angular_modes::exponential_differences::log_ratio;
use crate::reference::angular_modes::first_order_system::{Equations, State, System};
use crate::reference::angular_modes::force_dipole::finite_moment;
use crate::reference::angular_modes::node_solution::{Inward, NodeSolution};
use crate::reference::angular_modes::solution_basis::Frame;
use crate::reference::angular_modes::source_series::{LARGEST_SCREENING, Source, regular_solutions};
use crate::reference::angular_modes::{
    AngularModeError, AngularSolution, Complex, ModeState, compliance_ratio, finite_force,
};
use crate::vector::larger;

/// One angular mode of a screened medium in a held circle, due to a force or a force dipole at its centre.
///
/// ```text
/// Δu + (λ+μ)/μ ∇(∇·u) + Γ u + f δ(r) = 0        u(R) = 0
/// force F along θ = 0: f = (F/μ) x̂, n = 1        dipole F s: f δ = −(F s/μ) x̂ ∂_x δ, n = 0 and n = 2
/// u = rot rot (g_T f)/Γ − ∇ (∇·(g_L f))/Γ + regular        g_k = −Y_0(kr)/4        k_L² = Γ μ/(λ+2μ),  k_T² = Γ
/// ```
///
/// For Γ < 0, g = K_0(|k|r)/2π. The regular part contains J_n (I_n) of k_L r and k_T r and cancels u at R. Γ = 0 is
/// [`PointForce`](super::point_force::PointForce) and [`ForceDipole`](super::force_dipole::ForceDipole).
///
/// The formula subtracts nearly equal Bessel functions for small kr, so it is not used. Near the centre the solution is
/// a power series with a logarithm, whose terms in Γ are divided differences without cancellation. There it is matched
/// to the solutions that vanish at the rim, which are integrated as in [`ScreenedMode`](super::screened::ScreenedMode).
///
/// # Units
/// Radii in lengths, Γ in 1/length²; the force over μ in lengths, the moment over μ in length².
///
/// # Source
/// Lemaître et al. (2021), Phys. Rev. E 104, 024904, for the medium; the solution is derived here and in its series.
///
/// # Accuracy
/// As [`ScreenedMode`](super::screened::ScreenedMode): relative to |u| + ℓ|u'| below `2⁻⁵² (8 + node_count) · condition`.
/// Largest error found against 25 digits: 8.3·10⁻¹⁵ of the condition, 0.41 of that bound, for |Γ| R² from 10⁻¹² to 62500,
/// r/R from 10⁻⁵ to 0.95, ν from −0.5 to 0.999999, and next to poles.
///
/// # Cost
/// As [`ScreenedMode`](super::screened::ScreenedMode).
///
/// # Example
/// ```
/// use jamscope::reference::Annulus;
/// use jamscope::reference::angular_modes::{AngularSolution, point_force::PointForce, screened_source::ScreenedSource};
/// let annulus = Annulus::new(0.5, 100.0)?;
/// let elastic = PointForce::new(annulus, 0.3, 0.1)?;
/// // With Γ < 0 the medium is held by springs, and the displacement decays over 10 lengths.
/// let held = ScreenedSource::force(annulus, 0.3, -0.01, 0.1)?;
/// assert!(held.displacement(50.0, 0.0)[0].abs() < 0.1 * elastic.displacement(50.0, 0.0)[0]);
/// // The dipole has two modes, n = 0 and n = 2.
/// let [inflation, elongation] = ScreenedSource::dipole(annulus, 0.3, -0.01, 0.1)?;
/// assert_eq!((inflation.mode(), elongation.mode()), (0, 2));
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScreenedSource {
    annulus: Annulus,
    source: Source,
    solution: NodeSolution,
    condition: f64,
}

impl ScreenedSource {
    /// A force F along θ = 0 at the centre, given as F/μ \[length\]; Poisson's ratio ν of two dimensions, and the even
    /// screening Γ \[1/length²\]. The solution is defined outside the inner radius only.
    ///
    /// # Errors
    /// A Poisson's ratio that is not between −1 and 1; a force or a screening that is not finite; too many nodes needed
    /// (√|Γ| R above 2·10⁵); a screening that is a pole of n = 1 to rounding.
    pub fn force(
        annulus: Annulus,
        poisson_ratio: f64,
        screening: f64,
        force_over_shear: f64,
    ) -> Result<Self, AngularModeError> {
        finite_force(force_over_shear)?;
        ScreenedSource::new(annulus, poisson_ratio, screening, Source::Force, force_over_shear)
    }

    /// The modes n = 0 and n = 2 of two opposite forces, F x̂ at (s/2, 0) and −F x̂ at (−s/2, 0), s → 0, given as F s/μ
    /// \[length²\].
    ///
    /// # Errors
    /// As for the force; a screening that is a pole of either mode.
    pub fn dipole(
        annulus: Annulus,
        poisson_ratio: f64,
        screening: f64,
        moment_over_shear: f64,
    ) -> Result<[Self; 2], AngularModeError> {
        finite_moment(moment_over_shear)?;
        let part = |source: Source| ScreenedSource::new(annulus, poisson_ratio, screening, source, moment_over_shear);
        Ok([part(Source::DipoleInflation)?, part(Source::DipoleElongation)?])
    }

    fn new(
        annulus: Annulus,
        poisson_ratio: f64,
        screening: f64,
        source: Source,
        strength: f64,
    ) -> Result<Self, AngularModeError> {
        let epsilon = compliance_ratio(poisson_ratio)?;
        if !screening.is_finite() {
            return Err(AngularModeError::ScreeningNotFinite { even: screening, odd: 0.0 });
        }
        let mode = source.mode();
        let system = System { mode: f64::from(mode), compliance_ratio: epsilon, even: screening, odd: 0.0 };
        // Where the series about the centre meets the solutions from the rim.
        let outer = annulus.outer_radius();
        let reach = LARGEST_SCREENING.sqrt() / system.wavenumber();
        let meeting = annulus.inner_radius().min(0.5 * outer).min(reach);
        // A radius that underflows is too small: the screening is beyond every limit of nodes.
        let Ok(whole) = Annulus::new(meeting, outer) else {
            return Err(AngularModeError::ScreeningTooLarge { even: screening, odd: 0.0, outer_radius: outer });
        };
        let inward = Inward::march(whole, &system, mode)?;

        let x = screening * meeting * meeting;
        let regular = Frame::orthonormal(regular_solutions(mode, epsilon, x), &system, meeting).0;
        let condition = rim_condition(&inward, &regular, &system);
        // Every node adds a rounding of some 2⁻⁵².
        if condition.is_nan() || condition * 4.0 * f64::EPSILON * inward.radii.len() as f64 >= 1.0 {
            return Err(AngularModeError::AtPole { mode, even: screening, odd: 0.0, condition });
        }
        let logarithm = -log_ratio(outer, meeting);
        let singular = source.state(meeting, epsilon, x, logarithm).map(|component| component * strength);
        let coefficients = matched(inward.inner_frame(), &regular, &singular, system.rate(meeting), mode);
        let solution = inward.outward(system, coefficients);
        Ok(ScreenedSource { annulus, source, solution, condition })
    }

    /// The annulus in which it is defined.
    pub fn annulus(&self) -> Annulus {
        self.annulus
    }

    /// Approximate ratio of the relative errors of the displacement and of the screening: of order one away from the
    /// poles of the mode, and growing as Γ/|Γ − pole| towards one.
    ///
    /// It is that of the equation for the regular part, which cancels the source at the rim: the sum of the products in
    /// its determinant, over the determinant, each factor replaced by the amplitude of its oscillation. At a pole a
    /// regular solution vanishes at the rim.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Number of nodes at which the solution is stored.
    pub fn node_count(&self) -> usize {
        self.solution.node_count()
    }
}

impl AngularSolution for ScreenedSource {
    fn mode(&self) -> u32 {
        self.source.mode()
    }

    fn at(&self, radius: f64) -> ModeState {
        if !self.annulus.contains(radius) {
            return ModeState::undefined();
        }
        self.solution.at(radius)
    }
}

/// The condition of the displacement of the `regular` solutions at the rim.
fn rim_condition(inward: &Inward, regular: &Frame, system: &System) -> f64 {
    let radii = &inward.radii;
    let at_rim = (1..radii.len()).rev().fold(*regular, |frame, index| {
        let (from, to) = (radii[index], radii[index - 1]);
        frame.advance(system, from, (from - to) / from).0
    });
    let relative_length = 1.0 / system.rate(radii[0]);
    if system.mode == 0.0 {
        // U with P alone, the first solution; the second one is a torsion.
        let inflation = at_rim.columns[0];
        let [slope, _] = system.displacement_slope(inflation);
        return larger(inflation[0].re.abs(), relative_length * slope.re.abs()) / inflation[0].re.abs();
    }
    let zero = Complex::new(0.0, 0.0);
    at_rim.with_displacement(system, [zero, zero], relative_length).1
}

/// The coefficients of the rim solutions that differ from `singular` by regular ones only.
fn matched(rim: &Frame, regular: &Frame, singular: &State, rate: f64, mode: u32) -> [Complex<f64>; 2] {
    // U, v, P and W, the last two over the rate.
    let rows = [(0, 1.0), (1, 1.0), (3, 1.0 / rate), (4, 1.0 / rate)];
    let zero = Complex::new(0.0, 0.0);
    if mode == 0 {
        let [(u, _), _, (p, scale), _] = rows;
        let row = |index: usize, scale: f64| {
            [rim.columns[0][index], regular.columns[0][index], singular[index]].map(|z| z.re * scale)
        };
        let ([a, b, c], [d, e, f]) = (row(u, 1.0), row(p, scale));
        return [Complex::new((c * e - b * f) / (a * e - b * d), 0.0), zero];
    }
    let mut system = rows.map(|(index, scale)| {
        let columns = [rim.columns[0], rim.columns[1], regular.columns[0], regular.columns[1]];
        let [a, b, c, d] = columns.map(|column| column[index].re * scale);
        [a, b, c, d, singular[index].re * scale]
    });
    // Elimination with row pivots; the columns are orthonormal in pairs.
    for step in 0..system.len() {
        let pivot = (step + 1..system.len())
            .fold(step, |best, row| if system[row][step].abs() > system[best][step].abs() { row } else { best });
        system.swap(step, pivot);
        let lead = system[step];
        for (index, row) in system.iter_mut().enumerate() {
            if index != step {
                let factor = row[step] / lead[step];
                for (entry, of_lead) in row.iter_mut().zip(lead).skip(step) {
                    *entry -= factor * of_lead;
                }
            }
        }
    }
    [0, 1].map(|step| Complex::new(system[step][4] / system[step][step], 0.0))
}
