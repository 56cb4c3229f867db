//! The mass matrix, factorised at a third of its size: components of vectors do not mix.

use std::sync::Arc;

use crate::assembly::System;
use crate::linear::{Factorization, LinearError, Pattern, SymmetricMatrix};
use crate::nonlinear::Failure;

/// The scalar mass matrix over nodal vectors and its factors.
pub(super) struct Inertia {
    matrix: SymmetricMatrix,
    parts: Vec<Part>,
    positions: Vec<usize>,
}

/// Components whose free nodal vectors are the same.
struct Part {
    components: [bool; 3],
    vectors: Vec<usize>,
    factorization: Factorization,
    /// Room for the components of the vectors.
    right: Vec<[f64; 4]>,
}

impl Inertia {
    /// The mass matrix that the system has now.
    pub fn new(system: &System) -> Result<Self, Failure> {
        if let Some(body) = system.model().bodies().iter().find(|body| body.plate().material.density() == 0.0) {
            return Err(Failure::Massless { body: body.name().to_owned() });
        }
        let matrix = system.mass().clone();
        let mut parts: Vec<Part> = Vec::new();
        for component in 0..3 {
            let of_component = system.free().iter().filter(|coordinate| *coordinate % 3 == component);
            let vectors: Vec<usize> = of_component.map(|coordinate| coordinate / 3).collect();
            if let Some(part) = parts.iter_mut().find(|part| part.vectors == vectors) {
                part.components[component] = true;
            } else {
                let factorization = factorize(&matrix, &vectors)
                    .map_err(|e| Failure::from_linear(e, 0, |row| format!("nodal vector {}", vectors[row])))?;
                let right = vec![[0.0; 4]; vectors.len()];
                parts.push(Part { components: [0, 1, 2].map(|c| c == component), vectors, factorization, right });
            }
        }
        Ok(Self { matrix, parts, positions: system.positions().collect() })
    }

    /// The nodal vectors that are positions.
    pub fn positions(&self) -> &[usize] {
        &self.positions
    }

    /// The matrix, over nodal vectors.
    pub fn matrix(&self) -> &SymmetricMatrix {
        &self.matrix
    }

    /// Adds `M x` to `y`.
    pub fn add_product(&self, x: &[f64], y: &mut [f64]) {
        self.matrix.multiply_add::<3>(x, y);
    }

    /// Solves `M x = right` for the free coordinates; leaves the others of `x` as they are.
    pub fn solve(&mut self, right: &[f64], x: &mut [f64]) {
        for part in &mut self.parts {
            let Part { components, vectors, factorization, right: packed } = part;
            for (packed, vector) in packed.iter_mut().zip(&*vectors) {
                // What else there is of a vector is solved for, too, but not used.
                packed[..3].copy_from_slice(&right[3 * vector..3 * vector + 3]);
            }
            factorization.solve_four(packed);
            for (packed, vector) in packed.iter().zip(&*vectors) {
                for (c, x) in x[3 * vector..3 * vector + 3].iter_mut().enumerate() {
                    if components[c] {
                        *x = packed[c];
                    }
                }
            }
        }
    }
}

/// Factorises the part of a matrix with these rows and columns, in their order.
fn factorize(matrix: &SymmetricMatrix, vectors: &[usize]) -> Result<Factorization, LinearError> {
    let mut number = vec![usize::MAX; matrix.pattern().n()];
    for (i, &vector) in vectors.iter().enumerate() {
        number[vector] = i;
    }
    let mut columns = vec![Vec::new(); vectors.len()];
    for &column in vectors {
        for (k, &row) in matrix.pattern().rows(column).iter().enumerate() {
            if number[row] != usize::MAX {
                let (i, j) = (number[row].max(number[column]), number[row].min(number[column]));
                columns[j].push((i, matrix.values()[matrix.pattern().col_ptr()[column] + k]));
            }
        }
    }
    let (mut col_ptr, mut row_idx, mut values) = (vec![0], Vec::new(), Vec::new());
    for column in &mut columns {
        column.sort_unstable_by_key(|entry| entry.0);
        row_idx.extend(column.iter().map(|entry| entry.0));
        values.extend(column.iter().map(|entry| entry.1));
        col_ptr.push(row_idx.len());
    }
    let mut factorization = Factorization::new(Arc::new(Pattern::new(vectors.len(), col_ptr, row_idx)?))?;
    factorization.factorize(&values)?;
    Ok(factorization)
}
