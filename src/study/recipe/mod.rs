//! [`Recipe`]: the studies for the figures of the published study, of spheres, and of other drives, at three scales.
//!
//! Six recipes, [`Recipe::Kappa`] to [`Recipe::Isostatic`], use the same study: in a common folder its samples are run
//! once.

mod drive;
mod scale;

pub use scale::Scale;

use serde::Serialize;

use crate::inflation::Boundary;
use crate::law::choice::LawChoice;
use crate::law::power_laws::{Hertzian, Hookean};
use crate::relax::{Fire, RelaxerChoice};
use crate::scene::ProtocolChoice;
use crate::study::recipe::drive::{free_centre, line, spheres};
use crate::study::recipe::scale::{common, part, reduced};
use crate::study::settings::{Part, Seeds, Study, Target};

/// A figure of the published study, or the same in three dimensions.
#[derive(Debug, Clone, Copy, PartialEq, Eq, PartialOrd, Ord, Serialize)]
#[serde(rename_all = "kebab-case")]
pub enum Recipe {
    /// Radial profiles of the three phases, single samples and means over samples (figs. 1, S2).
    Radial,
    /// κ and Δp against the pressure (fig. 2).
    Kappa,
    /// G(θ) and S(f) at several p̂ (fig. 3).
    Angular,
    /// G*, θ*, θ† against p and p̂, several sizes (fig. 4).
    OrderParameters,
    /// ℓ_s and ℓ_iso against p (fig. 5).
    Matching,
    /// θ* for several thresholds (fig. S4).
    Threshold,
    /// h_∥ and h_r against r ΔZ (fig. S8).
    Isostatic,
    /// G* and θ* against p N^(β/2)/d_0^(β/4) (fig. 6).
    InflationScaling,
    /// p_c in the plane of N^β p and N² d_0, both laws (figs. 6c, 7).
    PhaseDiagram,
    /// Angular modes in the periodic box (fig. S1).
    Periodic,
    /// ξ against φ below jamming (fig. S3).
    Jamming,
    /// Hookean disks: G*, θ* against p N and p N^(3/2) (fig. S5).
    Hookean,
    /// S(f) at p̂_c in several rings, both laws (fig. S6).
    Radius,
    /// Contacts changed by inflation and deflation (fig. S9).
    ContactChanges,
    /// The transition of spheres: κ, Δp, contact changes and G(γ) against p̂, several sizes.
    Spheres,
    /// A row of disks inflated in strips of several lengths and widths.
    Line,
    /// The inflated disk held and free.
    FreeCentre,
}

impl Recipe {
    /// All recipes.
    pub const ALL: [Recipe; 17] = [
        Recipe::Radial,
        Recipe::Kappa,
        Recipe::Angular,
        Recipe::OrderParameters,
        Recipe::Matching,
        Recipe::Threshold,
        Recipe::Isostatic,
        Recipe::InflationScaling,
        Recipe::PhaseDiagram,
        Recipe::Periodic,
        Recipe::Jamming,
        Recipe::Hookean,
        Recipe::Radius,
        Recipe::ContactChanges,
        Recipe::Spheres,
        Recipe::Line,
        Recipe::FreeCentre,
    ];

    /// Its name on the command line.
    pub fn name(self) -> &'static str {
        match self {
            Recipe::Radial => "radial",
            Recipe::Kappa => "kappa",
            Recipe::Angular => "angular",
            Recipe::OrderParameters => "order-parameters",
            Recipe::Matching => "matching",
            Recipe::Threshold => "threshold",
            Recipe::Isostatic => "isostatic",
            Recipe::InflationScaling => "inflation-scaling",
            Recipe::PhaseDiagram => "phase-diagram",
            Recipe::Periodic => "periodic",
            Recipe::Jamming => "jamming",
            Recipe::Hookean => "hookean",
            Recipe::Radius => "radius",
            Recipe::ContactChanges => "contact-changes",
            Recipe::Spheres => "spheres",
            Recipe::Line => "line",
            Recipe::FreeCentre => "free-centre",
        }
    }

    /// Its content, with the figure of the published study.
    pub fn title(self) -> &'static str {
        match self {
            Recipe::Radial => "radial profiles of the three phases, and their means over samples (figs. 1, S2)",
            Recipe::Kappa => "κ and Δp against the pressure (fig. 2)",
            Recipe::Angular => "G(θ) and S(f) across the transition (fig. 3)",
            Recipe::OrderParameters => "G*, θ* and θ† against p and p̂ (fig. 4)",
            Recipe::Matching => "screening and isostatic length against the pressure (fig. 5)",
            Recipe::Threshold => "θ* by its threshold (fig. S4)",
            Recipe::Isostatic => "fluctuations of the stretching of bonds (fig. S8)",
            Recipe::InflationScaling => "G* and θ* for several inflations (fig. 6)",
            Recipe::PhaseDiagram => "the transition in the plane of pressure and inflation (figs. 6c, 7)",
            Recipe::Periodic => "angular modes in the periodic box (fig. S1)",
            Recipe::Jamming => "penetration length below jamming (fig. S3)",
            Recipe::Hookean => "finite-size scaling of Hookean disks (fig. S5)",
            Recipe::Radius => "S(f) at the transition by distance, both laws (fig. S6)",
            Recipe::ContactChanges => "contacts changed by inflation and deflation (fig. S9)",
            Recipe::Spheres => "the transition in three dimensions, against p and p̂",
            Recipe::Line => {
                "a row of disks inflated between walls: correlations along the line, by its length and the width"
            }
            Recipe::FreeCentre => {
                "the inflated disk held or free: what of G*, θ*, the dipole and ℓ_iso the held disk makes"
            }
        }
    }

    /// The study, with the protocol of the published one.
    pub fn study(self, scale: Scale) -> Study {
        self.study_by(scale, vec![ProtocolChoice::default().relaxer()])
    }

    /// The study with other relaxers; each starts from the same packings. Packings below jamming always use FIRE,
    /// because damped dynamics would not end.
    pub fn study_by(self, scale: Scale, relaxers: Vec<RelaxerChoice>) -> Study {
        let mut study = self.of_scale(scale);
        // Parts below jamming have their own relaxer.
        if self != Recipe::Jamming {
            study.relaxers = relaxers;
        }
        study
    }

    fn of_scale(self, scale: Scale) -> Study {
        match self {
            Recipe::Radial => radial(scale),
            Recipe::Kappa
            | Recipe::Angular
            | Recipe::OrderParameters
            | Recipe::Matching
            | Recipe::Threshold
            | Recipe::Isostatic => transition(scale),
            Recipe::InflationScaling => inflations(scale, &[LawChoice::Hertzian(Hertzian::default())]),
            Recipe::PhaseDiagram => {
                inflations(scale, &[LawChoice::Hertzian(Hertzian::default()), LawChoice::Hookean(Hookean::default())])
            }
            Recipe::Periodic => periodic(scale),
            Recipe::Jamming => jamming(scale),
            Recipe::Hookean => hookean(scale),
            Recipe::Radius => radius(scale),
            Recipe::ContactChanges => contact_changes(scale),
            Recipe::Spheres => spheres(scale),
            Recipe::Line => line(scale),
            Recipe::FreeCentre => free_centre(scale),
        }
    }
}

fn transition(scale: Scale) -> Study {
    let parts = match scale {
        Scale::Small => vec![
            part(0, reduced(&[1e6, 3e6, 1e7, 3e7, 1e8]), 60),
            part(1, reduced(&[1e6, 1e7, 3e7, 1e8, 2e8, 4e8, 1e9]), 40),
        ],
        Scale::Medium => vec![
            part(1, reduced(&[1e6, 3e6, 1e7, 3e7, 6e7, 1e8, 2e8, 4e8, 1e9]), 100),
            part(0, reduced(&[1e6, 3e6, 1e7, 3e7, 1e8, 2e8]), 80),
            part(2, reduced(&[1e7, 3e7, 1e8, 2e8, 4e8, 1e9, 4e9]), 16),
        ],
        Scale::Full => {
            let all = [1e5, 3e5, 1e6, 3e6, 1e7, 2e7, 4e7, 6e7, 8e7, 1e8, 2e8, 3e8, 4e8, 6e8, 1e9];
            let higher = [3e9, 1e10];
            let wide: Vec<f64> = all.iter().chain(&higher).copied().collect();
            vec![part(1, reduced(&all), 400), part(2, reduced(&wide), 400), part(3, reduced(&wide), 400)]
        }
    };
    Study { parts, ..common() }
}

fn radial(scale: Scale) -> Study {
    let (size, count) = match scale {
        Scale::Small => (1, 20),
        Scale::Medium => (2, 40),
        Scale::Full => (3, 400),
    };
    let unjammed = Part {
        relaxers: vec![RelaxerChoice::Fire(Fire::default())],
        ..part(size, vec![Target::PackingFraction(0.82)], count)
    };
    let jammed = Part { increases: vec![0.1, 0.03, 0.01, 0.003], ..part(size, reduced(&[1e6, 1e7, 1e8, 1e9]), count) };
    Study { parts: vec![unjammed, jammed], ..common() }
}

fn inflations(scale: Scale, laws: &[LawChoice]) -> Study {
    let increases = vec![0.02, 0.05, 0.1, 0.2];
    let hertzian: &[f64] = &[1e6, 1e7, 3e7, 1e8, 2e8, 4e8, 1e9];
    // Two laws in the time of one. Half of the time of the larger size would go into its lowest pressure, far below p_c.
    let few = if laws.len() == 1 { 20 } else { 12 };
    let mut parts = Vec::new();
    for &law in laws {
        // Hookean pressures at about the same packing fractions, from φ(p) of both laws.
        let targets = |values: &[f64]| match law {
            LawChoice::Hookean(_) => {
                reduced(&values.iter().map(|p| 1.6e7 * libm::pow(p / 1e8, 2.0 / 3.0)).collect::<Vec<_>>())
            }
            _ => reduced(values),
        };
        let sizes: Vec<(usize, usize, &[f64])> = match scale {
            Scale::Small => vec![(0, 48, &[1e6, 3e6, 1e7, 3e7, 1e8]), (1, few, &hertzian[1..])],
            Scale::Medium => vec![(0, 100, &[1e6, 3e6, 1e7, 3e7, 1e8]), (1, 100, hertzian), (2, 24, hertzian)],
            Scale::Full => vec![(1, 400, hertzian), (2, 400, hertzian), (3, 400, hertzian)],
        };
        for (size, count, pressures) in sizes {
            let (laws, increases) = (vec![law], increases.clone());
            parts.push(Part { laws, increases, ..part(size, targets(pressures), count) });
        }
    }
    Study { parts, ..common() }
}

fn hookean(scale: Scale) -> Study {
    let near = reduced(&[3e5, 1e6, 3e6, 1e7, 2e7]);
    let wide = reduced(&[1e6, 3e6, 1e7, 2e7, 4e7]);
    let parts = match scale {
        Scale::Small => vec![part(0, near, 80), part(1, wide, 40)],
        Scale::Medium => vec![part(0, near, 200), part(1, wide.clone(), 100), part(2, wide, 24)],
        Scale::Full => vec![part(1, wide.clone(), 400), part(2, wide.clone(), 400), part(3, wide, 400)],
    };
    Study { parts, laws: vec![LawChoice::Hookean(Hookean::default())], ..common() }
}

fn radius(scale: Scale) -> Study {
    let (size, count) = match scale {
        Scale::Small => (1, 80),
        Scale::Medium => (2, 160),
        Scale::Full => (3, 400),
    };
    let law = |law: LawChoice, p| Part { laws: vec![law], ..part(size, reduced(&[p]), count) };
    let parts =
        vec![law(LawChoice::Hertzian(Hertzian::default()), 1e8), law(LawChoice::Hookean(Hookean::default()), 1.6e7)];
    Study { parts, ..common() }
}

/// The published study uses ten samples of 2774 disks.
fn periodic(scale: Scale) -> Study {
    let count = match scale {
        Scale::Small => 10,
        Scale::Medium => 100,
        Scale::Full => 400,
    };
    let part = Part {
        disk_counts: vec![2774],
        boundary: Some(Boundary::Periodic),
        seeds: Some(Seeds { first: 1, count }),
        ..Part::default()
    };
    Study { parts: vec![part], targets: vec![Target::Pressure(3500.0)], ..common() }
}

fn jamming(scale: Scale) -> Study {
    let fractions = |values: &[f64]| values.iter().map(|&value| Target::PackingFraction(value)).collect::<Vec<_>>();
    let coarse = fractions(&[0.74, 0.77, 0.79, 0.80, 0.81, 0.82, 0.83]);
    let fine = fractions(&[0.74, 0.77, 0.79, 0.80, 0.81, 0.82, 0.825, 0.83, 0.835, 0.838]);
    let parts = match scale {
        Scale::Small => vec![part(0, coarse.clone(), 100), part(1, coarse, 100)],
        Scale::Medium => vec![part(0, fine.clone(), 200), part(1, fine.clone(), 100), part(2, fine, 24)],
        Scale::Full => vec![part(1, fine.clone(), 400), part(2, fine.clone(), 400), part(3, fine, 400)],
    };
    Study { parts, relaxers: vec![RelaxerChoice::Fire(Fire::default())], ..common() }
}

fn contact_changes(scale: Scale) -> Study {
    let (size, count) = match scale {
        Scale::Small => (1, 40),
        Scale::Medium => (2, 60),
        Scale::Full => (3, 400),
    };
    let mut study = Study { parts: vec![part(size, reduced(&[1e6, 1e7, 1e8, 4e8, 1e9]), count)], ..common() };
    study.scene.inflation.deflate = true;
    study
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::study::Plan;

    #[test]
    fn every_recipe_makes_a_plan_at_every_scale() {
        for recipe in Recipe::ALL {
            let counts = Scale::ALL.map(|scale| Plan::of(&recipe.study(scale)).expect("it makes sense").sample_count());
            assert!(counts[0] < counts[1] && counts[1] < counts[2], "{}: {counts:?}", recipe.name());
        }
    }

    #[test]
    fn a_relaxer_is_that_of_jammed_packings_only() {
        for recipe in Recipe::ALL {
            for relaxer in ProtocolChoice::ALL.map(ProtocolChoice::relaxer) {
                let (study, default) = (recipe.study_by(Scale::Small, vec![relaxer]), recipe.study(Scale::Small));
                let below = recipe == Recipe::Jamming;
                assert_eq!(study.relaxers == default.relaxers, below || relaxer == ProtocolChoice::default().relaxer());
                let parts: Vec<_> = study.parts.iter().map(|part| &part.relaxers).collect();
                assert_eq!(parts, default.parts.iter().map(|part| &part.relaxers).collect::<Vec<_>>());
            }
        }
    }

    #[test]
    fn recipes_of_one_study_share_their_samples() {
        let study = |recipe: Recipe| recipe.study(Scale::Small);
        assert_eq!(study(Recipe::Kappa), study(Recipe::Isostatic));
        let names: std::collections::BTreeSet<_> = Recipe::ALL.iter().map(|recipe| recipe.name()).collect();
        assert_eq!(names.len(), Recipe::ALL.len());
    }
}
