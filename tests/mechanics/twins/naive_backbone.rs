//! The slow twin of the removal of rattlers: from scratch, all disks, until nothing changes.

/// Which disks remain when every mobile disk with fewer than `least` contacts among the remaining is taken out.
pub fn backbone(held: &[bool], contacts: &[(u32, u32)], least: usize) -> Vec<bool> {
    let mut remains = vec![true; held.len()];
    loop {
        let counts: Vec<usize> = (0..held.len()).map(|disk| contacts_within(disk, &remains, contacts)).collect();
        let next: Vec<bool> =
            (0..held.len()).map(|disk| held[disk] || (remains[disk] && counts[disk] >= least)).collect();
        if next == remains {
            return remains;
        }
        remains = next;
    }
}

/// Contacts of a disk with members of a set.
pub fn contacts_within(disk: usize, members: &[bool], contacts: &[(u32, u32)]) -> usize {
    let touches = |&&(a, b): &&(u32, u32)| {
        (a as usize == disk && members[b as usize]) || (b as usize == disk && members[a as usize])
    };
    contacts.iter().filter(touches).count()
}
