//! The rounding of energies and of residuals: [`rounding_floor`].

use crate::forces::assembly::Assembly;
use crate::network::{Links, Peeling};
use crate::vector::larger;

/// Rounding of an energy summed over blocks, relative \[1\].
pub(crate) const ENERGY_ROUNDING: f64 = 1e-13;

/// The relative residual caused by rounding alone \[1\].
///
/// ```text
/// max_i Σ_j 4 u_r [w F'(δ_ij) + F(δ_ij)] / ⟨F⟩          u_r = 2⁻⁵³, the unit roundoff
/// ```
///
/// Here w is the longest displacement from the anchors. An overlap is known to about 4 u_r of the relative
/// displacement, and a force to about 4 u_r of itself. A law with sites adds |Γ| times the longest distance from a
/// site. If coordinates were single numbers, the floor would be about `5 F' ulp(L) / ⟨F⟩`, L the side of the box.
pub fn rounding_floor<const D: usize>(assembly: &Assembly<D>) -> f64 {
    let (mut links, mut members) = (Links::default(), vec![true; assembly.len()]);
    links.take(assembly);
    Peeling::default().peel::<D>(|disk| disk >= assembly.mobile_count(), &links.ends, &mut members);
    let mean = mean_force(&links, &members);
    floor_of(assembly, &members, mean, assembly.longest_displacement(), &mut Vec::new())
}

/// Mean force of the contacts between members; 0 without contacts \[force\].
pub(crate) fn mean_force(links: &Links, members: &[bool]) -> f64 {
    let of_members =
        links.ends.iter().zip(&links.forces).filter(|((a, b), _)| members[*a as usize] && members[*b as usize]);
    let (count, total) = of_members.fold((0usize, 0.0), |(count, total), (_, &force)| (count + 1, total + force));
    if count == 0 { 0.0 } else { total / count as f64 }
}

/// The estimate of [`rounding_floor`] for these members and this longest displacement from the anchors.
pub(crate) fn floor_of<const D: usize>(
    assembly: &Assembly<D>,
    members: &[bool],
    mean: f64,
    moved: f64,
    row: &mut Vec<f64>,
) -> f64 {
    if mean == 0.0 {
        return 0.0;
    }
    let exponent = assembly.law().exponent();
    // F = F' δ / (α − 1). The row sums count a contact of two mobile disks twice (Gershgorin), hence 2 u_r for
    // 4 u_r. Next to held disks the estimate is half as large.
    let noise = |_: usize, overlap: f64, stiffness: f64| stiffness * (moved + overlap / (exponent - 1.0));
    assembly.row_bound(row, Some(&noise));
    let most =
        row.iter().zip(members).filter(|&(_, &member)| member).fold(0.0, |most, (&value, _)| larger(value, most));
    let sites = if assembly.law().has_sites() {
        assembly.law().on_site_coupling().abs() * assembly.longest_displacement_from_site()
    } else {
        0.0
    };
    (most + sites) * f64::EPSILON / mean
}
