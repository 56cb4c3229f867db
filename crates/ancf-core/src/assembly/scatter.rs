//! From elements to the global forces and the global tangent, the same sum in the same order on any number of threads.
//!
//! Each part of the model evaluates its elements and adds what they give at once, while it is in the cache: to its own
//! columns of the tangent, which no other part touches, or to copies of the columns on its border. Then each part adds the
//! copies that earlier parts have made of its columns, in their order.

use std::sync::Arc;
use std::time::{Duration, Instant};

use pulp::Arch;
use rayon::prelude::*;

use crate::element::Portion;
use crate::lanes::arch;
use crate::linear::{LinearError, Pattern};

use super::columns::Columns;
use super::numbering::{Node, Numbering};
use super::parts::Part;
use super::tangent::Tangents;

/// Nodes whose forces are put in their places by one task.
const TASK: usize = 4096;

/// The registers by which tangents are added: two of four numbers and one number are a column of a node with three vectors.
const COLUMN: usize = 4;

/// Where each entry of element forces and tangents goes.
#[derive(Clone, Debug)]
pub(super) struct Scatter {
    pattern: Arc<Pattern>,
    nodes: Vec<Node>,
    /// The place of each node in the order of elimination.
    place: Vec<usize>,
    columns: Columns,
    parts: Vec<Part>,
    arch: Arch,
}

/// What a part gives beside its own columns and forces.
#[derive(Clone, Debug, Default)]
pub(super) struct Subtotal {
    /// Columns and forces of the nodes on its border.
    border: [Vec<f64>; 2],
    /// Membrane and bending energy in each block.
    pub energy: Vec<[f64; 2]>,
    /// Strain rates in each block, as in [`Portion`].
    pub rates: Vec<[f64; 2]>,
    /// The time for the elements, and that for their sum.
    time: [Duration; 2],
}

/// A global vector or matrix in the order of elimination, to be shared out among parts.
struct Rest<'a>(&'a mut [f64]);

impl<'a> Rest<'a> {
    /// The next numbers.
    fn take(&mut self, count: usize) -> &'a mut [f64] {
        self.0.split_off_mut(..count).expect("as many as all parts have")
    }
}

impl Scatter {
    /// Makes the pattern of the tangent and the places of all element entries in it.
    pub fn new(numbering: &Numbering) -> Result<Self, LinearError> {
        let (columns, pattern) = Columns::new(numbering)?;
        let parts = Part::cut(numbering, &columns);
        let (nodes, place) = (numbering.nodes.clone(), numbering.place.clone());
        Ok(Self { pattern: Arc::new(pattern), nodes, place, columns, parts, arch: arch(COLUMN) })
    }

    /// The pattern of the tangent.
    pub fn pattern(&self) -> &Arc<Pattern> {
        &self.pattern
    }

    /// Evaluates all elements and sums their forces into `force`, over all coordinates of the model, and their tangents
    /// into `values`, in the order of the pattern, if they are wanted. `evaluate` hands what elements of a block give to its
    /// last argument; `ordered` has room for the forces. Returns the time that the sums take of the time for all.
    pub fn sum(
        &self,
        evaluate: impl Fn(usize, &[u32], &mut dyn FnMut(Portion<'_>)) + Sync,
        mut values: Option<&mut [f64]>,
        ordered: &mut [f64],
        force: &mut [f64],
        subtotals: &mut Vec<Subtotal>,
    ) -> Duration {
        let begin = Instant::now();
        subtotals.resize(self.parts.len(), Subtotal::default());
        let tasks = self.share(values.as_deref_mut(), ordered).zip(subtotals.iter_mut());
        each(self.parts.len(), tasks, |((part, sums), subtotal)| self.sum_part(part, &evaluate, sums, subtotal));
        let time = |i: usize| subtotals.iter().map(|subtotal| subtotal.time[i]).sum::<Duration>().as_secs_f64();
        let share = time(1) / (time(0) + time(1)).max(f64::MIN_POSITIVE);
        let sums = begin.elapsed().mul_f64(share);

        let begin = Instant::now();
        each(self.parts.len(), self.share(values, ordered), |(part, sums)| self.sum_shares(part, sums, subtotals));
        self.place_forces(ordered, force);
        sums + begin.elapsed()
    }

    /// The parts, each with its own columns and forces.
    fn share<'a>(
        &'a self,
        values: Option<&'a mut [f64]>,
        ordered: &'a mut [f64],
    ) -> impl Iterator<Item = (&'a Part, [&'a mut [f64]; 2])> {
        let wanted = values.is_some();
        let (mut values, mut ordered) = (Rest(values.unwrap_or_default()), Rest(ordered));
        self.parts.iter().map(move |part| {
            let columns = &self.columns.of[part.nodes.clone()];
            let (first, last) = (&columns[0], &columns[columns.len() - 1]);
            let entries = if wanted { last.start + last.entries() - first.start } else { 0 };
            (part, [values.take(entries), ordered.take(last.forces.end - first.forces.start)])
        })
    }

    /// Evaluates the elements of a part and adds what they give.
    fn sum_part(
        &self,
        part: &Part,
        evaluate: &impl Fn(usize, &[u32], &mut dyn FnMut(Portion<'_>)),
        [values, force]: [&mut [f64]; 2],
        subtotal: &mut Subtotal,
    ) {
        let mut start = Instant::now();
        let Subtotal { border, energy, rates, time } = subtotal;
        // To look at the clock for each portion takes a fiftieth of a force without tangents.
        let tangents = !values.is_empty();
        values.fill(0.0);
        force.fill(0.0);
        for ((border, size), wanted) in border.iter_mut().zip(part.border_size).zip([tangents, true]) {
            border.clear();
            border.resize(if wanted { size } else { 0 }, 0.0);
        }
        energy.clear();
        rates.clear();
        let mut slots = part.slots.as_slice();
        *time = [Duration::ZERO; 2];
        if tangents {
            // Of the sum, not of the elements that follow.
            let cleared = Instant::now();
            time[1] = cleared - start;
            start = cleared;
        }
        for (block, elements) in part.elements.iter().enumerate() {
            let (mut block_energy, mut block_rates) = ([0.0; 2], [0.0; 2]);
            evaluate(block, elements, &mut |portion| {
                let evaluated = tangents.then(Instant::now);
                let count = portion.elements.len();
                let own;
                (own, slots) = slots.split_at(count);
                for (element, slots) in own.iter().enumerate() {
                    for i in 0..2 {
                        block_energy[i] += portion.energy[element][i];
                        block_rates[i] += portion.rates[element][i];
                    }
                    let size = portion.force.len() / count;
                    let forces = &portion.force[element * size..(element + 1) * size];
                    for (corner, forces) in slots.corners.iter().zip(forces.chunks_exact(size / 4)) {
                        let target = if corner.inside { &mut *force } else { &mut border[1] };
                        let target = &mut target[corner.first[1] as usize..];
                        match size {
                            36 => add_node::<9>(target, forces),
                            48 => add_node::<12>(target, forces),
                            _ => add(target, forces),
                        }
                    }
                }
                if !portion.tangent.is_empty() {
                    let (columns, tangents, border) = (&self.columns, portion.tangent, &mut border[0]);
                    self.arch.dispatch(Tangents { columns, slots: own, tangents, values, border });
                }
                if let Some(evaluated) = evaluated {
                    time[0] += evaluated - start;
                    start = Instant::now();
                    time[1] += start - evaluated;
                }
            });
            energy.push(block_energy);
            rates.push(block_rates);
        }
    }

    /// Adds to the columns and forces of a part what earlier ones have summed for them.
    fn sum_shares(&self, part: &Part, [values, force]: [&mut [f64]; 2], subtotals: &[Subtotal]) {
        let first = &self.columns.of[part.nodes.start];
        for share in &part.shares {
            let border = &self.parts[share.part].border[share.border];
            let column = &self.columns.of[border.place];
            let [tangent, forces] = &subtotals[share.part].border;
            if !values.is_empty() {
                add(&mut values[column.start - first.start..], &tangent[border.first[0]..][..column.entries()]);
            }
            add(
                &mut force[column.forces.start - first.forces.start..],
                &forces[border.first[1]..][..column.forces.len()],
            );
        }
    }

    /// Puts forces from the order of elimination into that of the model.
    fn place_forces(&self, ordered: &[f64], force: &mut [f64]) {
        let mut rest = Rest(force);
        let tasks = self.nodes.chunks(TASK).zip(self.place.chunks(TASK)).map(|(nodes, place)| {
            let count = nodes.iter().map(|node| 3 * node.vectors).sum();
            (place, rest.take(count))
        });
        each(self.nodes.len().div_ceil(TASK), tasks, |(place, force)| {
            let mut rest = Rest(force);
            for &place in place {
                let own = &ordered[self.columns.of[place].forces.clone()];
                rest.take(own.len()).copy_from_slice(own);
            }
        });
    }
}

/// Does all of `count` tasks, in parallel if there are several.
fn each<T: Send>(count: usize, tasks: impl Iterator<Item = T>, work: impl Fn(T) + Send + Sync) {
    if count == 1 {
        tasks.for_each(work);
    } else {
        tasks.collect::<Vec<_>>().into_par_iter().for_each(work);
    }
}

/// Adds the forces of a node, of known number.
fn add_node<const SIZE: usize>(sums: &mut [f64], parts: &[f64]) {
    let sums = sums.first_chunk_mut::<SIZE>().expect("forces of the node");
    let parts = parts.first_chunk::<SIZE>().expect("forces of the node");
    for i in 0..SIZE {
        sums[i] += parts[i];
    }
}

/// Adds to the first numbers.
fn add(sums: &mut [f64], parts: &[f64]) {
    for (sum, part) in sums.iter_mut().zip(parts) {
        *sum += part;
    }
}
