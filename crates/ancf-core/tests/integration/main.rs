//! Integration tests: one module a subject, one program, so that the crate is linked once.

mod architecture;
mod assembly;
mod common;
mod conformance;
mod dynamics;
mod elements;
mod frequencies;
mod invariance;
mod load_paths;
mod loads;
mod motion;
mod reference_shapes;
mod resultants;
mod statics;
mod threads;
