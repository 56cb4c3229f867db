//! What can go wrong in the linear algebra.

use thiserror::Error;

/// Failure of a symbolic or numeric step of the linear algebra.
#[derive(Debug, Clone, Copy, PartialEq, Error)]
pub enum LinearError {
    /// The arrays of a pattern do not describe a sorted lower triangle with a full diagonal.
    #[error(
        "column {column} of the pattern is not a sorted list of rows from {column} to {n} that begins at the diagonal"
    )]
    InvalidPattern {
        /// First column that is wrong.
        column: usize,
        /// Number of rows and columns.
        n: usize,
    },
    /// A coordinate of a group does not exist.
    #[error("coordinate {index} is outside a system of {n}")]
    IndexOutOfRange {
        /// The coordinate.
        index: usize,
        /// Number of coordinates.
        n: usize,
    },
    /// The factor does not fit in memory or its size overflows the index type.
    #[error("the factor of a system of {n} coordinates is too large for the memory")]
    TooLarge {
        /// Number of coordinates.
        n: usize,
    },
    /// The matrix holds a NaN or an infinity.
    #[error("column {column} of the matrix holds a value that is not finite")]
    NotFinite {
        /// First such column.
        column: usize,
    },
    /// A pivot is below rounding: to working precision the matrix is singular.
    #[error(
        "the matrix is singular to working precision: column {column} has pivot {pivot:e} and diagonal entry {scale:e}"
    )]
    Singular {
        /// Column (coordinate in the numbering of the pattern) in which the pivot was met.
        column: usize,
        /// The pivot, in the unit of the matrix.
        pivot: f64,
        /// Magnitude of the diagonal entry it was formed from, same unit.
        scale: f64,
    },
}
