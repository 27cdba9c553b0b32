//! [`ElasticModuli`]: the response of energy and stress of a periodic packing to an infinitesimal strain of its box.
//!
//! The box and all centres follow the strain, r → (1 + ε) r with ε symmetric; then the disks relax (non-affine part).
//!
//! ```text
//! C_abcd = (1/V) ∂²E/∂ε_ab ∂ε_cd = (1/V) Σ_contacts d^(ab) · B d^(cd)        d^(ab) = e^(ab) r_ij + u_i^(ab) − u_j^(ab)
//!
//! K u^(ab) = Ξ^(ab)        Ξ_i^(ab) = −Σ_j B e^(ab) r_ij        e^(ab) = (e_a e_bᵀ + e_b e_aᵀ)/2
//! ```
//!
//! B is the block of a contact in the [Hessian](crate::linear::hessian), including its force at rest (prestress). u = 0
//! gives the affine (Born) part, and C = C_affine − (1/V) Ξ·K⁻¹ Ξ. The sum over d is used instead, because an error of
//! u enters it only squared. It also avoids the cancellation of the two parts in a soft packing.
//!
//! *Under pressure* the second derivatives of the energy are not the derivatives of the stress, which are
//!
//! ```text
//! B_abcd = ∂σ_ab/∂ε_cd = C_abcd + (σ_ac δ_bd + σ_ad δ_bc + σ_bc δ_ad + σ_bd δ_ac)/4 − σ_ab δ_cd
//! ```
//!
//! where σ is the stress at rest, here positive in tension. For σ = −p the bulk modulus −V dp/dV is C_aacc/D² + p
//! (D−1)/D and
//! the shear modulus C_xyxy − p/2.
//!
//! # Source
//! Wallace (1967), Phys. Rev. 162, 776 (derivatives of the stress; there C contains derivatives in the Lagrangian
//! strain, C − (σ_ac δ_bd + …)/4). Lutsko (1989), J. Appl. Phys. 65, 2991 (relaxation). The convention of C is that of
//! the published constants of `fixtures/goodrich`.

use faer::{Mat, Side};

use crate::law::pair_law::PairLaw;
use crate::linear::error::LinearError;
use crate::linear::factorisation::Analysis;
use crate::linear::hessian::{Hessian, Members, Prestress, contact_block};
use crate::linear::pinned::pinned;
use crate::network::ContactNetwork;
use crate::packing::Packing;
use crate::vector::{Vector, dot, larger, norm};

/// A tensor of rank four, indices a, b, c, d.
pub type Tensor<const D: usize> = [[[[f64; D]; D]; D]; D];

/// Second derivatives of the energy with respect to the strain, and the stress at rest.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Stiffness<const D: usize> {
    /// C_abcd \[force / length^(D−1)\].
    pub constants: Tensor<D>,
    /// Stress of the backbone at rest, positive in compression; 0 without prestress \[force / length^(D−1)\].
    pub stress: [[f64; D]; D],
}

/// Shear moduli over all directions: ½ ε:B:ε over the traceless strains with ε:ε = 1.
///
/// A simple shear by the angle γ has ε:ε = γ²/2, so ½ γ² of any of these is its energy per volume.
#[derive(Debug, Clone, Copy, PartialEq)]
pub struct Shear {
    /// Mean over all traceless strains: the average of Voigt \[force / length^(D−1)\].
    pub mean: f64,
    /// Softest traceless strain \[force / length^(D−1)\].
    pub smallest: f64,
    /// Stiffest traceless strain \[force / length^(D−1)\].
    pub largest: f64,
}

/// Elastic constants of a periodic packing at rest.
///
/// 40 published packings of `fixtures/goodrich`: every constant is within 8·10⁻¹⁵ of the published one, for constants
/// up to 1 (asserted to 10⁻¹², `cargo test moduli:: -- --nocapture`).
/// (asserted to 10⁻¹², `cargo test moduli:: -- --nocapture`).
///
/// # Cost
/// One analysis, one factorisation and D(D+1)/2 solutions of the Hessian.
///
/// # Example
/// ```
/// use jamscope::law::Hertzian;
/// use jamscope::linear::Prestress;
/// use jamscope::lattice::Lattice;
/// use jamscope::linear::ElasticModuli;
///
/// let (lattice, law) = (Lattice::triangular(0.5, 0.05)?, Hertzian::default());
/// let moduli = ElasticModuli::of(&lattice.periodic([8, 5])?, &law, Prestress::Included)?;
/// let exact = lattice.moduli(&law).expect("isotropic");
/// assert!((moduli.relaxed.bulk() / exact.bulk - 1.0).abs() < 1e-12);
/// assert!((moduli.relaxed.shear().mean / exact.shear - 1.0).abs() < 1e-12);
/// # Ok::<(), Box<dyn std::error::Error>>(())
/// ```
#[derive(Debug, Clone, PartialEq)]
pub struct ElasticModuli<const D: usize> {
    /// All disks follow the strain affinely.
    pub affine: Stiffness<D>,
    /// The disks relax, as in an experiment.
    pub relaxed: Stiffness<D>,
    /// Number of unknowns.
    pub unknown_count: usize,
    /// Number of negative eigenvalues of the Hessian: 0 at a minimum, more at a saddle.
    pub negative_eigenvalue_count: usize,
    /// Largest backward error of a solution \[1\].
    pub backward_error: f64,
    /// Smallest over largest pivot of the factorisation \[1\].
    pub pivot_ratio: f64,
}

impl<const D: usize> ElasticModuli<D> {
    /// The elastic constants of a packing at rest. Rattlers and their contacts are excluded.
    ///
    /// # Errors
    /// Held disks, the open plane, a law with sites; no backbone; a backbone that is not rigid (its Hessian is
    /// singular).
    pub fn of(packing: &Packing<D>, law: &dyn PairLaw, prestress: Prestress) -> Result<Self, LinearError> {
        let held_count = packing.held().iter().filter(|&&held| held).count();
        if held_count > 0 {
            return Err(LinearError::HeldDisks { held_count });
        }
        let volume = packing.domain().volume().ok_or(LinearError::NotPeriodic)?;
        if law.has_sites() {
            return Err(LinearError::OnSites { coupling: law.on_site_coupling() });
        }
        let network = ContactNetwork::new(packing, law)?;
        let no_backbone = LinearError::NoBackbone { disk_count: packing.len() };
        let fixed = pinned(packing, &network)?.ok_or(no_backbone)?;
        let hessian = Hessian::new(&fixed, law, Members::Backbone, prestress)?;
        let links = links(&network, law, prestress);
        let strains = strains::<D>();

        let mut analysis = Analysis::of(&hessian)?;
        let mut factorisation = analysis.factorise(hessian.matrix())?;
        let mut backward_error = 0.0;
        let mut fields = Vec::with_capacity(strains.len());
        for &(a, b) in &strains {
            let push = hessian.gather(&affine_forces(&links, packing.len(), (a, b)));
            let mut unknowns = vec![0.0; push.len()];
            let solution = factorisation.solve(&push, &mut unknowns)?;
            backward_error = larger(solution.backward_error, backward_error);
            fields.push(hessian.scatter(&unknowns));
        }

        let stress = stress(&network, prestress, volume);
        let nowhere = vec![vec![[0.0; D]; packing.len()]; strains.len()];
        let of = |fields: &[Vec<Vector<D>>]| Stiffness { constants: constants(&links, fields, volume), stress };
        Ok(ElasticModuli {
            affine: of(&nowhere),
            relaxed: of(&fields),
            unknown_count: hessian.matrix().dimension(),
            negative_eigenvalue_count: factorisation.negative_eigenvalue_count(),
            backward_error,
            pivot_ratio: factorisation.pivot_ratio(),
        })
    }
}

impl<const D: usize> Stiffness<D> {
    /// Derivatives of the stress, B_abcd = ∂σ_ab/∂ε_cd, tension positive \[force / length^(D−1)\]. Equal to the
    /// constants if there are no forces at rest.
    pub fn stress_slopes(&self) -> Tensor<D> {
        let one = |a: usize, b: usize| f64::from(u8::from(a == b));
        let tension = |a: usize, b: usize| -self.stress[a][b];
        tensor(|[a, b, c, d]| {
            let turned = tension(a, c) * one(b, d)
                + tension(a, d) * one(b, c)
                + tension(b, c) * one(a, d)
                + tension(b, d) * one(a, c);
            self.constants[a][b][c][d] + 0.25 * turned - tension(a, b) * one(c, d)
        })
    }

    /// Bulk modulus −V dp/dV, pressure p = −tr σ/D \[force / length^(D−1)\].
    pub fn bulk(&self) -> f64 {
        let slopes = self.stress_slopes();
        let total: f64 = (0..D).flat_map(|a| (0..D).map(move |c| (a, c))).map(|(a, c)| slopes[a][a][c][c]).sum();
        total / (D * D) as f64
    }

    /// Shear moduli; NaN if a constant is NaN.
    pub fn shear(&self) -> Shear {
        let (slopes, strains) = (self.stress_slopes(), traceless::<D>());
        let energy = |first: &[[f64; D]; D], second: &[[f64; D]; D]| {
            let mut total = 0.0;
            for a in 0..D {
                for b in 0..D {
                    for c in 0..D {
                        for d in 0..D {
                            total += first[a][b] * slopes[a][b][c][d] * second[c][d];
                        }
                    }
                }
            }
            0.5 * total
        };
        let count = strains.len();
        let matrix = Mat::from_fn(count, count, |p, q| energy(&strains[p], &strains[q]));
        let mean = (0..count).map(|p| matrix[(p, p)]).sum::<f64>() / count as f64;
        let whole = (0..count).all(|p| (0..count).all(|q| matrix[(p, q)].is_finite()));
        match matrix.self_adjoint_eigenvalues(Side::Lower) {
            Ok(values) if whole => Shear { mean, smallest: values[0], largest: values[count - 1] },
            _ => Shear { mean, smallest: f64::NAN, largest: f64::NAN },
        }
    }
}

/// A contact of the backbone: its disks, the vector between them, and its block.
struct Link<const D: usize> {
    ends: (usize, usize),
    apart: Vector<D>,
    block: [Vector<D>; D],
}

fn links<const D: usize>(network: &ContactNetwork<D>, law: &dyn PairLaw, prestress: Prestress) -> Vec<Link<D>> {
    let contacts = network.backbone_contacts();
    let link = contacts.map(|contact| {
        let (apart, distance) = (contact.separation, norm(contact.separation));
        let stiffness = law.stiffness(contact.force, contact.overlap);
        let block = contact_block(stiffness, prestress.across(contact.force, distance), apart, distance);
        Link { ends: (contact.first as usize, contact.second as usize), apart, block }
    });
    link.collect()
}

/// The pairs (a, b), a ≤ b, of the symmetric strains e^(ab).
fn strains<const D: usize>() -> Vec<(usize, usize)> {
    (0..D).flat_map(|a| (a..D).map(move |b| (a, b))).collect()
}

/// An orthonormal basis of the traceless symmetric matrices: simple shears, then differences of stretches.
fn traceless<const D: usize>() -> Vec<[[f64; D]; D]> {
    let shears = strains::<D>().into_iter().filter(|(a, b)| a != b).map(|(a, b)| {
        let mut matrix = [[0.0; D]; D];
        (matrix[a][b], matrix[b][a]) = (0.5f64.sqrt(), 0.5f64.sqrt());
        matrix
    });
    let stretches = (1..D).map(|last| {
        let mut matrix = [[0.0; D]; D];
        let length = ((last * (last + 1)) as f64).sqrt();
        (0..last).for_each(|axis| matrix[axis][axis] = 1.0 / length);
        matrix[last][last] = -(last as f64) / length;
        matrix
    });
    shears.chain(stretches).collect()
}

fn tensor<const D: usize>(entry: impl Fn([usize; 4]) -> f64) -> Tensor<D> {
    std::array::from_fn(|a| {
        std::array::from_fn(|b| std::array::from_fn(|c| std::array::from_fn(|d| entry([a, b, c, d]))))
    })
}

/// e^(ab) r.
fn strained<const D: usize>((a, b): (usize, usize), apart: Vector<D>) -> Vector<D> {
    let mut moved = [0.0; D];
    moved[a] += 0.5 * apart[b];
    moved[b] += 0.5 * apart[a];
    moved
}

fn multiplied<const D: usize>(block: &[Vector<D>; D], vector: Vector<D>) -> Vector<D> {
    block.map(|row| dot(row, vector))
}

/// Ξ^(ab): the net force on each disk per affine strain.
fn affine_forces<const D: usize>(links: &[Link<D>], disk_count: usize, strain: (usize, usize)) -> Vec<Vector<D>> {
    let mut forces = vec![[0.0; D]; disk_count];
    for link in links {
        let force = multiplied(&link.block, strained(strain, link.apart));
        for d in 0..D {
            forces[link.ends.0][d] -= force[d];
            forces[link.ends.1][d] += force[d];
        }
    }
    forces
}

/// C from the displacement fields for all strains.
fn constants<const D: usize>(links: &[Link<D>], fields: &[Vec<Vector<D>>], volume: f64) -> Tensor<D> {
    let strains = strains::<D>();
    let mut sums = vec![vec![0.0; strains.len()]; strains.len()];
    let mut stretched = vec![[0.0; D]; strains.len()];
    for link in links {
        for ((stretch, &strain), field) in stretched.iter_mut().zip(&strains).zip(fields) {
            let (u, v, moved) = (field[link.ends.0], field[link.ends.1], strained(strain, link.apart));
            *stretch = std::array::from_fn(|d| moved[d] + (u[d] - v[d]));
        }
        for (row, first) in sums.iter_mut().zip(&stretched) {
            let force = multiplied(&link.block, *first);
            row.iter_mut().zip(&stretched).for_each(|(sum, second)| *sum += dot(force, *second));
        }
    }
    let place = |a: usize, b: usize| strains.iter().position(|&pair| pair == (a.min(b), a.max(b))).unwrap_or(0);
    // The sums of (p, q) and (q, p) differ by rounding: one of them is used for both.
    tensor(|[a, b, c, d]| {
        let (p, q) = (place(a, b), place(c, d));
        sums[p.min(q)][p.max(q)] / volume
    })
}

/// Stress of the backbone, positive in compression.
fn stress<const D: usize>(network: &ContactNetwork<D>, prestress: Prestress, volume: f64) -> [[f64; D]; D] {
    let mut stress = [[0.0; D]; D];
    if prestress == Prestress::LeftOut {
        return stress;
    }
    for contact in network.backbone_contacts() {
        let factor = contact.force / (norm(contact.separation) * volume);
        for a in 0..D {
            for b in 0..D {
                stress[a][b] += factor * (contact.separation[a] * contact.separation[b]);
            }
        }
    }
    stress
}
