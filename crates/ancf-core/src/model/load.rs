//! Loads as a user states them.

use crate::mesh::Edge;

use super::{BodyId, History};

/// A load and how it varies.
#[derive(Clone, Debug, PartialEq)]
pub struct Load {
    /// What acts where.
    pub kind: LoadKind,
    /// Its factor over time, or over the load factor in statics.
    pub history: History,
}

/// What acts where.
#[derive(Clone, Debug, PartialEq)]
pub enum LoadKind {
    /// An acceleration of gravity on all bodies, m/s2.
    Gravity([f64; 3]),
    /// A dead force at a material point, N; its work is that of the point's own displacement.
    Force {
        /// The loaded body.
        body: BodyId,
        /// Natural coordinates of the point.
        point: [f64; 2],
        /// The force, N.
        force: [f64; 3],
    },
    /// A dead force per reference length of an edge, N/m.
    Line {
        /// The loaded body.
        body: BodyId,
        /// The loaded edge.
        edge: Edge,
        /// The force per length, N/m.
        per_length: [f64; 3],
    },
    /// A moment per reference length of an edge, N m/m, about the edge, following it. A positive one turns the
    /// outward direction of the edge towards the normal `r_x x r_y`. It does work on what the edge's own nodes hold: the
    /// gradient across the edge, in a solid `r_z`.
    Moment {
        /// The loaded body.
        body: BodyId,
        /// The loaded edge.
        edge: Edge,
        /// The moment per length, N m/m.
        per_length: f64,
    },
    /// A pressure on the current surface along its normal `r_x x r_y`, Pa.
    Pressure {
        /// The loaded body.
        body: BodyId,
        /// The pressure, Pa.
        pressure: f64,
    },
}

impl LoadKind {
    /// The numbers that make up the load, and their name in scene files.
    pub(crate) fn magnitude(&self) -> (&'static str, Vec<f64>) {
        match self {
            Self::Gravity(a) => ("acceleration", a.to_vec()),
            Self::Force { force, .. } => ("force", force.to_vec()),
            Self::Line { per_length, .. } => ("per_length", per_length.to_vec()),
            Self::Moment { per_length, .. } => ("per_length", vec![*per_length]),
            Self::Pressure { pressure, .. } => ("pressure", vec![*pressure]),
        }
    }
}
