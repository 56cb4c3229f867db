//! Factorisation L D L^T of a symmetric sparse matrix and solution of linear systems with it.

use std::ops::Range;
use std::sync::{Arc, Mutex};

use rayon::prelude::*;

use super::frontal::Work;
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
        self.solve_side_by_side::<1>(rhs.as_chunks_mut().0);
    }

    /// Solves for four interleaved right-hand sides, (n, 4): a scalar mass matrix with vectors in R3, and room for one more
    /// component.
    ///
    /// # Panics
    ///
    /// As [`solve`](Self::solve).
    pub fn solve_four(&mut self, rhs: &mut [[f64; 4]]) {
        self.solve_side_by_side(rhs);
    }

    /// Directions in which the matrix is negative, one for each negative pivot: `z . A z = -1`, and `z . A y = 0` for any two.
    ///
    /// # Panics
    ///
    /// When the last [`factorize`](Self::factorize) did not succeed.
    pub fn descents(&mut self) -> Vec<Vec<f64>> {
        assert!(self.valid, "descents without a successful factorisation");
        self.solution.descents(&self.tree, &self.factor)
    }

    fn solve_side_by_side<const W: usize>(&mut self, rhs: &mut [[f64; W]]) {
        assert!(self.valid, "solve without a successful factorisation");
        assert_eq!(rhs.len(), self.pattern.n(), "one number for each column and right-hand side");
        self.solution.solve(&self.tree, &self.factor, rhs);
    }
}

#[cfg(test)]
mod tests;
