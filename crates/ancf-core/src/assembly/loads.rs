//! The loads of a model: dead ones as force vectors, followers with their stiffness.

use nalgebra::Vector3;

use crate::element::{ElementBlock, Portion};
use crate::mesh::End;
use crate::model::{History, LoadKind, Model};
use crate::quadrature::Rule;

use super::follower::{Follower, Moment, Pressure};

/// A load that does not depend on the state.
struct Dead {
    history: History,
    force: Vec<f64>,
}

/// A load that depends on the state of a block.
struct Following {
    block: usize,
    history: History,
    load: Box<dyn Follower>,
}

/// All loads of a model. They are applied to its elements `blocks`, with its nodal coordinates `reference` at rest.
pub(super) struct Loads {
    dead: Vec<Dead>,
    following: Vec<Following>,
}

impl Loads {
    /// The loads of a model, whose nodal vectors stand for the masses `weight` in a uniform field.
    pub fn new(model: &Model, blocks: &[Box<dyn ElementBlock>], weight: &[f64]) -> Self {
        let mut loads = Self { dead: Vec::new(), following: Vec::new() };
        let reference = model.reference();
        for load in model.loads() {
            let history = load.history.clone();
            let mut force = vec![0.0; reference.len()];
            match load.kind {
                LoadKind::Gravity(acceleration) => {
                    for (target, weight) in force.chunks_mut(3).zip(weight) {
                        for (sum, a) in target.iter_mut().zip(acceleration) {
                            *sum = weight * a;
                        }
                    }
                }
                LoadKind::Force { body, point, force: f } => {
                    let grid = model.body(body).grid();
                    let (element, at) = grid.locate(point).expect("checked when the load was added");
                    add_at(blocks[body.index()].as_ref(), element, at, f, &mut force);
                }
                LoadKind::Line { body, edge, per_length } => {
                    let grid = model.body(body).grid();
                    let elements = blocks[body.index()].as_ref();
                    for element in grid.elements_at(edge) {
                        for (s, weight) in Rule::Gauss(4).points() {
                            let constant = f64::from(edge.end == End::High);
                            let at = if edge.across == 0 { [constant, s] } else { [s, constant] };
                            let orders = if edge.across == 0 { [0, 1] } else { [1, 0] };
                            let along = interpolate(elements, element, orders, at, reference);
                            let length = weight * grid.element_sides()[1 - edge.across] * along.norm();
                            add_at(elements, element, at, per_length.map(|f| f * length), &mut force);
                        }
                    }
                }
                LoadKind::Moment { body, edge, per_length } => {
                    let (block, grid, element) =
                        (body.index(), model.body(body).grid(), model.body(body).plate().element);
                    let elements = blocks[block].as_ref();
                    let load = Box::new(Moment::new(element, elements, grid, edge, per_length));
                    loads.following.push(Following { block, history, load });
                    continue;
                }
                LoadKind::Pressure { body, pressure } => {
                    let (block, grid) = (body.index(), model.body(body).grid());
                    let elements = blocks[block].as_ref();
                    let load = Box::new(Pressure::new(elements, grid, pressure));
                    loads.following.push(Following { block, history, load });
                    continue;
                }
            }
            loads.dead.push(Dead { history, force });
        }
        loads
    }

    /// The loads, each times a number that its history gives.
    pub fn sum(
        &self,
        blocks: &[Box<dyn ElementBlock>],
        reference: &[f64],
        q: &[f64],
        factor: impl Fn(&History) -> f64,
        force: &mut [f64],
    ) {
        force.fill(0.0);
        for load in &self.dead {
            let factor = factor(&load.history);
            for (sum, f) in force.iter_mut().zip(&load.force) {
                *sum += factor * f;
            }
        }
        for Following { block, history, load } in &self.following {
            load.add_force(blocks[*block].as_ref(), reference, q, factor(history), force);
        }
    }

    /// The factor of each follower at `t`.
    pub fn follower_factors(&self, t: f64) -> impl Iterator<Item = f64> {
        self.following.iter().map(move |following| following.history.factor(t))
    }

    /// Whether any load follows the surface.
    pub fn follow(&self) -> bool {
        !self.following.is_empty()
    }

    /// Subtracts the symmetric half of the followers' stiffness, each times its factor, from the tangents of elements of
    /// a block.
    pub fn subtract_stiffness(
        &self,
        blocks: &[Box<dyn ElementBlock>],
        block: usize,
        reference: &[f64],
        q: &[f64],
        factors: &[f64],
        portion: &mut Portion<'_>,
    ) {
        let size = portion.tangent.len() / portion.elements.len();
        for (following, &factor) in self.following.iter().zip(factors).filter(|(following, _)| following.block == block)
        {
            for (&element, tangent) in portion.elements.iter().zip(portion.tangent.chunks_exact_mut(size)) {
                following.load.subtract_stiffness(
                    blocks[block].as_ref(),
                    element as usize,
                    reference,
                    q,
                    factor,
                    tangent,
                );
            }
        }
    }

    /// Subtracts the skew half of the followers' stiffness, each times its factor, times `x` from `y`.
    pub fn subtract_skew_times(
        &self,
        blocks: &[Box<dyn ElementBlock>],
        reference: &[f64],
        (q, factors): &(Vec<f64>, Vec<f64>),
        x: &[f64],
        y: &mut [f64],
    ) {
        for (Following { block, load, .. }, factor) in self.following.iter().zip(factors) {
            load.add_skew_times(blocks[*block].as_ref(), reference, q, -factor, x, y);
        }
    }

    /// Work of the loads, held as they are at `t`, on the way between two states whose coordinates change at the rates
    /// `p0` and `p1` there, per unit of a parameter that runs from 0 to 1.
    ///
    /// Exact for dead loads. For a follower it is that of the mean force on the straight way, unless the rates of work
    /// at both ends bound it: a moment that turns an edge does the same work in each part of the way, and the straight
    /// way is too short.
    pub fn work(
        &self,
        blocks: &[Box<dyn ElementBlock>],
        reference: &[f64],
        t: f64,
        [q0, q1]: [&[f64]; 2],
        [p0, p1]: [&[f64]; 2],
    ) -> f64 {
        let along = |force: &[f64], p: &[f64]| force.iter().zip(p).map(|(f, p)| f * p).sum::<f64>();
        let straight: Vec<f64> = q0.iter().zip(q1).map(|(a, b)| b - a).collect();
        let dead = self.dead.iter().map(|load| load.history.factor(t) * along(&load.force, &straight));
        let following = self.following.iter().map(|Following { block, history, load }| {
            let [start, end] = [q0, q1].map(|q| {
                let mut force = vec![0.0; q.len()];
                load.add_force(blocks[*block].as_ref(), reference, q, history.factor(t), &mut force);
                force
            });
            let mean = 0.5 * (along(&start, &straight) + along(&end, &straight));
            let (a, b) = (along(&start, p0), along(&end, p1));
            mean.clamp(a.min(b), a.max(b))
        });
        dead.chain(following).sum()
    }
}

/// Adds a force at a point of an element.
fn add_at(elements: &dyn ElementBlock, element: usize, at: [f64; 2], value: [f64; 3], force: &mut [f64]) {
    let shape = elements.derivative([0, 0], at);
    for (vector, shape) in elements.vectors(element).iter().zip(shape) {
        for (sum, f) in force[3 * *vector as usize..][..3].iter_mut().zip(value) {
            *sum += shape * f;
        }
    }
}

/// The position, or a derivative of it, at a point of an element.
fn interpolate(
    elements: &dyn ElementBlock,
    element: usize,
    orders: [usize; 2],
    at: [f64; 2],
    q: &[f64],
) -> Vector3<f64> {
    let shape = elements.derivative(orders, at);
    let vectors = elements.vectors(element);
    shape.iter().zip(vectors).map(|(s, v)| *s * Vector3::from_column_slice(&q[3 * *v as usize..][..3])).sum()
}
