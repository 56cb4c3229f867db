//! Elements: shape tables, strain measures and weights, put together to the energy
//! `1/2 (eps - eps_0)^T W (eps - eps_0)` over strain samples.
//!
//! An element is data. `tables` holds what congruent parameters share (shape functions at the samples, the projection),
//! `constants` what congruent reference shapes share (`eps_0` and `W`; `classes` finds them), `kernel` turns both into
//! energy, force and tangent of several elements at once, `task` brings these into lanes and back, and `block` has all
//! elements of a body. `thin` makes
//! the tables of the thin elements, `full48` those of the fully parametrised ones, `kind` lists them all; another
//! element is another file and another line there.

mod block;
mod classes;
mod constants;
mod corners;
mod full48;
mod kernel;
mod kind;
mod moments;
mod operations;
mod pairs;
mod patch;
mod portion;
mod projected;
mod projection;
mod sample;
mod tables;
mod task;
mod thin;
mod totals;

pub use block::ElementBlock;
pub(crate) use constants::{RoughShares, Section};
pub(crate) use kind::Variant;
pub use kind::{Kind, NodalVector};
pub use operations::Operations;
pub use pairs::{tangent_place, tangent_size};
pub use portion::{At, Motion, Portion, Want};
pub use thin::Membrane;
pub(crate) use thin::followed;
