//! Bodies: a reference surface, its mesh, its section and the element that models it.

use crate::element::{ElementBlock, Kind, Membrane, NodalVector, Section, Variant};
use crate::error::InputError;
use crate::material::Material;
use crate::mesh::{Grid, Surface};
use crate::quadrature::Rule;
use crate::strain::CurvatureLaw;

/// What a plate is made of and how it is modelled.
#[derive(Clone, Copy, Debug)]
pub struct Plate {
    /// The material.
    pub material: Material,
    /// Thickness, m.
    pub thickness: f64,
    /// The element type.
    pub element: Kind,
    /// How the membrane strain is sampled; none for the default, and for solid elements.
    pub membrane: Option<Membrane>,
    /// The variant of the curvature; none for the default, and for solid elements.
    pub curvature: Option<CurvatureLaw>,
}

/// A body of a model.
#[derive(Clone, Debug)]
pub struct Body {
    name: String,
    grid: Grid,
    plate: Plate,
    variant: Variant,
    first_vector: usize,
}

impl Body {
    /// A body whose nodal vectors are numbered from `first_vector`.
    pub(super) fn new(
        name: &str,
        surface: &Surface,
        divisions: [usize; 2],
        plate: Plate,
        first_vector: usize,
    ) -> Result<Self, InputError> {
        let h = plate.thickness;
        InputError::check("thickness", h, (1e-30..=1e30).contains(&h), "from 1e-30 to 1e30, m")?;
        let variant = plate.element.variant(plate.membrane, plate.curvature)?;
        let grid = Grid::new(surface.domain(), divisions)?;
        Ok(Self { name: name.to_owned(), grid, plate, variant, first_vector })
    }

    /// The same with this density, kg/m3, if it has none.
    pub(super) fn with_density_where_none(&self, density: f64) -> Self {
        let material = self.plate.material.with_density_where_none(density);
        Self { plate: Plate { material, ..self.plate }, ..self.clone() }
    }

    /// The name.
    pub fn name(&self) -> &str {
        &self.name
    }

    /// The mesh.
    pub fn grid(&self) -> &Grid {
        &self.grid
    }

    /// What the body is made of and how it is modelled.
    pub fn plate(&self) -> &Plate {
        &self.plate
    }

    /// The vectors at each node.
    pub fn nodal_vectors(&self) -> &'static [NodalVector] {
        self.plate.element.nodal_vectors()
    }

    /// The model-wide number of a node's nodal vector.
    pub fn vector(&self, node: usize, index: usize) -> usize {
        self.first_vector + node * self.nodal_vectors().len() + index
    }

    /// The model-wide number of a node's nodal vector of the given kind.
    pub(super) fn find_vector(&self, node: usize, kind: NodalVector) -> Option<usize> {
        self.nodal_vectors().iter().position(|v| *v == kind).map(|index| self.vector(node, index))
    }

    /// The model-wide numbers of an element's nodal vectors.
    pub(crate) fn element_vectors(&self, element: usize) -> impl Iterator<Item = usize> {
        let count = self.nodal_vectors().len();
        self.grid.cell(element).into_iter().flat_map(move |node| (0..count).map(move |i| self.vector(node, i)))
    }

    /// The nodal coordinates of the reference surface.
    pub(super) fn reference(&self, surface: &Surface) -> Result<Vec<f64>, InputError> {
        let points = surface.at_nodes(&self.grid)?;
        Ok(points.iter().flat_map(|point| self.nodal_vectors().iter().flat_map(|v| v.of(point))).collect())
    }

    /// The elements, ready to be evaluated; `reference` are the nodal coordinates of the whole model at rest.
    pub fn elements(&self, reference: &[f64]) -> Box<dyn ElementBlock> {
        let Plate { material, thickness, element, .. } = self.plate;
        let section = Section { material, thickness };
        let vectors = (0..self.grid.elements()).flat_map(|element| self.element_vectors(element));
        let vectors: Vec<u32> = vectors.map(|vector| vector as u32).collect();
        element.block(self.grid.element_sides(), self.variant, section, &vectors, reference)
    }

    /// The variant of the curvature.
    pub(crate) fn curvature(&self) -> CurvatureLaw {
        self.variant.curvature
    }

    /// How the membrane strain of a thin element is sampled.
    pub(crate) fn membrane(&self) -> Option<Membrane> {
        (!self.plate.element.is_solid()).then_some(self.variant.membrane)
    }

    /// The points of an element at which its membrane strain and its curvature, or its strain, are sampled: relative to
    /// its sides.
    pub fn samples(&self) -> [Vec<[f64; 2]>; 2] {
        let rules = self.membrane().map_or([Rule::Gauss(4); 2], |membrane| membrane.rules().into());
        rules.map(|rule| rule.square().into_iter().map(|(at, _)| at).collect())
    }

    /// The shape functions of the vector through the thickness of a solid at a point of an element, and their first
    /// derivatives.
    pub(crate) fn director(&self, at: [f64; 2]) -> Option<[Vec<f64>; 3]> {
        let sides = self.grid.element_sides();
        let tables = [[0, 0], [1, 0], [0, 1]].map(|orders| self.plate.element.director_functions(sides, orders, at));
        self.plate.element.is_solid().then_some(tables)
    }

    /// The nodal vectors of an element and its shape functions at a point of it: `N`, `N_x`, `N_y`, `N_xx`, `N_yy`,
    /// `N_xy`.
    pub(crate) fn shape(&self, element: usize, at: [f64; 2]) -> (Vec<usize>, [Vec<f64>; 6]) {
        const ORDERS: [[usize; 2]; 6] = [[0, 0], [1, 0], [0, 1], [2, 0], [0, 2], [1, 1]];
        let sides = self.grid.element_sides();
        let tables = ORDERS.map(|orders| self.plate.element.shape_functions(sides, orders, at));
        (self.element_vectors(element).collect(), tables)
    }
}
