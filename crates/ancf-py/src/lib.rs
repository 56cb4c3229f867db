//! The extension module `ancf._core`: declarations only, the mechanics is in `ancf_core`.

mod arguments;
mod arrays;
mod background;
mod errors;
mod model;
mod run;
mod shape;
mod solve;

use pyo3::prelude::*;

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

    #[pymodule_init]
    fn init(_module: &pyo3::Bound<'_, pyo3::types::PyModule>) -> pyo3::PyResult<()> {
        super::keep_memory();
        Ok(())
    }

    #[allow(non_upper_case_globals, reason = "the name that Python expects")]
    #[pymodule_export]
    const __version__: &str = env!("CARGO_PKG_VERSION");
}

/// A block that glibc's allocator maps apart, below the largest that changes its thresholds, bytes.
const BLOCK: usize = 31 << 20;

/// Makes the system's allocator keep what a run frees for the next one: an eighth of the time of a small model went into
/// fetching memory again, page by page.
///
/// When a block that was mapped apart is freed, glibc takes blocks of its size from the heap from then on and keeps twice as
/// much there (mallopt(3), `M_MMAP_THRESHOLD`). Any program that frees a large array gets there. This one is never touched,
/// and elsewhere has no effect.
fn keep_memory() {
    drop(std::hint::black_box(Vec::<u8>::with_capacity(BLOCK)));
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
