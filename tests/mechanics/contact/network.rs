//! The backbone against a naive one, and crystals in closed form.

use super::*;

proptest! {
    #![proptest_config(cases(128))]

    #[test]
    fn the_backbone_is_the_largest_set_with_three_contacts_each(
        seed: u64, count in 1usize..60, side in 1.5..3.5f64, held_share in 0.0..0.3f64,
    ) {
        let packing = disks(seed, count, periodic([on_grid(side); 2]), held_share);
        let network = ContactNetwork::new(&packing, &Hertzian::default()).expect("no coincidence");
        let links: Vec<(u32, u32)> = network.contacts.iter().map(|contact| (contact.first, contact.second)).collect();
        // Maximal: the naive removal, which takes out only what no such set can contain, leaves the same disks.
        prop_assert_eq!(&network.backbone, &naive_backbone::backbone(packing.held(), &links, 3));
        let mut ends = 0;
        for disk in 0..packing.len() {
            let contacts = contacts_within(disk, &network.backbone, &links);
            prop_assert!(packing.held()[disk] || !network.backbone[disk] || contacts >= 3);
            prop_assert!(!packing.held()[disk] || network.backbone[disk]);
            if network.backbone[disk] && !packing.held()[disk] {
                ends += contacts;
            }
        }
        // Z: mean number of contacts of the mobile disks of the backbone.
        let mobile = network.backbone_count();
        prop_assert_eq!(network.coordination(), if mobile == 0 { 0.0 } else { ends as f64 / mobile as f64 });
        prop_assert_eq!(mobile + network.rattlers().count() + packing.held().iter().filter(|&&held| held).count(), count);
        // Each contact gives half of its virial to either disk: two sums of the same terms.
        let volume = packing.domain().volume().expect("periodic");
        // Contacts with the rim count half: none of them, or all.
        prop_assert_eq!(network.cluster_pressure(volume, |_| false), network.pressure(volume));
        prop_assert_eq!(network.cluster_pressure(volume, |_| true), 0.5 * network.pressure(volume));
        let (stress, virials) = (network.stress(volume), network.disk_virials());
        for (a, b) in [(0, 0), (0, 1), (1, 0), (1, 1)] {
            let sum: f64 = virials.iter().map(|virial| virial[a][b]).sum();
            let scale = (virials.len() + network.contacts.len() + 16) as f64 * EPSILON * 2.0 * network.pressure(volume);
            prop_assert!((sum / volume - stress[a][b]).abs() <= scale, "{sum} {:?}", stress);
        }
        // Once more, within the backbone, takes nothing out.
        let kept: Vec<usize> = (0..packing.len()).filter(|&disk| network.backbone[disk]).collect();
        let index = |disk: u32| kept.iter().position(|&other| other == disk as usize).expect("on the backbone") as u32;
        let inner: Vec<(u32, u32)> = network.backbone_contacts().map(|c| (index(c.first), index(c.second))).collect();
        let held: Vec<bool> = kept.iter().map(|&disk| packing.held()[disk]).collect();
        prop_assert!(backbone::<2>(&held, &inner).iter().all(|&member| member));
    }
}

/// A triangular lattice of disks a apart, in a periodic box: Z = 6, and per disk 3 contacts, so with a cell of √3 a²/2
///
/// ```text
/// E = 3 N u(δ)      p = 3 N F a / (2 V) = √3 F / a
/// ```
#[test]
fn a_triangular_lattice_has_six_contacts_and_its_pressure_and_energy_in_closed_form() {
    fn check(law: &dyn PairLaw) {
        let (columns, rows, radius, apart) = (12usize, 14usize, 0.5, 0.97);
        let height = 3f64.sqrt() / 2.0 * apart;
        let positions: Vec<Vector<2>> = (0..rows * columns)
            .map(|disk| (disk / columns, disk % columns))
            .map(|(row, column)| [(column as f64 + 0.5 * (row % 2) as f64) * apart, row as f64 * height])
            .collect();
        let lengths = [columns as f64 * apart, rows as f64 * height];
        let count = positions.len();
        let domain = Domain::rectangular([0.0; 2], lengths);
        let packing = Packing::new(domain, positions, vec![radius; count]).expect("valid");
        let network = ContactNetwork::new(&packing, law).expect("no coincidence");
        let overlap = 2.0 * radius - apart;
        let force = law.force(law.coefficient(radius, radius), overlap);
        assert_eq!(network.contacts.len(), 3 * count);
        assert_eq!(network.coordination(), 6.0);
        assert_eq!(network.rattlers().count(), 0);
        // Coordinates up to 14 carry 2e-15, an overlap of 0.03 twice that: 1.3e-13 of it, α times that in the energy.
        let tolerance = 1e-12;
        let energy = 3.0 * count as f64 * law.energy(force, overlap);
        assert!((network.energy() / energy - 1.0).abs() < tolerance, "{law:?}: energy");
        let pressure = 3f64.sqrt() * force / apart;
        let volume = lengths[0] * lengths[1];
        assert!((network.pressure(volume) / pressure - 1.0).abs() < tolerance, "{law:?}: pressure");
        // Isotropic, and no net force: six equal forces cancel to their rounding.
        let stress = network.stress(volume);
        assert!((stress[0][0] / stress[1][1] - 1.0).abs() < tolerance && stress[0][1].abs() < tolerance * pressure);
        assert!(network.largest_net_force() < 6.0 * tolerance * force, "{law:?}: net force");
        assert!((network.mean_contact_force() / force - 1.0).abs() < tolerance);
    }
    check(&Hertzian::default());
    check(&Hookean::default());
    check(&PowerLaw { energy_scale: 2.0, exponent: 3.3 });
}

/// A face-centred cubic crystal of balls a apart: Z = 12, 6 contacts a ball in a cell of a³/√2, so p = 2√2 F/a².
#[test]
fn a_cubic_crystal_has_twelve_contacts_and_its_pressure_in_closed_form() {
    let (cells, radius, apart) = (3usize, 0.5, 0.98);
    let edge = SQRT_2 * apart;
    let corners = [[0.0, 0.0, 0.0], [0.5, 0.5, 0.0], [0.5, 0.0, 0.5], [0.0, 0.5, 0.5]];
    let positions: Vec<Vector<3>> = (0..4 * cells.pow(3))
        .map(|ball| {
            let cell = [ball / 4 % cells, ball / 4 / cells % cells, ball / 4 / cells / cells];
            std::array::from_fn(|d| (cell[d] as f64 + corners[ball % 4][d]) * edge)
        })
        .collect();
    let count = positions.len();
    let side = cells as f64 * edge;
    let packing = Packing::new(Domain::<3>::cube(side), positions, vec![radius; count]).expect("valid");
    let law = Hertzian::default();
    let network = ContactNetwork::new(&packing, &law).expect("no coincidence");
    let force = law.force(law.coefficient(radius, radius), 2.0 * radius - apart);
    assert_eq!(network.contacts.len(), 6 * count);
    assert_eq!(network.coordination(), 12.0);
    // Coordinates up to 4 carry 4e-16 each, overlaps of 0.02: 4e-14, times 3/2.
    let pressure = 2.0 * SQRT_2 * force / (apart * apart);
    assert!((network.pressure(side.powi(3)) / pressure - 1.0).abs() < 1e-12);
}
