//! The global system of a model: mass, forces and tangent, and the linear equations for its free coordinates.

mod follower;
mod numbering;
mod scatter;

use std::sync::Arc;
use std::time::{Duration, Instant};

use nalgebra::Vector3;

use crate::element::{At, ElementBlock, NodalVector, Outcome, Want};
use crate::linear::{Factorization, Inertia, LinearError, Pattern, SymmetricMatrix, gmres};
use crate::material::Damping;
use crate::mesh::Place;
use crate::model::{History, LoadKind, Model};
use crate::quadrature::Rule;
use crate::strain::packed;

use follower::Follower;
use numbering::Numbering;
use scatter::Scatter;

/// Time spent in the parts of a solve.
#[derive(Clone, Copy, Debug, Default)]
pub struct Timers {
    /// Making the system: numbering, patterns, tables.
    pub setup: Duration,
    /// Forces and tangents.
    pub assembly: Duration,
    /// Numeric factorisations.
    pub factorization: Duration,
    /// Solutions with a factorisation.
    pub solve: Duration,
}

/// Strain energy, J.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainEnergy {
    /// From membrane strain; of solid elements, whose energy is not split, all of it.
    pub membrane: f64,
    /// From curvature.
    pub bending: f64,
}

impl StrainEnergy {
    /// Both parts together.
    pub fn total(&self) -> f64 {
        self.membrane + self.bending
    }
}

/// Strain rates, summed over all samples.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct StrainRates {
    /// Power that the viscosity of the materials takes, W.
    pub power: f64,
    /// Power of a viscosity of one, W/s.
    pub square: f64,
    /// Strain energy gained over a step that the mean elastic force misses, J.
    pub missed: f64,
}

/// Accuracy of solutions with the skew part of the followers: Newton corrects what is left.
const SKEW_TOLERANCE: f64 = 1e-8;
/// Most products with the skew part in a solution.
const SKEW_PRODUCTS: usize = 40;

/// A load that does not depend on the state.
struct Dead {
    history: History,
    force: Vec<f64>,
}

/// The equations of a model, with everything that stays while the state changes made once.
///
/// Vectors over all nodal coordinates have the length of [`Model::reference`]; linear equations are solved for the
/// free ones, fixed coordinates leave before anything is factorised.
pub struct System {
    model: Arc<Model>,
    numbering: Numbering,
    blocks: Vec<Box<dyn ElementBlock>>,
    scatter: Scatter,
    mass: SymmetricMatrix,
    weight: Vec<f64>,
    /// Of each nodal vector; empty if no material has it.
    mass_damping: Vec<f64>,
    dead: Vec<Dead>,
    followers: Vec<Follower>,
    /// The state of the last tangent, for the skew part of the followers: coordinates, and the factor of each load.
    tangent_at: (Vec<f64>, Vec<f64>),
    outcomes: Vec<Outcome>,
    values: Vec<f64>,
    factorization: Factorization,
    free: Vec<f64>,
    factorizations: usize,
    timers: Timers,
}

impl System {
    /// Makes the system of a model.
    ///
    /// # Errors
    ///
    /// Only if the memory does not suffice.
    pub fn new(model: Arc<Model>) -> Result<Self, LinearError> {
        let start = Instant::now();
        let numbering = Numbering::new(&model)?;
        let blocks: Vec<_> = model.bodies().iter().map(|body| body.elements(model.reference())).collect();
        let scatter = Scatter::new(&numbering)?;
        let (mass, weight) = mass_matrix(&model, &blocks)?;
        let mass_damping = mass_damping(&model, &blocks);
        let factorization = Factorization::new(Arc::clone(scatter.pattern()))?;
        let mut system = Self {
            values: vec![0.0; scatter.pattern().nnz()],
            free: vec![0.0; numbering.coordinate.len()],
            outcomes: vec![Outcome::default(); blocks.len()],
            dead: Vec::new(),
            followers: Vec::new(),
            tangent_at: (Vec::new(), Vec::new()),
            factorizations: 0,
            timers: Timers::default(),
            model,
            numbering,
            blocks,
            scatter,
            mass_damping,
            mass,
            weight,
            factorization,
        };
        system.add_loads();
        system.timers.setup = start.elapsed();
        Ok(system)
    }

    fn add_loads(&mut self) {
        let model = Arc::clone(&self.model);
        for load in model.loads() {
            let history = load.history.clone();
            let mut force = vec![0.0; model.reference().len()];
            match load.kind {
                LoadKind::Gravity(acceleration) => {
                    for (target, weight) in force.chunks_mut(3).zip(&self.weight) {
                        for (sum, a) in target.iter_mut().zip(acceleration) {
                            *sum = weight * a;
                        }
                    }
                }
                LoadKind::Force { body, point, force: f } => {
                    let grid = model.body(body).grid();
                    let (element, at) = grid.locate(point).expect("checked when the load was added");
                    self.add_at(body.index(), element, at, f, &mut force);
                }
                LoadKind::Line { body, edge, per_length } => {
                    let grid = model.body(body).grid();
                    let block = body.index();
                    for element in grid.elements_at(edge) {
                        for (s, weight) in Rule::Gauss(4).points() {
                            let constant = f64::from(edge.end == crate::mesh::End::High);
                            let at = if edge.across == 0 { [constant, s] } else { [s, constant] };
                            let orders = if edge.across == 0 { [0, 1] } else { [1, 0] };
                            let along = self.interpolate(block, element, orders, at, model.reference());
                            let length = weight * grid.element_sides()[1 - edge.across] * along.norm();
                            self.add_at(block, element, at, per_length.map(|f| f * length), &mut force);
                        }
                    }
                }
                LoadKind::Moment { body, edge, per_length } => {
                    let block = body.index();
                    let grid = model.body(body).grid();
                    let follower =
                        Follower::moment(block, self.blocks[block].as_ref(), grid, edge, per_length, history);
                    self.followers.push(follower);
                    continue;
                }
                LoadKind::Pressure { body, pressure } => {
                    let block = body.index();
                    let grid = model.body(body).grid();
                    self.followers.push(Follower::pressure(
                        block,
                        self.blocks[block].as_ref(),
                        grid,
                        pressure,
                        history,
                    ));
                    continue;
                }
            }
            self.dead.push(Dead { history, force });
        }
    }

    /// Adds a force at a point of an element.
    fn add_at(&self, block: usize, element: usize, at: [f64; 2], value: [f64; 3], force: &mut [f64]) {
        let shape = self.blocks[block].derivative([0, 0], at);
        for (vector, shape) in self.blocks[block].vectors(element).iter().zip(shape) {
            for (sum, f) in force[3 * *vector as usize..][..3].iter_mut().zip(value) {
                *sum += shape * f;
            }
        }
    }

    /// The position, or a derivative of it, at a point of an element.
    fn interpolate(&self, block: usize, element: usize, orders: [usize; 2], at: [f64; 2], q: &[f64]) -> Vector3<f64> {
        let shape = self.blocks[block].derivative(orders, at);
        let vectors = self.blocks[block].vectors(element);
        shape.iter().zip(vectors).map(|(s, v)| *s * Vector3::from_column_slice(&q[3 * *v as usize..][..3])).sum()
    }

    /// The model.
    pub fn model(&self) -> &Model {
        &self.model
    }

    /// Number of nodal coordinates.
    pub fn coordinates(&self) -> usize {
        self.model.reference().len()
    }

    /// The coordinates that are not fixed, in the order of the equations.
    pub fn free(&self) -> &[usize] {
        &self.numbering.coordinate
    }

    /// Number of elements.
    pub fn elements(&self) -> usize {
        self.blocks.iter().map(|block| block.elements()).sum()
    }

    /// Number of different reference shapes among the elements: what is stored once each.
    pub fn classes(&self) -> usize {
        self.blocks.iter().map(|block| block.classes()).sum()
    }

    /// Number of numeric factorisations so far.
    pub fn factorizations(&self) -> usize {
        self.factorizations
    }

    /// Time spent in each part so far.
    pub fn timers(&self) -> Timers {
        self.timers
    }

    /// Scalar mass matrix over all nodal vectors.
    pub fn mass(&self) -> &SymmetricMatrix {
        &self.mass
    }

    /// The mass that each nodal vector stands for in a uniform field, kg or kg m.
    pub fn weight(&self) -> &[f64] {
        &self.weight
    }

    /// Elastic force `Q_k` on all coordinates, and the strain energy.
    ///
    /// # Source
    ///
    /// Dufva and Shabana (2005), (25), (35).
    pub fn internal_force(&mut self, q: &[f64], force: &mut [f64]) -> StrainEnergy {
        self.force(At::rest(q), force)
    }

    /// Elastic and viscous force on all coordinates, and the strain energy.
    pub fn force(&mut self, at: At<'_>, force: &mut [f64]) -> StrainEnergy {
        let start = Instant::now();
        self.evaluate(at, None);
        self.scatter.sum_forces(&self.blocks, &self.outcomes, force);
        self.timers.assembly += start.elapsed();
        self.energy()
    }

    /// Force of the loads `Q_e` on all coordinates at time (or load factor) `t`.
    pub fn external_force(&self, q: &[f64], t: f64, force: &mut [f64]) {
        self.sum_loads(|history| history.factor(t), q, force);
    }

    /// Derivative of [`external_force`](Self::external_force) with respect to `t`, just after it.
    pub fn external_force_rate(&self, q: &[f64], t: f64, force: &mut [f64]) {
        self.sum_loads(|history| history.rate(t), q, force);
    }

    /// The loads, each times a number that its history gives.
    fn sum_loads(&self, factor: impl Fn(&History) -> f64, q: &[f64], force: &mut [f64]) {
        force.fill(0.0);
        for load in &self.dead {
            let factor = factor(&load.history);
            for (sum, f) in force.iter_mut().zip(&load.force) {
                *sum += factor * f;
            }
        }
        for load in &self.followers {
            let elements = self.blocks[load.block].as_ref();
            load.add_force(elements, self.model.reference(), q, factor(&load.history), force);
        }
    }

    /// Work of the loads, held as they are at `t`, on the way between two states whose coordinates change at the rates
    /// `p0` and `p1` there, per unit of a parameter that runs from 0 to 1.
    ///
    /// Exact for dead loads. For a follower it is that of the mean force on the straight way, unless the rates of work
    /// at both ends bound it: a moment that turns an edge does the same work in each part of the way, and the straight
    /// way is too short.
    pub(crate) fn work(&self, t: f64, [q0, q1]: [&[f64]; 2], [p0, p1]: [&[f64]; 2]) -> f64 {
        let along = |force: &[f64], p: &[f64]| force.iter().zip(p).map(|(f, p)| f * p).sum::<f64>();
        let straight: Vec<f64> = q0.iter().zip(q1).map(|(a, b)| b - a).collect();
        let dead = self.dead.iter().map(|load| load.history.factor(t) * along(&load.force, &straight));
        let followers = self.followers.iter().map(|load| {
            let [start, end] = [q0, q1].map(|q| {
                let mut force = vec![0.0; q.len()];
                let elements = self.blocks[load.block].as_ref();
                load.add_force(elements, self.model.reference(), q, load.history.factor(t), &mut force);
                force
            });
            let mean = 0.5 * (along(&start, &straight) + along(&end, &straight));
            let (a, b) = (along(&start, p0), along(&end, p1));
            mean.clamp(a.min(b), a.max(b))
        });
        dead.chain(followers).sum()
    }

    /// The tangent of elastic forces at rest, as [`assemble_at`](Self::assemble_at).
    pub fn assemble(&mut self, q: &[f64], t: f64, want: Want<'_>, force: &mut [f64]) -> StrainEnergy {
        self.assemble_at(At::rest(q), t, want, force)
    }

    /// Forces as [`force`](Self::force), and the tangent `want.mass M + want.stiffness (dQ_k/dq - dQ_e/dq)`, damping
    /// included, which is kept for [`factorize`](Self::factorize). It is symmetric: of loads that follow the surface it
    /// has the symmetric half, of viscous and mean forces what stays when `B` does not change within a step.
    pub fn assemble_at(&mut self, at: At<'_>, t: f64, want: Want<'_>, force: &mut [f64]) -> StrainEnergy {
        let start = Instant::now();
        self.evaluate(at, Some(want));
        self.scatter.sum_forces(&self.blocks, &self.outcomes, force);
        if !self.followers.is_empty() {
            let factors = self.followers.iter().map(|load| want.stiffness * load.history.factor(t));
            self.tangent_at = (at.q.to_vec(), factors.collect());
        }
        for (load, &factor) in self.followers.iter().zip(&self.tangent_at.1) {
            let elements = self.blocks[load.block].as_ref();
            load.subtract_stiffness(elements, self.model.reference(), at.q, factor, &mut self.outcomes[load.block]);
        }
        self.scatter.sum(&self.blocks, &self.outcomes, &mut self.values);
        self.timers.assembly += start.elapsed();
        self.energy()
    }

    fn evaluate(&mut self, at: At<'_>, want: Option<Want<'_>>) {
        for (block, outcome) in self.blocks.iter().zip(&mut self.outcomes) {
            block.evaluate(at, want, outcome);
        }
    }

    /// Strain rates of the forces that were evaluated last, at the velocities given there.
    pub fn strain_rates(&self) -> StrainRates {
        let mut rates = StrainRates::default();
        for (block, outcome) in self.blocks.iter().zip(&self.outcomes) {
            for [square, missed] in &outcome.rates {
                rates.power += block.damping().viscosity * square;
                rates.square += square;
                rates.missed += missed;
            }
        }
        rates
    }

    /// Mass-proportional damping of each nodal vector, 1/s; none where no material has it.
    pub fn mass_damping(&self) -> Option<&[f64]> {
        (!self.mass_damping.is_empty()).then_some(&self.mass_damping)
    }

    /// Whether any material is damped.
    pub fn is_damped(&self) -> bool {
        self.blocks.iter().any(|block| block.damping() != Damping::default())
    }

    fn energy(&self) -> StrainEnergy {
        let mut energy = StrainEnergy::default();
        for [membrane, bending] in self.outcomes.iter().flat_map(|outcome| &outcome.energy) {
            energy.membrane += membrane;
            energy.bending += bending;
        }
        energy
    }

    /// The pattern and the values of the tangent that was assembled last, over the free coordinates.
    pub fn tangent(&self) -> (&Pattern, &[f64]) {
        (self.scatter.pattern(), &self.values)
    }

    /// The tangent that was assembled last, over the free coordinates.
    pub fn tangent_matrix(&self) -> SymmetricMatrix {
        SymmetricMatrix::new(Arc::clone(self.scatter.pattern()), self.values.clone())
    }

    /// The state of the last tangent, for the skew part of the followers: coordinates, and the factor of each load.
    pub(crate) fn tangent_at(&self) -> &(Vec<f64>, Vec<f64>) {
        &self.tangent_at
    }

    /// Adds the skew half of a tangent, that of loads which follow the body, times `x` to `y`; `at` is its
    /// [`tangent_at`](Self::tangent_at).
    pub(crate) fn add_skew_times(&self, (q, factors): &(Vec<f64>, Vec<f64>), x: &[f64], y: &mut [f64]) {
        for (load, factor) in self.followers.iter().zip(factors) {
            let elements = self.blocks[load.block].as_ref();
            load.add_skew_times(elements, self.model.reference(), q, -factor, x, y);
        }
    }

    /// Factorises a tangent that was assembled earlier.
    ///
    /// # Errors
    ///
    /// As [`factorize`](Self::factorize).
    pub(crate) fn restore(&mut self, values: &[f64], at: &(Vec<f64>, Vec<f64>)) -> Result<Inertia, LinearError> {
        self.values.copy_from_slice(values);
        self.tangent_at = at.clone();
        self.factorize()
    }

    /// Factorises the tangent that was assembled last.
    ///
    /// # Errors
    ///
    /// It must be finite and not singular.
    pub fn factorize(&mut self) -> Result<Inertia, LinearError> {
        let start = Instant::now();
        self.factorizations += 1;
        let result = self.factorization.factorize(&self.values);
        self.timers.factorization += start.elapsed();
        result
    }

    /// Solves for the free coordinates: `solution = tangent^-1 right`, zero where fixed.
    ///
    /// The factorised tangent has the symmetric half of the loads' part only. The skew half is brought in by GMRES with
    /// the factorised tangent as preconditioner; its eigenvalues then lie around 1 on a line, so a few products suffice.
    pub fn solve(&mut self, right: &[f64], solution: &mut [f64]) {
        let start = Instant::now();
        let Self { numbering, factorization, free, followers, tangent_at: (at, factors), blocks, model, .. } = self;
        let mut solve = |right: &[f64], solution: &mut [f64]| {
            for (value, &coordinate) in free.iter_mut().zip(&numbering.coordinate) {
                *value = right[coordinate];
            }
            factorization.solve(free);
            for (value, &coordinate) in free.iter().zip(&numbering.coordinate) {
                solution[coordinate] = *value;
            }
        };
        solution.fill(0.0);
        solve(right, solution);
        if factors.iter().any(|factor| *factor != 0.0) {
            let mut skew = vec![0.0; right.len()];
            let with_skew = |x: &[f64], y: &mut [f64]| {
                skew.fill(0.0);
                for (load, factor) in followers.iter().zip(factors.iter()) {
                    load.add_skew_times(blocks[load.block].as_ref(), model.reference(), at, -factor, x, &mut skew);
                }
                solve(&skew, y);
                y.iter_mut().zip(x).for_each(|(y, x)| *y += x);
            };
            gmres(with_skew, solution, SKEW_TOLERANCE, SKEW_PRODUCTS);
        }
        self.timers.solve += start.elapsed();
    }

    /// Adds `M x` to `y`.
    pub fn add_mass_times(&self, x: &[f64], y: &mut [f64]) {
        self.mass.multiply_add::<3>(x, y);
    }

    /// The nodal vectors that are positions.
    pub fn positions(&self) -> impl Iterator<Item = usize> {
        self.model.bodies().iter().flat_map(|body| {
            let index = body.nodal_vectors().iter().position(|v| *v == NodalVector::R);
            let index = index.expect("every node has a position");
            (0..body.grid().nodes()).map(move |node| body.vector(node, index))
        })
    }

    /// Kinetic energy (J), momentum (kg m/s) and angular momentum about the origin (kg m2/s), with a mass matrix over
    /// nodal vectors.
    pub fn motion(&self, mass: &SymmetricMatrix, q: &[f64], v: &[f64]) -> (f64, [f64; 3], [f64; 3]) {
        let mut momenta = vec![0.0; v.len()];
        mass.multiply_add::<3>(v, &mut momenta);
        let kinetic = 0.5 * v.iter().zip(&momenta).map(|(v, p)| v * p).sum::<f64>();
        let at = |x: &[f64], a: usize| Vector3::from_column_slice(&x[3 * a..3 * a + 3]);
        // Gradients do not change in a translation.
        let momentum: Vector3<f64> = self.positions().map(|a| at(&momenta, a)).sum();
        let angular: Vector3<f64> = (0..q.len() / 3).map(|a| at(q, a).cross(&at(&momenta, a))).sum();
        (kinetic, momentum.into(), angular.into())
    }

    /// Says which coordinate an equation is for.
    pub fn describe(&self, equation: usize) -> String {
        let coordinate = self.numbering.coordinate[equation];
        let vector = coordinate / 3;
        for body in self.model.bodies() {
            let count = body.nodal_vectors().len();
            let first = body.vector(0, 0);
            if (first..first + body.grid().nodes() * count).contains(&vector) {
                let node = (vector - first) / count;
                let name = body.nodal_vectors()[(vector - first) % count].name();
                let component = ["x", "y", "z"][coordinate % 3];
                let at = Place::Point(body.grid().parameters(node));
                return format!("{name}.{component} at {at} of body \"{}\"", body.name());
            }
        }
        format!("coordinate {coordinate}")
    }
}

/// The mass-proportional damping of each nodal vector; empty if there is none.
fn mass_damping(model: &Model, blocks: &[Box<dyn ElementBlock>]) -> Vec<f64> {
    if blocks.iter().all(|block| block.damping().mass == 0.0) {
        return Vec::new();
    }
    let mut damping = vec![0.0; model.reference().len() / 3];
    for block in blocks {
        for vector in (0..block.elements()).flat_map(|element| block.vectors(element)) {
            damping[*vector as usize] = block.damping().mass;
        }
    }
    damping
}

/// The scalar mass matrix over all nodal vectors and its row sums in a uniform field.
///
/// # Source
///
/// Dufva and Shabana (2005), (37), (38).
fn mass_matrix(model: &Model, blocks: &[Box<dyn ElementBlock>]) -> Result<(SymmetricMatrix, Vec<f64>), LinearError> {
    let vectors = model.reference().len() / 3;
    let all = || blocks.iter().flat_map(|block| (0..block.elements()).map(move |element| (block, element)));
    let groups: Vec<Vec<usize>> =
        all().map(|(block, element)| block.vectors(element).iter().map(|v| *v as usize).collect()).collect();
    let pattern = Arc::new(Pattern::from_groups(vectors, &groups)?);
    let mut values = vec![0.0; pattern.nnz()];
    let mut weight = vec![0.0; vectors];
    for ((block, element), group) in all().zip(&groups) {
        let mass = block.mass(element);
        for (b, &j) in group.iter().enumerate() {
            weight[j] += block.weight(element)[b];
            for (a, &i) in group[..=b].iter().enumerate() {
                values[pattern.slot(i, j).expect("an entry of the pattern")] += mass[packed(a, b)];
            }
        }
    }
    Ok((SymmetricMatrix::new(pattern, values), weight))
}
