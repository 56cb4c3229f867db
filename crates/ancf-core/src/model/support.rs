//! Supports: nodal coordinates that keep their value at rest, or move as prescribed.

use std::str::FromStr;

use crate::element::NodalVector;
use crate::error::InputError;
use crate::mesh::Place;

use super::{BodyId, Model, SupportMotion};

/// Which coordinates of a node a support fixes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fix {
    /// The nodal vector.
    pub vector: NodalVector,
    /// One component of it, or all three.
    pub component: Option<usize>,
}

impl FromStr for Fix {
    type Err = InputError;

    /// Reads `r_x` (all components) or `r_x.z` (one).
    fn from_str(text: &str) -> Result<Self, InputError> {
        let names = || NodalVector::ALL.map(NodalVector::name).join(", ");
        let refuse =
            || InputError::new("fix", format!("\"{text}\""), format!("{}, or one component of one, as r.x", names()));
        let (name, component) = match text.split_once('.') {
            None => (text, None),
            Some((name, axis)) => (name, Some(["x", "y", "z"].iter().position(|a| *a == axis).ok_or_else(refuse)?)),
        };
        let vector = NodalVector::ALL.into_iter().find(|v| v.name() == name).ok_or_else(refuse)?;
        Ok(Self { vector, component })
    }
}

/// What one support holds.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Support {
    /// The body.
    pub body: BodyId,
    /// The positions of the nodes at its place, as nodal vectors.
    pub nodes: Vec<usize>,
    /// The nodal coordinates that it holds, but for those that an earlier support holds.
    pub coordinates: Vec<usize>,
}

/// A fixed coordinate that moves with its support.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Moved {
    /// The nodal coordinate.
    pub coordinate: usize,
    is_position: bool,
    motion: usize,
}

impl Model {
    /// Fixes coordinates of the nodes at a place at their reference values.
    ///
    /// # Errors
    ///
    /// The place must be on the body, the nodes must have the vectors, a component is 0, 1 or 2, and no coordinate may be
    /// moved by another support.
    pub fn fix(&mut self, id: BodyId, place: Place, fixes: &[Fix]) -> Result<(), InputError> {
        self.hold(id, place, fixes, None)
    }

    /// Fixes all coordinates of the nodes at a place.
    ///
    /// # Errors
    ///
    /// As [`fix`](Self::fix).
    pub fn clamp(&mut self, id: BodyId, place: Place) -> Result<(), InputError> {
        let vectors = self.body(id).nodal_vectors();
        self.fix(id, place, &Vec::from_iter(vectors.iter().map(|&vector| Fix { vector, component: None })))
    }

    /// Moves coordinates of the nodes at a place with a rigid motion.
    ///
    /// # Errors
    ///
    /// As [`fix`](Self::fix); the motion must be finite and begin at the reference configuration, and no coordinate may
    /// be held or moved differently by another support.
    pub fn move_support(
        &mut self,
        id: BodyId,
        place: Place,
        fixes: &[Fix],
        motion: SupportMotion,
    ) -> Result<(), InputError> {
        motion.validate()?;
        let index = self.motions.iter().position(|known| *known == motion).unwrap_or(self.motions.len());
        self.hold(id, place, fixes, Some(index))?;
        if index == self.motions.len() {
            self.motions.push(motion);
        }
        Ok(())
    }

    /// Adds a support that stands still, or has the motion of a number.
    fn hold(&mut self, id: BodyId, place: Place, fixes: &[Fix], motion: Option<usize>) -> Result<(), InputError> {
        let mut held = Vec::new();
        for fix in fixes {
            held.extend(self.coordinates_at(id, place, *fix)?);
        }
        for &(coordinate, _) in &held {
            self.check_support(coordinate, motion)?;
        }
        let body = self.body(id);
        let position = |node| body.find_vector(node, NodalVector::R).expect("every node has a position");
        let nodes = body.grid().nodes_at(place)?.into_iter().map(position).collect();
        let mut support = Support { body: id, nodes, coordinates: Vec::new() };
        for (coordinate, is_position) in held {
            if !self.fixed[coordinate] {
                self.fixed[coordinate] = true;
                support.coordinates.push(coordinate);
                self.moved.extend(motion.map(|motion| Moved { coordinate, is_position, motion }));
            }
        }
        self.supports.push(support);
        Ok(())
    }

    /// The supports, in the order in which they were added.
    pub fn supports(&self) -> &[Support] {
        &self.supports
    }

    /// The coordinates that move with supports.
    pub fn moved(&self) -> &[Moved] {
        &self.moved
    }

    /// The motions of supports.
    pub(crate) fn motions(&self) -> &[SupportMotion] {
        &self.motions
    }

    /// Value, velocity and acceleration of a moved coordinate at time `t`.
    pub fn prescribed(&self, moved: &Moved, t: f64) -> [f64; 3] {
        let vector = moved.coordinate / 3 * 3;
        let reference = [0, 1, 2].map(|c| self.reference[vector + c]);
        let motion = &self.motions[moved.motion];
        motion.at(t, reference, moved.is_position).map(|v| v[moved.coordinate - vector])
    }

    /// The coordinates that a support takes hold of, and whether each belongs to a position.
    fn coordinates_at(&self, id: BodyId, place: Place, fix: Fix) -> Result<Vec<(usize, bool)>, InputError> {
        let body = &self.bodies[id.0];
        let components = match fix.component {
            None => 0..3,
            Some(c @ 0..3) => c..c + 1,
            Some(c) => return Err(InputError::new("fix", c, "a component 0, 1 or 2")),
        };
        let mut coordinates = Vec::new();
        for node in body.grid().nodes_at(place)? {
            let vector = body.find_vector(node, fix.vector).ok_or_else(|| {
                let names: Vec<_> = body.nodal_vectors().iter().map(|v| v.name()).collect();
                InputError::new("fix", fix.vector.name(), names.join(", "))
            })?;
            coordinates.extend(components.clone().map(|c| (3 * vector + c, fix.vector == NodalVector::R)));
        }
        Ok(coordinates)
    }

    /// Two supports may hold the same coordinate only if they move it in the same way.
    fn check_support(&self, coordinate: usize, motion: Option<usize>) -> Result<(), InputError> {
        let known = self.moved.iter().find(|moved| moved.coordinate == coordinate).map(|moved| moved.motion);
        let value = format!("{}, which another support moves differently", self.describe(coordinate));
        let valid = !self.fixed[coordinate] || known == motion;
        InputError::check("at", value, valid, "one motion of each coordinate")
    }
}
