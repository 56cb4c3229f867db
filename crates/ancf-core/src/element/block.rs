//! All elements of a body: what they share, and their energies, forces and tangents side by side.

use std::cell::Cell;

use pulp::{Arch, Simd, WithSimd};

use crate::lanes::{Aligned, Lanes, MAX_LANES, Transpose, Vector, arch};
use crate::material::Damping;
use crate::strain::packed;

use super::classes::classes;
use super::constants::{COMPONENTS, Constants, Couplings, Section, to_lanes};
use super::corners::{combine_all, distribute_all};
use super::kernel::{Batch, Flow, Tangent, Totals, point_constants};
use super::operations::Operations;
use super::pairs::{tangent_size, to_pairs};
use super::tables::{Group, Tables};

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

/// Energies, forces and tangents of a few elements, one after the other.
pub struct Portion<'a> {
    /// The numbers of the elements in their body.
    pub elements: &'a [u32],
    /// Membrane and bending energy of each element.
    pub energy: &'a [[f64; 2]],
    /// Strain rates of each element as two numbers: `B v . W B v`, which times the viscosity is the power it takes, and
    /// for mean forces `s . (eps - eps_start - B (q - q_start))`, the energy that they miss. Zero without viscous stress.
    pub rates: &'a [[f64; 2]],
    /// Elastic and viscous force on the nodal vectors of each element: `3 N` numbers an element.
    pub force: &'a [f64],
    /// Tangent of each element, in the order of [`tangent_place`](super::tangent_place); empty unless it is wanted.
    pub tangent: &'a mut [f64],
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
    /// Evaluates some elements, the tangents if they are wanted, and hands what they give to `take`, a few at a time.
    fn evaluate(&self, elements: &[u32], at: At<'_>, want: Option<Want<'_>>, take: &mut dyn FnMut(Portion<'_>));
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

thread_local! {
    /// Memory for the tangents of a portion, kept from call to call: the system would clear it anew each time.
    static TANGENTS: Cell<Vec<f64>> = const { Cell::new(Vec::new()) };
}

/// The most components of the nodal vectors of an element.
const MOST_FORCES: usize = 48;

/// Elements, evaluated with the instruction set that the processor has.
struct Task<'a, 'b, const N: usize> {
    block: &'a Block<N>,
    elements: &'a [u32],
    at: At<'a>,
    want: Option<Want<'a>>,
    take: &'b mut dyn FnMut(Portion<'_>),
}

impl<const N: usize> WithSimd for Task<'_, '_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { block, elements, at, want, take } = self;
        let mut combined = want.map(|_| Tangent::<S, N>::new(simd));
        let size = if want.is_some() { tangent_size(N) } else { 0 };
        let mut tangent = TANGENTS.take();
        tangent.resize(size * S::F64_LANES, 0.0);
        let mut force = [0.0; MOST_FORCES * MAX_LANES];
        let force = &mut force[..3 * N * S::F64_LANES];
        let (mut constants, mut mass) = (Vec::new(), Vec::new());
        let Damping { mass: mass_damping, viscosity } = block.damping;
        let factor = at.motion.map_or(0.0, |motion| viscosity + motion.viscosity);
        let rate = at.motion.map_or(0.0, |motion| motion.rate);
        // Shares of the geometric and of the material stiffness.
        let geometric = if at.start.is_some() { 0.5 } else { 1.0 };
        let material = geometric + factor * rate;
        let order = Transpose::new(simd);
        let mut constants_of = [u32::MAX; MAX_LANES];
        let mut totals = Totals::<S, N>::new(simd);
        for elements in elements.chunks(S::F64_LANES) {
            // Beyond the last element it is repeated; what it gives there does not count.
            let count = elements.len();
            let mut members = [elements[count - 1]; MAX_LANES];
            members[..count].copy_from_slice(elements);
            let members = &members[..S::F64_LANES];

            let mut class_of = [u32::MAX; MAX_LANES];
            for (element, &member) in members.iter().enumerate() {
                class_of[element] = block.class_of[member as usize];
            }
            if class_of != constants_of {
                let mut classes = [&block.classes[0]; MAX_LANES];
                for (class, &index) in classes.iter_mut().zip(&class_of[..members.len()]) {
                    *class = &block.classes[index as usize];
                }
                let classes = &classes[..members.len()];
                to_lanes(simd, order, classes, |class| &class.values, &mut constants);
                if want.is_some() {
                    to_lanes(simd, order, classes, |class| &class.mass, &mut mass);
                }
                constants_of = class_of;
            }

            let current = gather(simd, order, &block.vectors, members, at.q);
            let [mut start, mut velocity, mut previous] = [const { None }; 3];
            if let Some(q) = at.start {
                start = Some(gather(simd, order, &block.vectors, members, q));
            }
            let motion = at.motion.filter(|_| block.flows(at));
            if let Some(motion) = motion {
                velocity = Some(gather(simd, order, &block.vectors, members, motion.velocity));
            }
            if let Some(q) = want.and_then(|want| want.previous) {
                previous = Some(gather(simd, order, &block.vectors, members, q));
            }
            totals.clear(simd);
            if let Some(combined) = &mut combined {
                combined.empty = true;
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

            let energy = by_element(order, totals.energy);
            let rates = by_element(order, totals.rates);
            store(order, distribute_all(&totals.force).as_flattened(), force);
            if let (Some(want), Some(Tangent { blocks, forms, .. })) = (want, &mut combined) {
                let inertia = want.mass + want.stiffness * mass_damping * rate;
                let pairs = &mut forms.as_flattened_mut().as_flattened_mut()[..size];
                to_pairs(blocks, want.stiffness * material, &mass, inertia, pairs);
                store(order, pairs, &mut tangent);
            }
            take(Portion {
                elements,
                energy: &energy[..count],
                rates: &rates[..count],
                force: &force[..count * 3 * N],
                tangent: &mut tangent[..count * size],
            });
        }
        TANGENTS.set(tangent);
    }
}

/// Two numbers of each element.
#[inline(always)]
fn by_element<S: Simd>(order: Transpose<S>, numbers: [Lanes<S>; 2]) -> [[f64; 2]; MAX_LANES] {
    let [first, second] = [numbers[0].to_array(), numbers[1].to_array()];
    let mut pairs = [[0.0; 2]; MAX_LANES];
    for (pair, &lane) in pairs.iter_mut().zip(&order.lanes) {
        *pair = [first[lane], second[lane]];
    }
    pairs
}

/// Forces or tangents from lanes to one element after the other.
#[inline(always)]
fn store<S: Simd>(order: Transpose<S>, numbers: &[Lanes<S>], elements: &mut [f64]) {
    // Of known length, so that nothing is checked in the loops: a tenth of the time of the cheapest element.
    match numbers.len() {
        36 => order.store::<36>(numbers, elements.as_chunks_mut().0),
        48 => order.store::<48>(numbers, elements.as_chunks_mut().0),
        810 => order.store::<810>(numbers, elements.as_chunks_mut().0),
        1440 => order.store::<1440>(numbers, elements.as_chunks_mut().0),
        size => unreachable!("forces or tangent of 12 or 16 vectors, not {size} numbers"),
    }
}

/// The nodal vectors of several elements in lanes, as sums and differences over the corners.
#[inline(always)]
fn gather<S: Simd, const N: usize>(
    simd: S,
    order: Transpose<S>,
    vectors: &[[u32; N]],
    members: &[u32],
    q: &[f64],
) -> Aligned<[Vector<S>; N]> {
    let mut numbers = [[[0.0; MAX_LANES]; 3]; N];
    for (&member, &lane) in members.iter().zip(&order.lanes) {
        for a in 0..N {
            let vector = &q[3 * vectors[member as usize][a] as usize..][..3];
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

#[cfg(test)]
mod tests {
    use super::*;
    use crate::element::Membrane;
    use crate::element::full48::full48a;
    use crate::element::kind::Variant;
    use crate::element::thin::{thin36, thin48};
    use crate::material::Material;
    use crate::strain::CurvatureLaw;

    const SIDES: [f64; 2] = [0.3, 0.2];
    const THICKNESS: f64 = 0.02;
    /// More than the widest register holds, and no multiple of any.
    const ELEMENTS: usize = 11;

    /// Elements apart from each other, each of another shape.
    fn block<const N: usize>(tables: Tables<N>) -> (Block<N>, Vec<f64>) {
        let kinds = N / 4;
        let mut q = Vec::new();
        for a in 0..ELEMENTS * N {
            let (corner, kind, bend) = (a / kinds % 4, a % kinds, 0.01 * (1.7 * a as f64).sin());
            let at = [f64::from(matches!(corner, 1 | 2)), f64::from(corner >= 2)];
            q.extend(match kind {
                0 => [SIDES[0] * at[0], SIDES[1] * at[1], bend],
                1 => [1.0, bend, 0.0],
                2 => [bend, 1.0, 0.0],
                _ => [0.0, bend, 1.0],
            });
        }
        let vectors = (0..ELEMENTS).map(|e| std::array::from_fn(|a| (e * N + a) as u32)).collect();
        let material =
            Material::new(1e5, 0.3, 1e3).unwrap().with_damping(Damping { mass: 0.4, viscosity: 0.02 }).unwrap();
        (Block::new(tables, vectors, &q, Section { material, thickness: THICKNESS }), q)
    }

    /// Energies, rates, forces and tangents with everything that a state can have.
    fn numbers<const N: usize>(block: &Block<N>, q: &[f64]) -> [Vec<f64>; 4] {
        let moved = |size: f64, phase: f64| -> Vec<f64> {
            q.iter().enumerate().map(|(i, x)| x + size * (0.37 * i as f64 + phase).sin()).collect()
        };
        let (now, start, previous, velocity) = (moved(2e-2, 0.0), moved(1e-2, 1.0), moved(3e-2, 2.0), moved(0.1, 3.0));
        let motion = Some(Motion { velocity: &velocity, rate: 20.0, viscosity: 0.01 });
        let want = Want { mass: 3.0, stiffness: 0.7, previous: Some(&previous) };
        let elements: Vec<u32> = (0..ELEMENTS as u32).rev().collect();
        let mut numbers = [const { Vec::new() }; 4];
        block.evaluate(&elements, At { q: &now, start: Some(&start), motion }, Some(want), &mut |portion| {
            numbers[0].extend(portion.energy.as_flattened());
            numbers[1].extend(portion.rates.as_flattened());
            numbers[2].extend_from_slice(portion.force);
            numbers[3].extend_from_slice(portion.tangent);
        });
        assert_eq!(numbers.each_ref().map(Vec::len), [2, 2, 3 * N, tangent_size(N)].map(|n| n * ELEMENTS));
        numbers
    }

    fn check<const N: usize>(tables: Tables<N>) {
        let (mut block, q) = block(tables);
        block.arch = Arch::Scalar;
        let expected = numbers(&block, &q);
        // A register of four numbers and the widest there is.
        for elements in [1, usize::MAX] {
            block.arch = arch(elements);
            for (numbers, expected) in numbers(&block, &q).iter().zip(&expected) {
                let largest = expected.iter().fold(0.0_f64, |most, x| most.max(x.abs()));
                let error = numbers.iter().zip(expected).fold(0.0_f64, |most, (a, b)| most.max((a - b).abs()));
                assert!(largest > 0.0 && error < 1e-12 * largest, "{error:e} of {largest:e} with {:?}", block.arch);
            }
        }
    }

    #[test]
    fn every_instruction_set_gives_the_same_numbers() {
        for membrane in Membrane::ALL {
            check(thin36(SIDES, Variant { membrane, curvature: CurvatureLaw::Paper }));
        }
        check(thin48(SIDES, Variant { membrane: Membrane::Projected, curvature: CurvatureLaw::Koiter }));
        check(full48a(SIDES, THICKNESS));
    }
}
