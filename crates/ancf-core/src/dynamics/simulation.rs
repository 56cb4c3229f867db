//! Steps strung together: outputs, rejected steps, checkpoints.

mod controlled;
mod limit;

use crate::assembly::Reaction;
use crate::nonlinear::{Failure, Middles};
use crate::observe::{Observer, State};
use crate::report::Counts;

use super::Options;
use super::checkpoint::{Checkpoint, Memory};
use super::control::{Controller, Steps, Tolerances};
use super::equations::Equations;
use super::fingerprint::Fingerprint;
use super::method::{Integrator, Method};
use super::state::Instantaneous;

/// A motion while it is computed.
pub(super) struct Simulation<'a> {
    equations: Equations<'a>,
    options: &'a Options,
    integrator: Box<dyn Integrator>,
    controller: Controller,
    middles: Middles,
    now: Instantaneous,
    next: Instantaneous,
    error: Vec<f64>,
    /// The coordinates of positions, and what is allowed of the error of each.
    allowed: Vec<(usize, f64)>,
    /// Times at which steps under error control end, besides outputs: what begins between two steps, no estimate sees.
    kinks: Vec<f64>,
    /// The last state in which a fixed explicit step was found stable, and the steps up to there.
    stable: Option<(Instantaneous, usize)>,
    /// Controlled steps without a solution, and the time since which they are counted.
    unsolved: (f64, usize),
    /// What belongs to the state `now` in a checkpoint, when checkpoints are wanted: a step that is being tried has
    /// changed the present ones already.
    accepted: (Controller, Memory, Counts),
    /// Steps of this run and, after a checkpoint, all counts of the run before.
    counts: Counts,
    /// Evaluations and factorisations of the system before this run.
    earlier: [usize; 2],
}

impl<'a> Simulation<'a> {
    pub fn new(equations: Equations<'a>, options: &'a Options) -> Self {
        let n = equations.system.coordinates();
        let earlier = [equations.system.forces(), equations.system.factorizations()];
        let (mut allowed, mut kinks) = (Vec::new(), Vec::new());
        if let Steps::Controlled(Tolerances { rtol, atol, .. }) = options.steps {
            kinks.extend(equations.system.model().kinks(0.0, options.until, rtol));
            let coordinates = equations.inertia.positions().iter().flat_map(|a| 3 * a..3 * a + 3);
            allowed.extend(coordinates.map(|i| (i, atol + rtol * equations.newton.scale()[i])));
        }
        Self {
            middles: Middles::new(equations.system.model()),
            equations,
            options,
            integrator: options.method.integrator(),
            controller: Controller::new(0.0),
            now: Instantaneous::default(),
            next: Instantaneous::default(),
            error: vec![0.0; n],
            allowed,
            kinks,
            stable: None,
            unsolved: (0.0, 0),
            accepted: (Controller::new(0.0), Memory::default(), Counts::default()),
            counts: Counts::default(),
            earlier,
        }
    }

    pub fn counts(&self) -> Counts {
        Counts {
            iterations: self.counts.iterations + self.equations.newton.iterations(),
            forces: self.counts.forces + self.equations.system.forces() - self.earlier[0],
            factorizations: self.counts.factorizations + self.equations.system.factorizations() - self.earlier[1],
            ..self.counts
        }
    }

    pub fn reached(&self) -> f64 {
        self.now.t
    }

    /// Sets the state at the start, or the one of a checkpoint.
    pub fn begin(&mut self, checkpoint: Option<Checkpoint>, observer: &mut dyn Observer) -> Result<(), Failure> {
        if let Some(checkpoint) = checkpoint {
            self.resume(checkpoint)?;
            // What an uninterrupted run would not have done is not counted.
            self.earlier = [self.equations.system.forces(), self.equations.system.factorizations()];
            return Ok(());
        }
        let q = self.equations.system.model().reference().to_vec();
        let zeros = vec![0.0; q.len()];
        let v = self.options.velocity.clone().unwrap_or_else(|| zeros.clone());
        self.now = Instantaneous { q, v, a: zeros.clone(), external: zeros, ..Instantaneous::default() };
        self.integrator.begin(&mut self.equations, &mut self.now)?;
        self.next = self.now.clone();
        self.controller = Controller::new(match self.options.steps {
            Steps::Fixed { step, .. } => step,
            Steps::Controlled(tolerances) => tolerances.first_step.unwrap_or_else(|| self.first_step(tolerances)),
        });
        let heeded = self.heed_limit(observer);
        self.accepted = (self.controller, Memory::default(), self.counts());
        if self.options.outputs.first() == Some(&0.0) {
            observer.state(self.now.output(&mut self.equations));
        }
        heeded
    }

    /// Integrates to the end.
    pub fn run(&mut self, observer: &mut dyn Observer) -> Result<(), Failure> {
        self.middles.begin(self.equations.system.model(), &self.now.q);
        let end = self.steps(observer);
        observer.checkpoint(&|states| self.checkpoint().to_bytes(states), true);
        if end.is_err() && !self.options.outputs.contains(&self.now.t) {
            // The last good state is not lost; a run that is resumed goes on from the checkpoint without it.
            observer.state(self.now.output(&mut self.equations));
        }
        end
    }

    fn steps(&mut self, observer: &mut dyn Observer) -> Result<(), Failure> {
        let outputs = &self.options.outputs;
        let mut outputs = outputs[outputs.partition_point(|t| *t <= self.now.t)..].iter().copied().peekable();
        while self.now.t < self.options.until {
            if observer.stop() {
                return Err(Failure::Stopped);
            }
            if self.counts.steps.is_multiple_of(limit::EVERY) && self.counts.steps > 0 {
                self.heed_limit(observer)?;
            }
            match self.options.steps {
                Steps::Fixed { step, .. } => {
                    if let Err(failure) = self.fixed_step(step, observer) {
                        if failure == Failure::Stopped {
                            return Err(failure);
                        }
                        self.counts.rejected.count(&failure);
                        return Err(self.unstable_before(step, observer)?.unwrap_or(failure));
                    }
                }
                Steps::Controlled(tolerances) => {
                    let output = outputs.peek().map_or(self.options.until, |t| t.min(self.options.until));
                    let kink = self.next_kink().filter(|kink| *kink < output - self.rounding());
                    self.controlled_step(tolerances, kink.unwrap_or(output), observer)?;
                    if kink == Some(self.next.t) {
                        // Earlier accelerations say nothing about how they change from here on.
                        self.next.lag = 0.0;
                    }
                }
            }
            self.counts.steps += 1;
            let mut reactions = None;
            while let Some(t) = outputs.next_if(|t| *t <= self.next.t) {
                observer.state(self.output(t, &mut reactions));
            }
            std::mem::swap(&mut self.now, &mut self.next);
            self.middles.accept();
            if observer.wants_checkpoints() {
                self.accepted = (self.controller, Memory::of(&self.equations), self.counts());
            }
            observer.reached(self.now.t);
            observer.checkpoint(&|states| self.checkpoint().to_bytes(states), false);
        }
        Ok(())
    }

    /// The output at a time of the step just made. `reactions` are those at its ends, once they are needed.
    fn output(&mut self, t: f64, reactions: &mut Option<[Vec<Reaction>; 2]>) -> State {
        let rounding = self.rounding();
        let Self { equations, integrator, .. } = self;
        let (now, next) = (&self.now, &self.next);
        if t == next.t {
            return next.output(equations);
        }
        let mut state = Instantaneous::between(now, next, t, integrator.order() > 2).output(equations);
        if [now.t, next.t].iter().any(|end| (t - end).abs() <= rounding) {
            return state;
        }
        // Interpolated positions are strained in a way that the motion is not: forces are interpolated themselves.
        let [from, to] = reactions.get_or_insert_with(|| [now, next].map(|end| equations.reactions(end).1));
        let share = (t - now.t) / (next.t - now.t);
        for (reaction, (from, to)) in state.reactions.iter_mut().zip(from.iter().zip(to)) {
            *reaction = Reaction { point: reaction.point, ..from.towards(to, share) };
        }
        state
    }

    fn try_step(&mut self, observer: &dyn Observer) -> Result<(), Failure> {
        self.integrator.step(&mut self.equations, &self.now, &mut self.next, &mut self.error, observer)?;
        let Instantaneous { q, v, a, .. } = &self.next;
        // All numbers are looked at, which compiles to less than stopping at the first.
        let finite = [q, v, a].iter().all(|x| x.iter().fold(true, |finite, x| finite & x.is_finite()));
        if !finite {
            return Err(Failure::Overflow { t: self.next.t });
        }
        // A rigid body may make half a turn in a step; a step that is forced shows all that comes of it.
        let forced = matches!(self.options.steps, Steps::Fixed { force: true, .. });
        if forced || self.options.method == Method::Rigid {
            return Ok(());
        }
        let place = self.middles.collapsed(self.equations.system.model(), &self.next.q);
        let end = || format!("t = {:.6e} s", self.next.t);
        place.map_or(Ok(()), |place| Err(Failure::Collapsed { place, end: end() }))
    }

    fn fixed_step(&mut self, step: f64, observer: &dyn Observer) -> Result<(), Failure> {
        // Steps are counted, so that their ends do not drift with rounding; the last may be shorter.
        let steps = (self.options.until / step - 1e-9).ceil().max(1.0) as usize;
        let count = self.counts.steps + 1;
        self.next.t = if count >= steps { self.options.until } else { count as f64 * step };
        self.try_step(observer)
    }

    /// Times that are closer are the same but for rounding, s.
    fn rounding(&self) -> f64 {
        4.0 * f64::EPSILON * self.options.until
    }

    /// What is needed to go on from the last accepted step.
    fn checkpoint(&self) -> Checkpoint {
        let (controller, memory, counts) = self.accepted.clone();
        Checkpoint {
            method: self.options.method.name().to_owned(),
            fingerprint: Fingerprint::of(self.equations.system.model(), self.options),
            now: self.now.clone(),
            controller,
            memory,
            counts,
        }
    }

    fn resume(&mut self, checkpoint: Checkpoint) -> Result<(), Failure> {
        let Checkpoint { now, controller, memory, counts, .. } = checkpoint;
        memory.restore(&mut self.equations)?;
        self.next = now.clone();
        (self.now, self.controller, self.counts) = (now, controller, counts);
        self.accepted = (controller, memory, counts);
        Ok(())
    }
}
