//! The positions at which a symmetric matrix may be nonzero.

use faer::sparse::{SymbolicSparseColMat, SymbolicSparseColMatRef};

use super::LinearError;

/// Sparsity of a symmetric matrix: its lower triangle by columns, rows ascending, the diagonal first in each column.
///
/// Read as a graph, entry (i, j) says that i and j are coupled, so [`order`](super::order) takes a pattern of nodes.
///
/// # Examples
///
/// ```
/// use ancf_core::linear::Pattern;
///
/// let chain = Pattern::from_groups(3, &[[0, 1], [1, 2]])?;
/// assert_eq!(chain.col_ptr(), [0, 2, 4, 5]);
/// assert_eq!(chain.row_idx(), [0, 1, 1, 2, 2]);
/// # Ok::<(), ancf_core::linear::LinearError>(())
/// ```
#[derive(Debug, Clone)]
pub struct Pattern {
    lower: SymbolicSparseColMat<usize>,
}

impl Pattern {
    /// Takes a lower triangle in compressed columns: column j holds rows `row_idx[col_ptr[j]..col_ptr[j + 1]]`.
    ///
    /// # Errors
    ///
    /// [`LinearError::InvalidPattern`] unless the rows of each column j ascend from j and stay below `n`.
    pub fn new(n: usize, col_ptr: Vec<usize>, row_idx: Vec<usize>) -> Result<Self, LinearError> {
        let valid = |column: usize| {
            let rows = col_ptr.get(column).zip(col_ptr.get(column + 1)).and_then(|(&a, &b)| row_idx.get(a..b));
            rows.is_some_and(|rows| {
                rows.first() == Some(&column) && rows.is_sorted_by(|a, b| a < b) && rows.last() < Some(&n)
            })
        };
        if let Some(column) = (0..n).find(|&column| !valid(column)) {
            return Err(LinearError::InvalidPattern { column, n });
        }
        if col_ptr.len() != n + 1 || col_ptr[0] != 0 || col_ptr[n] != row_idx.len() {
            return Err(LinearError::InvalidPattern { column: n.saturating_sub(1), n });
        }
        Ok(Self { lower: SymbolicSparseColMat::new_checked(n, n, col_ptr, None, row_idx) })
    }

    /// Couples all members of each group with each other: the coordinates, or the nodes, of each element.
    ///
    /// # Errors
    ///
    /// [`LinearError::IndexOutOfRange`] when a member is not below `n`.
    pub fn from_groups<G: AsRef<[usize]>>(n: usize, groups: &[G]) -> Result<Self, LinearError> {
        let mut groups_of = vec![Vec::new(); n];
        for group in groups {
            for &index in group.as_ref() {
                groups_of.get_mut(index).ok_or(LinearError::IndexOutOfRange { index, n })?.push(group.as_ref());
            }
        }
        let mut col_ptr = vec![0];
        let mut row_idx = Vec::new();
        let mut seen_in = vec![usize::MAX; n];
        for (column, groups) in groups_of.iter().enumerate() {
            let start = row_idx.len();
            seen_in[column] = column;
            row_idx.push(column);
            for &row in groups.iter().copied().flatten() {
                if row > column && seen_in[row] != column {
                    seen_in[row] = column;
                    row_idx.push(row);
                }
            }
            row_idx[start..].sort_unstable();
            col_ptr.push(row_idx.len());
        }
        Self::new(n, col_ptr, row_idx)
    }

    /// Number of rows and columns.
    #[must_use]
    pub fn n(&self) -> usize {
        self.lower.ncols()
    }

    /// Number of stored entries.
    #[must_use]
    pub fn nnz(&self) -> usize {
        self.row_idx().len()
    }

    /// Where each column begins in [`row_idx`](Self::row_idx), (n + 1).
    #[must_use]
    pub fn col_ptr(&self) -> &[usize] {
        self.lower.col_ptr()
    }

    /// Rows of the stored entries, (nnz), column by column.
    #[must_use]
    pub fn row_idx(&self) -> &[usize] {
        self.lower.row_idx()
    }

    /// Rows of one column; the first is the diagonal.
    #[must_use]
    pub fn rows(&self, column: usize) -> &[usize] {
        &self.row_idx()[self.col_ptr()[column]..self.col_ptr()[column + 1]]
    }

    /// Place of entry (i, j), or of (j, i), in the array of values; `None` where the pattern has no entry.
    #[must_use]
    pub fn slot(&self, i: usize, j: usize) -> Option<usize> {
        let (row, column) = (i.max(j), i.min(j));
        let place = self.rows(column).binary_search(&row).ok()?;
        Some(self.col_ptr()[column] + place)
    }

    pub(super) fn lower(&self) -> SymbolicSparseColMatRef<'_, usize> {
        self.lower.as_ref()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn groups_couple_their_members_and_no_others() {
        let groups = [vec![4, 0, 2], vec![], vec![2, 5], vec![5, 2, 2], vec![1]];
        let pattern = Pattern::from_groups(6, &groups).unwrap();
        for i in 0..6 {
            for j in 0..6 {
                let coupled = i == j || groups.iter().any(|group| group.contains(&i) && group.contains(&j));
                assert_eq!(pattern.slot(i, j).is_some(), coupled, "({i}, {j})");
            }
        }
        let rows: Vec<usize> = (0..6).flat_map(|column| pattern.rows(column).to_vec()).collect();
        assert_eq!(rows, pattern.row_idx());
        assert_eq!(pattern.nnz(), 10);
    }

    #[test]
    fn arrays_that_are_no_lower_triangle_are_refused() {
        let new = |col_ptr: &[usize], row_idx: &[usize]| Pattern::new(2, col_ptr.to_vec(), row_idx.to_vec());
        assert!(new(&[0, 2, 3], &[0, 1, 1]).is_ok());
        let invalid: [(&[usize], &[usize], usize); 8] = [
            (&[0, 2, 3], &[1, 0, 1], 0), // not ascending
            (&[0, 2, 3], &[0, 0, 1], 0), // twice
            (&[0, 2, 3], &[0, 2, 1], 0), // outside
            (&[0, 1, 2], &[0, 0], 1),    // above the diagonal
            (&[0, 1, 1], &[0], 1),       // no diagonal
            (&[0, 1], &[0], 1),          // a column short
            (&[0, 1, 2], &[0, 1, 1], 1), // an entry in no column
            (&[0, 3, 2], &[0, 1, 1], 0), // beyond the end of its column
        ];
        for (col_ptr, row_idx, column) in invalid {
            let error = new(col_ptr, row_idx).unwrap_err();
            assert_eq!(error, LinearError::InvalidPattern { column, n: 2 }, "{col_ptr:?} {row_idx:?}");
        }
    }

    #[test]
    fn a_member_outside_the_system_is_refused() {
        let error = Pattern::from_groups(3, &[[0, 3]]).unwrap_err();
        assert_eq!(error, LinearError::IndexOutOfRange { index: 3, n: 3 });
    }
}
