//! The way down.

use jamscope::relax::Check;

/// The energy does not rise beyond the rounding of sums over contacts, 10⁻¹³ of what is summed up, in any step; twice that, for
/// both ends.
pub fn only_falls(looks: &[Check], steps_a_look: f64, what: &str) {
    assert!(looks.len() > 2, "{what}: {} looks", looks.len());
    for pair in looks.windows(2) {
        let (before, after) = (pair[0].energy, pair[1].energy);
        assert!(after <= before + 2e-13 * steps_a_look * before.abs(), "{what}: {before} rises to {after}");
    }
    assert!(looks[looks.len() - 1].energy < looks[0].energy);
}
