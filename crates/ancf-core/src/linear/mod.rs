//! Symmetric sparse matrices: pattern, order of elimination, factorisation, product. The only place that names faer.
//!
//! A model numbers its nodes by [`order`], makes one [`Pattern`] of its free coordinates, and one [`Factorization`]
//! from it. From then on only values change: assembly refills an array laid out as the pattern,
//! [`Factorization::factorize`] and [`Factorization::solve`] work in storage that was allocated once.

mod dot;
mod elimination;
mod error;
mod factor;
mod front;
mod frontal;
mod gmres;
mod ordering;
mod panel;
mod pattern;
mod solve;
mod sparse;
mod supernodes;
#[cfg(test)]
mod testing;
mod tree;

pub(crate) use dot::dot;
pub use error::LinearError;
pub use factor::{Factorization, Inertia};
pub use gmres::gmres;
pub use ordering::order;
pub use pattern::Pattern;
pub use sparse::SymmetricMatrix;
