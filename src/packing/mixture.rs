//! The distribution of radii.

use serde::{Deserialize, Serialize};

use crate::packing::error::{LARGEST_RADIUS, PackingError, SMALLEST_RADIUS};

/// One component of a mixture.
#[derive(Debug, Clone, Copy, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Component {
    /// Radius \[length\].
    pub radius: f64,
    /// Share of the disks by number, relative to the other components \[1\].
    pub share: f64,
}

/// A finite mixture of radii, in the proportions given.
#[derive(Debug, Clone, PartialEq, Serialize, Deserialize)]
#[serde(transparent)]
pub struct Mixture {
    /// The components.
    pub components: Vec<Component>,
}

impl Default for Mixture {
    /// Equal numbers of radii 0.5 and 0.7. Source: the study.
    fn default() -> Self {
        Mixture { components: vec![Component { radius: 0.5, share: 1.0 }, Component { radius: 0.7, share: 1.0 }] }
    }
}

impl Mixture {
    /// All disks of one radius.
    pub fn monodisperse(radius: f64) -> Self {
        Mixture { components: vec![Component { radius, share: 1.0 }] }
    }

    /// Radii of `count` disks \[length\], in the order of the components.
    ///
    /// The numbers are the shares rounded by the largest-remainder method. They add up to `count` and differ from the
    /// exact proportions by less than one disk per component.
    ///
    /// # Errors
    /// See [`check`](Self::check).
    pub fn radii(&self, count: usize) -> Result<Vec<f64>, PackingError> {
        self.check(count)?;
        let total: f64 = self.components.iter().map(|kind| kind.share).sum();
        let exact: Vec<f64> = self.components.iter().map(|kind| kind.share / total * count as f64).collect();
        let mut counts: Vec<usize> = exact.iter().map(|&number| number.floor() as usize).collect();
        let mut order: Vec<usize> = (0..counts.len()).collect();
        order.sort_by(|&a, &b| (exact[b] - exact[b].floor()).total_cmp(&(exact[a] - exact[a].floor())));
        let missing = count.saturating_sub(counts.iter().sum());
        for &kind in order.iter().cycle().take(missing) {
            counts[kind] += 1;
        }
        Ok(self
            .components
            .iter()
            .zip(counts)
            .flat_map(|(kind, number)| std::iter::repeat_n(kind.radius, number))
            .collect())
    }

    /// Checks whether `count` disks of this mixture are possible, without allocation.
    ///
    /// # Errors
    /// No component, a radius outside [`SMALLEST_RADIUS`] to [`LARGEST_RADIUS`], a share or a sum of shares that is not
    /// positive and finite, no disk, or more disks than an index can count.
    pub fn check(&self, count: usize) -> Result<(), PackingError> {
        if count == 0 || self.components.is_empty() {
            return Err(PackingError::NoDisks);
        }
        for (component, kind) in self.components.iter().enumerate() {
            if !(SMALLEST_RADIUS..=LARGEST_RADIUS).contains(&kind.radius) {
                return Err(PackingError::MixtureRadiusOutOfRange { component, radius: kind.radius });
            }
            if !(kind.share.is_finite() && kind.share > 0.0) {
                return Err(PackingError::MixtureShareNotPositive { component, share: kind.share });
            }
        }
        let total: f64 = self.components.iter().map(|kind| kind.share).sum();
        if !total.is_finite() {
            return Err(PackingError::MixtureShareNotPositive { component: self.components.len() - 1, share: total });
        }
        if count > u32::MAX as usize {
            return Err(PackingError::TooManyDisks { count });
        }
        Ok(())
    }

    /// The smallest radius \[length\].
    pub fn smallest_radius(&self) -> f64 {
        self.components.iter().map(|kind| kind.radius).fold(f64::INFINITY, f64::min)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn shares_add_up() {
        let radii = Mixture::default().radii(7).expect("valid mixture");
        assert_eq!(radii.len(), 7);
        let small = radii.iter().filter(|&&radius| radius == 0.5).count();
        assert!((3..=4).contains(&small));
    }
}
