//! [`SymmetricMatrix`]: the lower triangle of a sparse symmetric matrix in compressed columns.
//!
//! ```text
//! column j:  rows[starts[j]..starts[j+1]], ascending, the first of them j        A_ij = A_ji
//! ```

use crate::vector::{Vector, larger};

/// The lower triangle, including the diagonal, of a symmetric matrix in compressed columns.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct SymmetricMatrix {
    pub(crate) starts: Vec<usize>,
    pub(crate) rows: Vec<usize>,
    pub(crate) values: Vec<f64>,
}

impl SymmetricMatrix {
    /// Number of rows and columns.
    pub fn dimension(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// Number of stored entries, those of one triangle.
    pub fn stored_count(&self) -> usize {
        self.values.len()
    }

    /// Index of the first entry of each column, and the number of entries.
    ///
    /// # Shape
    /// One more than [`SymmetricMatrix::dimension`].
    pub fn column_starts(&self) -> &[usize] {
        &self.starts
    }

    /// Row of each entry, ascending within a column, on or below the diagonal.
    pub fn rows(&self) -> &[usize] {
        &self.rows
    }

    /// Value of each entry \[force / length, of a Hessian\].
    pub fn values(&self) -> &[f64] {
        &self.values
    }

    /// Whether both matrices have the same pattern of entries.
    pub fn has_pattern_of(&self, other: &Self) -> bool {
        self.starts == other.starts && self.rows == other.rows
    }

    /// The entries as (row, column, value \[force / length, of a Hessian\]), column by column.
    pub fn entries(&self) -> impl Iterator<Item = (usize, usize, f64)> + '_ {
        (0..self.dimension()).flat_map(move |column| {
            (self.starts[column]..self.starts[column + 1]).map(move |k| (self.rows[k], column, self.values[k]))
        })
    }

    /// `product ← A x`, in the order of the columns.
    ///
    /// # Panics
    /// If the lengths differ from the dimension.
    pub fn multiply(&self, x: &[f64], product: &mut [f64]) {
        assert!(x.len() == self.dimension() && product.len() == self.dimension(), "one number a row");
        product.fill(0.0);
        for column in 0..self.dimension() {
            let range = self.starts[column]..self.starts[column + 1];
            let mut along = 0.0;
            for (&row, &value) in self.rows[range.clone()].iter().zip(&self.values[range]) {
                product[row] += value * x[column];
                if row != column {
                    along += value * x[row];
                }
            }
            product[column] += along;
        }
    }

    /// A + shift · 1, with the same pattern of entries.
    #[must_use]
    pub fn shifted(&self, shift: f64) -> Self {
        let mut shifted = self.clone();
        // The first entry of a column is that of the diagonal.
        self.starts.iter().take(self.dimension()).for_each(|&start| shifted.values[start] += shift);
        shifted
    }

    /// Largest sum of absolute values in a row, ‖A‖_∞ \[unit of the entries\]: a bound of all eigenvalues. NaN if an
    /// entry is NaN.
    pub fn norm(&self) -> f64 {
        let mut sums = vec![0.0; self.dimension()];
        for column in 0..self.dimension() {
            let range = self.starts[column]..self.starts[column + 1];
            let mut own = sums[column];
            for (&row, value) in self.rows[range.clone()].iter().zip(&self.values[range]) {
                own += value.abs();
                sums[row] += value.abs();
            }
            // The diagonal was added there as well.
            sums[column] = own;
        }
        sums.into_iter().fold(0.0, |most, sum| larger(sum, most))
    }
}

/// An undirected graph: both directions of every edge are stored; neighbours of a vertex are contiguous.
#[derive(Debug, Clone, Default, PartialEq)]
pub struct Graph {
    starts: Vec<usize>,
    neighbours: Vec<u32>,
}

impl Graph {
    /// The graph with these edges, each given once in either direction.
    ///
    /// # Panics
    /// If an edge contains a vertex index of `vertex_count` or more.
    pub fn new(vertex_count: usize, edges: impl Iterator<Item = (u32, u32)> + Clone) -> Self {
        let mut starts = vec![0; vertex_count + 1];
        for (a, b) in edges.clone() {
            starts[a as usize + 1] += 1;
            starts[b as usize + 1] += 1;
        }
        for vertex in 0..vertex_count {
            starts[vertex + 1] += starts[vertex];
        }
        let mut next = starts.clone();
        let mut neighbours = vec![0; starts[vertex_count]];
        for (a, b) in edges {
            for (from, to) in [(a, b), (b, a)] {
                neighbours[next[from as usize]] = to;
                next[from as usize] += 1;
            }
        }
        Graph { starts, neighbours }
    }

    /// Number of vertices.
    pub fn vertex_count(&self) -> usize {
        self.starts.len().saturating_sub(1)
    }

    /// The neighbours of a vertex.
    pub fn neighbours(&self, vertex: u32) -> &[u32] {
        &self.neighbours[self.starts[vertex as usize]..self.starts[vertex as usize + 1]]
    }
}

/// Collects D × D blocks of a symmetric matrix; its buffers are reused for further matrices.
#[derive(Debug, Clone, Default)]
pub(crate) struct BlockPattern {
    /// Index of the first block below the diagonal of each block column.
    starts: Vec<usize>,
    /// Block row of each, ascending in a column.
    rows: Vec<u32>,
    next: Vec<usize>,
}

impl BlockPattern {
    /// The pattern of these pairs of block rows (row > column, each pair once).
    pub(crate) fn set(&mut self, block_count: usize, pairs: impl Iterator<Item = (u32, u32)> + Clone) {
        self.starts.clear();
        self.starts.resize(block_count + 1, 0);
        for (_, column) in pairs.clone() {
            self.starts[column as usize + 1] += 1;
        }
        for block in 0..block_count {
            self.starts[block + 1] += self.starts[block];
        }
        self.next.clone_from(&self.starts);
        self.rows.clear();
        self.rows.resize(self.starts[block_count], 0);
        for (row, column) in pairs {
            self.rows[self.next[column as usize]] = row;
            self.next[column as usize] += 1;
        }
        for block in 0..block_count {
            self.rows[self.starts[block]..self.starts[block + 1]].sort_unstable();
        }
    }

    /// Whether a block below the diagonal is in the pattern.
    pub(crate) fn has(&self, row: u32, column: u32) -> bool {
        let range = self.starts[column as usize]..self.starts[column as usize + 1];
        self.rows[range].binary_search(&row).is_ok()
    }

    /// Sets the entries of the pattern to zero. Returns whether the pattern is unchanged.
    pub(crate) fn clear_into<const D: usize>(&self, matrix: &mut SymmetricMatrix) -> bool {
        let block_count = self.starts.len() - 1;
        let mut same = matrix.dimension() == D * block_count;
        let mut at = 0;
        let mut put = |rows: &mut Vec<usize>, row: usize| {
            match rows.get_mut(at) {
                Some(old) if *old == row => {}
                Some(old) => {
                    *old = row;
                    same = false;
                }
                None => {
                    rows.push(row);
                    same = false;
                }
            }
            at += 1;
        };
        let mut starts = Vec::with_capacity(D * block_count + 1);
        starts.push(0);
        for block in 0..block_count {
            let below = &self.rows[self.starts[block]..self.starts[block + 1]];
            for axis in 0..D {
                for other in axis..D {
                    put(&mut matrix.rows, D * block + other);
                }
                for &row in below {
                    for other in 0..D {
                        put(&mut matrix.rows, D * row as usize + other);
                    }
                }
                starts.push(starts[D * block + axis] + (D - axis) + D * below.len());
            }
        }
        let count = starts[D * block_count];
        same &= matrix.rows.len() == count && matrix.starts == starts;
        matrix.rows.truncate(count);
        matrix.starts = starts;
        matrix.values.clear();
        matrix.values.resize(count, 0.0);
        same
    }

    /// The blocks as vertices, those below the diagonal as edges.
    pub(crate) fn graph(&self) -> Graph {
        let block_count = self.starts.len().saturating_sub(1);
        let below = |column: usize| self.rows[self.starts[column]..self.starts[column + 1]].iter();
        Graph::new(block_count, (0..block_count).flat_map(|column| below(column).map(move |&row| (row, column as u32))))
    }

    /// Adds a block to the diagonal.
    pub(crate) fn add_diagonal<const D: usize>(
        &self,
        matrix: &mut SymmetricMatrix,
        block: u32,
        values: &[Vector<D>; D],
    ) {
        for axis in 0..D {
            let start = matrix.starts[D * block as usize + axis];
            for other in axis..D {
                matrix.values[start + other - axis] += values[other][axis];
            }
        }
    }

    /// Subtracts a block below the diagonal.
    ///
    /// # Panics
    /// If the pattern does not have it.
    pub(crate) fn subtract_below<const D: usize>(
        &self,
        matrix: &mut SymmetricMatrix,
        (row, column): (u32, u32),
        values: &[Vector<D>; D],
    ) {
        let below = &self.rows[self.starts[column as usize]..self.starts[column as usize + 1]];
        let place = below.binary_search(&row).expect("the pattern was made from the same pairs");
        for axis in 0..D {
            let start = matrix.starts[D * column as usize + axis] + (D - axis) + D * place;
            for other in 0..D {
                matrix.values[start + other] -= values[other][axis];
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blocks_land_in_one_triangle_and_multiply_as_the_whole_matrix() {
        let pairs = [(2u32, 0u32), (1, 0), (2, 1)];
        let mut pattern = BlockPattern::default();
        pattern.set(3, pairs.iter().copied());
        let mut matrix = SymmetricMatrix::default();
        assert!(!pattern.clear_into::<2>(&mut matrix));
        let mut dense = [[0.0; 6]; 6];
        for (k, &(row, column)) in pairs.iter().enumerate() {
            let k = k as f64;
            let block = [[1.0 + k, 2.0 - k], [2.0 - k, 5.0 + 3.0 * k]];
            pattern.add_diagonal(&mut matrix, row, &block);
            pattern.add_diagonal(&mut matrix, column, &block);
            pattern.subtract_below(&mut matrix, (row, column), &block);
            for a in 0..2 {
                for b in 0..2 {
                    let (i, j) = (2 * row as usize, 2 * column as usize);
                    dense[i + a][i + b] += block[a][b];
                    dense[j + a][j + b] += block[a][b];
                    dense[i + a][j + b] -= block[a][b];
                    dense[j + b][i + a] -= block[a][b];
                }
            }
        }
        assert_eq!((matrix.dimension(), matrix.stored_count()), (6, 21));
        for (row, column, value) in matrix.entries() {
            assert!(row >= column);
            assert_eq!(value, dense[row][column]);
        }
        // Small integers: no rounding.
        let x = [1.0, -2.0, 3.0, 5.0, -7.0, 11.0];
        let mut product = [f64::NAN; 6];
        matrix.multiply(&x, &mut product);
        let whole: [f64; 6] = std::array::from_fn(|i| (0..6).map(|j| dense[i][j] * x[j]).sum());
        assert_eq!(product, whole);
        let sums = dense.map(|row| row.iter().map(|value| value.abs()).sum::<f64>());
        assert_eq!(matrix.norm(), sums.into_iter().fold(0.0, f64::max));
        // The same pairs again keep the pattern, fewer do not.
        let before = matrix.clone();
        assert!(pattern.clear_into::<2>(&mut matrix) && matrix.has_pattern_of(&before));
        pattern.set(3, pairs[1..].iter().copied());
        assert!(!pattern.clear_into::<2>(&mut matrix) && !matrix.has_pattern_of(&before));
        assert_eq!(matrix.stored_count(), 17);
    }
}
