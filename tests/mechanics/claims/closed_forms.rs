//! Few disks whose rest is known in closed form.

use jamscope::law::{PairLaw, PowerLaw};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{Cost, RelaxerChoice};
use jamscope::vector::{norm, sum};

use crate::scenes::laws::{hertzian, hookean};
use crate::scenes::rest::{at_rest, relax};
use crate::scenes::starts::cross;

/// A disk between four held ones comes to rest in their middle, with any law; what each took.
pub fn rests_in_the_middle(choice: &RelaxerChoice) -> [Cost; 3] {
    fn check(choice: &RelaxerChoice, law: &dyn PairLaw) -> Cost {
        let outcome = relax(choice, cross([0.02, -0.013]), law);
        let cost = outcome.cost;
        let force = law.force(law.coefficient(0.55, 0.5), 0.05);
        // Stiffness of the mobile disk: two contacts along, 2 F', two across, −2 F/r with r = 1.
        let stiffness = 2.0 * (law.stiffness(force, 0.05) - force);
        let (position, rest) = at_rest(outcome).centre(0);
        let off = norm(sum(position, rest));
        // Force limit over stiffness; twice, for the change of both on the way to the middle.
        let allowed = 2.0 * choice.limit().value() * force / stiffness;
        assert!(off <= allowed, "{law:?}, {}: {off:e} from the middle", choice.name());
        cost
    }
    [
        check(choice, &hertzian()),
        check(choice, &hookean()),
        check(choice, &PowerLaw { energy_scale: 3.0, exponent: 3.5 }),
    ]
}

/// Three disks in a row between two held ones have no backbone, and nothing holds them across the row: they rest under
/// one force F = c_j δ_j^(α−1), the overlaps adding up to what the last disk was pushed in.
pub fn rests_under_one_force(choice: &RelaxerChoice) {
    let (law, total, limit) = (hertzian(), 0.125, choice.limit().value());
    let radii = [0.5, 0.75, 0.5, 0.625, 1.0];
    let mut positions = vec![[0.0, 0.0]];
    for pair in radii.windows(2) {
        positions.push([positions[positions.len() - 1][0] + pair[0] + pair[1], 0.0]);
    }
    positions[4][0] -= total;
    let packing = Packing::new(Domain::Open, positions, radii.to_vec())
        .and_then(|packing| packing.with_held(vec![true, false, false, false, true]))
        .expect("valid");
    let shares: Vec<f64> = radii.windows(2).map(|pair| law.coefficient(pair[0], pair[1]).powf(-2.0 / 3.0)).collect();
    let end = at_rest(relax(choice, packing, &law));
    let network = ContactNetwork::new(&end, &law).expect("no coincidence");
    assert_eq!(network.contacts.len(), 4);
    for contact in &network.contacts {
        let expected = total * shares[contact.first as usize] / shares.iter().sum::<f64>();
        // Forces differ by the limit a disk, overlaps by two thirds of that; rounding of positions up to 5 over 0.03.
        let error = (contact.overlap / expected - 1.0).abs();
        assert!(error <= 5.0 * limit + 5.0 * 8.0 * f64::EPSILON / 0.03, "{}: {error:e}", choice.name());
    }
}
