//! Where damped motions end after an inflation: energies and Δp by implicit and by explicit dynamics, with both damping laws.
//!
//! ```text
//! cargo run --release --features measurements --example damped_ends -- [--disks N] [--pressures A,B,...] [--seeds FIRST,COUNT]
//!     [--rates A,B,...] [--law constant|viscoelastic] [--tolerances A,B,...] [--methods implicit,share,fixed] [--starts DIR]
//! ```
//!
//! Random points are quenched at a pressure by FIRE and Newton's method, cut to a circle with a held rim and brought to rest; the centre grows
//! by 0.1. From there: *implicit*, [`ImplicitDynamics`] with its defaults at each tolerance; *share*, [`DampedDynamics`] at its default share of
//! the longest stable step; *fixed*, the same with steps of 4·10⁻⁴. Explicit motions end at a residual of 0.01, from where Newton's method goes
//! on. A line each has the elastic energy before the inflation, of the blow, and at rest; what damping took and what the steps left
//! unaccounted for; Δp; contacts at rest; evaluations, factorisations and seconds. Then for each pressure, law and method the mean of E/E_before and of Δp with
//! its standard error. With `--starts`, circles at rest are kept in files there and read again.

use std::collections::BTreeMap;
use std::error::Error;
use std::path::Path;

use jamscope::inflation::{Centre, Circle, choose_centre};
use jamscope::io::{read_packing, write_packing};
use jamscope::law::Hertzian;
use jamscope::law::damping::{ConstantDamping, DampingChoice, ViscoelasticDamping};
use jamscope::network::ContactNetwork;
use jamscope::packing::{Mixture, Packing};
use jamscope::preparation::{Preparation, Target, prepare_with};
use jamscope::relax::{
    Cost, DampedDynamics, ForceLimit, ImplicitDynamics, Newton, Outcome, Relaxer, Staged, Stop, TimeStep,
};

/// Where an explicit motion is left to Newton's method.
const EXPLICIT_LIMIT: ForceLimit = ForceLimit::Relative(0.01);

/// Step of explicit dynamics that nothing adapts \[time\].
const FIXED_STEP: f64 = 4e-4;

/// Radius of the circle over the side of the box: the study's smallest size.
const OUTER_RADIUS_OVER_SIDE: f64 = 0.480;

struct Settings {
    disk_count: usize,
    pressures: Vec<f64>,
    seeds: (u64, u64),
    dampings: Vec<DampingChoice>,
    tolerances: Vec<f64>,
    methods: Vec<String>,
    starts: Option<String>,
}

fn main() -> Result<(), Box<dyn Error>> {
    let settings = settings()?;
    let mut cells: BTreeMap<String, Vec<(f64, f64)>> = BTreeMap::new();
    for &pressure in &settings.pressures {
        for seed in settings.seeds.0..settings.seeds.0 + settings.seeds.1 {
            let circle = at_rest(&settings, pressure, seed)?;
            for &damping in &settings.dampings {
                for (name, relaxer) in relaxers(&settings, damping) {
                    let (ratio, change) = row(&circle, &format!("p {pressure} seed {seed} {name}"), &relaxer)?;
                    if ratio.is_finite() {
                        cells.entry(format!("p {pressure} {name}")).or_default().push((ratio, change));
                    }
                }
            }
        }
    }
    for (name, rows) in &cells {
        let [(ratio, ratio_error), (change, change_error)] =
            [mean(rows.iter().map(|row| row.0)), mean(rows.iter().map(|row| row.1))];
        println!(
            "{name}: {} motions, E/E_before {ratio:.4} ± {ratio_error:.4}, Δp {change:.4} ± {change_error:.4}",
            rows.len()
        );
    }
    Ok(())
}

fn settings() -> Result<Settings, Box<dyn Error>> {
    let mut settings = Settings {
        disk_count: 5548,
        pressures: vec![0.05, 0.3, 1.0],
        seeds: (2001, 4),
        dampings: vec![constant(500.0), viscoelastic(500.0)],
        tolerances: vec![ImplicitDynamics::default().tolerance],
        methods: vec!["implicit".into(), "share".into()],
        starts: None,
    };
    let mut arguments = std::env::args().skip(1);
    while let Some(argument) = arguments.next() {
        let value = arguments.next().ok_or_else(|| format!("{argument} needs a value"))?;
        let numbers = || value.split(',').map(str::parse::<f64>).collect::<Result<Vec<_>, _>>();
        match argument.as_str() {
            "--disks" => settings.disk_count = value.parse()?,
            "--pressures" => settings.pressures = numbers()?,
            "--seeds" => {
                let (first, count) = value.split_once(',').ok_or("--seeds FIRST,COUNT")?;
                settings.seeds = (first.parse()?, count.parse()?);
            }
            "--rates" => {
                settings.dampings =
                    numbers()?.into_iter().flat_map(|rate| [constant(rate), viscoelastic(rate)]).collect();
            }
            "--tolerances" => settings.tolerances = numbers()?,
            "--law" => settings.dampings.retain(|damping| law_of(*damping) == value),
            "--methods" => settings.methods = value.split(',').map(String::from).collect(),
            "--starts" => settings.starts = Some(value),
            _ => return Err(format!("unknown argument {argument}").into()),
        }
    }
    Ok(settings)
}

fn law_of(damping: DampingChoice) -> &'static str {
    match damping {
        DampingChoice::Constant(_) => "constant",
        DampingChoice::Viscoelastic(_) => "viscoelastic",
    }
}

fn constant(rate: f64) -> DampingChoice {
    DampingChoice::Constant(ConstantDamping { rate })
}

fn viscoelastic(rate: f64) -> DampingChoice {
    DampingChoice::Viscoelastic(ViscoelasticDamping { rate })
}

/// How a motion is followed.
enum Method {
    Implicit(ImplicitDynamics),
    Explicit(DampedDynamics),
}

fn relaxers(settings: &Settings, damping: DampingChoice) -> Vec<(String, Method)> {
    let law = format!("{} {}", law_of(damping), damping.rate());
    let mut relaxers = Vec::new();
    for method in &settings.methods {
        let explicit = |time_step| {
            Method::Explicit(DampedDynamics { damping, limit: EXPLICIT_LIMIT, time_step, ..DampedDynamics::default() })
        };
        match method.as_str() {
            "implicit" => relaxers.extend(settings.tolerances.iter().map(|&tolerance| {
                let dynamics = ImplicitDynamics { damping, tolerance, ..ImplicitDynamics::default() };
                (format!("{law} implicit {tolerance}"), Method::Implicit(dynamics))
            })),
            "share" => relaxers.push((format!("{law} share"), explicit(TimeStep::default()))),
            _ => relaxers.push((format!("{law} fixed"), explicit(TimeStep::Fixed(FIXED_STEP)))),
        }
    }
    relaxers
}

struct Start {
    packing: Packing<2>,
    centre: usize,
    outer_radius: f64,
}

/// A circle at rest, from its file if there is one.
fn at_rest(settings: &Settings, pressure: f64, seed: u64) -> Result<Start, Box<dyn Error>> {
    let law = Hertzian::default();
    let disk_count = settings.disk_count;
    let file = settings.starts.as_ref().map(|folder| format!("{folder}/N{disk_count}_p{pressure}_{seed}.xyz"));
    if let Some(file) = file.as_ref().filter(|file| Path::new(file).exists()) {
        let packing = read_packing::<2>(file)?;
        let centre = (0..packing.len()).find(|&disk| packing.positions()[disk] == [0.0; 2]).ok_or("no centre")?;
        let text = std::fs::read_to_string(file)?;
        let outer_radius = text.split("outer_radius=").nth(1).and_then(|rest| rest.split_whitespace().next());
        return Ok(Start { packing, centre, outer_radius: outer_radius.ok_or("no outer_radius")?.parse()? });
    }
    let (mixture, target) = (Mixture::default(), Target::Pressure(pressure));
    let preparation = Preparation { disk_count, mixture, target, tolerance: 0.01, seed, ..Preparation::default() };
    let relaxer = Staged::default();
    let prepared = prepare_with::<2>(&preparation, &law, &relaxer, &mut ())?;
    let packing = prepared.packing.get();
    let chosen = choose_centre(packing, &law, Centre::Backbone, seed)?;
    let side = packing.domain().lengths().ok_or("the packing is not periodic")?[0];
    let circle = Circle::cut(packing, chosen, OUTER_RADIUS_OVER_SIDE * side)?;
    let outcome = relaxer.relax(circle.packing.clone(), &law, &mut ())?;
    let stop = outcome.stop;
    let at_rest = outcome.converged().map_err(|_| format!("the circle is not at rest: {stop:?}"))?.into_inner();
    if let Some(file) = file {
        if let Some(folder) = Path::new(&file).parent() {
            std::fs::create_dir_all(folder)?;
        }
        write_packing(&file, &at_rest, &[], &[("outer_radius", &format!("{:?}", circle.outer_radius))])?;
    }
    Ok(Start { packing: at_rest, centre: circle.centre, outer_radius: circle.outer_radius })
}

/// Moves the disks, prints a line and returns E/E_before and Δp; NaN where the end is not at rest.
fn row(start: &Start, name: &str, method: &Method) -> Result<(f64, f64), Box<dyn Error>> {
    let law = Hertzian::default();
    let radius = start.packing.radii()[start.centre];
    let grown = start.packing.clone().with_radius(start.centre, radius + 0.1)?;
    let (outcome, first) = match method {
        Method::Implicit(dynamics) => (dynamics.relax(grown, &law, &mut ())?, Cost::default()),
        Method::Explicit(dynamics) => {
            let Outcome { state, cost, stop, .. } = dynamics.relax(grown, &law, &mut ())?;
            if !matches!(stop, Stop::Converged(_)) {
                println!("{name}: {stop:?}");
                return Ok((f64::NAN, f64::NAN));
            }
            (Newton::default().relax(state, &law, &mut ())?, cost)
        }
    };
    let cost = first.plus(outcome.cost);
    let account = cost.energies.unwrap_or_default();
    let networks = [ContactNetwork::new(&start.packing, &law)?, ContactNetwork::new(&outcome.state, &law)?];
    let [before, after] = [&networks[0], &networks[1]].map(|network| pressure(network, start));
    println!(
        "{name}: {:?} E_before {:.6e} blow {:.6e} E {:.12e} damped {:.4e} unaccounted {:.1e} Δp {:.5} contacts {} of {} \
         evaluations {} factorisations {} seconds {:.1}",
        outcome.stop,
        networks[0].energy(),
        account.before,
        networks[1].energy(),
        account.damped,
        account.imbalance,
        after - before,
        networks[1].contacts.len(),
        networks[0].contacts.len(),
        cost.force_evaluation_count,
        cost.factorisation_count,
        cost.seconds,
    );
    let at_rest = matches!(outcome.stop, Stop::Converged(_));
    let ratio = networks[1].energy() / networks[0].energy();
    Ok(if at_rest { (ratio, after - before) } else { (f64::NAN, f64::NAN) })
}

/// Virial of the disks within r_out over 2π r_out²; contacts with held disks count half.
fn pressure(network: &ContactNetwork<2>, start: &Start) -> f64 {
    let middle = start.centre;
    network.cluster_pressure(std::f64::consts::PI * start.outer_radius * start.outer_radius, |disk| disk > middle)
}

/// Mean and its standard error; the latter NaN for one value.
fn mean(values: impl Iterator<Item = f64> + Clone) -> (f64, f64) {
    let count = values.clone().count() as f64;
    let mean = values.clone().sum::<f64>() / count;
    let squares: f64 = values.map(|value| (value - mean) * (value - mean)).sum();
    (mean, (squares / (count * (count - 1.0))).sqrt())
}
