//! [`Cause`]: a possible reason why states are not at rest, in numbers and in a sentence.

use std::fmt;

use serde::Serialize;

use crate::law::choice::LawChoice;
use crate::verdict::coordinate_digits::Digits;

/// The residual under another law.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
pub struct OtherLaw {
    /// The law, with the stiffness of the model. All contact forces scale with the stiffness, so residuals do not
    /// depend on it.
    pub law: LawChoice,
    /// Largest relative residual of the states \[1\].
    pub relative_residual: f64,
}

/// A possible reason why states are not at rest.
#[derive(Debug, Clone, Copy, PartialEq, Serialize)]
#[serde(rename_all = "snake_case")]
#[non_exhaustive]
pub enum Cause {
    /// Another law leaves almost no residual.
    Law {
        /// That law.
        law: LawChoice,
        /// Largest residual under it \[1\].
        relative_residual: f64,
    },
    /// No disk lies beyond R.
    NothingHeld {
        /// R \[length\].
        outer_radius: f64,
        /// Distance of the farthest disk \[length\].
        farthest: f64,
    },
    /// The unbalanced disks are those near R.
    Boundary {
        /// R \[length\].
        outer_radius: f64,
        /// Number of unbalanced disks.
        unbalanced_count: usize,
        /// Number of them with an outward net force.
        outward_count: usize,
        /// Number of held disks within a contact range of R.
        held_count: usize,
        /// Number expected from the density of the mobile disks.
        expected_count: usize,
    },
    /// Disks other than the inflated one changed their radius.
    OtherRadii {
        /// Number of these disks.
        count: usize,
        /// Label of the first of them.
        label: u64,
    },
    /// The unbalanced disks are neighbours of the inflated one.
    Centre {
        /// Label of the inflated disk.
        label: u64,
        /// Number of unbalanced disks.
        unbalanced_count: usize,
    },
    /// Coordinates with few digits.
    FewDigits {
        /// The number of digits.
        digits: Digits,
        /// Upper bound of the residual caused by the rounding \[1\].
        residual_bound: f64,
    },
    /// The packing has sites, whose forces this law does not include.
    Sites,
    /// A few disks cause the whole residual.
    FewDisks {
        /// Number of unbalanced disks.
        unbalanced_count: usize,
        /// Label of the disk with the largest net force.
        label: u64,
    },
    /// None of the other causes.
    Unfinished,
}

impl fmt::Display for OtherLaw {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(formatter, "{} {:.1e}", argument(&self.law), self.relative_residual)
    }
}

impl fmt::Display for Cause {
    fn fmt(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        match *self {
            Cause::Law { law, relative_residual } => {
                let law = argument(&law);
                write!(formatter, "the contact law; under the law {law} the residual is {relative_residual:.1e}.")
            }
            Cause::NothingHeld { outer_radius, farthest } => write!(
                formatter,
                "R beyond the data; R is {outer_radius}, but the farthest disk is at {farthest}, so nothing holds the packing."
            ),
            Cause::Boundary { outer_radius, unbalanced_count, outward_count, held_count, expected_count } => {
                let side = if 2 * outward_count > unbalanced_count { "outwards" } else { "inwards" };
                write!(
                    formatter,
                    "a wall or a rim inside R; the {unbalanced_count} unbalanced disks lie within a contact of R = {outer_radius}, \
                     pushed {side}. Beyond R, {held_count} disks hold them; from the density, {expected_count} are expected. Give an R inside the \
                     wall, with --outer-radius."
                )
            }
            Cause::OtherRadii { count, label } => {
                write!(formatter, "the centre; {count} other disks changed their radius too, disk {label} among them.")
            }
            Cause::Centre { label, unbalanced_count } => write!(
                formatter,
                "the centre; the {unbalanced_count} unbalanced disks are neighbours of the inflated disk {label}, whose radius or \
                 position was different when they came to rest."
            ),
            Cause::FewDigits { digits: Digits { significant, spacing }, residual_bound } => write!(
                formatter,
                "the digits of the coordinates; they were written with {significant} digits, with a spacing of {spacing:.0e}, which alone \
                 causes a residual of up to {residual_bound:.0e}. In LAMMPS: dump_modify ID format float %.17g"
            ),
            Cause::Sites => formatter.write_str("the sites; the forces in the file contain their forces, but this law does not."),
            Cause::FewDisks { unbalanced_count, label } => write!(
                formatter,
                "a damaged line; {unbalanced_count} disks are unbalanced, all others at rest; disk {label} has the largest net force."
            ),
            Cause::Unfinished => formatter.write_str(
                "a relaxation that ended early; unbalanced disks are everywhere, and no other law explains the residual.",
            ),
        }
    }
}

/// A law as an argument of the command line.
fn argument(law: &LawChoice) -> String {
    match law {
        LawChoice::Hertzian(_) => "hertzian".into(),
        LawChoice::Hookean(_) => "hookean".into(),
        LawChoice::PowerLaw(law) => format!("power:{}", law.exponent),
    }
}
