//! All elements of a body: what they share, and what they give.

use pulp::Arch;

use crate::lanes::arch;
use crate::material::Damping;
use crate::strain::packed;

use super::classes::classes;
use super::constants::{COMPONENTS, Constants, Couplings, Section};
use super::kernel::point_constants;
use super::operations::Operations;
use super::portion::{At, Portion, Want};
use super::tables::{Group, Tables};
use super::task::Task;

/// The elements of a body, whatever their type.
pub trait ElementBlock: Send + Sync {
    /// Number of elements.
    fn elements(&self) -> usize;
    /// Number of nodal vectors of an element.
    fn vectors_per_element(&self) -> usize;
    /// The nodal vectors of an element, numbered through the model.
    fn vectors(&self, element: usize) -> &[u32];
    /// Packed scalar mass matrix of an element, `a <= b`.
    fn mass(&self, element: usize) -> &[f64];
    /// The mass each nodal vector of an element stands for in a uniform field.
    fn weight(&self, element: usize) -> &[f64];
    /// Number of different reference shapes among the elements.
    fn classes(&self) -> usize;
    /// Memory of the elements, bytes: the numbers of their nodal vectors and of their classes, and the constants of each
    /// class; without the shape tables, which they all share.
    fn bytes(&self) -> usize;
    /// Mass-proportional and viscous damping.
    fn damping(&self) -> Damping;
    /// Floating-point operations of an element.
    fn operations(&self) -> Operations;
    /// Evaluates some elements, the tangents if they are wanted, and hands what they give to `take`, a few at a time.
    fn evaluate(&self, elements: &[u32], at: At<'_>, want: Option<Want<'_>>, take: &mut dyn FnMut(Portion<'_>));
    /// The derivatives of an element's shape functions, `in_x` and `in_y` times, at `(xi, eta)`.
    fn derivative(&self, orders: [usize; 2], point: [f64; 2]) -> Vec<f64>;
}

/// Elements with `N` nodal vectors, equal parameter sides and one section.
pub(crate) struct Block<const N: usize> {
    pub(super) arch: Arch,
    pub(super) tables: Tables<N>,
    pub(super) couplings: Couplings,
    pub(super) classes: Vec<Constants>,
    pub(super) class_of: Vec<u32>,
    pub(super) vectors: Vec<[u32; N]>,
    pub(super) damping: Damping,
}

impl<const N: usize> Block<N> {
    /// Elements on the nodal vectors `vectors`, whose reference state is the nodal coordinates `reference`.
    pub fn new(tables: Tables<N>, vectors: Vec<[u32; N]>, reference: &[f64], section: Section) -> Self {
        let (classes, class_of) = classes(&tables, &vectors, reference, section);
        let couplings = couplings(&tables, &classes);
        let damping = section.material.damping();
        Self { arch: arch(vectors.len()), tables, couplings, classes, class_of, vectors, damping }
    }
}

impl<const N: usize> Block<N> {
    /// Whether strain rates matter.
    pub(super) fn flows(&self, at: At<'_>) -> bool {
        at.motion.is_some_and(|motion| at.start.is_some() || self.damping.viscosity + motion.viscosity != 0.0)
    }
}

/// The nodal vectors of an element.
pub(super) fn coordinates<const N: usize>(vectors: &[u32; N], q: &[f64]) -> [[f64; 3]; N] {
    vectors.map(|v| [q[3 * v as usize], q[3 * v as usize + 1], q[3 * v as usize + 2]])
}

/// The pairs of generalised strains that are coupled in any class.
fn couplings<const N: usize>(tables: &Tables<N>, classes: &[Constants]) -> Couplings {
    let mut start = 0;
    for group in &tables.groups {
        if let Group::Projected(samples, projection) = group {
            start += samples.tables.len() * point_constants(COMPONENTS);
            let modes = projection.modes.len();
            let mut coupled = vec![false; modes * (modes + 1) / 2];
            for class in classes {
                let matrix = &class.values[start..start + coupled.len()];
                // Compared with the diagonals of both strains: the units of x and y do not count.
                for l in 0..modes {
                    for k in 0..=l {
                        let scale = (matrix[packed(k, k)] * matrix[packed(l, l)]).sqrt();
                        coupled[packed(k, l)] |= matrix[packed(k, l)].abs() > 1e-15 * scale;
                    }
                }
            }
            let position = |k: usize, l: usize| packed(k.min(l), k.max(l));
            return (0..modes)
                .map(|k| (0..modes).map(|l| (l, position(k, l))).filter(|(_, p)| coupled[*p]).collect())
                .collect();
        }
        start += group.constants();
    }
    Couplings::new()
}

impl<const N: usize> ElementBlock for Block<N> {
    fn elements(&self) -> usize {
        self.vectors.len()
    }

    fn vectors_per_element(&self) -> usize {
        N
    }

    fn vectors(&self, element: usize) -> &[u32] {
        &self.vectors[element]
    }

    fn mass(&self, element: usize) -> &[f64] {
        &self.classes[self.class_of[element] as usize].mass
    }

    fn weight(&self, element: usize) -> &[f64] {
        &self.classes[self.class_of[element] as usize].weight
    }

    fn classes(&self) -> usize {
        self.classes.len()
    }

    fn bytes(&self) -> usize {
        let numbers = |class: &Constants| class.values.len() + class.mass.len() + class.weight.len();
        size_of_val(self.vectors.as_slice())
            + size_of_val(self.class_of.as_slice())
            + size_of::<f64>() * self.classes.iter().map(numbers).sum::<usize>()
    }

    fn derivative(&self, orders: [usize; 2], point: [f64; 2]) -> Vec<f64> {
        self.tables.derivative(orders, point).to_vec()
    }

    fn operations(&self) -> Operations {
        Operations::count(&self.tables, &self.couplings)
    }

    fn damping(&self) -> Damping {
        self.damping
    }

    fn evaluate(&self, elements: &[u32], at: At<'_>, want: Option<Want<'_>>, take: &mut dyn FnMut(Portion<'_>)) {
        self.arch.dispatch(Task { block: self, elements, at, want, take });
    }
}
