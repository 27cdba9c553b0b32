//! Scratch.
use std::error::Error;

use jamscope::contact::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use jamscope::contact::{ContactNetwork, Hertzian};
use jamscope::io::read_packing;
use jamscope::packing::Packing;
use jamscope::relax::implicit::Finish;
use jamscope::relax::{DampedDynamics, Fire, ForceLimit, ImplicitDynamics, Look, Relaxer, Staged, TimeStep};

fn main() -> Result<(), Box<dyn Error>> {
    let mut arguments = std::env::args().skip(1);
    let mut files = vec![];
    let mut how = vec!["implicit".to_string()];
    let mut rate = 500.0;
    let mut constant = false;
    let mut tol = ImplicitDynamics::default().tolerance;
    let mut finish = Finish::default();
    let mut limit = 1e-8;
    let mut verbose = false;
    let mut dt = 5e-4;
    while let Some(argument) = arguments.next() {
        let mut value = || arguments.next().ok_or_else(|| format!("{argument} needs a value"));
        match argument.as_str() {
            "--how" => how = value()?.split(',').map(String::from).collect(),
            "--rate" => rate = value()?.parse()?,
            "--tol" => tol = value()?.parse()?,
            "--dt" => dt = value()?.parse()?,
            "--limit" => limit = value()?.parse()?,
            "--finish" => finish = Finish::Newton(value()?.parse()?),
            "--prepare" => prepare_starts(&value()?)?,
            "--constant" => constant = true,
            "--verbose" => verbose = true,
            _ => files.push(argument),
        }
    }
    let damping = if constant {
        DampingChoice::Constant(ConstantDamping { rate })
    } else {
        DampingChoice::Viscoelastic(ViscoelasticDamping { rate })
    };
    let law = Hertzian::default();
    for file in files {
        let before = read_packing::<2>(&file)?;
        let centre = (0..before.len())
            .min_by(|&a, &b| {
                let r = |i: usize| before.positions()[i][0].hypot(before.positions()[i][1]);
                r(a).total_cmp(&r(b))
            })
            .ok_or("empty")?;
        let mut held = before.held().to_vec();
        held[centre] = true;
        let radius = before.radii()[centre];
        let outer = file_outer(&file)?;
        let start: Packing<2> = before.clone().with_held(held)?.with_radius(centre, radius + 0.1)?;
        let network = ContactNetwork::new(&before, &law)?;
        let p0 = pressure(&network, &before, outer);
        println!(
            "{file}: n = {} p = {p0:.6} E = {:.6e} rattlers {} start E {:.6e}",
            before.len(),
            network.energy(),
            network.rattlers().count(),
            ContactNetwork::new(&start, &law)?.energy()
        );
        for how in &how {
            let mut last = 0.0;
            let mut trace = |look: &Look| {
                if verbose && (look.step_count as f64) >= last {
                    last = (look.step_count as f64 * 1.2).max(1.0 + look.step_count as f64);
                    println!(
                        "   {} E {:.6e} K {:.4e} R {:.3e} h {:.3e}",
                        look.step_count, look.energy, look.kinetic_energy, look.residual, look.time_step
                    );
                }
            };
            let limit = ForceLimit::Relative(limit);
            let outcome =
                match how.as_str() {
                    "implicit" => {
                        ImplicitDynamics { damping, limit, tolerance: tol, finish, ..ImplicitDynamics::default() }
                            .relax(start.clone(), &law, &mut trace)?
                    }
                    "explicit" => {
                        DampedDynamics { damping, limit, time_step: TimeStep::Fixed(dt), ..DampedDynamics::default() }
                            .relax(start.clone(), &law, &mut trace)?
                    }
                    "share" => DampedDynamics { damping, limit, ..DampedDynamics::default() }.relax(
                        start.clone(),
                        &law,
                        &mut trace,
                    )?,
                    "staged" => Staged { limit, ..Staged::default() }.relax(start.clone(), &law, &mut trace)?,
                    _ => Fire { limit, ..Fire::default() }.relax(start.clone(), &law, &mut trace)?,
                };
            let network = ContactNetwork::new(&outcome.state, &law)?;
            let p1 = pressure(&network, &outcome.state, outer);
            println!(
                " {how}: {:?} E {:.8e} dp {:.5} residual {:.2e} rattlers {} contacts {} cost {:?}",
                outcome.stop,
                network.energy(),
                p1 - p0,
                outcome.residual.relative(),
                network.rattlers().count(),
                network.contacts.len(),
                outcome.cost
            );
            println!("   {:?}", outcome.cost.energies);
        }
    }
    Ok(())
}

fn file_outer(file: &str) -> Result<f64, Box<dyn Error>> {
    let text = std::fs::read_to_string(file)?;
    let at = text.find("outer_radius=").ok_or("no outer radius")? + 13;
    let rest = &text[at..];
    Ok(rest[..rest.find([' ', '\n']).ok_or("end")?].parse()?)
}

fn pressure(network: &ContactNetwork<2>, packing: &Packing<2>, outer: f64) -> f64 {
    let _ = packing;
    let mut virial = 0.0;
    for contact in &network.contacts {
        let inside = |i: usize| {
            let p = packing.positions()[i];
            (p[0].hypot(p[1]) < outer) as u8 as f64
        };
        let (i, j) = (contact.first as usize, contact.second as usize);
        let r = packing.separation(i, j);
        virial += 0.5 * (inside(i) + inside(j)) * contact.force * r[0].hypot(r[1]);
    }
    virial / (2.0 * std::f64::consts::PI * outer * outer)
}

fn prepare_starts(folder: &str) -> Result<(), Box<dyn Error>> {
    use jamscope::inflation::{Centre, Circle, choose_centre};
    use jamscope::packing::Mixture;
    use jamscope::preparation::{Preparation, Target, prepare};
    let law = Hertzian::default();
    std::fs::create_dir_all(folder)?;
    for (name, pressure) in [("p005", 0.05), ("p03", 0.3), ("p1", 1.0), ("p7", 7.0), ("p100", 100.0)] {
        for seed in 2001..=2004u64 {
            let path = format!("{folder}/{name}_{seed}.xyz");
            if std::path::Path::new(&path).exists() {
                continue;
            }
            let preparation = Preparation {
                disk_count: 5548,
                mixture: Mixture::default(),
                target: Target::Pressure(pressure),
                tolerance: 0.01,
                seed,
            };
            let relaxer = Staged::default();
            let prepared = prepare::<2, _>(&preparation, &law, &relaxer, &mut ())?;
            let packing = prepared.packing.get();
            let chosen = choose_centre(packing, &law, Centre::Backbone, seed)?;
            let side = packing.domain().lengths().ok_or("box")?[0];
            let circle = Circle::cut(packing, chosen, 0.480 * side)?;
            let at_rest = relaxer.relax(circle.packing.clone(), &law, &mut ())?;
            let outer = format!("{:?}", circle.outer_radius);
            jamscope::io::write_packing(&path, &at_rest.state, &[], &[("outer_radius", &outer), ("law", "hertzian")])?;
            println!("{path}: {:?} {:?}", at_rest.stop, prepared.cost.seconds);
        }
    }
    Ok(())
}
