//! When a factorisation serves further iterations and solutions.

use crate::linear::Inertia;

/// Most solutions that pass between two trials.
const LONGEST: usize = 32;

/// The factorisation that the system holds.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Kept {
    /// The factors of inertia and stiffness, and the rate of the velocities, that it was made with.
    pub coefficients: [f64; 3],
    pub inertia: Inertia,
}

/// A trial that is made the less often, the more often it failed in a row.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Trial {
    /// Solutions without a trial from now on.
    pub pause: usize,
    /// Solutions without a trial after the last failure; zero after a success.
    pub last_pause: usize,
}

impl Trial {
    /// Whether a solution that could make the trial does.
    fn is_due(&mut self) -> bool {
        let due = self.pause == 0;
        self.pause = self.pause.saturating_sub(1);
        due
    }

    fn failed(&mut self) {
        self.last_pause = (2 * self.last_pause).clamp(1, LONGEST);
        self.pause = self.last_pause;
    }
}

/// What is known from earlier solutions.
///
/// A solution may begin with the factorisation of an earlier one, or take its own first one for all iterations. Either
/// costs an iteration or two where it does not serve, and whether it does hardly changes from one solution to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(crate) struct Reuse {
    pub kept: Option<Kept>,
    pub trials: [Trial; 2],
    /// The trial that the solution makes that is being found.
    pub made: Option<usize>,
}

const EARLIER: usize = 0;
const FIRST: usize = 1;

impl Reuse {
    /// Begins a solution, with the factorisation that is kept if `wanted`, of these coefficients, and due.
    pub fn begin(&mut self, wanted: bool, coefficients: [f64; 3]) {
        self.kept = self.kept.filter(|kept| wanted && kept.coefficients == coefficients);
        if self.kept.is_some() && !self.trials[EARLIER].is_due() {
            self.kept = None;
        }
        self.made = self.kept.map(|_| EARLIER);
    }

    /// Whether the first factorisation of a solution is kept for its next iteration.
    pub fn try_first(&mut self) -> bool {
        let due = self.trials[FIRST].is_due();
        self.made = due.then_some(FIRST);
        due
    }

    /// The kept factorisation does not serve.
    pub fn failed(&mut self) {
        if let Some(trial) = self.made.take() {
            self.trials[trial].failed();
        }
    }

    /// The solution was found.
    pub fn served(&mut self) {
        if let Some(trial) = self.made.take() {
            self.trials[trial] = Trial::default();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Of 200 solutions that could make a trial that always fails few do; once it succeeds all do again.
    #[test]
    fn trials_that_fail_become_rare() {
        let coefficients = [1.0; 3];
        let mut reuse = Reuse::default();
        let mut solve = |serves: bool| {
            reuse.kept = Some(Kept { coefficients, inertia: Inertia { negative: 0 } });
            reuse.begin(true, coefficients);
            let tried = reuse.kept.is_some();
            if serves {
                reuse.served();
            } else {
                reuse.failed();
            }
            tried
        };
        let tried = (0..200).filter(|_| solve(false)).count();
        assert!((8..=12).contains(&tried), "{tried}");
        assert!((0..LONGEST + 1).any(|_| solve(true)) && (0..10).all(|_| solve(true)));
        reuse.kept = Some(Kept { coefficients, inertia: Inertia { negative: 0 } });
        reuse.begin(true, [2.0; 3]);
        assert_eq!(reuse.kept, None, "other coefficients make another tangent");
    }
}
