//! Some elements of a body side by side: their nodal vectors gathered into lanes, evaluated, and what they give handed on
//! element by element.

use std::any::Any;
use std::cell::Cell;

use pulp::{Simd, WithSimd};

use crate::lanes::{Aligned, Lanes, MAX_LANES, Transpose, Vector};
use crate::material::Damping;

use super::block::Block;
use super::constants::to_lanes;
use super::corners::{combine_all, distribute_all};
use super::kernel::{Batch, Flow};
use super::pairs::{tangent_size, to_pairs};
use super::portion::{At, Portion, Want};
use super::totals::{Tangent, Totals};

thread_local! {
    /// Room for tangents, kept from call to call: clearing it takes as long as a tenth of a small model.
    static ROOM: Cell<Option<Box<dyn Any>>> = const { Cell::new(None) };
}

/// Room for the tangents of a portion: in lanes, and of one element after the other.
struct Room<S: Simd, const N: usize> {
    combined: Tangent<S, N>,
    elements: Vec<f64>,
}

impl<S: Simd, const N: usize> Room<S, N> {
    /// What the last call on this thread has left, if it was for the same type of element.
    #[inline(always)]
    fn take(simd: S) -> Box<Self> {
        match ROOM.take().map(Box::<dyn Any>::downcast) {
            Some(Ok(room)) => room,
            _ => {
                let elements = vec![0.0; tangent_size(N) * S::F64_LANES];
                Box::new(Self { combined: Tangent::new(simd), elements })
            }
        }
    }
}

/// The most components of the nodal vectors of an element.
const MOST_FORCES: usize = 48;

/// Elements, evaluated with the instruction set that the processor has.
pub(super) struct Task<'a, 'b, const N: usize> {
    pub block: &'a Block<N>,
    pub elements: &'a [u32],
    pub at: At<'a>,
    pub want: Option<Want<'a>>,
    pub take: &'b mut dyn FnMut(Portion<'_>),
}

impl<const N: usize> WithSimd for Task<'_, '_, N> {
    type Output = ();

    #[inline(always)]
    fn with_simd<S: Simd>(self, simd: S) {
        let Self { block, elements, at, want, take } = self;
        let mut room = want.map(|_| Room::<S, N>::take(simd));
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
        let velocity = at.motion.filter(|_| block.flows(at)).map(|motion| motion.velocity);
        let others = [at.start, velocity, want.and_then(|want| want.previous)];
        // Rooms that are filled anew for each portion: to clear them takes as long as to fill them.
        let mut numbers = [[[0.0; MAX_LANES]; 3]; N];
        let mut current = Aligned([[Lanes::splat(simd, 0.0); 3]; N]);
        let [mut start, mut velocity, mut previous] = others.map(|q| q.map(|_| current));
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

            gather(simd, order, &block.vectors, members, at.q, &mut numbers, &mut current);
            for (to, q) in [&mut start, &mut velocity, &mut previous].into_iter().zip(others) {
                if let (Some(to), Some(q)) = (to, q) {
                    gather(simd, order, &block.vectors, members, q, &mut numbers, to);
                }
            }
            totals.clear(simd);
            if let Some(room) = &mut room {
                room.combined.empty = true;
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
            batch.evaluate(&mut totals, room.as_deref_mut().map(|room| &mut room.combined));

            let energy = by_element(order, totals.energy);
            let rates = by_element(order, totals.rates);
            distribute_all(&mut totals.force);
            store(order, totals.force.as_flattened(), force);
            let mut tangent = [].as_mut_slice();
            if let (Some(want), Some(room)) = (want, room.as_deref_mut()) {
                let Room { combined: Tangent { blocks, forms, .. }, elements } = room;
                let inertia = want.mass + want.stiffness * mass_damping * rate;
                let pairs = &mut forms.as_flattened_mut().as_flattened_mut()[..tangent_size(N)];
                to_pairs(blocks, want.stiffness * material, &mass, inertia, pairs);
                store(order, pairs, elements);
                tangent = &mut elements[..count * tangent_size(N)];
            }
            take(Portion {
                elements,
                energy: &energy[..count],
                rates: &rates[..count],
                force: &force[..count * 3 * N],
                tangent,
            });
        }
        if let Some(room) = room {
            ROOM.set(Some(room));
        }
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
    numbers: &mut [[[f64; MAX_LANES]; 3]; N],
    Aligned(lanes): &mut Aligned<[Vector<S>; N]>,
) {
    for (&member, &lane) in members.iter().zip(&order.lanes) {
        for a in 0..N {
            let vector = &q[3 * vectors[member as usize][a] as usize..][..3];
            for i in 0..3 {
                numbers[a][i][lane] = vector[i];
            }
        }
    }
    for a in 0..N {
        for i in 0..3 {
            lanes[a][i] = Lanes::from_array(simd, &numbers[a][i]);
        }
    }
    combine_all(lanes);
}

#[cfg(test)]
mod tests {
    use pulp::Arch;

    use super::*;
    use crate::element::Membrane;
    use crate::element::block::ElementBlock;
    use crate::element::constants::Section;
    use crate::element::full48::full48a;
    use crate::element::kind::Variant;
    use crate::element::portion::Motion;
    use crate::element::tables::Tables;
    use crate::element::thin::{thin36, thin48};
    use crate::lanes::arch;
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
        for elements in [4, usize::MAX] {
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
