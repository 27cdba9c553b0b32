//! [`Lattice`]: equal disks on a regular lattice, whose continuum response is known exactly.
//!
//! A triangular lattice is isotropic for long waves. Consider pressed disks with spacing b = 2R − δ, contact force F,
//! stiffness F' at the overlap δ, and one disk per cell of area A = (√3/2) b². For slowly varying displacements they
//! obey
//!
//! ```text
//! m ü = A [ (λ+2μ) ∇(∇·u) − μ ∇×(∇×u) ] + Γ u       λ+2μ = (9F' − 3F/b) b²/(8A)       μ = (3F' − 9F/b) b²/(8A)
//! ```
//!
//! *Derivation.* Along a bond n the force changes by B (u_j − u_i), B = F' n nᵀ − (F/b)(1 − n nᵀ), the block of the
//! [Hessian](crate::linear::hessian). A wave u = U exp(i k·r) gives ω² U = Σ_n B (1 − cos b k·n) U → ½ b² Σ_n (k·n)² B
//! U for small k. Over the six directions (k·n)² n nᵀ averages to k² (3/8 along k, 1/8 across), (k·n)² (1 − n nᵀ) to k²
//! (1/8 along, 3/8 across). Six times ½ is three: ω² = (b² k²/8)(9F' − 3F/b) along k and (b² k²/8)(3F' − 9F/b) across.
//! These are the moduli in the equation of motion, including the forces at rest. Their difference is the bulk modulus,
//! λ+μ = (√3/2)(F' + F/b) = −A dp/dA with p = √3 F/b, in agreement with a uniform compression of the lattice.
//!
//! *A growing disk.* The growth of one disk by d_0 pushes each of its six neighbours away with a force g d_0, where g =
//! F' + F ∂ln c/∂R. These forces are an isotropic dipole of strength Σ r·f/2 = 3 g b d_0. In the continuum (λ+2μ)
//! ∇(∇·u) = 3 g b d_0 ∇δ(r), so far away
//!
//! ```text
//! u_r → B d_0/r        B = 3 g b / (2π A' )        A' = λ+2μ, per area
//! ```
//!
//! In a circle with u(R) = 0 this becomes B d_0 (1/r − r/R²). With sites (Γ) it becomes the screened profile with κ² =
//! (Γ/A)/(λ+2μ) and the same B as r → 0. So both the shape and the amplitude are known without a fit.
//!
//! *Position of the rim.* Held sites are between R and about one spacing beyond, so u vanishes between; using R itself
//! is an error of first order in b/R. The position follows from a field that is linear near the rim, u = s x with x
//! towards the inside. Along a wall of close-packed rows it is an exact solution that vanishes on the first held row.
//! This row is half a row, (√3/4) b = 0.433 b, beyond the area of the last mobile row. Consider next a wall at 30° to
//! it, with rows b/2 apart and bonds across one and two of them, of stiffness F'/4 + F'/4 and F'. There the mobile rows
//! 0, −1, … follow u_m = −(m − m_0) + c (−1/2)^|m| (without prestress). The conditions u_1 = u_2 = 0 in the same
//! recursion give m_0 = 4/3: 2/3 b, (5/12) b = 0.417 b beyond their area. Other directions give similar values; the
//! mean over a circle is measured ([`WALL`]). [`Lattice::effective_radius`] is the radius of the area of the mobile
//! sites plus this distance: with it the profile is exact to second order.

use std::f64::consts::PI;

use crate::inflation::Circle;
use crate::inflation::circle::RIM_WIDTH;
use crate::law::pair_law::PairLaw;
use crate::packing::{Domain, Packing, PackingError};
use crate::vector::{Vector, two_product, two_sum};

/// √3/2 as an unevaluated sum, to 32 digits.
const ROW_HEIGHT: (f64, f64) = (0.8660254037844386, 5.0175421109034514e-17);

/// Distance beyond the area of the mobile sites of a circle at which the displacement vanishes, over the spacing \[1\].
///
/// Measured in linear responses with known amplitude: 0.406 to 0.417 at R = 40, 0.408 to 0.413 at R = 80, for overlaps
/// from 0 to a twentieth of a diameter, Hertzian and Hookean. The walls of the two simplest directions have 0.433 and
/// 0.417.
pub const WALL: f64 = 0.412;

/// The arrangement of the disks.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub enum Arrangement {
    /// Six neighbours each; isotropic.
    Triangular,
    /// Four neighbours each; not isotropic, and unstable against shear at any pressure.
    Square,
}

/// Equal disks pressed together on a lattice in the plane.
///
/// # Example
/// ```
/// use jamscope::law::Hookean;
/// use jamscope::network::ContactNetwork;
/// use jamscope::lattice::Lattice;
///
/// let lattice = Lattice::triangular(0.5, 0.05)?;
/// let packing = lattice.periodic([12, 7])?;
/// let network = ContactNetwork::new(&packing, &Hookean { stiffness: 1.0 })?;
/// assert_eq!((packing.len(), network.contacts.len()), (168, 3 * 168));
/// let moduli = lattice.moduli(&Hookean { stiffness: 1.0 }).expect("isotropic");
/// let volume = packing.domain().volume().expect("a box");
/// assert!((network.pressure(volume) / moduli.pressure - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Lattice {
    arrangement: Arrangement,
    radius: f64,
    spacing: f64,
}

/// Long-wave moduli of a triangular lattice, including its forces at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Moduli {
    /// λ+2μ: stiffness of long waves along their direction \[force / length\].
    pub longitudinal: f64,
    /// μ: stiffness of long waves across their direction \[force / length\].
    pub shear: f64,
    /// −A dp/dA = λ+μ \[force / length\].
    pub bulk: f64,
    /// p \[force / length\].
    pub pressure: f64,
}

/// Why a lattice is invalid.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[non_exhaustive]
pub enum LatticeError {
    /// The disks are invalid.
    #[error(transparent)]
    Packing(#[from] PackingError),
    /// The radius must be positive.
    #[error("radius is {radius}, not a positive number")]
    RadiusNotPositive {
        /// The value given.
        radius: f64,
    },
    /// Only neighbours may touch: the overlap must be positive, and second neighbours must not touch.
    #[error("overlap is {overlap}, not between 0 and {largest}, where second neighbours touch")]
    OverlapOutOfRange {
        /// The value given.
        overlap: f64,
        /// The overlap at which second neighbours touch.
        largest: f64,
    },
    /// The circle must contain a site besides the central one.
    #[error("outer radius {outer_radius} is not a finite number above the spacing {spacing}: no site could move")]
    OuterRadiusTooSmall {
        /// The radius given.
        outer_radius: f64,
        /// Distance of neighbours.
        spacing: f64,
    },
}

impl Lattice {
    /// A triangular lattice of disks of this radius that overlap their six neighbours by `overlap`.
    ///
    /// # Errors
    /// A radius that is not positive; an overlap that is not, or at which second neighbours touch.
    pub fn triangular(radius: f64, overlap: f64) -> Result<Self, LatticeError> {
        Self::new(Arrangement::Triangular, radius, overlap, 3f64.sqrt())
    }

    /// A square lattice of disks of this radius that overlap their four neighbours by `overlap`.
    ///
    /// # Errors
    /// See [`Lattice::triangular`].
    pub fn square(radius: f64, overlap: f64) -> Result<Self, LatticeError> {
        Self::new(Arrangement::Square, radius, overlap, 2f64.sqrt())
    }

    fn new(arrangement: Arrangement, radius: f64, overlap: f64, second: f64) -> Result<Self, LatticeError> {
        if !(radius.is_finite() && radius > 0.0) {
            return Err(LatticeError::RadiusNotPositive { radius });
        }
        let largest = 2.0 * radius * (1.0 - 1.0 / second);
        if !(overlap > 0.0 && overlap < largest) {
            return Err(LatticeError::OverlapOutOfRange { overlap, largest });
        }
        Ok(Lattice { arrangement, radius, spacing: 2.0 * radius - overlap })
    }

    /// Distance of neighbours, b \[length\].
    pub fn spacing(&self) -> f64 {
        self.spacing
    }

    /// Radius of the disks \[length\].
    pub fn radius(&self) -> f64 {
        self.radius
    }

    /// Overlap of neighbours, 2R − b \[length\].
    pub fn overlap(&self) -> f64 {
        2.0 * self.radius - self.spacing
    }

    /// Area per disk, A \[length²\].
    pub fn cell_area(&self) -> f64 {
        match self.arrangement {
            Arrangement::Triangular => ROW_HEIGHT.0 * self.spacing * self.spacing,
            Arrangement::Square => self.spacing * self.spacing,
        }
    }

    /// Force and stiffness of a contact.
    fn contact(&self, law: &dyn PairLaw) -> (f64, f64) {
        let force = law.force(law.coefficient(self.radius, self.radius), self.overlap());
        (force, law.stiffness(force, self.overlap()))
    }

    /// The long-wave moduli; none for the square lattice, which is not isotropic.
    pub fn moduli(&self, law: &dyn PairLaw) -> Option<Moduli> {
        let (force, stiffness) = self.contact(law);
        let (tension, scale) = (-force / self.spacing, self.spacing * self.spacing / self.cell_area());
        (self.arrangement == Arrangement::Triangular).then(|| Moduli {
            longitudinal: scale * (9.0 * stiffness + 3.0 * tension) / 8.0,
            shear: scale * (3.0 * stiffness + 9.0 * tension) / 8.0,
            bulk: ROW_HEIGHT.0 * (stiffness - tension),
            pressure: -2.0 * ROW_HEIGHT.0 * tension,
        })
    }

    /// B: far from a disk that grows by d_0 the displacement tends to B d_0/r \[length\]; none for the square lattice.
    pub fn growth_amplitude(&self, law: &dyn PairLaw) -> Option<f64> {
        let (force, stiffness) = self.contact(law);
        let push = stiffness + force * law.coefficient_growth(self.radius, self.radius);
        self.moduli(law).map(|moduli| 3.0 * push * self.spacing / (2.0 * PI * moduli.longitudinal))
    }

    /// Γ for which the lattice responds as a screened medium with this κ² \[force / length\]: κ² (λ+2μ) A; negative for
    /// κ² < 0. None for the square lattice.
    pub fn coupling(&self, law: &dyn PairLaw, squared_wavenumber: f64) -> Option<f64> {
        self.moduli(law).map(|moduli| squared_wavenumber * moduli.longitudinal * self.cell_area())
    }

    /// A site as position and correction: `along` half spacings along a row, `row` rows up.
    fn site(&self, along: i64, row: i64) -> (Vector<2>, Vector<2>) {
        let height = match self.arrangement {
            Arrangement::Triangular => {
                let (high, low) = two_product(ROW_HEIGHT.0, self.spacing);
                two_sum(high, low + ROW_HEIGHT.1 * self.spacing)
            }
            Arrangement::Square => (self.spacing, 0.0),
        };
        let (x, x_rest) = two_product(0.5 * along as f64, self.spacing);
        let (y, y_rest) = two_product(row as f64, height.0);
        let (y, y_rest) = two_sum(y, y_rest + row as f64 * height.1);
        ([x, y], [x_rest, y_rest])
    }

    /// A periodic box of this many rectangular cells along each axis: b × √3 b with two disks (triangular) or b × b
    /// with one (square).
    ///
    /// # Errors
    /// No cell. If a box is too small for one image per pair, later functions refuse it.
    pub fn periodic(&self, cells: [usize; 2]) -> Result<Packing<2>, LatticeError> {
        let rows_a_cell = match self.arrangement {
            Arrangement::Triangular => 2,
            Arrangement::Square => 1,
        };
        let (columns, rows) = (cells[0] as i64, rows_a_cell * cells[1] as i64);
        let sites = (0..rows).flat_map(|row| {
            let shift = if rows_a_cell == 2 { row % 2 } else { 0 };
            (0..columns).map(move |column| (2 * column + shift, row))
        });
        let (positions, corrections): (Vec<_>, Vec<_>) = sites.map(|(along, row)| self.site(along, row)).unzip();
        let ([width, _], [_, height]) = (self.site(2 * columns, 0).0, self.site(0, rows).0);
        let domain = Domain::rectangular([0.0; 2], [width, height]);
        let radii = vec![self.radius; positions.len()];
        Ok(Packing::new(domain, positions, radii)?.with_corrections(corrections)?)
    }

    /// A circle in the open plane around a site: sites nearer than `outer_radius` are mobile. Sites from there on, as
    /// far as a mobile disk can reach, and the central one are held.
    ///
    /// # Errors
    /// A radius that leaves no mobile site.
    pub fn circle(&self, outer_radius: f64) -> Result<Circle<2>, LatticeError> {
        if !(outer_radius.is_finite() && outer_radius > self.spacing) {
            return Err(LatticeError::OuterRadiusTooSmall { outer_radius, spacing: self.spacing });
        }
        let reach = outer_radius + RIM_WIDTH * self.radius;
        let mut mobile = Vec::new();
        let mut rim = Vec::new();
        for (along, row, distance) in self.sites_within(reach) {
            match distance {
                _ if (along, row) == (0, 0) => {}
                distance if distance < outer_radius => mobile.push(self.site(along, row)),
                _ => rim.push(self.site(along, row)),
            }
        }
        let centre = mobile.len();
        let all: Vec<_> = mobile.into_iter().chain([([0.0; 2], [0.0; 2])]).chain(rim).collect();
        let (positions, corrections): (Vec<_>, Vec<_>) = all.into_iter().unzip();
        let count = positions.len();
        let packing = Packing::new(Domain::Open, positions, vec![self.radius; count])?
            .with_corrections(corrections)?
            .with_held((0..count).map(|disk| disk >= centre).collect())?;
        Ok(Circle { packing, centre, outer_radius })
    }

    /// The radius at which the displacement in a circle of this lattice vanishes \[length\]: that of the area of its N
    /// mobile sites and the central one, plus [`WALL`].
    ///
    /// ```text
    /// R_eff = √((N + 1) A/π) + 0.412 b
    /// ```
    ///
    /// # Accuracy
    /// 0.006 b for R from 40 to 80 (asserted). None for the square lattice, for which it is unknown.
    pub fn effective_radius(&self, circle: &Circle<2>) -> Option<f64> {
        let area = (circle.mobile_count() + 1) as f64 * self.cell_area();
        (self.arrangement == Arrangement::Triangular).then(|| (area / PI).sqrt() + WALL * self.spacing)
    }

    /// The sites nearer than `reach` to the central one, as half spacings along a row, row, and distance.
    fn sites_within(&self, reach: f64) -> Vec<(i64, i64, f64)> {
        // Squared distance in half spacings: x² + 3 y² (triangular), x² + 4 y² (square), both exact.
        let weight = match self.arrangement {
            Arrangement::Triangular => 3,
            Arrangement::Square => 4,
        };
        let half = 0.5 * self.spacing;
        let most = (reach / half).ceil() as i64;
        let rows = (reach / (half * (weight as f64).sqrt())).ceil() as i64;
        let mut sites = Vec::new();
        for row in -rows..=rows {
            let shift = if self.arrangement == Arrangement::Triangular { row.rem_euclid(2) } else { 0 };
            for along in (-most..=most).filter(|along| (along - shift).rem_euclid(2) == 0) {
                let distance = half * ((along * along + weight * row * row) as f64).sqrt();
                if distance < reach {
                    sites.push((along, row, distance));
                }
            }
        }
        sites
    }
}
