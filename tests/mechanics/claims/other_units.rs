//! Units do not matter.

use jamscope::law::{Hertzian, Hookean, PairLaw};
use jamscope::packing::{Domain, Packing};
use jamscope::relax::{Cost, Criterion, RelaxerChoice, Stop};
use jamscope::vector::{Vector, scaled};

use crate::scenes::rest::relax;
use crate::scenes::starts::points;

/// A relaxation in other units takes the same steps to the same bits; what each took.
///
/// Lengths by 4^a, stiffness by 2^b with b even: every number, and every entry of a matrix, is a power of four of the one
/// before, so not even roots round otherwise.
pub fn same_bits_in_other_units(choice: &RelaxerChoice) -> [Cost; 3] {
    fn check(choice: &RelaxerChoice, laws: [&dyn PairLaw; 2], length: f64) -> Cost {
        let scale = |column: &[Vector<2>]| -> Vec<Vector<2>> { column.iter().map(|x| scaled(length, *x)).collect() };
        let packing = points::<2>(100, 0.9, 15);
        let side = packing.domain().lengths().expect("periodic")[0];
        let radii = packing.radii().iter().map(|radius| radius * length).collect();
        let other = Packing::new(Domain::cube(side * length), scale(packing.positions()), radii).expect("valid");
        let (one, two) = (relax(choice, packing, laws[0]), relax(choice, other, laws[1]));
        assert_eq!(one.stop, Stop::Converged(Criterion::RelativeForce), "{}", choice.name());
        assert_eq!(one.stop, two.stop, "{}", choice.name());
        let unitless = |cost: Cost| Cost { seconds: 0.0, energies: None, ..cost };
        assert_eq!(unitless(one.cost), unitless(two.cost), "{}", choice.name());
        let [here, there] = [one.cost, two.cost].map(|cost| cost.energies.expect("energies"));
        assert_eq!(there.before / here.before, there.after / here.after, "{}", choice.name());
        assert_eq!(scale(one.state.positions()), two.state.positions());
        assert_eq!(scale(one.state.corrections()), two.state.corrections());
        one.cost
    }
    [
        // F' grows with k' √(length²) = k' length.
        check(choice, [&Hertzian { stiffness: 2e5 }, &Hertzian { stiffness: 2e5 * 64.0 }], 16.0),
        check(choice, [&Hertzian { stiffness: 2e5 }, &Hertzian { stiffness: 2e5 / 256.0 }], 0.25),
        check(choice, [&Hookean { stiffness: 2e5 }, &Hookean { stiffness: 2e5 / 256.0 }], 4.0),
    ]
}
