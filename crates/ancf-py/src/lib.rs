//! The extension module `ancf._core`: declarations only, the mechanics is in `ancf_core`.

mod arrays;
mod errors;
mod model;
mod run;
mod shape;
mod solve;

use mimalloc::MiMalloc;
use pyo3::prelude::*;

/// Keeps the memory of a run for the next one. That of the system gives it back, and for statics of a few thousand coordinates
/// an eighth of the time went into fetching it again, page by page.
#[global_allocator]
static ALLOCATOR: MiMalloc = MiMalloc;

/// The mechanics of `ancf`, in Rust.
#[pymodule]
mod _core {
    #[pymodule_export]
    use super::errors::InputError;
    #[pymodule_export]
    use super::info;
    #[pymodule_export]
    use super::model::Model;
    #[pymodule_export]
    use super::model::curve;
    #[pymodule_export]
    use super::run::Run;
    #[pymodule_export]
    use super::shape::Shape;
    #[pymodule_export]
    use super::solve::{modes, simulate, solve_static};

    #[allow(non_upper_case_globals, reason = "the name that Python expects")]
    #[pymodule_export]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}

/// What runs here: version, threads, instruction set.
#[pyfunction]
fn info() -> std::collections::BTreeMap<&'static str, String> {
    let (name, lanes) = ancf_core::simd();
    [
        ("core", env!("CARGO_PKG_VERSION").to_owned()),
        ("build", if cfg!(debug_assertions) { "debug" } else { "release" }.to_owned()),
        ("threads", rayon::current_num_threads().to_string()),
        ("simd", name.to_owned()),
        ("lanes", lanes.to_string()),
    ]
    .into()
}
