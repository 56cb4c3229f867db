//! Natural frequencies and shapes of small oscillations about a state.
//!
//! `K x = omega^2 M x` with the tangent `K` and the mass matrix `M` over the free coordinates. The shift `s` is raised
//! until `K + s M` is positive definite; the smallest eigenvalues are then the largest of `(K + s M)^-1 M`, which
//! `lanczos` finds. The negative pivots of `K - tau M`, with `tau` above them, count what lies below: none is missed.

mod lanczos;
mod scale;

use std::time::Instant;

use crate::assembly::System;
use crate::element::Want;
use crate::error::InputError;
use crate::linear::{Inertia, LinearError, SymmetricMatrix};
use crate::nonlinear::Failure;
use crate::observe::Observer;
use crate::report::{Counts, Outcome, Run, Seconds};

use lanczos::{Lanczos, Ritz};
use scale::{bending, least_rounding, rounding};

/// Which modes to find.
#[derive(Clone, Debug)]
pub struct Options {
    /// How many, those with the smallest eigenvalues.
    pub count: usize,
    /// Nodal coordinates of the state about which the model oscillates.
    pub q: Vec<f64>,
    /// Load factor (or time, s) of the loads that follow the body.
    pub t: f64,
}

/// A mode of small oscillations.
#[derive(Clone, Debug, PartialEq)]
pub struct Mode {
    /// Square of the circular frequency, 1/s2: 0 of rigid motions, where it is nothing but rounding; negative where the state is
    /// unstable.
    pub eigenvalue: f64,
    /// Changes of all nodal coordinates, with `x . M x` = 1.
    pub shape: Vec<f64>,
}

/// Modes beyond those that are wanted, among which a gap is sought.
const MORE: usize = 6;
/// A gap between eigenvalues, relative to their distance from the shift, in which modes can be counted.
const GAP: f64 = 1e-6;
/// Where in a gap to count; the others serve where the first meets an eigenvalue of a part of the model.
const PLACES: [f64; 3] = [0.5, 0.35, 0.65];
/// Residual of a mode that has converged, relative to its eigenvalue's distance from the shift.
const PRECISION: f64 = 1e-9;
/// Residual of a mode that rounding keeps from converging, in units of `eps |x| . |K| |x|`, where `|x|` holds the lengths of
/// nodal vectors.
const FLOOR: f64 = 0.02;
/// Eigenvalue that is nothing but rounding, in the same unit. Rigid motions of flat and curved bodies reach 1.7.
const ZERO: f64 = 5.0;
/// Rounding of an eigenvalue, relative to it, above which it is lost; and an eigenvalue, relative to that of slow bending, below
/// which it is compared with this: near buckling it passes through zero. A strip that is 3000 times as long as
/// wide has 0.07, and its eigenvalue is wrong by up to 0.03.
const LOST: f64 = 0.02;
const SLOW: f64 = 0.05;
/// Coupling of modes by loads without potential, relative to their eigenvalues, above which they are none.
const COUPLING: f64 = 1e-6;
/// Factorisations to find the shift, each with ten times the last one.
const SHIFTS: usize = 40;
/// Restarts after which the search is given up.
const RESTARTS: usize = 60;
/// Vectors of the basis beyond twice the modes.
const ROOM: usize = 40;

/// Finds the modes with the smallest eigenvalues, in increasing order.
///
/// The observer hears how many have been found. A search that was stopped leaves those.
///
/// # Source
///
/// Bathe, Finite Element Procedures (1996), 11.2 for the count of eigenvalues by Sturm sequences.
///
/// # Errors
///
/// There must be from one to as many modes as free coordinates, and a finite state of all coordinates. A search that
/// fails is not an error here but an [`Outcome`].
pub fn solve(
    system: &mut System,
    options: &Options,
    observer: &mut dyn Observer,
) -> Result<(Vec<Mode>, Run), InputError> {
    let dofs = system.free().len();
    let valid = (1..=dofs).contains(&options.count);
    InputError::check("count", options.count, valid, &format!("1 to {dofs}, the coordinates that are not fixed"))?;
    let valid = options.q.len() == system.coordinates() && options.q.iter().all(|x| x.is_finite());
    InputError::check("q", format!("{} numbers", options.q.len()), valid, "as many finite numbers as coordinates")?;
    InputError::check("load_factor", options.t, options.t.is_finite(), "a finite number")?;

    let start = Instant::now();
    let mut modes = Vec::new();
    let mut products = 0;
    let end = Search::new(system, options).and_then(|mut search| {
        let end = search.run(observer);
        products = search.lanczos.products();
        modes = search.modes();
        end.and_then(|()| search.check_rounding(&modes)).and_then(|()| search.check_potential(&modes))
    });
    let counts = Counts { iterations: products, ..Counts::default() }.of(system);
    let (outcome, seconds) = (Outcome::from_end(end), Seconds::new(system, start.elapsed()));
    let reached = modes.len() as f64;
    Ok((modes, Run { outcome, reached, jumps: Vec::new(), counts, seconds }))
}

/// A search for the smallest eigenvalues.
struct Search<'a> {
    system: &'a mut System,
    count: usize,
    stiffness: SymmetricMatrix,
    mass: SymmetricMatrix,
    /// Where the loads that follow the body are.
    at: (Vec<f64>, Vec<f64>),
    /// Number of rigid motions that no support holds.
    rigid: usize,
    shift: f64,
    lanczos: Lanczos,
    /// The leading pairs that have converged.
    converged: Vec<Ritz>,
}

impl<'a> Search<'a> {
    fn new(system: &'a mut System, options: &Options) -> Result<Self, Failure> {
        if let Some(body) = system.model().bodies().iter().find(|body| body.plate().material.density() == 0.0) {
            return Err(Failure::Massless { body: body.name().to_owned() });
        }
        let mut matrix = |mass: f64, stiffness: f64| {
            let want = Want { mass, stiffness, previous: None };
            system.assemble(&options.q, options.t, want, &mut vec![0.0; options.q.len()]);
            system.tangent_matrix()
        };
        let (mass, stiffness) = (matrix(1.0, 0.0), matrix(0.0, 1.0));
        let at = system.tangent_at().clone();
        let rigid = system.model().rigid_motions(&options.q).len();
        let shift = bending(system);
        let lanczos = Lanczos::new(system);
        let (count, converged) = (options.count, Vec::new());
        let mut search = Self { system, count, stiffness, mass, at, rigid, shift, lanczos, converged };
        for _ in 0..SHIFTS {
            match search.factorize(-search.shift) {
                Ok(inertia) if inertia.is_positive_definite() => return Ok(search),
                Ok(_) | Err(LinearError::Singular { .. }) => search.shift *= 10.0,
                Err(error) => return Err(search.failure(error)),
            }
        }
        let error = search.factorize(-search.shift).err().unwrap_or(LinearError::NotFinite { column: 0 });
        Err(search.failure(error))
    }

    /// Factorises `K - tau M`, without what is skew.
    fn factorize(&mut self, tau: f64) -> Result<Inertia, LinearError> {
        let values = self.stiffness.values().iter().zip(self.mass.values()).map(|(k, m)| k - tau * m);
        let values: Vec<f64> = values.collect();
        self.system.restore(&values, &(Vec::new(), Vec::new()))
    }

    fn failure(&self, error: LinearError) -> Failure {
        Failure::from_linear(error, 0, |row| self.system.describe(row))
    }

    /// The eigenvalue of `K x = lambda M x`.
    fn eigenvalue(&self, ritz: &Ritz) -> f64 {
        1.0 / ritz.value - self.shift
    }

    fn run(&mut self, observer: &mut dyn Observer) -> Result<(), Failure> {
        let dofs = self.system.free().len();
        let mut wanted = (self.count + MORE).min(dofs);
        let mut largest = (2 * wanted + ROOM).min(dofs);
        let mut next = wanted;
        let mut restarts = 0;
        loop {
            if observer.stop() {
                self.converged.truncate(self.count);
                return Err(Failure::Stopped);
            }
            self.lanczos.extend(self.system);
            let complete = self.lanczos.is_complete();
            if self.lanczos.acted() < next.min(largest) && !complete {
                continue;
            }
            let mut pairs = self.lanczos.ritz();
            let found = if complete { dofs } else { self.converging(&pairs) }.min(wanted);
            observer.reached(found.min(self.count) as f64);
            next = self.lanczos.acted() + (wanted / 8).max(8);
            if found < wanted && self.lanczos.acted() >= largest {
                restarts += 1;
                if restarts > RESTARTS {
                    self.converged = pairs.into_iter().take(found.min(self.count)).collect();
                    return Err(Failure::ModesNotFound { found: found.min(self.count), count: self.count });
                }
                pairs.truncate((wanted + largest) / 2);
                self.lanczos.restart(&pairs);
                next = largest;
                continue;
            }
            self.converged = pairs.into_iter().take(found).collect();
            if found < wanted {
                continue;
            }
            match self.find_gap() {
                _ if complete => {}
                None if wanted < dofs => {
                    wanted = (2 * wanted).min(dofs);
                    largest = (2 * wanted + ROOM).min(dofs);
                    continue;
                }
                None => {}
                Some(below) => {
                    let missed = self.count_missed(below)?;
                    for _ in 0..missed {
                        self.lanczos.add_random(self.system);
                    }
                    if missed > 0 {
                        continue;
                    }
                }
            }
            self.converged.truncate(self.count);
            return Ok(());
        }
    }

    /// How many of the leading pairs have converged, to the precision wanted or to what rounding allows.
    fn converging(&self, pairs: &[Ritz]) -> usize {
        let good = |pair: &&Ritz| {
            pair.residual <= PRECISION * pair.value || {
                let vector = self.lanczos.vector(pair);
                pair.residual <= FLOOR * rounding(self.system, &self.stiffness, &vector) * pair.value * pair.value
            }
        };
        pairs.iter().take_while(good).count()
    }

    /// After how many of the modes there is a gap, the widest beyond those that are wanted.
    fn find_gap(&self) -> Option<usize> {
        let values: Vec<f64> = self.converged.iter().map(|ritz| self.eigenvalue(ritz)).collect();
        let gap = |below: &usize| (values[*below] - values[*below - 1]) / (values[*below] + self.shift);
        let widest = (self.count..values.len()).max_by(|a, b| gap(a).total_cmp(&gap(b)))?;
        (gap(&widest) > GAP).then_some(widest)
    }

    /// How many eigenvalues lie below the gap that were not found. Leaves `K + s M` factorised.
    fn count_missed(&mut self, below: usize) -> Result<usize, Failure> {
        let [low, high] = [below - 1, below].map(|i| self.eigenvalue(&self.converged[i]));
        let mut counted = Err(LinearError::NotFinite { column: 0 });
        for place in PLACES {
            counted = self.factorize(low + place * (high - low));
            if counted.is_ok() {
                break;
            }
        }
        let inertia = counted.map_err(|error| self.failure(error))?;
        self.factorize(-self.shift).map_err(|error| self.failure(error))?;
        inertia.negative.checked_sub(below).ok_or(Failure::ModesNotFound { found: inertia.negative, count: below })
    }

    /// The modes that have converged.
    ///
    /// Of eigenvalues within rounding those of rigid motions are zero, the smallest, and what is negative: bending of a very thin
    /// body is as small, but its value is worth more than none.
    fn modes(&self) -> Vec<Mode> {
        let mode = |ritz: &Ritz| Mode { eigenvalue: self.eigenvalue(ritz), shape: self.lanczos.vector(ritz) };
        let mut modes: Vec<Mode> = self.converged.iter().map(mode).collect();
        let rounded =
            |mode: &&mut Mode| mode.eigenvalue.abs() <= ZERO * rounding(self.system, &self.stiffness, &mode.shape);
        let mut rounded: Vec<&mut Mode> = modes.iter_mut().filter(rounded).collect();
        rounded.sort_by(|a, b| a.eigenvalue.abs().total_cmp(&b.eigenvalue.abs()));
        for (place, mode) in rounded.into_iter().enumerate() {
            if place < self.rigid || mode.eigenvalue < 0.0 {
                mode.eigenvalue = 0.0;
            }
        }
        modes
    }

    /// Refuses modes that are lost in the rounding of the stiffness. Rigid motions are zero.
    fn check_rounding(&self, modes: &[Mode]) -> Result<(), Failure> {
        let slow = SLOW * bending(self.system);
        for (number, mode) in modes.iter().enumerate().filter(|(_, mode)| mode.eigenvalue != 0.0) {
            let lost = least_rounding(self.system, &self.stiffness, &mode.shape) / mode.eigenvalue.abs().max(slow);
            if lost > LOST {
                return Err(Failure::ModesLost { number: number + 1, lost });
            }
        }
        Ok(())
    }

    /// Refuses modes that loads without a potential couple: their oscillations have other frequencies.
    fn check_potential(&self, modes: &[Mode]) -> Result<(), Failure> {
        for mode in modes {
            let mut force = vec![0.0; mode.shape.len()];
            self.system.subtract_skew_times(&self.at, &mode.shape, &mut force);
            for other in modes {
                let coupling: f64 = other.shape.iter().zip(&force).map(|(x, f)| x * f).sum();
                let scale = self.shift + mode.eigenvalue.abs().max(other.eigenvalue.abs());
                if coupling.abs() > COUPLING * scale {
                    return Err(Failure::NoPotential { coupling: coupling.abs() / scale });
                }
            }
        }
        Ok(())
    }
}
