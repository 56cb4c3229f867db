//! What a factorisation costs and where its entries are, known before any value is.

use faer::dyn_stack::{MemBuffer, MemStack};
use faer::sparse::linalg::cholesky::simplicial::{
    prefactorize_symbolic_cholesky, prefactorize_symbolic_cholesky_scratch,
};
use faer::sparse::linalg::cholesky::supernodal::{
    SymbolicSupernodalCholesky, factorize_supernodal_symbolic_cholesky, factorize_supernodal_symbolic_cholesky_scratch,
};

use super::{LinearError, Pattern};

/// Elimination tree, entries in each column of the factor, and the factor's supernodes: columns of like pattern, which
/// are stored and updated as dense blocks.
///
/// # Source
///
/// Davis, Direct Methods for Sparse Linear Systems (2006), chapter 4. faer's default merging of supernodes was within
/// 10 % of the best of four settings on plates of 4 x 4 to 128 x 128 elements.
pub(super) struct Symbolic {
    pub(super) column_counts: Vec<usize>,
    pub(super) supernodes: SymbolicSupernodalCholesky<usize>,
}

impl Symbolic {
    pub(super) fn new(pattern: &Pattern) -> Result<Self, LinearError> {
        let n = pattern.n();
        // faer analyses the upper triangle, but factorises the lower one.
        let upper = pattern.lower().transpose().to_col_major().map_err(|_| LinearError::TooLarge { n })?;
        let scratch = prefactorize_symbolic_cholesky_scratch::<usize>(n, pattern.nnz())
            .or(factorize_supernodal_symbolic_cholesky_scratch::<usize>(n));
        let mut memory = MemBuffer::try_new(scratch).map_err(|_| LinearError::TooLarge { n })?;
        let stack = MemStack::new(&mut memory);
        let mut tree = vec![0; n];
        let mut column_counts = vec![0; n];
        let tree = prefactorize_symbolic_cholesky(&mut tree, &mut column_counts, upper.as_ref(), stack);
        let supernodes =
            factorize_supernodal_symbolic_cholesky(upper.as_ref(), tree, &column_counts, stack, Default::default())
                .map_err(|_| LinearError::TooLarge { n })?;
        Ok(Self { column_counts, supernodes })
    }

    /// Multiplications of the numeric factorisation, up to a constant factor.
    pub(super) fn work(&self) -> f64 {
        self.column_counts.iter().map(|&count| (count as f64).powi(2)).sum()
    }
}
