//! Prints the memory that an element takes on regular and on curved meshes of 64 x 64 elements: the table of
//! `docs/elements`.
//!
//! `cargo run --release --package ancf-core --example memory`

use std::error::Error;
use std::sync::Arc;

use ancf_core::assembly::System;
use ancf_core::element::Kind;
use ancf_core::mesh::{Surface, SurfacePoint};
use ancf_core::model::{Model, Plate};
use ancf_core::{InputError, Material};

const DIVISIONS: usize = 64;

fn main() -> Result<(), Box<dyn Error>> {
    print!("{}", table()?);
    Ok(())
}

/// The table, in Markdown.
pub fn table() -> Result<String, Box<dyn Error>> {
    let shapes = [
        ("rectangle", Surface::rectangle([1.0, 1.0])?),
        ("cylinder", Surface::cylinder(1.0, [0.0, 1.0], [0.0, 1.0])?),
        ("annulus", Surface::annulus([1.0, 2.0], 1.0)?),
        ("sphere", Surface::sphere(1.0, [0.0, 1.0], [0.1, 1.0])?),
        ("skew saddle", saddle()?),
    ];
    let names: Vec<_> = shapes.iter().map(|(name, _)| *name).collect();
    let mut table = format!("| element | {} |\n|---{}|\n", names.join(" | "), "|---".repeat(names.len()));
    for element in Kind::ALL {
        let bytes = shapes.iter().map(|(_, surface)| bytes(element, surface)).collect::<Result<Vec<_>, _>>()?;
        table += &format!("| `{}` | {} |\n", element.name(), bytes.join(" | "));
    }
    Ok(table)
}

/// What an element takes, rounded up to whole bytes.
fn bytes(element: Kind, surface: &Surface) -> Result<String, Box<dyn Error>> {
    let material = Material::new(2.1e11, 0.3, 7800.0)?;
    let plate = Plate { material, thickness: 0.01, element, membrane: None, curvature: None };
    let mut model = Model::new();
    model.add_body("shell", surface, [DIVISIONS; 2], plate)?;
    let system = System::new(Arc::new(model))?;
    Ok(system.element_bytes().div_ceil(system.elements()).to_string())
}

/// A surface without two congruent elements: `(x + 0.3 y, y, x y / 2 + x^2 / 3)` over a square off the middle.
fn saddle() -> Result<Surface, InputError> {
    let node = |i: usize, j: usize| {
        let [x, y] = [i, j].map(|k| 1.0 + k as f64 / DIVISIONS as f64);
        SurfacePoint {
            r: [x + 0.3 * y, y, 0.5 * x * y + x * x / 3.0],
            r_x: [1.0, 0.0, 0.5 * y + 2.0 / 3.0 * x],
            r_y: [0.3, 1.0, 0.5 * x],
            r_xy: [0.0, 0.0, 0.5],
        }
    };
    let nodes = (0..=DIVISIONS).flat_map(|j| (0..=DIVISIONS).map(move |i| node(i, j)));
    Surface::from_nodes([[1.0, 2.0]; 2], [DIVISIONS; 2], nodes.collect())
}
