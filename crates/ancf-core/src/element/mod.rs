//! Elements: shape tables, strain measures and weights, put together to the energy
//! `1/2 (eps - eps_0)^T W (eps - eps_0)` over strain samples.
//!
//! An element is data. `tables` holds what congruent parameters share (shape functions at the samples, the projection),
//! `constants` what congruent reference shapes share (`eps_0` and `W`; `classes` finds them), `kernel` turns both into energy, force and
//! tangent of several elements at once, and `block` does so for all elements of a body. `thin` makes the tables of
//! the thin elements; another element is another file like it.

mod block;
mod classes;
mod constants;
mod corners;
mod kernel;
mod projected;
mod projection;
mod tables;
mod thin;

pub use block::{ElementBlock, Outcome, Want};
pub(crate) use constants::Section;
pub use tables::{Kind, NodalVector};

pub(crate) use block::Block;
pub use thin::Membrane;
pub(crate) use thin::thin36;
