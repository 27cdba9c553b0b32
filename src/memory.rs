//! [`Memory`]: the memory limit for a count, and [`TooLarge`]: a count refused before any allocation.
//!
//! A failed allocation ends a process without a message, and a system that swaps does not respond. Counts from the user
//! are therefore checked against index types and against the memory of the machine beforehand.

use std::path::Path;

/// Memory limit if the system reports none: that of a large workstation \[bytes\].
pub const FIXED_LIMIT: u64 = 64 << 30;

/// The memory that a process may use.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Memory {
    /// The limit \[bytes\].
    pub bytes: u64,
    /// The origin of this limit.
    pub origin: &'static str,
}

impl Memory {
    /// The memory of this machine: the minimum of the installed memory, the limit of a control group (a container, a
    /// batch job), and the limit of the address space. Outside Linux [`FIXED_LIMIT`].
    ///
    /// Installed instead of free memory, because free memory varies with time, and so would the refusals.
    pub fn of_machine() -> Self {
        let read = |path: &str| std::fs::read_to_string(path).ok();
        let mut found = Vec::new();
        let mut add = |bytes: Option<u64>, origin| found.extend(bytes.map(|bytes| Memory { bytes, origin }));
        add(read("/proc/meminfo").and_then(|text| installed(&text)), "the memory of this machine");
        add(read("/proc/self/cgroup").and_then(|text| control_group(&text)), "the memory limit of its control group");
        add(read("/proc/self/limits").and_then(|text| address_space(&text)), "the limit on its address space");
        let fixed =
            Memory { bytes: FIXED_LIMIT, origin: "a fixed limit, because this system does not report its memory" };
        found.into_iter().min_by_key(|memory| memory.bytes).unwrap_or(fixed)
    }

    /// Checks whether a count fits, with `bytes_each` bytes each.
    ///
    /// # Errors
    /// [`TooLarge`] with the largest count that fits.
    pub fn check(self, field: &str, value: usize, bytes_each: f64) -> Result<(), TooLarge> {
        let limit = (self.bytes as f64 / bytes_each) as u64;
        let limit = Limit { largest: limit, reason: self.origin };
        limit.check(field, value, bytes_each)
    }
}

/// The largest count of a quantity, with a reason.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Limit {
    /// The largest count.
    pub largest: u64,
    /// The reason.
    pub reason: &'static str,
}

impl Limit {
    /// Checks whether a count is within the limit; `bytes_each` is the memory for one.
    ///
    /// # Errors
    /// [`TooLarge`] with field, value, limit and the memory needed.
    pub fn check(self, field: &str, value: usize, bytes_each: f64) -> Result<(), TooLarge> {
        let Limit { largest, reason } = self;
        if value as u64 <= largest {
            return Ok(());
        }
        Err(TooLarge { field: field.into(), value, limit: largest, reason, bytes: value as f64 * bytes_each })
    }
}

/// A count exceeds the memory or an index type.
#[derive(Debug, Clone, PartialEq, thiserror::Error)]
#[error("{field} = {value}: must be at most {limit} ({reason}); {value} would take {} of memory", amount(*bytes))]
pub struct TooLarge {
    /// The field of the settings, or the argument.
    pub field: String,
    /// The count given.
    pub value: usize,
    /// The largest count possible.
    pub limit: u64,
    /// The reason for the limit.
    pub reason: &'static str,
    /// The memory needed \[bytes\].
    pub bytes: f64,
}

/// A number of bytes in a suitable unit.
fn amount(bytes: f64) -> String {
    let units = ["bytes", "kB", "MB", "GB", "TB"];
    let mut unit = 0;
    let mut value = bytes;
    while value >= 1000.0 && unit + 1 < units.len() {
        value /= 1000.0;
        unit += 1;
    }
    if value < 1e6 { format!("{value:.1} {}", units[unit]) } else { format!("{value:.1e} {}", units[unit]) }
}

/// `MemTotal` of /proc/meminfo.
fn installed(text: &str) -> Option<u64> {
    let line = text.lines().find(|line| line.starts_with("MemTotal:"))?;
    line.split_whitespace().nth(1)?.parse::<u64>().ok()?.checked_mul(1024)
}

/// The smallest memory limit of the control group and those above it, version 2 or 1.
fn control_group(text: &str) -> Option<u64> {
    let least = |root: &str, file: &str, group: &str| {
        let limit = |folder: &Path| std::fs::read_to_string(folder.join(file)).ok()?.trim().parse::<u64>().ok();
        let root = Path::new(root);
        let own = root.join(group.trim_start_matches('/'));
        own.ancestors().take_while(|folder| folder.starts_with(root)).filter_map(limit).min()
    };
    // A line is `number:controllers:group`; version 2 has number 0 and names no controllers.
    let of_line = |line: &str| {
        let (controllers, group) = line.split_once(':')?.1.split_once(':')?;
        match controllers {
            "" => least("/sys/fs/cgroup", "memory.max", group),
            "memory" => least("/sys/fs/cgroup/memory", "memory.limit_in_bytes", group),
            _ => None,
        }
    };
    text.lines().filter_map(of_line).min()
}

/// `Max address space` of /proc/self/limits, unless it is unlimited.
fn address_space(text: &str) -> Option<u64> {
    text.lines().find_map(|line| line.strip_prefix("Max address space"))?.split_whitespace().next()?.parse().ok()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_limits_of_linux_are_read() {
        assert_eq!(installed("MemTotal:       16000 kB\nMemFree: 1 kB\n"), Some(16_384_000));
        assert_eq!(
            address_space("Max address space         4096                 unlimited            bytes\n"),
            Some(4096)
        );
        assert_eq!(address_space("Max address space         unlimited            unlimited            bytes\n"), None);
        assert_eq!(control_group("no such line"), None);
        assert!(Memory::of_machine().bytes > 0);
    }

    #[test]
    fn a_count_is_refused_with_field_value_limit_and_memory() {
        let memory = Memory { bytes: 16_000_000_000, origin: "the memory of this machine" };
        assert_eq!(memory.check("disk_count", 16_000_000, 1000.0), Ok(()));
        let message = memory.check("disk_count", 1_000_000_000_000, 1000.0).expect_err("too many").to_string();
        let expected = "disk_count = 1000000000000: must be at most 16000000 (the memory of this machine); 1000000000000 would take \
                        1000.0 TB of memory";
        assert_eq!(message, expected);
        // The largest count does not overflow.
        assert!(memory.check("disk_count", usize::MAX, 1e3).is_err());
    }
}
