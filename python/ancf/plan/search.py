"""What a search knows: pilots, what they promise, and which of them is the cheapest that is good enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace

import numpy as np

from ancf.plan.climb import Climb
from ancf.plan.cost import Costs
from ancf.plan.errors import Side, Values, distance, scales
from ancf.plan.ladder import RIGID, Choice, Family, Rung, Stepping
from ancf.plan.pilots import Pilot, Pilots
from ancf.plan.timing import SHARE, Timing


@dataclass
class Search:
    """The state of a search; `ancf.plan.ascent` and `ancf.plan.descent` go up and down the ladder.

    Parameters
    ----------
    pilots : Pilots
        Runs and remembers.
    costs : Costs
        Predicts.
    families : sequence of Family
        That the scene allows.
    base : tuple of pairs of int
        The coarsest divisions.
    tol : float
        Of the plan.
    timings : list of Timing
        In motion, what is good enough in time; empty in statics.
    """

    pilots: Pilots
    costs: Costs
    families: Sequence[Family]
    base: tuple[tuple[int, int], ...]
    tol: float
    timings: list[Timing] = field(default_factory=list)
    predicted: dict[Choice, float] = field(default_factory=dict)
    allowed: list[Stepping] = field(default_factory=list)
    guessed: dict[Choice, float] = field(default_factory=dict)
    climbs: list[Climb] = field(default_factory=list)

    def __post_init__(self) -> None:
        """Allow the steppings that are good enough; those that replace them are allowed later."""
        self.allowed = [timing.stepping for timing in self.timings]

    @property
    def allowance(self) -> float:
        """The error in space that the choice may have: in motion a share is left for that in time."""
        return (1.0 - SHARE if self.timings else 1.0) * self.tol

    @property
    def lead(self) -> Climb:
        """The climb with the smallest error."""
        return min((climb for climb in self.climbs if climb.rung is not None), key=lambda climb: climb.own)

    @property
    def best(self) -> Rung:
        """The finest rung of the leading climb."""
        assert self.lead.rung is not None
        return self.lead.rung

    @property
    def exact(self) -> Values:
        """What is known best of the wanted quantities."""
        return self.lead.exact

    @property
    def own(self) -> float:
        """The error of `exact`, relative."""
        return self.lead.own

    @property
    def sides(self) -> dict[tuple[int, int], Side]:
        """What is known along the sides of `best`."""
        return self.lead.sides

    def stepping(self, rung: Rung) -> Stepping | None:
        """Return the stepping that is predicted to be the cheapest on a rung; None in statics."""
        if not self.timings:
            return None
        return min(self.timings, key=lambda timing: self.predict_with(rung, timing)).stepping

    def found(self, stepping: Stepping) -> Stepping:
        """Return the stepping of the same kind that was found on the coarse mesh, from which it was made longer."""
        same = (t.stepping for t in self.timings if t.stepping.like(stepping))
        return next(same, stepping)

    def shorten(self, stepping: Stepping, shorter: Stepping) -> None:
        """Take shorter steps in place of others; longer ones may still do on coarser meshes."""
        self.allowed.remove(stepping)
        self.allowed = [shorter, *self.allowed, stepping]
        for index, timing in enumerate(self.timings):
            if timing.stepping == stepping:
                # Its cost is known from the pilot with the longer steps.
                again = self.pilots.run(Choice(timing.pilot.choice.rung, shorter))
                pilot = again if again.ok else timing.pilot
                self.timings[index] = replace(timing, stepping=shorter, pilot=pilot)

    def predict_with(self, rung: Rung, timing: Timing) -> float:
        """Return the seconds of a rung with a stepping, from the pilot with it that is most like the rung."""
        like = self._like(rung, timing.stepping)
        return self.costs.predict(rung, like if like is not None else timing.pilot)

    def _like(self, rung: Rung, stepping: Stepping | None) -> Pilot | None:
        like = [p for p in self.pilots.done if p.ok and p.choice.stepping == stepping]

        def unlike(pilot: Pilot) -> tuple[float, bool]:
            other = pilot.choice.rung
            return abs(np.log(other.elements / rung.elements)), other.family != rung.family

        return min(like, key=unlike, default=None)

    def choice(self, rung: Rung) -> Choice:
        """Return the rung with the stepping that is predicted to be the cheapest."""
        return Choice(rung, self.stepping(rung))

    def run(self, rung: Rung, limit: float = np.inf) -> Pilot:
        """Run a rung, after its cost has been predicted from the pilot most like it."""
        choice = self.choice(rung)
        predicted = self.predict(rung)
        if predicted is not None:
            self.predicted.setdefault(choice, predicted)
        return self.pilots.run(choice, limit)

    def predict(self, rung: Rung) -> float | None:
        """Return the seconds that a rung should take, from the pilot that is most like it."""
        like = self._like(rung, self.stepping(rung))
        return None if like is None else self.costs.predict(rung, like)

    def values(self, rung: Rung) -> Values | None:
        """Return the wanted quantities of a rung if it has been run, with any stepping that is good enough."""
        choices = [Choice(rung, stepping) for stepping in self.allowed] if self.timings else [Choice(rung)]
        found = (self.pilots.known(choice) for choice in choices)
        return next((pilot.values for pilot in found if pilot is not None), None)

    def observed(self) -> dict[Choice, float]:
        """Return the error of every pilot that reached its end: its distance to `exact` and what that lacks."""
        scale = scales(self.exact)
        done = (pilot for pilot in self.pilots.done if pilot.ok)
        return {pilot.choice: distance(pilot.values, self.exact, scale) + self.own for pilot in done}

    def cheapest(self, errors: dict[Choice, float]) -> Pilot | None:
        """Return the cheapest pilot whose error is small enough."""
        return min(self.good(errors), key=lambda pilot: pilot.seconds, default=None)

    def good(self, errors: dict[Choice, float]) -> list[Pilot]:
        """Return the pilots whose error is small enough."""
        rigid = [pilot.choice.stepping for pilot in self.pilots.done if pilot.choice.rung.family == RIGID]
        allowed = [*self.allowed, *rigid] if self.timings else [None]
        return [
            pilot
            for choice, error in errors.items()
            if error <= self.allowance
            and choice.stepping in allowed
            and (pilot := self.pilots.known(choice)) is not None
        ]
