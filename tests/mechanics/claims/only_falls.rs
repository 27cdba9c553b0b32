//! The way down.

use jamscope::relax::Check;

/// The energy does not rise beyond the rounding of sums over contacts, 10⁻¹³ of what is summed up, in any step; twice that, for
/// both ends.
pub fn only_falls(checks: &[Check], steps_a_look: f64, what: &str) {
    assert!(checks.len() > 2, "{what}: {} checks", checks.len());
    for pair in checks.windows(2) {
        let (before, after) = (pair[0].energy, pair[1].energy);
        assert!(after <= before + 2e-13 * steps_a_look * before.abs(), "{what}: {before} rises to {after}");
    }
    assert!(checks[checks.len() - 1].energy < checks[0].energy);
}
