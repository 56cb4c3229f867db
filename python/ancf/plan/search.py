"""What a search knows: pilots, what they promise, and which of them is the cheapest that is good enough."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from math import log

import numpy as np

from ancf.plan.climb import Climb
from ancf.plan.cost import Costs
from ancf.plan.errors import Side, Values, distance, scales
from ancf.plan.ladder import Choice, Family, Rung, Stepping
from ancf.plan.pilots import Pilot, Pilots
from ancf.plan.timing import SHARE, Timing

_MARGIN = 0.85
"""Part of the tolerance that estimates may promise: they are no bounds."""
_LEFT = 0.5
"""Part of what tighter steps change that is left when it is taken out: a third at the second order."""
_TIGHTENED = 4
"""Times that steps are tightened until that changes little."""
_ALIKE = 2.0
"""Times an estimate that is above the tolerance up to which another one says the same."""
_ROUNDING = 1e-13
"""Relative differences below it are none."""
_OTHER = log(4.0)
"""A pilot of another family says as much of costs as one of the same on a mesh of a quarter of the elements."""
_LENGTH = log(2.0)
"""And one with other steps as much as on a mesh of half of the elements."""
_TIE = 1.15
"""Times the cheapest up to which the one with the smallest error is taken."""


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
    predicted, guessed : dict of Choice to float
        Seconds and errors that were expected of pilots before they were run.
    allowed : list of Stepping
        Whose values are trusted on the way up.
    climbs : list of Climb
        The way up.
    in_time : float
        Error in time that is left in what is known best, relative.
    late : list of ndarray or None
        What tighter steps change of it.
    stepped : Stepping or None
        Than which they are tighter.
    checked : bool
        Whether tighter steps were run on any rung that is fine enough; always in statics.
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
    in_time: float = 0.0
    late: Values | None = None
    stepped: Stepping | None = None
    checked: bool = False
    _alike: dict[tuple[Family, int, Stepping | None], Pilot | None] = field(default_factory=dict)
    _of_kind: dict[tuple[str, bool, bool] | None, list[Pilot]] = field(default_factory=dict)
    _runs: int = -1

    def __post_init__(self) -> None:
        """Allow the steppings that are good enough; those that replace them are allowed later."""
        self.allowed = [timing.stepping for timing in self.timings]
        self.in_time = max((timing.error for timing in self.timings), default=0.0)
        self.checked = not self.timings

    @property
    def allowance(self) -> float:
        """The distance to what is known best, and what that lacks in space, that the choice may have."""
        return _MARGIN * self.tol - self.in_time

    @property
    def lead(self) -> Climb:
        """The climb with the smallest error; where none is small, the one with the finest mesh unless it tells more.

        Estimates that are far from their end say little of which is the better one.
        """
        known = [climb for climb in self.climbs if climb.rung is not None]
        least = min(known, key=lambda climb: climb.own)
        finest = max(known, key=lambda climb: climb.rung.elements if climb.rung else 0)
        return finest if least.own > self.tol and finest.own <= _ALIKE * least.own else least

    @property
    def best(self) -> Rung:
        """The finest rung of the leading climb."""
        assert self.lead.rung is not None
        return self.lead.rung

    @property
    def exact(self) -> Values:
        """What is known best of the wanted quantities."""
        exact = self.lead.exact
        return exact if self.late is None else [x + late for x, late in zip(exact, self.late, strict=True)]

    def correct(self, rung: Rung) -> None:
        """Take out of what is known best what tighter steps change on a rung; set what is left of the error in time.

        Steps that were short enough on the coarse mesh may damp or miss what moves fast on a finer one: they are
        tightened until that changes little. Where that cannot be run nothing is promised.
        """
        if not self.timings:
            return
        if self.stepped is None:
            self.stepped = self.stepping(self.best)
        assert self.stepped is not None
        first = last = self.pilots.run(Choice(rung, self.stepped))
        for _ in range(_TIGHTENED):
            assert last.choice.stepping is not None
            stepping = last.choice.stepping.tighter()
            tight = self.pilots.run(Choice(rung, stepping))
            if not last.ok or not tight.ok:
                return
            self.checked = True
            change = distance(tight.values, last.values, scales(last.values))
            self.late = [after - before for after, before in zip(tight.values, first.values, strict=True)]
            # The limit of stability may set the steps of both: then tighter control tells nothing.
            if change > _ROUNDING:
                self.in_time = _LEFT * change
            if change <= SHARE * self.tol:
                return
            if change > 2 * SHARE * self.tol and last.choice.stepping in self.allowed:
                self.shorten(last.choice.stepping, stepping)
            last = tight

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
        return self.timing(rung).stepping

    def timing(self, rung: Rung) -> Timing:
        """Return the same with what is known of it."""
        return min(self.timings, key=lambda timing: self.predict_with(rung, timing))

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
        predicted = self.predict_choice(Choice(rung, timing.stepping))
        return self.costs.predict(rung, timing.pilot) if predicted is None else predicted

    def _like(self, rung: Rung, stepping: Stepping | None) -> Pilot | None:
        """Return the pilot with the same kind of stepping whose rung and steps are the most like others."""
        if self._runs != self.pilots.runs:
            self._runs = self.pilots.runs
            self._alike.clear()
            self._of_kind = {}
            for pilot in self.pilots.done:
                if pilot.ok:
                    self._of_kind.setdefault(_kind(pilot.choice.stepping), []).append(pilot)
        # Of a rung only its family and elements matter.
        key = (rung.family, rung.elements, stepping)
        if key not in self._alike:
            pilots = self._of_kind.get(_kind(stepping), [])
            self._alike[key] = min(pilots, key=lambda pilot: _unlike(pilot.choice, rung, stepping), default=None)
        return self._alike[key]

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
        return self.predict_choice(self.choice(rung))

    def predict_choice(self, choice: Choice) -> float | None:
        """Return the seconds of a choice, from the pilot most like it; its steps may be longer than that one's."""
        stepping = choice.stepping
        like = self._like(choice.rung, stepping)
        if like is None or stepping is None or like.choice.stepping is None:
            return None if like is None else self.costs.predict(choice.rung, like)
        return self.costs.predict(choice.rung, like) * like.choice.stepping.lengthening(stepping)

    def values(self, rung: Rung) -> Values | None:
        """Return the wanted quantities of a rung if it has been run, with any stepping that is good enough."""
        choices = [Choice(rung, stepping) for stepping in self.allowed] if self.timings else [Choice(rung)]
        found = (self.pilots.known(choice) for choice in choices)
        return next((pilot.values for pilot in found if pilot is not None), None)

    def observed(self) -> dict[Choice, float]:
        """Return the error of every pilot that reached its end: its distance to `exact` and what that lacks."""
        exact, own = self.exact, self.own
        scale = scales(exact)
        done = (pilot for pilot in self.pilots.done if pilot.ok)
        return {pilot.choice: distance(pilot.values, exact, scale) + own for pilot in done}

    def cheapest(self, errors: dict[Choice, float]) -> Pilot | None:
        """Return the cheapest pilot whose error is small enough."""
        good = self.good(errors)
        limit = _TIE * min((pilot.seconds for pilot in good), default=0.0)
        # Among those that cost about the same the clock shall not choose.
        tied = (pilot for pilot in good if pilot.seconds <= limit)
        return min(tied, key=lambda pilot: errors[pilot.choice], default=None)

    def good(self, errors: dict[Choice, float]) -> list[Pilot]:
        """Return the pilots whose error is small enough."""
        return [
            pilot
            for choice, error in errors.items()
            if error <= self.allowance and (pilot := self.pilots.known(choice)) is not None
        ]


def _kind(stepping: Stepping | None) -> tuple[str, bool, bool] | None:
    return None if stepping is None else stepping.kind


def _unlike(choice: Choice, rung: Rung, stepping: Stepping | None) -> float:
    """Return how little the cost of a choice says of that of a rung with some steps."""
    differs = _OTHER * (choice.rung.family != rung.family) + _LENGTH * (choice.stepping != stepping)
    return abs(log(choice.rung.elements / rung.elements)) + differs
