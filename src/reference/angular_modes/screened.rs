//! [`ScreenedMode`]: an angular mode of the screened annulus, for even and odd screening of any sign.

use crate::reference::Annulus;
use crate::reference::angular_modes::first_order_system::{Equations, System};
use crate::reference::angular_modes::node_solution::{Inward, NodeSolution};
use crate::reference::angular_modes::solution_basis::Frame;
use crate::reference::angular_modes::{
    AngularModeError, AngularSolution, ModeAmplitudes, ModeState, compliance_ratio, finite_amplitudes, times_i,
};
use crate::vector::larger;

pub use crate::reference::angular_modes::node_solution::NODE_LIMIT;

/// The screening of a medium, over its shear modulus.
#[derive(Debug, Clone, Copy, PartialEq, Default)]
pub struct Screening {
    /// Γ_e \[1/length²\]: positive gives waves (Bessel functions J, Y), negative decay (I, K).
    pub even: f64,
    /// Γ_o \[1/length²\]: a force perpendicular to the displacement, counterclockwise if positive.
    pub odd: f64,
}

impl Screening {
    /// The even screening whose radial inflation is [`Screened`](crate::reference::screened::Screened) with
    /// `wavenumber` κ \[1/length\]: `Γ_e = κ² (λ+2μ)/μ = 2κ²/(1 − ν)`.
    pub fn from_wavenumber(wavenumber: f64, poisson_ratio: f64) -> Self {
        Screening { even: wavenumber * wavenumber / (0.5 * (1.0 - poisson_ratio)), odd: 0.0 }
    }
}

/// An angular mode of a medium with dipole screening whose inner circle is displaced and whose rim is held.
///
/// ```text
/// Δu + (λ+μ)/μ ∇(∇·u) + Γ u = 0        Γ = [[Γ_e, −Γ_o], [Γ_o, Γ_e]]
/// u_r = Re[U e^(inθ)],  u_θ = Re[V e^(inθ)]        U(a) = U_a,  V(a) = V_a,  U(R) = V(R) = 0
/// ```
///
/// Γ_o = 0: u is a gradient and a curl of Bessel functions of order n with `k_L² = Γ_e μ/(λ+2μ)` and `k_T² = Γ_e`. Odd
/// screening mixes the two; their squared wavenumbers then solve `((λ+2μ)/μ k² − Γ_e)(k² − Γ_e) + Γ_o² = 0`.
///
/// The solution is stored at nodes, whose distances are within the reach of a power series, set by r/4, r/n and 1/√|Γ|.
/// Two solutions that vanish at the rim are integrated inward and kept orthogonal. They are combined to match the
/// displacement at a, and the combination is evaluated outward, in the direction of its decay. Between nodes the series
/// about the nearest one gives U, V and their derivatives. This is accurate to rounding, like the Bessel functions, but
/// has no cancellation for small κr. There the four Bessel functions become pairwise equal, and the displacement is in
/// their difference. For κR = 4 and n = 2 the direct formula has errors of 3·10⁻¹² at R/a = 340 and of 4·10⁻⁷ at R/a =
/// 10⁵.
///
/// # Units
/// Radii and amplitudes in lengths.
///
/// # Source
/// Lemaître et al. (2021), Phys. Rev. E 104, 024904; with odd screening Cohen, Schiller, Wang, Dijksman, Moshe (2023),
/// arXiv:2310.09942. The integration inward and outward: Conte (1966), SIAM Rev. 8, 309.
///
/// # Accuracy
/// Relative to |u| + ℓ|u'|, where ℓ is the length over which u changes, and u' times ℓ relative to the same: below
/// `2⁻⁵² (8 + node_count) · condition`. Largest error found against 160 bits: 1.1·10⁻¹⁴, a third of that bound, for n
/// to 1000, R/a from 1 + 10⁻⁷ to 10⁷, Γ R² from −6400 to 6400, either parity, away from poles. Amplitudes with U = iV
/// (which have no r^(−n+1)) in a nearly incompressible medium, ν → 1, have errors up to Γ R² times larger.
///
/// # Cost
/// Proportional to the number of nodes for the setup; constant per radius (`cargo bench --features measurements --bench reference_modes`).
///
/// # Example
/// ```
/// use jamscope::reference::Annulus;
/// use jamscope::reference::angular_modes::screened::{ScreenedMode, Screening};
/// use jamscope::reference::angular_modes::{AngularSolution, ModeAmplitudes};
/// let annulus = Annulus::new(0.5, 170.0)?;
/// // Radial inflation by 0.1, κ = 0.02, and odd screening a third of the even one: the medium also rotates.
/// let even = Screening::from_wavenumber(0.02, 0.3);
/// let screening = Screening { odd: even.even / 3.0, ..even };
/// let mode = ScreenedMode::new(annulus, 0.3, screening, 0, ModeAmplitudes::in_phase(0.1, 0.0))?;
/// let [radial, transverse] = mode.displacement(60.0, 0.0);
/// assert!(transverse.abs() > 0.1 * radial.abs());
/// assert_eq!(mode.displacement(0.5, 0.0), [0.1, 0.0]);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone)]
pub struct ScreenedMode {
    annulus: Annulus,
    mode: u32,
    solution: NodeSolution,
    condition: f64,
}

impl ScreenedMode {
    /// Mode n = `mode` in `annulus`, with Poisson's ratio ν of two dimensions, the screening, and the amplitudes at the
    /// inner circle.
    ///
    /// # Errors
    /// A Poisson's ratio that is not between −1 and 1; an amplitude or a screening that is not finite; more than
    /// [`NODE_LIMIT`] nodes needed; √|Γ| R above 2⁴² (a thin annulus only); a screening that is a pole to rounding.
    pub fn new(
        annulus: Annulus,
        poisson_ratio: f64,
        screening: Screening,
        mode: u32,
        boundary: ModeAmplitudes,
    ) -> Result<Self, AngularModeError> {
        let compliance_ratio = compliance_ratio(poisson_ratio)?;
        finite_amplitudes(boundary)?;
        let Screening { even, odd } = screening;
        if !(even.is_finite() && odd.is_finite()) {
            return Err(AngularModeError::ScreeningNotFinite { even, odd });
        }
        let system = System { mode: f64::from(mode), compliance_ratio, even, odd };
        let inward = Inward::march(annulus, &system, mode)?;

        // At the inner circle: the combination with its displacement.
        let quarter = times_i(boundary.transverse);
        let edge = [boundary.radial, quarter, boundary.radial - quarter];
        let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
        let relative_length = (1.0 / system.rate(inner)).min((outer - inner) / inner);
        let (coefficients, edge_condition) =
            inward.inner_frame().with_displacement(&system, [edge[0], edge[2]], relative_length);
        let condition = edge_condition * closeness(&system, &inward.radii, &inward.frames);
        // Every node adds a rounding of some 2⁻⁵². With less than this left, the determinant may be zero.
        if condition.is_nan() || condition * 4.0 * f64::EPSILON * inward.radii.len() as f64 >= 1.0 {
            return Err(AngularModeError::AtPole { mode, even, odd, condition });
        }
        let mut solution = inward.outward(system, coefficients);
        solution.set_inner_displacement(edge);
        Ok(ScreenedMode { annulus, mode, solution, condition })
    }

    /// The annulus.
    pub fn annulus(&self) -> Annulus {
        self.annulus
    }

    /// Approximate ratio of the relative errors of the displacement and of the screening: of order one away from the
    /// poles of the mode, and growing as Γ/|Γ − pole| towards one (to a factor of three at the first pole of n = 0).
    ///
    /// It is the inverse of the smallest sine of the angle between the solutions that vanish at the rim and those that
    /// vanish at a, times the cancellation in the determinant of the displacement at a.
    pub fn condition(&self) -> f64 {
        self.condition
    }

    /// Number of nodes at which the solution is stored.
    pub fn node_count(&self) -> usize {
        self.solution.node_count()
    }
}

impl AngularSolution for ScreenedMode {
    fn mode(&self) -> u32 {
        self.mode
    }

    fn at(&self, radius: f64) -> ModeState {
        if !self.annulus.contains(radius) {
            return ModeState::undefined();
        }
        self.solution.at(radius)
    }
}

/// The sine of the angle between the solutions that vanish at the rim and those that vanish at a: its value at a over
/// its smallest value anywhere between. At a pole one solution vanishes at both.
fn closeness(system: &System, radii: &[f64], frames: &[Frame]) -> f64 {
    let mut inner = Frame::held(system, radii[radii.len() - 1]);
    let mut sines = Vec::with_capacity(radii.len());
    for index in (0..radii.len()).rev() {
        if let Some(&from) = radii.get(index + 1) {
            inner = inner.advance(system, from, (from - radii[index]) / from).0;
        }
        sines.push(frames[index].smallest_sine(&inner, system, radii[index]));
    }
    sines.iter().fold(1.0, |largest, sine| larger(largest, sines[0] / sine))
}
