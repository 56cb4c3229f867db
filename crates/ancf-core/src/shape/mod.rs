//! Shape functions: one file a set, written as the formulas and differentiated exactly.

mod acm;
mod polynomial;

pub use acm::acm;
pub use polynomial::Polynomial;
