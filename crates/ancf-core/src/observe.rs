//! What a solve tells while it runs, and how it is stopped.

use crate::assembly::{Reaction, StrainEnergy};

/// A state that was accepted: an output of a solve.
#[derive(Clone, Debug, PartialEq)]
pub struct State {
    /// Time (s), or load factor in statics.
    pub t: f64,
    /// Nodal coordinates.
    pub q: Vec<f64>,
    /// Their velocities; zeros in statics.
    pub v: Vec<f64>,
    /// Their accelerations; zeros in statics.
    pub a: Vec<f64>,
    /// Strain energy, J.
    pub strain: StrainEnergy,
    /// Kinetic energy, J.
    pub kinetic: f64,
    /// Work done by the loads and by moved supports since the start, J.
    pub work: f64,
    /// Energy that damping has taken since the start, J; that of an integrator itself is what the balance misses.
    pub dissipated: f64,
    /// Momentum, kg m/s.
    pub momentum: [f64; 3],
    /// Angular momentum about the origin, kg m2/s.
    pub angular_momentum: [f64; 3],
    /// What each support exerts, in the order in which they were added.
    pub reactions: Vec<Reaction>,
    /// Negative pivots of the tangent near this state that count as instabilities, where they were counted.
    pub negative_pivots: Option<usize>,
}

/// Follows a solve.
pub trait Observer {
    /// An output was reached.
    fn state(&mut self, state: State);

    /// Outputs after a time are not sound: their steps had not been stable.
    fn withdraw(&mut self, _after: f64) {}

    /// Time (or load factor) that has been reached.
    fn reached(&mut self, _t: f64) {}

    /// Whether [`checkpoint`](Self::checkpoint) will ever ask for one.
    fn wants_checkpoints(&self) -> bool {
        false
    }

    /// A step of a motion was accepted, or the run has ended (`last`). `make` gives the bytes of a file to go on from the
    /// last accepted step, which holds the given outputs.
    fn checkpoint(&mut self, _make: &dyn Fn(&[State]) -> Vec<u8>, _last: bool) {}

    /// Whether to stop; asked before every Newton iteration.
    fn stop(&self) -> bool {
        false
    }
}

/// Keeps all states.
impl Observer for Vec<State> {
    fn state(&mut self, state: State) {
        self.push(state);
    }

    fn withdraw(&mut self, after: f64) {
        self.retain(|state| state.t <= after);
    }
}
