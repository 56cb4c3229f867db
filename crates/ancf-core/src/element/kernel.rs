//! Energy, force and tangent of several elements side by side, for every strain measure.

use pulp::Simd;

use crate::lanes::{Lanes, Vector, axpy, table_axpy};
use crate::strain::{Block, Curvature, Measure, Metric, packed};

use super::constants::point_stride;
use super::projection::Projection;
use super::tables::{Group, Samples, Tables};

/// Positions in the packed weights of the generalised strains that are not zero in every element: `(k, l, position)`.
pub(crate) type Couplings = Vec<(usize, usize, usize)>;

/// A batch of elements that share their tables.
pub(crate) struct Batch<'a, S: Simd, const N: usize> {
    pub simd: S,
    pub tables: &'a Tables<N>,
    pub couplings: &'a Couplings,
    pub constants: &'a [Lanes<S>],
    /// The nodal vectors of the current state.
    pub current: &'a [Vector<S>; N],
    /// The nodal vectors of the state before the last Newton correction, when the geometric stiffness is to use the
    /// stress extrapolated from there instead of the current one.
    pub previous: Option<&'a [Vector<S>; N]>,
}

/// What a batch gives; each part is added to.
pub(crate) struct Totals<S: Simd, const N: usize> {
    /// Energy of each sample group.
    pub energy: [Lanes<S>; 2],
    /// Elastic force on each nodal vector.
    pub force: [Vector<S>; N],
    /// Tangent, packed blocks; empty if it is not wanted.
    pub tangent: Vec<Block<S>>,
}

impl<S: Simd, const N: usize> Totals<S, N> {
    /// Zeros.
    #[inline(always)]
    pub fn new(simd: S, with_tangent: bool) -> Self {
        let zero = Lanes::splat(simd, 0.0);
        let blocks = if with_tangent { N * (N + 1) / 2 } else { 0 };
        Self { energy: [zero; 2], force: [[zero; 3]; N], tangent: vec![[[zero; 3]; 3]; blocks] }
    }

    /// Back to zeros.
    #[inline(always)]
    pub fn clear(&mut self, simd: S) {
        let zero = Lanes::splat(simd, 0.0);
        self.energy = [zero; 2];
        self.force = [[zero; 3]; N];
        self.tangent.fill([[zero; 3]; 3]);
    }
}

impl<S: Simd, const N: usize> Batch<'_, S, N> {
    /// Adds energy, force and, if `totals` has room for it, the tangent of the batch.
    #[inline(always)]
    pub fn evaluate(&self, totals: &mut Totals<S, N>) {
        let mut offset = 0;
        for (index, group) in self.tables.groups.iter().enumerate() {
            offset += match group {
                Group::Membrane(samples) => {
                    self.samples::<Metric<S>, 2, 3>(samples, (), &self.constants[offset..], index, totals)
                }
                Group::Bending(samples, law) => {
                    self.samples::<Curvature<S>, 5, 3>(samples, *law, &self.constants[offset..], index, totals)
                }
            };
        }
    }

    /// The same for one group of samples; returns how many constants it has.
    #[inline(always)]
    fn samples<M: Measure<S, D, C>, const D: usize, const C: usize>(
        &self,
        samples: &Samples<N, D>,
        law: M::Law,
        constants: &[Lanes<S>],
        index: usize,
        totals: &mut Totals<S, N>,
    ) -> usize {
        let zero = Lanes::splat(self.simd, 0.0);
        let points = samples.tables.len();
        let weights = Weights {
            projection: samples.projection.as_ref(),
            quadrature: &samples.weights,
            couplings: self.couplings,
            constants,
        };
        let with_tangent = !totals.tangent.is_empty();

        // Strains, and those that the last correction would have led to in a linear problem.
        let mut measures = Vec::with_capacity(points);
        let mut strain = vec![[zero; C]; points];
        let mut extrapolated = vec![[zero; C]; if with_tangent && self.previous.is_some() { points } else { 0 }];
        for (g, table) in samples.tables.iter().enumerate() {
            let area = constants[g * point_stride(C)];
            let gradients = gradients(zero, table, self.current);
            let measure = M::new(law, gradients, area);
            let value = measure.strain();
            for c in 0..C {
                strain[g][c] = value[c] - weights.reference::<C>(g, c);
            }
            measures.push(measure);
            if let (Some(previous), false) = (self.previous, extrapolated.is_empty()) {
                let before = self::gradients(zero, table, previous);
                let mut step = gradients;
                for d in 0..D {
                    for i in 0..3 {
                        step[d][i] = gradients[d][i] - before[d][i];
                    }
                }
                let start = M::new(law, before, area);
                let (value, change) = (start.strain(), start.change(&step));
                for c in 0..C {
                    extrapolated[g][c] = value[c] + change[c] - weights.reference::<C>(g, c);
                }
            }
        }

        // Stresses, energy, forces.
        let mut stress = vec![[zero; C]; points];
        weights.apply(zero, &strain, &mut stress);
        for (g, table) in samples.tables.iter().enumerate() {
            for c in 0..C {
                totals.energy[index] = (stress[g][c] * 0.5).mul_add(strain[g][c], totals.energy[index]);
            }
            let forces = measures[g].forces(stress[g]);
            for (d, row) in table.iter().enumerate() {
                for a in 0..N {
                    totals.force[a] = table_axpy(row[a], forces[d], totals.force[a]);
                }
            }
        }

        if with_tangent {
            if !extrapolated.is_empty() {
                weights.apply(zero, &extrapolated, &mut stress);
            }
            for (g, table) in samples.tables.iter().enumerate() {
                measures[g].add_second(stress[g], table, &mut totals.tangent);
                let mut rows = [[[zero; 3]; C]; N];
                let mut weighted = [[[zero; 3]; C]; N];
                for a in 0..N {
                    let mut entries = [0.0; D];
                    for d in 0..D {
                        entries[d] = table[d][a];
                    }
                    rows[a] = measures[g].row(entries);
                    for c in 0..C {
                        for other in 0..C {
                            weighted[a][c] = axpy(weights.entry::<C>(g, c, other), rows[a][other], weighted[a][c]);
                        }
                    }
                }
                add_products(&rows, &weighted, &mut totals.tangent);
            }
            if let Some(projection) = weights.projection {
                self.add_projected(samples, projection, &weights, &measures, &mut totals.tangent);
            }
        }
        weights.len::<C>(points)
    }

    /// Adds the material stiffness of the generalised strains.
    #[inline(always)]
    fn add_projected<M: Measure<S, D, C>, const D: usize, const C: usize>(
        &self,
        samples: &Samples<N, D>,
        projection: &Projection,
        weights: &Weights<'_, S>,
        measures: &[M],
        tangent: &mut [Block<S>],
    ) {
        /// Modes that are multiplied at once.
        const AT_ONCE: usize = 4;

        let zero = Lanes::splat(self.simd, 0.0);
        let count = projection.modes.len().div_ceil(AT_ONCE);
        let mut rows = vec![[[[zero; 3]; AT_ONCE]; N]; count];
        let mut weighted = rows.clone();
        for (g, table) in samples.tables.iter().enumerate() {
            for a in 0..N {
                let mut entries = [0.0; D];
                for d in 0..D {
                    entries[d] = table[d][a];
                }
                let row = measures[g].row(entries);
                for &(mode, factor) in &projection.at_point[g] {
                    let target = &mut rows[mode / AT_ONCE][a][mode % AT_ONCE];
                    *target =
                        table_axpy(factor * weights.quadrature[g], row[projection.modes[mode].component], *target);
                }
            }
        }
        let start = weights.matrix_start::<C>(measures.len());
        for &(k, l, position) in self.couplings {
            let weight = weights.constants[start + position];
            for a in 0..N {
                let target = &mut weighted[k / AT_ONCE][a][k % AT_ONCE];
                *target = axpy(weight, rows[l / AT_ONCE][a][l % AT_ONCE], *target);
                if k != l {
                    let target = &mut weighted[l / AT_ONCE][a][l % AT_ONCE];
                    *target = axpy(weight, rows[k / AT_ONCE][a][k % AT_ONCE], *target);
                }
            }
        }
        for (rows, weighted) in rows.iter().zip(&weighted) {
            add_products(rows, weighted, tangent);
        }
    }
}

/// `W` of one group of samples.
struct Weights<'a, S: Simd> {
    projection: Option<&'a Projection>,
    quadrature: &'a [f64],
    couplings: &'a Couplings,
    constants: &'a [Lanes<S>],
}

impl<S: Simd> Weights<'_, S> {
    /// The reference strain.
    #[inline(always)]
    fn reference<const C: usize>(&self, point: usize, component: usize) -> Lanes<S> {
        self.constants[point * point_stride(C) + 1 + component]
    }

    /// The weight that couples two components at a point.
    #[inline(always)]
    fn entry<const C: usize>(&self, point: usize, row: usize, column: usize) -> Lanes<S> {
        self.constants[point * point_stride(C) + 1 + C + row * C + column]
    }

    /// Where the packed weights of the generalised strains begin.
    #[inline(always)]
    fn matrix_start<const C: usize>(&self, points: usize) -> usize {
        points * point_stride(C)
    }

    /// The number of constants.
    #[inline(always)]
    fn len<const C: usize>(&self, points: usize) -> usize {
        let modes = self.projection.map_or(0, |p| p.modes.len());
        self.matrix_start::<C>(points) + modes * (modes + 1) / 2
    }

    /// `stress = W strain`.
    #[inline(always)]
    fn apply<const C: usize>(&self, zero: Lanes<S>, strain: &[[Lanes<S>; C]], stress: &mut [[Lanes<S>; C]]) {
        for g in 0..strain.len() {
            for c in 0..C {
                let mut sum = zero;
                for other in 0..C {
                    sum = self.entry::<C>(g, c, other).mul_add(strain[g][other], sum);
                }
                stress[g][c] = sum;
            }
        }
        if let Some(projection) = self.projection {
            let mut amplitudes = vec![zero; projection.modes.len()];
            let mut conjugates = amplitudes.clone();
            for (amplitude, mode) in amplitudes.iter_mut().zip(&projection.modes) {
                for &(g, phi) in &mode.basis {
                    *amplitude = strain[g][mode.component].scale_add(self.quadrature[g] * phi, *amplitude);
                }
            }
            let start = self.matrix_start::<C>(strain.len());
            for &(k, l, position) in self.couplings {
                let weight = self.constants[start + position];
                conjugates[k] = weight.mul_add(amplitudes[l], conjugates[k]);
                if k != l {
                    conjugates[l] = weight.mul_add(amplitudes[k], conjugates[l]);
                }
            }
            for (conjugate, mode) in conjugates.iter().zip(&projection.modes) {
                for &(g, phi) in &mode.basis {
                    stress[g][mode.component] =
                        conjugate.scale_add(self.quadrature[g] * phi, stress[g][mode.component]);
                }
            }
        }
    }
}

/// The gradient vectors at a point.
#[inline(always)]
fn gradients<S: Simd, const N: usize, const D: usize>(
    zero: Lanes<S>,
    table: &[[f64; N]; D],
    coordinates: &[Vector<S>; N],
) -> [Vector<S>; D] {
    let mut gradients = [[zero; 3]; D];
    for d in 0..D {
        for a in 0..N {
            gradients[d] = table_axpy(table[d][a], coordinates[a], gradients[d]);
        }
    }
    gradients
}

/// Adds `sum_c rows_c^T weighted_c` to the packed blocks.
#[inline(always)]
fn add_products<S: Simd, const N: usize, const C: usize>(
    rows: &[[Vector<S>; C]; N],
    weighted: &[[Vector<S>; C]; N],
    blocks: &mut [Block<S>],
) {
    for b in 0..N {
        for a in 0..=b {
            let block = &mut blocks[packed(a, b)];
            for i in 0..3 {
                for j in 0..3 {
                    let mut sum = block[i][j];
                    for c in 0..C {
                        sum = rows[a][c][i].mul_add(weighted[b][c][j], sum);
                    }
                    block[i][j] = sum;
                }
            }
        }
    }
}
