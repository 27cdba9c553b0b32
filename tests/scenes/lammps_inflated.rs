//! Inflated packings as LAMMPS left them, `fixtures/lammps/inflated`.

use std::f64::consts::PI;
use std::path::PathBuf;

use jamscope::network::ContactNetwork;
use jamscope::packing::{Domain, Packing};
use jamscope::vector::{Vector, difference, larger, norm};

/// Radius of the inflated disk, 0.5 before.
pub const INFLATED_RADIUS: f64 = 0.6;

pub fn fixture(name: &str) -> PathBuf {
    PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("fixtures").join(name)
}

pub fn text(name: &str) -> String {
    std::fs::read_to_string(fixture(name)).expect("fixture exists")
}

/// A table of LAMMPS: words of the header after `#`, rows of numbers.
pub struct Table {
    pub header: Vec<Vec<String>>,
    pub rows: Vec<Vec<f64>>,
}

impl Table {
    pub fn read(name: &str) -> Self {
        let text = text(name);
        let (header, rows): (Vec<&str>, Vec<&str>) = text.lines().partition(|line| line.starts_with('#'));
        let words = |line: &&str| line[1..].split_whitespace().map(|word| word.trim_matches('"').to_string()).collect();
        let numbers = |line: &&str| line.split_whitespace().map(|word| word.parse().expect("a number")).collect();
        Table { header: header.iter().map(words).collect(), rows: rows.iter().map(numbers).collect() }
    }

    /// The number that follows `key` in the header.
    pub fn find(&self, key: &str) -> Option<f64> {
        let pairs = || self.header.iter().flat_map(|line| line.windows(2)).filter(|pair| pair[0] == key);
        pairs().find_map(|pair| pair[1].parse().ok())
    }

    pub fn number(&self, key: &str) -> f64 {
        self.find(key).unwrap_or_else(|| panic!("no number {key} in the header"))
    }

    pub fn columns<const D: usize>(&self, from: usize) -> Vec<Vector<D>> {
        self.rows.iter().map(|row| std::array::from_fn(|d| row[from + d])).collect()
    }
}

/// An inflated packing of LAMMPS: mobile disks, the centre, the rim.
pub struct Inflated {
    pub name: String,
    pub table: Table,
    pub mobile_count: usize,
    pub outer_radius: f64,
    pub labels: Vec<u64>,
    pub after: Vec<Vector<2>>,
    pub rattler: Vec<bool>,
}

impl Inflated {
    pub fn read(name: &str) -> Self {
        let table = Table::read(&format!("lammps/inflated/{name}.txt"));
        Inflated {
            name: name.to_string(),
            mobile_count: table.number("n_mobile") as usize,
            outer_radius: table.number("r_out"),
            labels: table.rows.iter().map(|row| row[0] as u64).collect(),
            after: table.columns(5),
            rattler: table.rows.iter().map(|row| row[7] != 0.0).collect(),
            table,
        }
    }

    pub fn packing(&self, positions: Vec<Vector<2>>, centre_radius: f64) -> Packing<2> {
        let mut radii: Vec<f64> = self.table.rows.iter().map(|row| row[2]).collect();
        radii[self.mobile_count] = centre_radius;
        let held = (0..radii.len()).map(|disk| disk >= self.mobile_count).collect();
        Packing::new(Domain::Open, positions, radii)
            .and_then(|packing| packing.with_held(held))
            .and_then(|packing| packing.with_labels(self.labels.clone()))
            .expect("valid")
    }

    pub fn before(&self, centre_radius: f64) -> Packing<2> {
        self.packing(self.table.columns(3), centre_radius)
    }

    pub fn pressure(&self, network: &ContactNetwork<2>) -> f64 {
        let volume = PI * self.outer_radius * self.outer_radius;
        network.cluster_pressure(volume, |disk| disk > self.mobile_count)
    }

    /// Largest distance of a mobile disk from where LAMMPS has it, over those that are rattlers in neither.
    pub fn distance(&self, packing: &Packing<2>, network: &ContactNetwork<2>) -> f64 {
        (0..self.mobile_count)
            .filter(|&disk| network.backbone[disk] && !self.rattler[disk])
            .map(|disk| norm(difference(packing.positions()[disk], self.after[disk])))
            .fold(0.0, larger)
    }
}
