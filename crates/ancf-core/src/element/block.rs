//! All elements of a body: what they share, and their energies, forces and tangents side by side.

use pulp::{Arch, Simd, WithSimd};
use rayon::prelude::*;

use crate::lanes::{Aligned, Lanes, MAX_LANES, Transpose, Vector, arch};
use crate::material::Damping;
use crate::strain::{self, packed};

use super::classes::classes;
use super::constants::{COMPONENTS, Constants, Couplings, Section, to_lanes};
use super::corners::{combine_all, distribute, distribute_all};
use super::kernel::{Batch, Flow, Tangent, Totals, point_constants};
use super::operations::Operations;
use super::tables::{Group, Tables};

/// Elements handled by one task: a multiple of every number of lanes, and long enough to be worth a task.
const TASK: usize = 64;

/// The state at which elements are evaluated.
#[derive(Clone, Copy, Debug)]
pub struct At<'a> {
    /// Nodal coordinates.
    pub q: &'a [f64],
    /// Nodal coordinates at the start of a step, if mean forces over the step are wanted: the stress of the mean
    /// strain, on the directions `B` at the mean coordinates.
    ///
    /// # Source
    ///
    /// Simo and Tarnow (1994).
    pub start: Option<&'a [f64]>,
    /// Velocities, none: elastic forces only.
    pub motion: Option<Motion<'a>>,
}

impl<'a> At<'a> {
    /// At rest.
    pub fn rest(q: &'a [f64]) -> Self {
        Self { q, start: None, motion: None }
    }
}

/// Velocities, which damping acts on: the viscous stress is `(eta + viscosity) W B v`.
#[derive(Clone, Copy, Debug)]
pub struct Motion<'a> {
    /// Velocities `v` of the nodal coordinates.
    pub velocity: &'a [f64],
    /// Derivative of the velocities with respect to the nodal coordinates in the time step, 1/s; for mean forces the
    /// inverse of the step.
    pub rate: f64,
    /// Viscosity in addition to the material's `eta`, s.
    pub viscosity: f64,
}

/// Which combination of mass and stiffness a tangent is, and how the stiffness is made.
#[derive(Clone, Copy, Debug)]
pub struct Want<'a> {
    /// Factor of the mass matrix.
    pub mass: f64,
    /// Factor of the stiffness.
    pub stiffness: f64,
    /// Coordinates before the last Newton correction, if the geometric stiffness is to use the stress extrapolated
    /// from there (mixed-integration-point Newton).
    pub previous: Option<&'a [f64]>,
}

/// Energies, forces and tangents of all elements of a body.
#[derive(Clone, Debug, Default)]
pub struct Outcome {
    /// Membrane and bending energy of each element.
    pub energy: Vec<[f64; 2]>,
    /// Strain rates of each element as two numbers: `B v . W B v`, which times the viscosity is the power it takes, and
    /// for mean forces `s . (eps - eps_start - B (q - q_start))`, the energy that they miss. Empty without viscous stress.
    pub rates: Vec<[f64; 2]>,
    /// Elastic and viscous force on the nodal vectors of each element: `3 N` numbers an element.
    pub force: Vec<f64>,
    /// Packed symmetric blocks of each element's tangent, column by column, `a <= b`: `9 N (N + 1) / 2` numbers.
    pub tangent: Vec<f64>,
}

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
    /// Evaluates all elements; the tangents if they are wanted.
    fn evaluate(&self, at: At<'_>, want: Option<Want<'_>>, outcome: &mut Outcome);
    /// The derivatives of an element's shape functions, `in_x` and `in_y` times, at `(xi, eta)`.
    fn derivative(&self, orders: [usize; 2], point: [f64; 2]) -> Vec<f64>;
}

/// Elements with `N` nodal vectors, equal parameter sides and one section.
pub(crate) struct Block<const N: usize> {
    arch: Arch,
    tables: Tables<N>,
    couplings: Couplings,
    classes: Vec<Constants>,
    class_of: Vec<u32>,
    vectors: Vec<[u32; N]>,
    damping: Damping,
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
    fn flows(&self, at: At<'_>) -> bool {
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
            let coupled = |position: usize| {
                classes.iter().any(|class| {
                    let largest = (0..modes).map(|k| class.values[start + packed(k, k)]).fold(0.0, f64::max);
                    class.values[start + position].abs() > 1e-15 * largest
                })
            };
            let position = |k: usize, l: usize| packed(k.min(l), k.max(l));
            return (0..modes)
                .map(|k| (0..modes).map(|l| (l, position(k, l))).filter(|(_, p)| coupled(*p)).collect())
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

    fn evaluate(&self, at: At<'_>, want: Option<Want<'_>>, outcome: &mut Outcome) {
        let elements = self.elements();
        let tangent_size = if want.is_some() { 9 * N * (N + 1) / 2 } else { 0 };
        let rates_size = usize::from(self.flows(at));
        outcome.energy.resize(elements, [0.0; 2]);
        outcome.rates.resize(elements * rates_size, [0.0; 2]);
        outcome.force.resize(elements * 3 * N, 0.0);
        outcome.tangent.resize(elements * tangent_size, 0.0);

        let mut tasks = Vec::with_capacity(elements.div_ceil(TASK));
        let (mut rates, mut tangent) = (outcome.rates.as_mut_slice(), outcome.tangent.as_mut_slice());
        let parts = outcome.energy.chunks_mut(TASK).zip(outcome.force.chunks_mut(TASK * 3 * N));
        for (i, (energy, force)) in parts.enumerate() {
            let (rates_part, rates_rest) = rates.split_at_mut(energy.len() * rates_size);
            let (tangent_part, tangent_rest) = tangent.split_at_mut(energy.len() * tangent_size);
            (rates, tangent) = (rates_rest, tangent_rest);
            let first = i * TASK;
            tasks.push(Task { block: self, at, want, first, energy, rates: rates_part, force, tangent: tangent_part });
        }
        if let [_] = tasks.as_slice() {
            tasks.into_iter().for_each(|task| self.arch.dispatch(task));
        } else {
            tasks.into_par_iter().for_each(|task| self.arch.dispatch(task));
        }
    }
}

/// Consecutive elements, evaluated with the instruction set that the processor has.
struct Task<'a, const N: usize> {
    block: &'a Block<N>,
    at: At<'a>,
    want: Option<Want<'a>>,
    first: usize,
    energy: &'a mut [[f64; 2]],
    rates: &'a mut [[f64; 2]],
    force: &'a mut [f64],
    tangent: &'a mut [f64],
}

impl<const N: usize> WithSimd for Task<'_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { block, at, want, first, energy, rates, force, tangent } = self;
        let count = energy.len();
        let mut combined = want.map(|_| Tangent::<S, N>::new(simd));
        let (mut constants, mut mass) = (Vec::new(), Vec::new());
        let Damping { mass: mass_damping, viscosity } = block.damping;
        let factor = at.motion.map_or(0.0, |motion| viscosity + motion.viscosity);
        let rate = at.motion.map_or(0.0, |motion| motion.rate);
        // Shares of the geometric and of the material stiffness.
        let geometric = if at.start.is_some() { 0.5 } else { 1.0 };
        let material = geometric + factor * rate;
        let order = Transpose::new(simd);
        let mut constants_of = [u32::MAX; MAX_LANES];
        for begin in (0..count).step_by(S::F64_LANES) {
            // Lanes beyond the last element repeat it; what they give is not stored.
            let mut members = [0; MAX_LANES];
            for (lane, member) in members[..S::F64_LANES].iter_mut().enumerate() {
                *member = first + (begin + lane).min(count - 1);
            }
            let members = &members[..S::F64_LANES];

            let mut class_of = [u32::MAX; MAX_LANES];
            for (lane, &member) in members.iter().enumerate() {
                class_of[lane] = block.class_of[member];
            }
            if class_of != constants_of {
                let mut classes = [&block.classes[0]; MAX_LANES];
                for (class, &index) in classes.iter_mut().zip(&class_of[..members.len()]) {
                    *class = &block.classes[index as usize];
                }
                let classes = &classes[..members.len()];
                to_lanes(simd, classes, |class| &class.values, &mut constants);
                if want.is_some() {
                    to_lanes(simd, classes, |class| &class.mass, &mut mass);
                }
                constants_of = class_of;
            }

            let current = gather(simd, &block.vectors, members, at.q);
            let [mut start, mut velocity, mut previous] = [const { None }; 3];
            if let Some(q) = at.start {
                start = Some(gather(simd, &block.vectors, members, q));
            }
            let motion = at.motion.filter(|_| block.flows(at));
            if let Some(motion) = motion {
                velocity = Some(gather(simd, &block.vectors, members, motion.velocity));
            }
            if let Some(q) = want.and_then(|want| want.previous) {
                previous = Some(gather(simd, &block.vectors, members, q));
            }
            let mut totals = Totals::<S, N>::new(simd);
            if let Some(combined) = &mut combined {
                combined.clear(simd);
            }
            let batch = Batch {
                simd,
                tables: &block.tables,
                couplings: &block.couplings,
                constants: &constants,
                current: &current.0,
                previous: previous.as_ref().map(|vectors| &vectors.0),
                start: start.as_ref().map(|vectors| &vectors.0),
                flow: velocity.as_ref().map(|Aligned(velocity)| Flow { velocity, factor, rate }),
                geometric: geometric / material,
            };
            batch.evaluate(&mut totals, combined.as_mut());

            let lanes = S::F64_LANES.min(count - begin);
            for (i, part) in totals.energy.iter().enumerate() {
                let values = part.to_array();
                for lane in 0..lanes {
                    energy[begin + lane][i] = values[lane];
                }
            }
            if !rates.is_empty() {
                for (i, part) in totals.rates.iter().enumerate() {
                    let values = part.to_array();
                    for lane in 0..lanes {
                        rates[begin + lane][i] = values[lane];
                    }
                }
            }
            let forces = distribute_all(&totals.force);
            order.store(forces.as_flattened(), 0, 3 * N, &mut force[begin * 3 * N..(begin + lanes) * 3 * N]);
            if let (Some(want), Some(combined)) = (want, &mut combined) {
                to_corners(&mut combined.blocks);
                let size = 9 * N * (N + 1) / 2;
                let target = &mut tangent[begin * size..(begin + lanes) * size];
                let stiffness = Lanes::splat(simd, want.stiffness * material);
                let inertia = want.mass + want.stiffness * mass_damping * rate;
                for b in 0..N {
                    for a in 0..=b {
                        let mut block = combined.blocks[b][a];
                        let inertia = mass[packed(a, b)] * inertia;
                        for i in 0..3 {
                            for j in 0..3 {
                                block[i][j] = block[i][j] * stiffness;
                            }
                            block[i][i] = block[i][i] + inertia;
                        }
                        order.store(block.as_flattened(), 9 * packed(a, b), size, target);
                    }
                }
            }
        }
    }
}

/// The nodal vectors of several elements in lanes, as sums and differences over the corners.
#[inline(always)]
fn gather<S: Simd, const N: usize>(
    simd: S,
    vectors: &[[u32; N]],
    members: &[usize],
    q: &[f64],
) -> Aligned<[Vector<S>; N]> {
    let mut numbers = [[[0.0; MAX_LANES]; 3]; N];
    for (lane, &member) in members.iter().enumerate() {
        for a in 0..N {
            let vector = &q[3 * vectors[member][a] as usize..][..3];
            for i in 0..3 {
                numbers[a][i][lane] = vector[i];
            }
        }
    }
    let mut lanes = [[Lanes::splat(simd, 0.0); 3]; N];
    for a in 0..N {
        for i in 0..3 {
            lanes[a][i] = Lanes::from_array(simd, &numbers[a][i]);
        }
    }
    Aligned(combine_all(&lanes))
}

/// Turns the tangent of the sums and differences over the corners, `blocks[b][a]` for `a <= b`, into that of the nodal
/// vectors.
#[inline(always)]
fn to_corners<S: Simd, const N: usize>(blocks: &mut [[strain::Block<S>; N]; N]) {
    let kinds = N / 4;
    for u in 0..kinds {
        for v in u..kinds {
            // Only the upper half is stored; entries of the lower one are those of transposed blocks.
            let stored = |row: usize, column: usize| (row * kinds + u) <= (column * kinds + v);
            for i in 0..3 {
                for j in (if u == v { i } else { 0 })..3 {
                    let mut rows = [[blocks[0][0][0][0]; 4]; 4];
                    for row in 0..4 {
                        for column in 0..4 {
                            let (a, b) = (row * kinds + u, column * kinds + v);
                            rows[row][column] =
                                if stored(row, column) { blocks[b][a][i][j] } else { blocks[a][b][j][i] };
                        }
                        rows[row] = distribute(rows[row]);
                    }
                    for column in 0..4 {
                        let entries = distribute([rows[0][column], rows[1][column], rows[2][column], rows[3][column]]);
                        for row in 0..4 {
                            let (a, b) = (row * kinds + u, column * kinds + v);
                            if stored(row, column) {
                                blocks[b][a][i][j] = entries[row];
                            } else {
                                blocks[a][b][j][i] = entries[row];
                            }
                            if a == b {
                                blocks[b][b][j][i] = entries[row];
                            }
                        }
                    }
                }
            }
        }
    }
}
