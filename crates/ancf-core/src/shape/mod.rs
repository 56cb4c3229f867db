//! Shape functions: one file a set, written as the formulas and differentiated exactly.

mod acm;
mod bilinear;
mod hermite;
mod polynomial;

pub use acm::acm;
pub use bilinear::bilinear;
pub use hermite::hermite;
pub use polynomial::Polynomial;
