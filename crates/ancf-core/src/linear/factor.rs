//! Factorisation L D L^T of a symmetric sparse matrix and solution of linear systems with it.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use faer::MatMut;
use rayon::prelude::*;

use super::front::{eliminate, extend_add};
use super::solve::Solution;
use super::tree::{Front, Tree};
use super::{LinearError, Pattern};

/// Signs of the pivots, which by Sylvester's law are those of the eigenvalues.
#[derive(Debug, Clone, Copy, PartialEq, Eq)]
pub struct Inertia {
    /// Number of negative eigenvalues: zero in a stable equilibrium.
    pub negative: usize,
}

impl Inertia {
    /// Whether all eigenvalues are positive.
    #[must_use]
    pub fn is_positive_definite(self) -> bool {
        self.negative == 0
    }
}

/// Factorisation K = L D L^T with D diagonal: made once for a pattern, refilled for each tangent.
///
/// The pivots are taken in the order of the coordinates, up to exchanges of such that do not depend on each other, so
/// renumber by [`order`](super::order) first. Without pivoting the factorisation costs as much as Cholesky's and takes
/// definite and indefinite tangents alike. Definite matrices need no pivoting. For indefinite ones it can lose digits
/// where a pivot happens to be small; [`SymmetricMatrix::residual`](super::SymmetricMatrix::residual) tells, and one
/// step of refinement restores them.
///
/// Parts of the mesh that do not touch are eliminated in parallel, and so are tiles of the large dense matrices that
/// join them. What is added to what, and in which order, does not depend on the number of threads.
///
/// # Source
///
/// Golub and Van Loan, Matrix Computations (2013), 4.1 and 4.2; Duff and Reid (1983) for the multifrontal method;
/// Wriggers, Nonlinear Finite Element Methods (2008), for the count of negative pivots as a test of stability.
///
/// # Examples
///
/// ```
/// use std::sync::Arc;
/// use ancf_core::linear::{Factorization, Pattern};
///
/// let pattern = Arc::new(Pattern::from_groups(2, &[[0, 1]])?);
/// let mut factorization = Factorization::new(pattern)?;
/// let inertia = factorization.factorize(&[2.0, 1.0, 3.0])?; // [[2, 1], [1, 3]]
/// assert!(inertia.is_positive_definite());
/// let mut x = [4.0, 7.0];
/// factorization.solve(&mut x);
/// assert_eq!(x, [1.0, 2.0]);
/// # Ok::<(), ancf_core::linear::LinearError>(())
/// ```
pub struct Factorization {
    pattern: Arc<Pattern>,
    tree: Tree,
    factor: Vec<f64>,
    /// Working memory of the top, and that of subtrees for each thread.
    shared: Vec<f64>,
    stacks: Mutex<Vec<Vec<f64>>>,
    solution: Solution,
    valid: bool,
}

/// Fronts of the top with more operations than this share their tiles among threads.
const SHARED: f64 = 1e7;
/// Columns of a front that one task adds updates to.
const CHUNK: usize = 32;

impl Factorization {
    /// Analyses the pattern and allocates the factor and all working memory.
    ///
    /// # Errors
    ///
    /// [`LinearError::TooLarge`] when the memory does not suffice.
    pub fn new(pattern: Arc<Pattern>) -> Result<Self, LinearError> {
        let tree = Tree::new(&pattern);
        let zeros = |length: usize| {
            Vec::<f64>::new().try_reserve_exact(length).map_err(|_| LinearError::TooLarge { n: pattern.n() })?;
            // Zeros that the system hands out when they are first touched, which the threads do.
            Ok(vec![0.0; length])
        };
        let (factor, shared) = (zeros(tree.size())?, zeros(tree.shared)?);
        let stacks = Mutex::new(Vec::new());
        Ok(Self { pattern, tree, factor, shared, stacks, solution: Solution::default(), valid: false })
    }

    /// The pattern the values must have.
    #[must_use]
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Number of stored entries of the factor.
    #[must_use]
    pub fn factor_nnz(&self) -> usize {
        self.factor.len()
    }

    /// Factorises the matrix with these values, (nnz) in the order of the pattern, in memory that is there.
    ///
    /// # Errors
    ///
    /// [`LinearError::NotFinite`] when a value is not finite, [`LinearError::Singular`] when a pivot is below the
    /// rounding of its diagonal entry, n eps |K_jj|. Flat plates of 1 x 1 to 48 x 48 and 1000 x 1 elements, thickness /
    /// length 0.6 to 2e-4: free, they stay a factor of 2 below this bound; clamped, a factor of 1000 above. After an
    /// error there is no factorisation until the next success.
    ///
    /// # Panics
    ///
    /// When there is not one value for each entry of the pattern.
    pub fn factorize(&mut self, values: &[f64]) -> Result<Inertia, LinearError> {
        assert_eq!(values.len(), self.pattern.nnz(), "one value an entry");
        self.valid = false;
        if let Some(place) = values.iter().position(|value| !value.is_finite()) {
            let column = self.pattern.col_ptr().partition_point(|&start| start <= place) - 1;
            return Err(LinearError::NotFinite { column });
        }
        let Self { pattern, tree, factor, shared, stacks, .. } = self;
        let stacks = &*stacks;
        let work = Work { pattern, tree, values };

        let mut tasks = Vec::with_capacity(tree.results.len());
        let (mut factors, mut results) = (factor.as_mut_slice(), shared.as_mut_slice());
        for (fronts, places) in tree.subtrees.windows(2).zip(tree.results.windows(2)) {
            let size: usize = tree.fronts[fronts[0]..fronts[1]].iter().map(Front::size).sum();
            let (own, rest) = factors.split_at_mut(size);
            let (result, others) = results.split_at_mut(places[1] - places[0]);
            tasks.push((fronts[0]..fronts[1], own, result));
            (factors, results) = (rest, others);
        }
        let subtree = |(fronts, factor, result): (Range<usize>, &mut [f64], &mut [f64])| {
            let taken = stacks.lock().expect("no thread panics with it").pop();
            let mut stack = taken.unwrap_or_else(|| vec![0.0; tree.stack]);
            let mut rest = factor;
            let mut negative = 0;
            let root = fronts.end - 1;
            for f in fronts.start..root {
                let (panel, others) = rest.split_at_mut(tree.fronts[f].size());
                negative += work.front(f, panel, &mut stack, None, false)?;
                rest = others;
            }
            negative += work.front(root, rest, &mut stack, Some(result), false)?;
            stacks.lock().expect("no thread panics with it").push(stack);
            Ok(negative)
        };
        let outcomes: Vec<Result<usize, LinearError>> = if tasks.len() < 2 {
            tasks.into_iter().map(subtree).collect()
        } else {
            tasks.into_par_iter().map(subtree).collect()
        };
        let mut negative = outcomes.into_iter().sum::<Result<usize, _>>()?;
        for f in tree.top() {
            let (panel, others) = factors.split_at_mut(tree.fronts[f].size());
            negative += work.front(f, panel, shared, None, tree.fronts[f].work() > SHARED)?;
            factors = others;
        }
        self.valid = true;
        Ok(Inertia { negative })
    }

    /// Replaces the right-hand side, (n), by the solution.
    ///
    /// # Panics
    ///
    /// When the last [`factorize`](Self::factorize) did not succeed, or the length is wrong.
    pub fn solve(&mut self, rhs: &mut [f64]) {
        self.solve_many(rhs, 1);
    }

    /// Solves for `count` interleaved right-hand sides, (n, count): a scalar mass matrix with vectors in R3.
    ///
    /// # Panics
    ///
    /// As [`solve`](Self::solve).
    pub fn solve_many(&mut self, rhs: &mut [f64], count: usize) {
        assert!(self.valid, "solve without a successful factorisation");
        assert_eq!(rhs.len(), self.pattern.n() * count, "one number for each column and right-hand side");
        self.solution.solve(&self.tree, &self.factor, rhs, count);
    }
}

/// What the elimination of a front reads.
struct Work<'a> {
    pattern: &'a Pattern,
    tree: &'a Tree,
    values: &'a [f64],
}

impl Work<'_> {
    /// Assembles and eliminates a front; `memory` has its place and the updates of its children. Its own update goes to
    /// `result`, or stays at its place. Returns the number of its negative pivots.
    fn front(
        &self,
        f: usize,
        panel: &mut [f64],
        memory: &mut [f64],
        result: Option<&mut [f64]>,
        shared: bool,
    ) -> Result<usize, LinearError> {
        let tree = self.tree;
        let front = &tree.fronts[f];
        let (rows, columns, below) = (front.rows(), front.columns.len(), front.below);
        let size = if result.is_some() { front.scratch() } else { front.workspace() };
        let (before, rest) = memory.split_at_mut(front.place);
        let (own, after) = rest.split_at_mut(size);
        let (update, scratch) = match result {
            Some(result) => (result, own),
            None => own.split_at_mut(front.update_size()),
        };
        let children = || {
            tree.children[front.children.clone()].iter().map(|&child| {
                let child = &tree.fronts[child];
                let memory = match child.update < front.place {
                    true => &before[child.update..],
                    false => &after[child.update - front.place - size..],
                };
                (&memory[..child.update_size()], &tree.runs[child.runs.clone()])
            })
        };

        panel.fill(0.0);
        for run in &tree.entries[front.entries.clone()] {
            let length = run.length as usize;
            panel[run.to as usize..][..length].copy_from_slice(&self.values[run.from as usize..][..length]);
        }
        let add = |target: &mut [f64], top: usize, columns: Range<usize>| {
            let height = rows - top;
            let part = |(k, target): (usize, &mut [f64])| {
                let first = columns.start + k * CHUNK;
                for (child, runs) in children() {
                    extend_add(target, top, first..first + target.len() / height, child, runs);
                }
            };
            if shared {
                target.par_chunks_mut(CHUNK * height).enumerate().for_each(part);
            } else if height > 0 {
                target.chunks_mut(CHUNK * height).enumerate().for_each(part);
            }
        };
        add(panel, 0, 0..columns);
        let stopped_at = eliminate(
            MatMut::from_column_major_slice_mut(panel, rows, columns),
            MatMut::from_column_major_slice_mut(update, below, below),
            scratch,
            shared,
        )
        .err();

        // pivots that are exactly zero or have overflowed stop the elimination; those below rounding are found here
        let rounding = self.pattern.n() as f64 * f64::EPSILON;
        let mut negative = 0;
        for k in 0..columns {
            let column = tree.order[front.columns.start + k];
            let pivot = panel[k * rows + k];
            let scale = self.values[self.pattern.col_ptr()[column]].abs();
            if stopped_at == Some(k) || pivot.abs() <= rounding * scale {
                return Err(LinearError::Singular { column, pivot, scale });
            }
            negative += usize::from(pivot < 0.0);
        }
        if below > 0 {
            add(update, columns, columns..rows);
        }
        Ok(negative)
    }
}

#[cfg(test)]
mod tests {
    use super::super::testing::{dense, random_matrix, random_vector};
    use super::super::{SymmetricMatrix, order};
    use super::*;
    use nalgebra::{DMatrix, DVector};

    fn factorized(matrix: &SymmetricMatrix) -> (Factorization, Inertia) {
        let mut factorization = Factorization::new(Arc::clone(matrix.pattern())).unwrap();
        let inertia = factorization.factorize(matrix.values()).unwrap();
        (factorization, inertia)
    }

    /// Diagonally dominant, then scaled by up to 1e8 between coordinates as membrane and bending are.
    fn definite_badly_scaled(n: usize, seed: u64) -> SymmetricMatrix {
        let mut matrix = random_matrix(n, seed);
        let pattern = Arc::clone(matrix.pattern());
        let sums: Vec<f64> = dense(&matrix).row_iter().map(|row| row.abs().sum()).collect();
        let scales: Vec<f64> = random_vector(n, seed + 1).iter().map(|s| 10.0_f64.powf(4.0 * s)).collect();
        for (column, sum) in sums.iter().enumerate() {
            let start = pattern.col_ptr()[column];
            matrix.values_mut()[start] = 1.01 * sum;
            for (k, &row) in pattern.rows(column).iter().enumerate() {
                matrix.values_mut()[start + k] *= scales[row] * scales[column];
            }
        }
        matrix
    }

    #[test]
    fn definite_systems_agree_with_dense_cholesky() {
        for n in [1, 2, 9, 27, 81, 225] {
            let matrix = definite_badly_scaled(n, n as u64);
            let rhs = DVector::from_vec(random_vector(n, 7));
            let (mut factorization, inertia) = factorized(&matrix);
            assert!(inertia.is_positive_definite());
            let mut x = rhs.clone();
            factorization.solve(x.as_mut_slice());
            let expected = dense(&matrix).cholesky().unwrap().solve(&rhs);
            let error = x.zip_map(&expected, |x, e| (x - e).abs() / e.abs().max(1e-6 * expected.amax())).amax();
            assert!(error < 1e-9, "n = {n}: {error:e}");
            assert!(matrix.residual(x.as_slice(), rhs.as_slice(), &mut vec![0.0; n]) < 1e-14);
        }
    }

    #[test]
    fn inertia_counts_the_negative_eigenvalues_of_indefinite_matrices() {
        for seed in 0..20 {
            let n = 60;
            let matrix = random_matrix(n, seed);
            let (mut factorization, inertia) = factorized(&matrix);
            let negative = dense(&matrix).symmetric_eigenvalues().iter().filter(|value| **value < 0.0).count();
            assert_eq!(inertia.negative, negative);
            let rhs = random_vector(n, 100 + seed);
            let (mut x, mut correction) = (rhs.clone(), vec![0.0; n]);
            factorization.solve(&mut x);
            matrix.residual(&x, &rhs, &mut correction);
            factorization.solve(&mut correction);
            x.iter_mut().zip(&correction).for_each(|(x, dx)| *x += dx);
            assert!(matrix.residual(&x, &rhs, &mut correction) < 1e-14);
        }
    }

    #[test]
    fn singular_matrices_are_refused_where_they_fail() {
        // springs in a ring without a support: the last pivot vanishes, up to rounding
        let n = 50;
        let springs: Vec<[usize; 2]> = (0..n).map(|k| [k, (k + 1) % n]).collect();
        let pattern = Arc::new(Pattern::from_groups(n, &springs).unwrap());
        let mut ring = vec![0.0; pattern.nnz()];
        for (&[i, j], stiffness) in springs.iter().zip(random_vector(n, 1)) {
            for (a, b, sign) in [(i, i, 1.0), (j, j, 1.0), (i, j, -1.0)] {
                ring[pattern.slot(a, b).unwrap()] += sign * (1.1 + stiffness);
            }
        }
        let mut factorization = Factorization::new(Arc::clone(&pattern)).unwrap();
        let refused = factorization.factorize(&ring);
        assert!(matches!(refused, Err(LinearError::Singular { column: 49, .. })), "{refused:?}");
        ring[pattern.slot(20, 20).unwrap()] += 1e-3;
        assert!(factorization.factorize(&ring).unwrap().is_positive_definite());
    }

    #[test]
    fn an_exact_zero_and_a_value_that_is_not_finite_are_reported_with_their_column() {
        let pattern = Arc::new(Pattern::from_groups(200, &(0..199).map(|k| [k, k + 1]).collect::<Vec<_>>()).unwrap());
        let mut values: Vec<f64> = vec![0.0; pattern.nnz()];
        (0..200).for_each(|k| values[pattern.col_ptr()[k]] = 2.0);
        values[pattern.col_ptr()[130]] = 0.0;
        let mut factorization = Factorization::new(Arc::clone(&pattern)).unwrap();
        let expected = LinearError::Singular { column: 130, pivot: 0.0, scale: 0.0 };
        assert_eq!(factorization.factorize(&values), Err(expected));
        values[pattern.slot(131, 130).unwrap()] = f64::INFINITY;
        assert_eq!(factorization.factorize(&values), Err(LinearError::NotFinite { column: 130 }));
    }

    #[test]
    fn a_pivot_that_overflows_is_an_error() {
        let mut factorization = Factorization::new(Arc::new(Pattern::from_groups(2, &[[0, 1]]).unwrap())).unwrap();
        let expected = LinearError::Singular { column: 1, pivot: f64::NEG_INFINITY, scale: 1.0 };
        assert_eq!(factorization.factorize(&[1.0, 1e200, 1.0]), Err(expected));
    }

    #[test]
    #[should_panic(expected = "without a successful factorisation")]
    fn no_solution_without_a_factorisation() {
        let mut factorization = Factorization::new(Arc::new(Pattern::from_groups(1, &[[0]]).unwrap())).unwrap();
        assert!(factorization.factorize(&[0.0]).is_err());
        factorization.solve(&mut [1.0]);
    }

    #[test]
    fn interleaved_right_hand_sides_are_solved_each() {
        let n = 81;
        let matrix = definite_badly_scaled(n, 3);
        let (mut factorization, _) = factorized(&matrix);
        let rhs = DMatrix::from_vec(n, 5, random_vector(5 * n, 4));
        let expected = dense(&matrix).cholesky().unwrap().solve(&rhs);
        let mut solution = rhs.transpose(); // column-major, so that memory holds (n, 5) row by row
        factorization.solve_many(solution.as_mut_slice(), 5);
        assert!((solution.transpose() - &expected).amax() < 1e-10 * expected.amax());
    }

    #[test]
    fn a_factorization_can_be_refilled_and_gives_the_same_bits_again() {
        let (first, second) = (definite_badly_scaled(90, 5), random_matrix(90, 6));
        let solve = |factorization: &mut Factorization| {
            factorization.factorize(first.values()).unwrap();
            let mut x = random_vector(90, 8);
            factorization.solve(&mut x);
            x
        };
        let (mut factorization, _) = factorized(&first);
        let before = solve(&mut factorization);
        factorization.factorize(second.values()).unwrap();
        assert_eq!(solve(&mut factorization), before);
    }

    /// Plate of side x side nodes with nine coordinates each, in the order of elimination: random, and diagonally
    /// dominant with the given signs.
    fn plate(side: usize, sign: impl Fn(usize) -> f64) -> SymmetricMatrix {
        let node = |i: usize, j: usize| j * side + i;
        let cells = (0..(side - 1) * (side - 1)).map(|cell| (cell % (side - 1), cell / (side - 1)));
        let cells: Vec<_> =
            cells.map(|(i, j)| [node(i, j), node(i + 1, j), node(i + 1, j + 1), node(i, j + 1)]).collect();
        let positions: Vec<_> = (0..side * side).map(|k| [(k % side) as f64, (k / side) as f64]).collect();
        let order = order(&Pattern::from_groups(side * side, &cells).unwrap(), Some(&positions)).unwrap();
        let mut place = vec![0; order.len()];
        order.iter().enumerate().for_each(|(k, &node)| place[node] = k);
        let groups: Vec<Vec<usize>> =
            cells.iter().map(|cell| cell.iter().flat_map(|&n| 9 * place[n]..9 * place[n] + 9).collect()).collect();
        let pattern = Arc::new(Pattern::from_groups(9 * side * side, &groups).unwrap());
        let values = random_vector(pattern.nnz(), 9);
        let mut sums = vec![0.0; pattern.n()];
        for column in 0..pattern.n() {
            for (&row, value) in pattern.rows(column)[1..].iter().zip(&values[pattern.col_ptr()[column] + 1..]) {
                sums[row] += value.abs();
                sums[column] += value.abs();
            }
        }
        let mut matrix = SymmetricMatrix::new(Arc::clone(&pattern), values);
        for (column, sum) in sums.iter().enumerate() {
            matrix.values_mut()[pattern.col_ptr()[column]] = 1.01 * sign(column) * sum;
        }
        matrix
    }

    #[test]
    fn large_systems_have_the_same_bits_on_any_number_of_threads() {
        // by Gershgorin's theorem there are as many negative eigenvalues as negative diagonal entries
        let matrix = plate(30, |column| if column % 10 == 3 { -1.0 } else { 1.0 });
        let n = matrix.pattern().n();
        let rhs = random_vector(3 * n, 2);
        let solve = |threads: usize| {
            let pool = rayon::ThreadPoolBuilder::new().num_threads(threads).build().unwrap();
            pool.install(|| {
                let (mut factorization, inertia) = factorized(&matrix);
                assert_eq!(inertia.negative, n / 10);
                let tree = &factorization.tree;
                assert!(tree.subtrees.len() > 4 && tree.fronts[tree.top()].iter().any(|front| front.work() > SHARED));
                let mut x = rhs.clone();
                factorization.solve_many(&mut x, 3);
                x
            })
        };
        let one = solve(1);
        for component in 0..3 {
            let part = |x: &[f64]| x.iter().skip(component).step_by(3).copied().collect::<Vec<_>>();
            assert!(matrix.residual(&part(&one), &part(&rhs), &mut vec![0.0; n]) < 1e-14);
        }
        for threads in [2, 3] {
            assert!(solve(threads).iter().zip(&one).all(|(a, b)| a.to_bits() == b.to_bits()), "{threads} threads");
        }
    }

    #[test]
    fn a_large_singular_system_is_refused_at_its_last_column() {
        // springs between all nodes of a plate that nothing holds
        let mut matrix = plate(30, |_| 0.0);
        let pattern = Arc::clone(matrix.pattern());
        for column in 0..pattern.n() {
            for place in pattern.col_ptr()[column] + 1..pattern.col_ptr()[column + 1] {
                let stiffness = matrix.values()[place].abs();
                matrix.values_mut()[place] = -stiffness;
                for end in [column, pattern.row_idx()[place]] {
                    matrix.values_mut()[pattern.col_ptr()[end]] += stiffness;
                }
            }
        }
        let refused = Factorization::new(Arc::clone(&pattern)).unwrap().factorize(matrix.values());
        assert!(
            matches!(refused, Err(LinearError::Singular { column, .. }) if column == pattern.n() - 1),
            "{refused:?}"
        );
    }

    #[test]
    fn long_chains_are_solved_too() {
        // -u'' = 1 in differences: exact at the nodes
        let n = 20_000;
        let pattern = Arc::new(Pattern::from_groups(n, &(0..n - 1).map(|k| [k, k + 1]).collect::<Vec<_>>()).unwrap());
        let values = (0..n).flat_map(|k| [2.0, -1.0].into_iter().take(pattern.rows(k).len())).collect();
        let (mut factorization, _) = factorized(&SymmetricMatrix::new(pattern, values));
        let mut u = vec![1.0; n];
        factorization.solve(&mut u);
        for (k, u) in u.iter().enumerate() {
            let expected = 0.5 * (k + 1) as f64 * (n - k) as f64;
            assert!((u / expected - 1.0).abs() < 1e-8, "{k}: {u} instead of {expected}");
        }
    }

    #[test]
    fn an_empty_system_has_an_empty_solution() {
        let pattern = Arc::new(Pattern::from_groups::<[usize; 1]>(0, &[]).unwrap());
        let mut factorization = Factorization::new(pattern).unwrap();
        assert!(factorization.factorize(&[]).unwrap().is_positive_definite());
        factorization.solve(&mut []);
    }
}
