//! What the sources may name.
//!
//! Reference: the layers that `lib.rs` describes.
//! Goal: the linear algebra library stays behind `linear`, Python stays outside, dependencies point one way, elements come
//! whole.

use std::fs;
use std::path::{Path, PathBuf};

use ancf_core::element::Kind;

/// The modules from the lowest layer to the highest; each may name only those before it, or beside it.
const LAYERS: [&[&str]; 9] = [
    &["error", "lanes", "quadrature", "linear"],
    &["shape", "strain", "material", "mesh"],
    &["element"],
    &["model"],
    &["assembly"],
    &["evaluate", "observe"],
    &["nonlinear"],
    &["report"],
    &["statics", "dynamics", "modes"],
];

/// All source files of the crate with their lines, comments left out.
fn sources() -> Vec<(PathBuf, Vec<String>)> {
    fn visit(directory: &Path, files: &mut Vec<PathBuf>) {
        for entry in fs::read_dir(directory).unwrap() {
            let path = entry.unwrap().path();
            if path.is_dir() {
                visit(&path, files);
            } else if path.extension().is_some_and(|extension| extension == "rs") {
                files.push(path);
            }
        }
    }
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let mut files = Vec::new();
    visit(&root, &mut files);
    assert!(files.len() > 20, "{files:?}");
    files
        .into_iter()
        .map(|path| {
            let text = fs::read_to_string(&path).unwrap();
            let code = text.lines().filter(|line| !line.trim_start().starts_with("//")).map(str::to_owned).collect();
            (path.strip_prefix(&root).unwrap().to_owned(), code)
        })
        .collect()
}

/// The module that a file belongs to.
fn module(path: &Path) -> String {
    Path::new(path.components().next().unwrap().as_os_str()).file_stem().unwrap().to_string_lossy().into_owned()
}

#[test]
fn only_linear_names_faer() {
    for (path, code) in sources() {
        let found = code.iter().find(|line| line.contains("use faer") || line.contains("faer::"));
        assert!(module(&path) == "linear" || found.is_none(), "{}: {found:?}", path.display());
    }
}

#[test]
fn the_core_knows_no_python() {
    let manifest = fs::read_to_string(Path::new(env!("CARGO_MANIFEST_DIR")).join("Cargo.toml")).unwrap();
    assert!(!manifest.contains("pyo3") && !manifest.contains("numpy"));
    for (path, code) in sources() {
        let found = code.iter().find(|line| line.contains("pyo3"));
        assert!(found.is_none(), "{}: {found:?}", path.display());
    }
}

#[test]
fn dependencies_point_one_way() {
    let layer = |module: &str| LAYERS.iter().position(|layer| layer.contains(&module));
    for (path, code) in sources().into_iter().filter(|(path, _)| path != Path::new("lib.rs")) {
        let own = module(&path);
        let level = layer(&own).unwrap_or_else(|| panic!("{own} has no layer"));
        for line in &code {
            for part in line.split("crate::").skip(1) {
                let named: String = part.chars().take_while(|c| c.is_alphanumeric() || *c == '_').collect();
                // What lib.rs exports itself is below everything.
                if let Some(other) = layer(&named) {
                    assert!(other <= level, "{} is below {named}: {line}", path.display());
                }
            }
        }
    }
}

/// What CONTRIBUTING.md asks of an element, beside the suites that run over every `Kind`.
#[test]
fn elements_come_with_all_their_pieces() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    for element in Kind::ALL.map(Kind::name) {
        for (piece, mention) in [
            ("python/ancf/bodies.py".to_owned(), format!("\"{element}\": (")),
            ("python/ancf/reference/elements.py".to_owned(), format!("\"{element}\": (")),
            ("benchmarks/convergence.py".to_owned(), format!("\"{element}\": (")),
            (format!("docs/elements/{element}.md"), format!("# `{element}`")),
        ] {
            let text = fs::read_to_string(root.join(&piece)).unwrap_or_default();
            assert!(text.contains(&mention), "{piece} lacks {mention}");
        }
    }
}
