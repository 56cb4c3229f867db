//! Models: bodies, supports and loads, checked as they are added.

mod body;
mod history;
mod knots;
mod load;
mod prescribed;
mod rigid;
mod support;

pub use body::{Body, Plate};
pub use history::History;
pub use load::{Load, LoadKind};
pub use prescribed::{Course, Spline, SupportMotion};
pub use rigid::RigidMotion;
pub use support::{Fix, Moved, Support};

use crate::error::InputError;
use crate::mesh::{Edge, End, Place, Surface};

/// Refers to a body of the model that made it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct BodyId(usize);

impl BodyId {
    /// The place of the body among those of its model.
    pub(crate) fn index(self) -> usize {
        self.0
    }
}

/// Bodies, supports and loads.
///
/// The nodal coordinates of all bodies form one vector: body after body, node after node, nodal vector after nodal
/// vector, three components each.
#[derive(Clone, Debug, Default)]
pub struct Model {
    bodies: Vec<Body>,
    reference: Vec<f64>,
    fixed: Vec<bool>,
    supports: Vec<Support>,
    loads: Vec<Load>,
    moved: Vec<Moved>,
    motions: Vec<SupportMotion>,
}

impl Model {
    /// A model without bodies.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds a body.
    ///
    /// # Errors
    ///
    /// The name must be new, the thickness from 1e-30 to 1e30 m, the divisions at least one and those of a surface given at nodes;
    /// the element must have the membrane and curvature variants.
    pub fn add_body(
        &mut self,
        name: &str,
        surface: &Surface,
        divisions: [usize; 2],
        plate: Plate,
    ) -> Result<BodyId, InputError> {
        let new = self.bodies.iter().all(|body| body.name() != name);
        InputError::check("name", name, new, "a name that no other body has")?;
        let body = Body::new(name, surface, divisions, plate, self.reference.len() / 3)?;
        self.reference.extend(body.reference(surface)?);
        self.fixed.resize(self.reference.len(), false);
        self.bodies.push(body);
        Ok(BodyId(self.bodies.len() - 1))
    }

    /// Finds a body by its name.
    ///
    /// # Errors
    ///
    /// There must be one of that name.
    pub fn find(&self, name: &str) -> Result<BodyId, InputError> {
        let names = || self.bodies.iter().map(Body::name).collect::<Vec<_>>().join(", ");
        let found = self.bodies.iter().position(|body| body.name() == name);
        found.map(BodyId).ok_or_else(|| InputError::new("body", format!("\"{name}\""), names()))
    }

    /// The body.
    pub fn body(&self, id: BodyId) -> &Body {
        &self.bodies[id.0]
    }

    /// All bodies.
    pub fn bodies(&self) -> &[Body] {
        &self.bodies
    }

    /// All loads.
    pub fn loads(&self) -> &[Load] {
        &self.loads
    }

    /// The same model, bodies that have no density with this one, kg/m3.
    pub(crate) fn with_density_where_none(&self, density: f64) -> Self {
        let bodies = self.bodies.iter().map(|body| body.with_density_where_none(density)).collect();
        Self { bodies, ..self.clone() }
    }

    /// The times, or load factors, strictly between two at which a load changes its rate, or a table that moves a support
    /// has a row, in the order they are met. Left out is what straight lines smooth out within `tolerance`, relative to the
    /// largest value of each table.
    pub fn kinks(&self, from: f64, to: f64, tolerance: f64) -> impl Iterator<Item = f64> + use<> {
        let between = |t: &f64| from.min(to) < *t && *t < from.max(to);
        let of_loads = self.loads.iter().flat_map(|load| load.history.kinks(tolerance));
        let of_supports = self.motions.iter().flat_map(|motion| motion.kinks(tolerance));
        let mut kinks: Vec<f64> = of_loads.chain(of_supports).filter(between).collect();
        kinks.sort_by(|a, b| ((a - from).abs()).total_cmp(&(b - from).abs()));
        kinks.dedup();
        kinks.into_iter()
    }

    /// The nodal coordinates at rest.
    pub fn reference(&self) -> &[f64] {
        &self.reference
    }

    /// Whether each nodal coordinate is fixed.
    pub fn fixed(&self) -> &[bool] {
        &self.fixed
    }

    /// Says which coordinate it is: component, place and body.
    pub(crate) fn describe(&self, coordinate: usize) -> String {
        let vector = coordinate / 3;
        let body = self.bodies.iter().rfind(|body| body.vector(0, 0) <= vector).expect("a coordinate of a body");
        let (own, count) = (vector - body.vector(0, 0), body.nodal_vectors().len());
        let name = body.nodal_vectors()[own % count].name();
        let at = Place::Point(body.grid().parameters(own / count));
        format!("{name}.{} at {at} of body \"{}\"", ["x", "y", "z"][coordinate % 3], body.name())
    }

    /// Adds a load.
    ///
    /// # Errors
    ///
    /// Its numbers must be finite, a point must lie in the body.
    pub fn add_load(&mut self, load: Load) -> Result<(), InputError> {
        let (name, numbers) = load.kind.magnitude();
        InputError::check(name, format!("{numbers:?}"), numbers.iter().all(|x| x.is_finite()), "finite numbers")?;
        if let LoadKind::Force { body, point, .. } = load.kind {
            self.body(body).grid().locate(point)?;
        }
        self.loads.push(load);
        Ok(())
    }

    /// The point a force can act at: a corner or a material point.
    ///
    /// # Errors
    ///
    /// Other places are refused.
    pub fn point_at(&self, id: BodyId, place: Place) -> Result<[f64; 2], InputError> {
        let [x, y] = *self.body(id).grid().domain();
        let at = |range: [f64; 2], end: End| if end == End::High { range[1] } else { range[0] };
        match place {
            Place::Corner([ex, ey]) => Ok([at(x, ex), at(y, ey)]),
            Place::Point(point) => Ok(point),
            Place::Edge(_) | Place::All => Err(place.refuse("at", "a corner or a point [x, y]")),
        }
    }

    /// The edge a line load or a moment can act on.
    ///
    /// # Errors
    ///
    /// Other places are refused.
    pub fn edge_at(place: Place) -> Result<Edge, InputError> {
        match place {
            Place::Edge(edge) => Ok(edge),
            _ => Err(place.refuse("at", "edge:x0, edge:x1, edge:y0 or edge:y1")),
        }
    }
}
