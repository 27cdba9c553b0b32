//! `NodeSolution`: a solution stored at nodes between the rim and an inner circle, and the march that makes it.
//!
//! Two solutions that vanish at the rim are integrated inward and kept orthogonal ([`Inward`]). Who knows their
//! combination at the inner circle gets the solution at every node, evaluated outward.

use crate::reference::Annulus;
use crate::reference::angular_modes::first_order_system::{Equations, State, System};
use crate::reference::angular_modes::solution_basis::{Frame, Triangle};
use crate::reference::angular_modes::{AngularModeError, Complex, ModeAmplitudes, ModeState, times_i};

/// Largest number of nodes of a solution: 18 MB, and 58 MB during its computation.
pub const NODE_LIMIT: usize = 200_000;

/// The solutions that vanish at the rim, at every node.
pub(super) struct Inward {
    /// From R inward.
    pub(super) radii: Vec<f64>,
    pub(super) frames: Vec<Frame>,
    triangles: Vec<Triangle>,
}

impl Inward {
    /// From the rim of `annulus` to its inner circle.
    ///
    /// # Errors
    /// More than [`NODE_LIMIT`] nodes needed; √|Γ| R above 2⁴².
    pub(super) fn march(annulus: Annulus, system: &System, mode: u32) -> Result<Self, AngularModeError> {
        let radii = node_radii(annulus, system, mode)?;
        let mut frames = vec![Frame::held(system, annulus.outer_radius())];
        let mut triangles = Vec::with_capacity(radii.len() - 1);
        for pair in radii.windows(2) {
            let (frame, triangle) = frames[frames.len() - 1].advance(system, pair[0], (pair[0] - pair[1]) / pair[0]);
            frames.push(frame);
            triangles.push(triangle);
        }
        Ok(Inward { radii, frames, triangles })
    }

    /// The frame at the inner circle.
    pub(super) fn inner_frame(&self) -> &Frame {
        &self.frames[self.frames.len() - 1]
    }

    /// Outward: the solution at every node, from its `coefficients` at the inner circle.
    pub(super) fn outward(&self, system: System, mut coefficients: [Complex<f64>; 2]) -> NodeSolution {
        let mut nodes = Vec::with_capacity(self.radii.len());
        for index in (0..self.radii.len()).rev() {
            if index + 1 < self.radii.len() {
                coefficients = self.triangles[index].undo(coefficients);
            }
            nodes.push(Node { radius: self.radii[index], state: self.frames[index].combine(coefficients) });
        }
        nodes.reverse();
        NodeSolution { system, nodes }
    }
}

/// A solution of the first-order equations between the nodes.
#[derive(Debug, Clone)]
pub(super) struct NodeSolution {
    system: System,
    /// From the rim inward; at least two.
    nodes: Vec<Node>,
}

/// The solution at one radius.
#[derive(Debug, Clone, Copy)]
struct Node {
    radius: f64,
    state: State,
}

impl NodeSolution {
    pub(super) fn node_count(&self) -> usize {
        self.nodes.len()
    }

    /// Replaces U, v and d at the inner circle, which are known exactly.
    pub(super) fn set_inner_displacement(&mut self, displacement: [Complex<f64>; 3]) {
        if let Some(last) = self.nodes.last_mut() {
            last.state[..displacement.len()].copy_from_slice(&displacement);
        }
    }

    /// The node nearest to `radius`.
    fn nearest(&self, radius: f64) -> &Node {
        // There are at least two nodes, R and a; the search finds the first one not outside `radius`.
        let inside = self.nodes.partition_point(|node| node.radius > radius).clamp(1, self.nodes.len() - 1);
        let (outer, inner) = (&self.nodes[inside - 1], &self.nodes[inside]);
        if outer.radius - radius < radius - inner.radius { outer } else { inner }
    }

    /// The amplitudes at a radius between the nodes.
    pub(super) fn at(&self, radius: f64) -> ModeState {
        let node = self.nearest(radius);
        let state = self.system.advance(node.radius, (node.radius - radius) / node.radius, node.state);
        let [radial_slope, quarter_slope] = self.system.displacement_slope(state);
        ModeState {
            value: ModeAmplitudes { radial: state[0], transverse: -times_i(state[1]) },
            derivative: ModeAmplitudes { radial: radial_slope / radius, transverse: -times_i(quarter_slope) / radius },
        }
    }
}

/// From R inward to a, each within the reach of the series about the previous one.
fn node_radii(annulus: Annulus, system: &System, mode: u32) -> Result<Vec<f64>, AngularModeError> {
    let (inner, outer) = (annulus.inner_radius(), annulus.outer_radius());
    let node_estimate = (4.0 + system.mode) * libm::log(outer / inner) + system.wavenumber() * (outer - inner);
    if node_estimate.is_nan() || node_estimate > NODE_LIMIT as f64 {
        return Err(AngularModeError::TooManyNodes { mode, node_estimate, node_limit: NODE_LIMIT });
    }
    // Nodes are then at least 2¹⁰ roundings of R apart.
    let System { even, odd, .. } = *system;
    if system.wavenumber() * outer > libm::exp2(42.0) {
        return Err(AngularModeError::ScreeningTooLarge { even, odd, outer_radius: outer });
    }
    let mut radii = vec![outer];
    let mut radius = outer;
    while radius > inner {
        let next = radius - system.reach(radius) * radius;
        radius = if next > inner { next } else { inner };
        radii.push(radius);
    }
    Ok(radii)
}
