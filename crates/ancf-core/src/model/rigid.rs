//! Rigid motions that the supports leave free: statics has no answer while there is one.

use std::fmt;

use nalgebra::{Matrix6, SymmetricEigen, Vector3, Vector6};

use crate::element::NodalVector;

use super::{Body, Model};

/// A small rigid motion of a body.
#[derive(Clone, Debug, PartialEq)]
pub struct RigidMotion {
    /// The body that can move.
    pub body: String,
    /// Translation and rotation of the motion, the rotation times the size of the body.
    pub motion: [f64; 6],
}

impl RigidMotion {
    /// The motion in words.
    pub fn describe(&self) -> String {
        let names = [
            "translation along x",
            "translation along y",
            "translation along z",
            "rotation about x",
            "rotation about y",
            "rotation about z",
        ];
        let parts: Vec<_> =
            names.iter().zip(self.motion).filter(|(_, m)| m.abs() > 0.1).map(|(name, _)| *name).collect();
        parts.join(" with ")
    }
}

impl fmt::Display for RigidMotion {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "body \"{}\": {}", self.body, self.describe())
    }
}

impl Model {
    /// The independent rigid motions that no support holds, about the state `q`.
    pub fn rigid_motions(&self, q: &[f64]) -> Vec<RigidMotion> {
        self.bodies().iter().flat_map(|body| self.rigid_motions_of(body, q)).collect()
    }

    fn rigid_motions_of(&self, body: &Body, q: &[f64]) -> Vec<RigidMotion> {
        let nodes = body.grid().nodes();
        let vector = |v: usize| Vector3::new(q[3 * v], q[3 * v + 1], q[3 * v + 2]);
        // Rotations are taken about the middle of the fixed positions, so that a hinge turns about itself.
        let fixed = |v: usize| self.fixed()[3 * v..3 * v + 3].contains(&true);
        let held: Vec<_> = (0..nodes).map(|n| body.vector(n, 0)).filter(|v| fixed(*v)).map(vector).collect();
        let all: Vec<_> = (0..nodes).map(|n| vector(body.vector(n, 0))).collect();
        let mean = |points: &[Vector3<f64>]| points.iter().sum::<Vector3<f64>>() / points.len() as f64;
        let centre = mean(if held.is_empty() { &all } else { &held });
        let size = all.iter().map(|r| (r - centre).norm()).fold(0.0, f64::max);

        let mut gram = Matrix6::<f64>::zeros();
        for node in 0..nodes {
            for (index, kind) in body.nodal_vectors().iter().enumerate() {
                let v = body.vector(node, index);
                // A vector that is zero at rest, as r_xy of a rectangle, keeps its value in any motion.
                if !fixed(v) || vector(v) == Vector3::zeros() && *kind != NodalVector::R {
                    continue;
                }
                let (value, scale, moved) = match kind {
                    NodalVector::R => (vector(v) - centre, size, 1.0),
                    _ => (vector(v), vector(v).norm(), 0.0),
                };
                for c in (0..3).filter(|c| self.fixed()[3 * v + c]) {
                    let axis = Vector3::ith(c, 1.0);
                    // Component c of w x value is w . (value x axis).
                    let turn = value.cross(&axis) / scale;
                    let row = Vector6::new(moved * axis.x, moved * axis.y, moved * axis.z, turn.x, turn.y, turn.z);
                    gram += row * row.transpose();
                }
            }
        }
        // The square of how far a support must hold a motion, relative to the others, to count: a millionth, so that the ends
        // of a strip ten thousand times as long as wide keep it from turning about itself.
        const HELD: f64 = 1e-12;
        let named = |motion: &Vector6<f64>| (gram * motion).norm() <= HELD * gram.norm().max(1.0);
        let eigen = SymmetricEigen::new(gram);
        let largest = eigen.eigenvalues.max().max(1.0);
        let free: Vec<Vector6<f64>> = (0..6)
            .filter(|i| eigen.eigenvalues[*i] <= HELD * largest)
            .map(|i| eigen.eigenvectors.column(i).into_owned())
            .collect();
        // Prefer motions that have a name of their own.
        let canonical: Vec<Vector6<f64>> = (0..6).map(|i| Vector6::ith(i, 1.0)).filter(|m| named(m)).collect();
        let chosen = if canonical.len() == free.len() { canonical } else { free };
        chosen.iter().map(|motion| RigidMotion { body: body.name().to_owned(), motion: (*motion).into() }).collect()
    }
}
