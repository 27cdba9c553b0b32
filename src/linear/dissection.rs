//! Nested dissection from positions: the order in which disks are eliminated.
//!
//! The positions of the disks are known, so the ordering need not be found from the matrix entries alone. The disks are
//! split in halves at the median of their widest coordinate. The *separator* is a smallest set of disks that touches
//! every contact across the cut (Kőnig: it is as large as a largest matching). Both halves come first, each dissected
//! in the same way; the separator comes last:
//!
//! ```text
//! order(S) = order(left of S), order(right of S), separator
//! ```
//!
//! The order is then rearranged so that each disk directly follows those that depend on it alone (a postorder of the
//! elimination tree). This does not change the factor, but makes its columns contiguous.
//!
//! # Source
//! George (1973), SIAM J. Numer. Anal. 10, 345 (nested dissection); Kőnig (1931) and Kuhn (1955), Nav. Res. Logist. Q.
//! 2, 83 (cover and matching); Liu (1990), SIAM J. Matrix Anal. Appl. 11, 134 (elimination trees).

use crate::sparse::Graph;
use crate::vector::Vector;

/// Sets up to this size are not divided further. Changes speed only.
const LEAF: usize = 12;

/// No vertex.
const NONE: u32 = u32::MAX;

/// Elimination order of the vertices of a graph with positions `points`: the vertex at each place of the order.
///
/// # Shape
/// One point per vertex.
///
/// # Cost
/// N log N for the cuts, and about N for the separators in two dimensions; N is the number of vertices.
pub(crate) fn nested_dissection<const D: usize>(points: &[Vector<D>], graph: &Graph) -> Vec<u32> {
    let count = points.len();
    let mut dissection = Dissection {
        points,
        graph,
        part: vec![0; count],
        part_count: 0,
        mate: vec![NONE; count],
        from: vec![NONE; count],
        order: Vec::with_capacity(count),
    };
    let mut all: Vec<u32> = (0..count as u32).collect();
    dissection.dissect(&mut all);
    postordered(&dissection.order, graph)
}

struct Dissection<'a, const D: usize> {
    points: &'a [Vector<D>],
    graph: &'a Graph,
    /// The part of the latest cut to which each vertex belongs.
    part: Vec<u32>,
    part_count: u32,
    /// The vertex with which each is matched across the cut.
    mate: Vec<u32>,
    /// The left vertex from which a search reached each right one.
    from: Vec<u32>,
    order: Vec<u32>,
}

impl<const D: usize> Dissection<'_, D> {
    fn dissect(&mut self, set: &mut [u32]) {
        if set.len() <= LEAF {
            self.order.extend_from_slice(set);
            return;
        }
        let axis = self.widest_axis(set);
        let points = self.points;
        // Vertices at equal coordinates are ordered by their index, so the cut is reproducible.
        let middle = set.len() / 2;
        set.select_nth_unstable_by(middle, |&a, &b| {
            points[a as usize][axis].total_cmp(&points[b as usize][axis]).then(a.cmp(&b))
        });
        let (left, right) = set.split_at_mut(middle);
        let (left_part, right_part) = (self.part_count + 1, self.part_count + 2);
        self.part_count += 2;
        for &vertex in left.iter() {
            self.part[vertex as usize] = left_part;
        }
        for &vertex in right.iter() {
            self.part[vertex as usize] = right_part;
        }
        let mut separator = self.separator(left, left_part, right_part);
        for &vertex in &separator {
            self.part[vertex as usize] = 0;
        }
        let (left_rest, right_rest) = (
            keep(left, |&v| self.part[v as usize] == left_part),
            keep(right, |&v| self.part[v as usize] == right_part),
        );
        self.dissect(left_rest);
        self.dissect(right_rest);
        let along = if D == 1 { axis } else { (axis + 1) % D };
        separator
            .sort_unstable_by(|&a, &b| points[a as usize][along].total_cmp(&points[b as usize][along]).then(a.cmp(&b)));
        self.order.append(&mut separator);
    }

    fn widest_axis(&self, set: &[u32]) -> usize {
        let width = |axis: usize| {
            let column = || set.iter().map(|&vertex| self.points[vertex as usize][axis]);
            column().fold(f64::NEG_INFINITY, f64::max) - column().fold(f64::INFINITY, f64::min)
        };
        (1..D).fold((0, width(0)), |best, axis| if width(axis) > best.1 { (axis, width(axis)) } else { best }).0
    }

    /// A smallest set of vertices that touches every edge between the two parts.
    fn separator(&mut self, left: &[u32], left_part: u32, right_part: u32) -> Vec<u32> {
        let graph = self.graph;
        let across = |part: &[u32], vertex: u32| -> bool {
            graph.neighbours(vertex).iter().any(|&other| part[other as usize] == right_part)
        };
        let boundary: Vec<u32> = left.iter().copied().filter(|&vertex| across(&self.part, vertex)).collect();
        for &vertex in &boundary {
            self.mate[vertex as usize] = NONE;
            for &other in graph.neighbours(vertex) {
                self.mate[other as usize] = NONE;
                self.from[other as usize] = NONE;
            }
        }
        // A greedy matching first; the rest by augmenting paths.
        for &vertex in &boundary {
            let free = graph.neighbours(vertex).iter().copied();
            let free = free.filter(|&other| self.part[other as usize] == right_part);
            if let Some(other) = free.into_iter().find(|&other| self.mate[other as usize] == NONE) {
                self.mate[vertex as usize] = other;
                self.mate[other as usize] = vertex;
            }
        }
        let mut reached = Vec::new();
        for &vertex in &boundary {
            if self.mate[vertex as usize] == NONE {
                let end = self.search(&[vertex], right_part, &mut reached);
                self.augment(end);
                self.forget(&mut reached);
            }
        }
        // Follow alternating paths from unmatched left vertices. The cover consists of the left vertices that are not
        // reached and the right vertices that are.
        let unmatched: Vec<u32> =
            boundary.iter().copied().filter(|&vertex| self.mate[vertex as usize] == NONE).collect();
        let end = self.search(&unmatched, right_part, &mut reached);
        debug_assert_eq!(end, NONE, "a largest matching has no augmenting path");
        let mut separator = Vec::new();
        for &other in &reached {
            separator.push(other);
            // Its mate on the left is reached through it, so it is not in the cover.
            self.part[self.mate[other as usize] as usize] = NONE;
        }
        for &vertex in &unmatched {
            self.part[vertex as usize] = NONE;
        }
        separator.extend(boundary.iter().copied().filter(|&vertex| self.part[vertex as usize] == left_part));
        for &vertex in &boundary {
            if self.part[vertex as usize] == NONE {
                self.part[vertex as usize] = left_part;
            }
        }
        self.forget(&mut reached);
        separator
    }

    /// Breadth-first search along alternating paths. Returns the unmatched right vertex at the end of a path, or `NONE`
    /// with all vertices reached.
    fn search(&mut self, starts: &[u32], right_part: u32, reached: &mut Vec<u32>) -> u32 {
        let mut queue = starts.to_vec();
        let mut next = 0;
        while next < queue.len() {
            let vertex = queue[next];
            next += 1;
            for &other in self.graph.neighbours(vertex) {
                if self.part[other as usize] != right_part || self.from[other as usize] != NONE {
                    continue;
                }
                self.from[other as usize] = vertex;
                reached.push(other);
                let mate = self.mate[other as usize];
                if mate == NONE {
                    return other;
                }
                queue.push(mate);
            }
        }
        NONE
    }

    /// Exchanges matched and unmatched edges along the path to `end`.
    fn augment(&mut self, mut end: u32) {
        while end != NONE {
            let vertex = self.from[end as usize];
            let before = self.mate[vertex as usize];
            self.mate[vertex as usize] = end;
            self.mate[end as usize] = vertex;
            end = before;
        }
    }

    fn forget(&mut self, reached: &mut Vec<u32>) {
        for other in reached.drain(..) {
            self.from[other as usize] = NONE;
        }
    }
}

/// The vertices for which `stays` is true, moved to the front in their order.
fn keep(set: &mut [u32], stays: impl Fn(&u32) -> bool) -> &mut [u32] {
    let mut count = 0;
    for index in 0..set.len() {
        if stays(&set[index]) {
            set.swap(count, index);
            count += 1;
        }
    }
    &mut set[..count]
}

/// An equivalent elimination order in which the vertices of each subtree of the elimination tree are contiguous.
fn postordered(order: &[u32], graph: &Graph) -> Vec<u32> {
    let count = order.len();
    let mut place = vec![0u32; count];
    for (index, &vertex) in order.iter().enumerate() {
        place[vertex as usize] = index as u32;
    }
    // Parents by Liu's algorithm, with path compression by `ancestor`.
    let (mut parent, mut ancestor) = (vec![NONE; count], vec![NONE; count]);
    for (index, &vertex) in order.iter().enumerate() {
        for &other in graph.neighbours(vertex) {
            let mut node = place[other as usize];
            while node < index as u32 {
                let above = ancestor[node as usize];
                ancestor[node as usize] = index as u32;
                if above == NONE {
                    parent[node as usize] = index as u32;
                    break;
                }
                if above == index as u32 {
                    break;
                }
                node = above;
            }
        }
    }
    // Children in ascending order; each list is built from its end.
    let (mut first_child, mut next_sibling) = (vec![NONE; count], vec![NONE; count]);
    let mut roots = Vec::new();
    for node in (0..count).rev() {
        match parent[node] {
            NONE => roots.push(node as u32),
            parent => {
                next_sibling[node] = first_child[parent as usize];
                first_child[parent as usize] = node as u32;
            }
        }
    }
    let mut result = Vec::with_capacity(count);
    let mut stack = Vec::new();
    while let Some(root) = roots.pop() {
        stack.push(root);
        while let Some(&node) = stack.last() {
            let child = first_child[node as usize];
            if child == NONE {
                result.push(order[node as usize]);
                stack.pop();
            } else {
                first_child[node as usize] = next_sibling[child as usize];
                stack.push(child);
            }
        }
    }
    result
}

#[cfg(test)]
mod tests {
    use super::*;
    use rand::{RngExt, SeedableRng};
    use rand_pcg::Pcg64;

    /// Random points of the unit square, connected if closer than `range`.
    fn random(seed: u64, count: usize, range: f64) -> (Vec<Vector<2>>, Graph) {
        let mut generator = Pcg64::seed_from_u64(seed);
        let points: Vec<Vector<2>> = (0..count).map(|_| [generator.random(), generator.random()]).collect();
        let near = |a: usize, b: usize| (points[a][0] - points[b][0]).hypot(points[a][1] - points[b][1]) < range;
        let edges: Vec<(u32, u32)> = (0..count)
            .flat_map(|a| (0..a).map(move |b| (a, b)))
            .filter(|&(a, b)| near(a, b))
            .map(|(a, b)| (a as u32, b as u32))
            .collect();
        let graph = Graph::new(count, edges.into_iter());
        (points, graph)
    }

    /// The size of a largest matching across a cut, by the simplest augmenting paths.
    fn largest_matching(graph: &Graph, left: &[u32], right: &[u32]) -> usize {
        fn extend(graph: &Graph, right: &[u32], vertex: u32, seen: &mut [bool], mate: &mut [u32]) -> bool {
            graph.neighbours(vertex).iter().filter(|other| right.contains(other)).any(|&other| {
                let fresh = !std::mem::replace(&mut seen[other as usize], true);
                let free = mate[other as usize] == NONE;
                let found = fresh && (free || extend(graph, right, mate[other as usize], seen, mate));
                if found {
                    mate[other as usize] = vertex;
                }
                found
            })
        }
        let mut mate = vec![NONE; graph.vertex_count()];
        left.iter().filter(|&&vertex| extend(graph, right, vertex, &mut vec![false; mate.len()], &mut mate)).count()
    }

    #[test]
    fn a_separator_is_a_smallest_cover_of_the_edges_cut() {
        for seed in 0..60 {
            let (points, graph) = random(seed, 40, 0.1 + 0.005 * seed as f64);
            let (left, right): (Vec<u32>, Vec<u32>) = (0..40u32).partition(|&vertex| points[vertex as usize][0] < 0.5);
            let mut dissection = Dissection {
                points: &points,
                graph: &graph,
                part: (0..40).map(|vertex| if left.contains(&vertex) { 1 } else { 2 }).collect(),
                part_count: 2,
                mate: vec![NONE; 40],
                from: vec![NONE; 40],
                order: Vec::new(),
            };
            let separator = dissection.separator(&left, 1, 2);
            for &vertex in &left {
                for other in graph.neighbours(vertex).iter().filter(|other| right.contains(other)) {
                    assert!(separator.contains(&vertex) || separator.contains(other), "seed {seed}: {vertex} {other}");
                }
            }
            // No cover is smaller than a matching (Kőnig: a smallest cover is as large as a largest matching).
            assert_eq!(separator.len(), largest_matching(&graph, &left, &right), "seed {seed}");
            assert!(dissection.part.iter().all(|&part| part == 1 || part == 2), "parts are left as they were");
        }
    }

    /// The column structure of the factor by the definition of elimination, as sets of places in the order.
    fn columns(graph: &Graph, order: &[u32]) -> Vec<std::collections::BTreeSet<usize>> {
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(index, &vertex)| place[vertex as usize] = index);
        let mut columns = vec![std::collections::BTreeSet::new(); order.len()];
        for &vertex in order {
            for &other in graph.neighbours(vertex) {
                let (a, b) = (place[vertex as usize], place[other as usize]);
                columns[a.min(b)].insert(a.max(b));
            }
        }
        for column in 0..columns.len() {
            let below: Vec<usize> = columns[column].iter().copied().collect();
            if let Some((&parent, rest)) = below.split_first() {
                columns[parent].extend(rest);
            }
        }
        columns
    }

    #[test]
    fn the_order_names_every_vertex_once_and_subtrees_lie_together() {
        let mut cases: Vec<_> = (0..20).map(|seed| random(seed, 150, 0.02 + 0.01 * seed as f64)).collect();
        // No edges at all; all points equal with all edges.
        cases.push(random(1, 30, 0.0));
        let everyone = (0..30u32).flat_map(|a| (0..a).map(move |b| (a, b)));
        cases.push((vec![[0.5, 0.5]; 30], Graph::new(30, everyone)));
        for (points, graph) in &cases {
            let order = nested_dissection(points, graph);
            let mut sorted = order.clone();
            sorted.sort_unstable();
            assert!(sorted.iter().copied().eq(0..points.len() as u32));
            // Postorder: a subtree of k vertices occupies the k places up to its root.
            let parents: Vec<Option<usize>> =
                columns(graph, &order).iter().map(|column| column.first().copied()).collect();
            let mut size = vec![1; order.len()];
            let mut first: Vec<usize> = (0..order.len()).collect();
            for node in 0..order.len() {
                if let Some(parent) = parents[node] {
                    size[parent] += size[node];
                    first[parent] = first[parent].min(first[node]);
                }
                assert_eq!(first[node] + size[node], node + 1);
            }
        }
    }

    #[test]
    fn a_long_strip_is_cut_across() {
        // 400 × 2 points: separators of two vertices, so every column of the factor has few entries.
        let points: Vec<Vector<2>> = (0..800).map(|i| [(i / 2) as f64, (i % 2) as f64]).collect();
        let ladder = (0..800u32).flat_map(|i| [(i + 2, i)].into_iter().chain((i % 2 == 0).then_some((i + 1, i))));
        let graph = Graph::new(800, ladder.filter(|&(a, _)| a < 800).collect::<Vec<_>>().into_iter());
        let order = nested_dissection(&points, &graph);
        let most = columns(&graph, &order).iter().map(|column| column.len()).max();
        assert!(most <= Some(6), "{most:?}");
    }
}
