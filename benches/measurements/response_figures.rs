//! Contact changes, stretching of bonds, isostatic length and angular modes of one inflation, in numbers and figures.
//!
//! ```text
//! cargo run --release --features measurements --example response_figures -- FOLDER [DISK_COUNT [PRESSURE [SEED]]]      (5548 Hertzian disks, p = 100)
//! ```
//!
//! A packing is prepared, its disk inflated by 0.1 in a circle with a held rim and deflated again. FOLDER gets one SVG a
//! figure.

use std::error::Error;
use std::time::Instant;

use jamscope::displacement::DisplacementField;
use jamscope::inflation::{Boundary, Inflation, inflate_with};
use jamscope::law::Hertzian;
use jamscope::linear::LinearResponse;
use jamscope::linear::Prestress;
use jamscope::observe::bond_changes::{BondChanges, BondSet};
use jamscope::observe::contact_changes::ContactCycle;
use jamscope::observe::fluctuations::{BondMeasure, Fluctuations};
use jamscope::observe::isostatic::{
    IsostaticLength, IsostaticOutcome, IsostaticRule, IsostaticSettings, Normalisation,
};
use jamscope::observe::multipoles::{MultipoleFit, MultipoleSettings, Multipoles};
use jamscope::observe::{ExcessCoordination, PressureChange, State};
use jamscope::packing::Mixture;
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::Fire;
use jamscope::report::figures::Figure;
use jamscope::report::figures::bond_map::bond_map;
use jamscope::report::figures::contact_map::contact_map;
use jamscope::report::figures::isostatic::isostatic_figure;
use jamscope::report::figures::map::MapFrame;
use jamscope::report::figures::multipoles::{Component, multipole_figure};
use jamscope::vector::larger;

fn main() -> Result<(), Box<dyn Error>> {
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let folder = std::path::Path::new(arguments.first().ok_or("a folder for the figures is needed")?);
    let number = |index: usize, default: f64| arguments.get(index).map_or(Ok(default), |text| text.parse::<f64>());
    let (disk_count, pressure, seed) = (number(1, 5548.0)? as usize, number(2, 100.0)?, number(3, 1.0)? as u64);
    let (law, fire) = (Hertzian::default(), Fire::default());
    let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
    let preparation = Preparation { disk_count, mixture, target, tolerance: 0.01, seed, ..Preparation::default() };
    let packing = prepare_with::<2>(&preparation, &law, &fire, &mut ())?.packing.into_inner();
    // r_out/L as the sizes of the study have it.
    let share = if disk_count < 10_000 {
        0.480
    } else if disk_count < 50_000 {
        0.486
    } else {
        0.491
    };
    let boundary = Boundary::HeldRim { outer_radius_over_side: share };
    let inflation = Inflation { deflate: true, boundary, ..Inflation::default() };
    let inflated = inflate_with(&inflation, &packing, &law, &fire, seed, &mut ())?;

    let start = Instant::now();
    let before = State::new(inflated.before.packing.get(), &law)?;
    let excess = ExcessCoordination::of(&before.network).map(|excess| excess.value);
    println!(
        "{} mobile disks, p = {:.4}, ΔZ = {:.4}",
        inflated.mobile_count,
        inflated.before.pressure,
        excess.unwrap_or(0.0)
    );
    let change = PressureChange::of_inflation(&inflated, &law);
    println!("Δp = {:.4}, Δp/p^(1/3) = {:.4}", change.change, change.scaled.unwrap_or(f64::NAN));

    let cycle = ContactCycle::of(&inflated, &law)?.ok_or("it was deflated")?;
    for (stage, changes) in [("inflation", &cycle.inflation), ("deflation", &cycle.deflation), ("cycle", &cycle.left)] {
        let (made, broken) = (changes.made.len(), changes.broken.len());
        println!("{stage}: {} kept, {made} made, {broken} broken; rattlers {:?}", changes.kept_count, changes.rattlers);
    }
    println!("returned: {} of those broken, {} of those made", cycle.broken_returned_count, cycle.made_returned_count);

    let field = DisplacementField::of_inflation(&inflated);
    let changes = BondChanges::of_inflation(&inflated, &law, BondSet::Kept)?;
    let response = LinearResponse::of_inflation(before.packing, inflated.centre, &law, Prestress::Included)?;
    let linear = BondChanges::of_linear_response(&before, &response, inflation.increase);
    let (outer, increase) = (inflated.outer_radius, inflation.increase);
    println!("largest y = (h/h_0) r ΔZ, and ℓ_iso ΔZ where y reaches 1.3:");
    let mut lengths = Vec::new();
    for (name, bonds) in [("relaxed", &changes), ("linear", &linear)] {
        for (unit, normalisation) in [
            ("h(1.5)", Normalisation::NearCentre { radius: 1.5 }),
            ("d_0", Normalisation::Increase),
            ("1", Normalisation::Length),
        ] {
            let settings = IsostaticSettings {
                normalisation,
                rule: IsostaticRule::Threshold(1.3),
                ..IsostaticSettings::default()
            };
            let fluctuations = Fluctuations::of_bonds(bonds, BondMeasure::Parallel, outer, settings.ring_width);
            let length = IsostaticLength::of(&fluctuations, excess, increase, outer, &settings)?;
            let largest = length.curve.iter().map(|point| point.scaled_fluctuation).fold(0.0, larger);
            println!("  {name:<8} h_0 = {unit:<7} {largest:>9.4}  {:?}", length.outcome);
            lengths.push((name, length));
        }
    }
    let multipoles = Multipoles::of(&field, &MultipoleSettings::default())?;
    println!("shares of modes 0, 1, 2, rest in the mean square of d_r:");
    for ring in multipoles.rings.iter().step_by(4) {
        if let MultipoleFit::Fitted { radial, .. } = &ring.fit {
            println!("  r = {:>6.2}: {:.3?}", ring.radius, radial.shares.unwrap_or_default());
        }
    }
    println!("measured in {:.3} s", start.elapsed().as_secs_f64());

    let frame = MapFrame::new(boundary, outer, packing.domain().lengths().ok_or("a box")?, 0.7);
    let (relaxed, unloaded) = (&lengths[0].1, &lengths[3].1);
    let radius = match relaxed.outcome {
        IsostaticOutcome::Reached { length, .. } => Some(length),
        _ => None,
    };
    let name = format!("p = {pressure}");
    let figures: [(&str, Figure); 7] = [
        ("bonds", bond_map(&name, &changes, &frame, radius)),
        ("bonds_linear", bond_map(&format!("{name}, linear"), &linear, &frame, None)),
        ("contacts", contact_map(&name, &cycle.inflation, &frame)),
        ("contacts_deflated", contact_map(&format!("{name}, deflated"), &cycle.deflation, &frame)),
        ("isostatic", isostatic_figure(&name, &[("relaxed", relaxed), ("linear", unloaded)])?),
        ("modes_radial", multipole_figure(&name, &multipoles, Component::Radial, 3, None)?),
        ("modes_transverse", multipole_figure(&name, &multipoles, Component::Transverse, 3, None)?),
    ];
    std::fs::create_dir_all(folder)?;
    for (file, figure) in figures {
        let text = figure.to_svg();
        println!("{file}.svg: {} kB", text.len() / 1000);
        std::fs::write(folder.join(format!("{file}.svg")), text)?;
    }
    Ok(())
}
