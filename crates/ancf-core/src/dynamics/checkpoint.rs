//! What is needed to continue a motion to the same bits.

use crate::assembly::{Reaction, StrainEnergy, System};
use crate::error::InputError;
use crate::linear::Inertia;
use crate::nonlinear::{Failure, Kept, Reuse, Trial};
use crate::observe::State;
use crate::report::{Counts, Rejections};

use super::Options;
use super::control::Controller;
use super::equations::Equations;
use super::fingerprint::Fingerprint;
use super::state::Instantaneous;

/// A motion at the end of an accepted step, from which [`simulate`](super::simulate) goes on.
#[derive(Clone, Debug, PartialEq)]
pub struct Checkpoint {
    pub(super) method: String,
    pub(super) fingerprint: Fingerprint,
    pub(super) now: Instantaneous,
    pub(super) controller: Controller,
    pub(super) memory: Memory,
    pub(super) counts: Counts,
}

/// What Newton's method takes over from the last solution.
#[derive(Clone, Debug, Default, PartialEq)]
pub(super) struct Memory {
    reuse: Reuse,
    /// The tangent whose factorisation is kept.
    tangent: Option<Tangent>,
}

/// The values of a tangent, and the positions and velocities that it was made with.
#[derive(Clone, Debug, PartialEq)]
struct Tangent {
    values: Vec<f64>,
    at: (Vec<f64>, Vec<f64>),
}

impl Memory {
    pub fn of(equations: &Equations<'_>) -> Self {
        let system = &equations.system;
        let reuse = equations.newton.reuse();
        let tangent = || Tangent { values: system.tangent().1.to_vec(), at: system.tangent_at().clone() };
        Self { reuse, tangent: reuse.kept.map(|_| tangent()) }
    }

    /// Makes the next solution go on from there.
    pub fn restore(&self, equations: &mut Equations<'_>) -> Result<(), Failure> {
        let Equations { system, newton, .. } = equations;
        if let Some(Tangent { values, at }) = &self.tangent {
            system.restore(values, at).map_err(|e| Failure::from_linear(e, 0, |row| system.describe(row)))?;
        }
        newton.resume(self.reuse);
        Ok(())
    }
}

/// What a file of a checkpoint begins with.
const MAGIC: &[u8; 8] = b"ancf-cp6";

impl Checkpoint {
    /// The time that was reached, s.
    pub fn t(&self) -> f64 {
        self.now.t
    }

    /// Checks that a run can go on from here.
    pub(super) fn validate(&self, system: &System, options: &Options) -> Result<(), InputError> {
        let n = system.coordinates();
        let sizes = [&self.now.q, &self.now.v, &self.now.a, &self.now.external].map(Vec::len);
        let given = format!("that of {} nodal coordinates", sizes[0]);
        InputError::check("checkpoint", given, sizes == [n; 4], &format!("that of a run with {n} nodal coordinates"))?;
        let entries = system.tangent().1.len();
        let fits = self.memory.tangent.as_ref().is_none_or(|tangent| tangent.values.len() == entries);
        InputError::check("checkpoint", "that of another mesh or support", fits, "that of a run of this model")?;
        let method = options.method.name();
        let given = format!("that of method \"{}\"", self.method);
        InputError::check("checkpoint", given, self.method == method, &format!("that of method \"{method}\""))?;
        self.fingerprint.check(&Fingerprint::of(system.model(), options))
    }

    /// The checkpoint, and the outputs so far, as bytes for a file; numbers in 8 bytes, lowest first. At the end is a checksum
    /// of all the others, CRC-32, in 4 bytes.
    pub(super) fn to_bytes(&self, states: &[State]) -> Vec<u8> {
        let mut words = Words(MAGIC.to_vec());
        self.write(&mut words);
        words.count(states.len());
        for state in states {
            words.state(state);
        }
        let checksum = crc32fast::hash(&words.0);
        words.0.extend(checksum.to_le_bytes());
        words.0
    }

    fn write(&self, words: &mut Words) {
        let Self { method, fingerprint, now, controller, memory, counts } = self;
        words.count(method.len());
        words.0.extend(method.as_bytes());
        words.0.extend(fingerprint.0.iter().flat_map(|digest| digest.to_le_bytes()));
        for x in [now.t, now.lag, now.damping, now.work, now.dissipated] {
            words.number(x);
        }
        for numbers in [&now.q, &now.v, &now.a, &now.external] {
            words.numbers(numbers);
        }
        words.count(now.negative_pivots.map_or(0, |n| n + 1));
        words.number(controller.step);
        words.number(controller.last_error);
        words.number(controller.limit);
        words.count(usize::from(controller.rejected));
        let Rejections { inaccurate, unsolved, singular, not_finite } = counts.rejected;
        for count in [counts.steps, inaccurate, unsolved, singular, not_finite] {
            words.count(count);
        }
        for count in [counts.iterations, counts.forces, counts.factorizations] {
            words.count(count);
        }
        for trial in memory.reuse.trials {
            words.count(trial.pause);
            words.count(trial.last_pause);
        }
        words.count(usize::from(memory.tangent.is_some()));
        if let (Some(kept), Some(Tangent { values, at })) = (memory.reuse.kept, &memory.tangent) {
            words.numbers(&kept.coefficients);
            words.count(kept.inertia.negative);
            words.numbers(values);
            words.numbers(&at.0);
            words.numbers(&at.1);
        }
    }

    /// A checkpoint and the outputs before it from their bytes.
    ///
    /// # Errors
    ///
    /// They must be those of a whole checkpoint, as they were written.
    pub fn from_bytes(bytes: &[u8]) -> Result<(Self, Vec<State>), InputError> {
        let broken = |given: String| InputError::new("checkpoint", given, "a whole checkpoint file of this version");
        let other = || broken(format!("{} bytes", bytes.len()));
        let inner = bytes.strip_prefix(MAGIC).ok_or_else(other)?;
        let (inner, checksum) = inner.split_last_chunk::<4>().ok_or_else(other)?;
        if crc32fast::hash(&bytes[..bytes.len() - checksum.len()]) != u32::from_le_bytes(*checksum) {
            return Err(broken("damaged: its checksum is that of other bytes".to_owned()));
        }
        let read = |bytes| {
            let mut words = Reader(bytes);
            let checkpoint = Self::read(&mut words)?;
            let states = (0..words.count()?).map(|_| words.state()).collect::<Option<_>>()?;
            words.0.is_empty().then_some((checkpoint, states))
        };
        read(inner).ok_or_else(other)
    }

    fn read(words: &mut Reader<'_>) -> Option<Self> {
        let length = words.count()?;
        let method = String::from_utf8(words.take(length)?.to_vec()).ok()?;
        let mut fingerprint = Fingerprint([0; 4]);
        for digest in &mut fingerprint.0 {
            *digest = u64::from_le_bytes(words.take(8)?.try_into().ok()?);
        }
        let [t, lag, damping, work, dissipated] = words.array()?;
        let (q, v, a, external) = (words.numbers()?, words.numbers()?, words.numbers()?, words.numbers()?);
        let negative_pivots = words.count()?.checked_sub(1);
        let now = Instantaneous { t, q, v, a, lag, external, damping, work, dissipated, negative_pivots };
        let [step, last_error, limit] = words.array()?;
        let controller = Controller { step, last_error, limit, rejected: words.count()? != 0 };
        let counts = Counts {
            steps: words.count()?,
            rejected: Rejections {
                inaccurate: words.count()?,
                unsolved: words.count()?,
                singular: words.count()?,
                not_finite: words.count()?,
            },
            iterations: words.count()?,
            forces: words.count()?,
            factorizations: words.count()?,
            ..Counts::default()
        };
        let mut reuse = Reuse::default();
        for trial in &mut reuse.trials {
            *trial = Trial { pause: words.count()?, last_pause: words.count()? };
        }
        let mut tangent = None;
        if words.count()? != 0 {
            let coefficients = words.numbers()?.try_into().ok()?;
            reuse.kept = Some(Kept { coefficients, inertia: Inertia { negative: words.count()? } });
            tangent = Some(Tangent { values: words.numbers()?, at: (words.numbers()?, words.numbers()?) });
        }
        let memory = Memory { reuse, tangent };
        Some(Self { method, fingerprint, now, controller, memory, counts })
    }
}

/// Bytes that are written.
struct Words(Vec<u8>);

impl Words {
    fn count(&mut self, count: usize) {
        self.0.extend((count as u64).to_le_bytes());
    }

    fn number(&mut self, x: f64) {
        self.0.extend(x.to_le_bytes());
    }

    fn numbers(&mut self, numbers: &[f64]) {
        self.count(numbers.len());
        self.0.extend(numbers.iter().flat_map(|x| x.to_le_bytes()));
    }

    fn state(&mut self, state: &State) {
        let State { t, q, v, a, strain, kinetic, work, dissipated, .. } = state;
        let State { momentum, angular_momentum, reactions, negative_pivots, .. } = state;
        for x in [*t, strain.membrane, strain.bending, *kinetic, *work, *dissipated] {
            self.number(x);
        }
        for x in momentum.iter().chain(angular_momentum) {
            self.number(*x);
        }
        for numbers in [q, v, a] {
            self.numbers(numbers);
        }
        self.count(reactions.len());
        for Reaction { point, force, moment } in reactions {
            for x in [point, force, moment].into_iter().flatten() {
                self.number(*x);
            }
        }
        self.count(negative_pivots.map_or(0, |n| n + 1));
    }
}

/// Bytes that are still to be read.
struct Reader<'a>(&'a [u8]);

impl<'a> Reader<'a> {
    fn take(&mut self, length: usize) -> Option<&'a [u8]> {
        let (taken, rest) = self.0.split_at_checked(length)?;
        self.0 = rest;
        Some(taken)
    }

    fn count(&mut self) -> Option<usize> {
        u64::from_le_bytes(self.take(8)?.try_into().ok()?).try_into().ok()
    }

    fn number(&mut self) -> Option<f64> {
        Some(f64::from_le_bytes(self.take(8)?.try_into().ok()?))
    }

    fn array<const N: usize>(&mut self) -> Option<[f64; N]> {
        let mut numbers = [0.0; N];
        for number in &mut numbers {
            *number = self.number()?;
        }
        Some(numbers)
    }

    fn state(&mut self) -> Option<State> {
        let [t, membrane, bending, kinetic, work, dissipated] = self.array()?;
        Some(State {
            t,
            strain: StrainEnergy { membrane, bending },
            kinetic,
            work,
            dissipated,
            momentum: self.array()?,
            angular_momentum: self.array()?,
            q: self.numbers()?,
            v: self.numbers()?,
            a: self.numbers()?,
            reactions: (0..self.count()?).map(|_| self.reaction()).collect::<Option<_>>()?,
            negative_pivots: self.count()?.checked_sub(1),
        })
    }

    fn reaction(&mut self) -> Option<Reaction> {
        Some(Reaction { point: self.array()?, force: self.array()?, moment: self.array()? })
    }

    fn numbers(&mut self) -> Option<Vec<f64>> {
        let count = self.count()?;
        let bytes = self.take(count.checked_mul(8)?)?;
        Some(bytes.as_chunks().0.iter().map(|word| f64::from_le_bytes(*word)).collect())
    }
}
