//! What supports exert on the bodies that they hold.

use nalgebra::Vector3;

use crate::element::NodalVector;
use crate::model::{Body, Support};

use super::System;

/// What a support exerts on its body: a force at a point, and a moment about it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Reaction {
    /// The mean position of the nodes of the support, m.
    pub point: [f64; 3],
    /// N.
    pub force: [f64; 3],
    /// N m.
    pub moment: [f64; 3],
}

impl Reaction {
    /// The one at `share` of the way to another, of each number.
    pub(crate) fn towards(&self, to: &Self, share: f64) -> Self {
        let between = |a: [f64; 3], b: [f64; 3]| [0, 1, 2].map(|i| a[i] + share * (b[i] - a[i]));
        Self {
            point: between(self.point, to.point),
            force: between(self.force, to.force),
            moment: between(self.moment, to.moment),
        }
    }
}

/// How far a support knows what it exerts.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Bodies {
    /// Each held coordinate has its own share of the residual.
    Flexible,
    /// Only the sums over a body are known: they are the reaction of its one support. Those of several are not determined.
    Rigid,
}

impl System {
    /// The reactions of all supports in a state. The residual `F` is what the equations of motion or of equilibrium lack,
    /// `M a + Q_k + damping - Q_e`: that of held coordinates is what their supports give.
    ///
    /// A support does the work `F . delta q` in a virtual displacement, so in a translation that of the sum of `F` over
    /// positions, and in a rotation, in which every nodal vector turns, that of the sum of `r x F` over all of them.
    pub(crate) fn reactions(&self, q: &[f64], residual: &[f64], bodies: Bodies) -> Vec<Reaction> {
        let supports = self.model.supports();
        let alone = |support: &Support| {
            supports.iter().filter(|s| s.body == support.body && !s.coordinates.is_empty()).count() == 1
        };
        let of_support = |support: &Support| {
            let body = self.model.body(support.body);
            let point: Vector3<f64> =
                support.nodes.iter().map(|&v| vector(q, v)).sum::<Vector3<f64>>() / support.nodes.len() as f64;
            let [force, moment] = match bodies {
                _ if support.coordinates.is_empty() => [Vector3::zeros(); 2],
                Bodies::Flexible => resultant(body, q, residual, &point, support.coordinates.iter().copied()),
                Bodies::Rigid if alone(support) => {
                    let all = 3 * body.vector(0, 0)..3 * body.vector(body.grid().nodes(), 0);
                    resultant(body, q, residual, &point, all)
                }
                Bodies::Rigid => [Vector3::repeat(f64::NAN); 2],
            };
            Reaction { point: point.into(), force: force.into(), moment: moment.into() }
        };
        supports.iter().map(of_support).collect()
    }
}

/// Resultant force, and moment about a point, of generalised forces on some coordinates of a body.
fn resultant(
    body: &Body,
    q: &[f64],
    generalised: &[f64],
    point: &Vector3<f64>,
    coordinates: impl Iterator<Item = usize>,
) -> [Vector3<f64>; 2] {
    let (first, kinds) = (body.vector(0, 0), body.nodal_vectors());
    let mut sums = [Vector3::zeros(); 2];
    for i in coordinates {
        let mut part = Vector3::zeros();
        part[i % 3] = generalised[i];
        let mut arm = vector(q, i / 3);
        if kinds[(i / 3 - first) % kinds.len()] == NodalVector::R {
            sums[0] += part;
            arm -= point;
        }
        sums[1] += arm.cross(&part);
    }
    sums
}

fn vector(x: &[f64], index: usize) -> Vector3<f64> {
    Vector3::from_column_slice(&x[3 * index..3 * index + 3])
}
