"""The reference of a chart: the finest run, confirmed by another element and integrator."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from ancf.errors import InputError, Mistake
from ancf.records import Record
from ancf.run import Dynamic, Static
from ancf.scene import Scene
from ancf.sweep import Outcome, Variant

_FINER = 2.0
_TIGHTER = 0.1
_TIGHT = 1e-10


@dataclass(frozen=True)
class Reference:
    """What errors are measured against.

    Parameters
    ----------
    variant : Variant
        The run whose probes it is.
    probes : mapping of str to Record
        Its probes.
    scale : mapping of str to float
        Of each probe the largest distance from its start: what errors are relative to.
    other : Variant or None
        The run with another element and integrator that confirms it; None if that did not end well.
    disagreement : float
        The largest distance of the two, relative to the scale; nan without the other.
    refinement : float
        The same between the reference and its own element on the mesh half as fine; nan if that did not end well.
    """

    variant: Variant
    probes: Mapping[str, Record]
    scale: Mapping[str, float]
    other: Variant | None
    disagreement: float
    refinement: float

    @property
    def trust(self) -> float:
        """How far the reference is known, relative to the scale: errors below that cannot be told apart.

        The larger of the disagreement and the refinement, which a method of first order or above would not exceed if
        it were refined for ever.
        """
        return max(self.disagreement, 0.0 if np.isnan(self.refinement) else self.refinement)

    def error(self, probes: Mapping[str, Record], other: Mapping[str, Record] | None = None) -> float:
        """Return the largest distance of probes from the reference, or from others, relative to the scale."""
        return _distance(probes, self.probes if other is None else other, self.scale)


@dataclass(frozen=True)
class Candidates:
    """Runs from which the reference is made, finer than the finest mesh of a chart.

    The first has the membrane of the scene, `full` or `projected`, the other one `lobatto` or `full`: another cure of
    locking than the first. (`projected` would be too soft in the plane of the scenes for which one takes `full`.)

    Parameters
    ----------
    first, coarser : Variant
        `thin48` with the tightest tolerance, and the same on the mesh half as fine.
    other : Variant
        `thin36`, by another integrator.
    spare, spare_coarser : Variant
        The element of the scene, which takes the place of `thin48` where that does not suit the supports.
    """

    first: Variant
    coarser: Variant
    other: Variant
    spare: Variant
    spare_coarser: Variant

    @classmethod
    def of(cls, scene: Scene, finest: float, tightest: float) -> Candidates:
        """Make the candidates for a scene with the outputs, the finest mesh and the tightest tolerance of a chart."""
        own = "full" if {body.membrane for body in scene.model.bodies.values()} == {"full"} else "projected"
        other = "lobatto" if own == "full" else "full"
        if isinstance(scene.run, Dynamic):
            tight = {"method": "esdirk", "rtol": _TIGHTER * tightest}
            another = {"method": "tr_bdf2", "rtol": tightest}
        else:
            assert isinstance(scene.run, Static)
            tight = {"tolerance": _TIGHT}
            another = {"tolerance": _TIGHT, "first_step": 0.25 * abs(scene.run.load_factors[0])}
        fine, coarse = {"mesh": _FINER * finest} | tight, {"mesh": finest} | tight
        return cls(
            first=Variant.of(scene, element="thin48", membrane=own, **fine),
            coarser=Variant.of(scene, element="thin48", membrane=own, **coarse),
            other=Variant.of(scene, element="thin36", membrane=other, mesh=_FINER * finest, **another),
            spare=Variant.of(scene, **fine),
            spare_coarser=Variant.of(scene, **coarse),
        )

    def choose(self, found: Mapping[str, Outcome]) -> Reference:
        """Make the reference of the outcomes, which are under the digests of the candidates.

        Raises
        ------
        InputError
            If neither the first nor the spare ended well, or no probe moves.
        """
        variant, coarser = self.first, self.coarser
        outcome = found.get(variant.digest)
        if outcome is None or outcome.status != "ok":
            variant, coarser = self.spare, self.spare_coarser
            outcome = found.get(variant.digest)
        if outcome is None or outcome.status != "ok":
            reason = outcome.reason if outcome else "there was no time for it"
            problem = f"the reference did not end well: {reason}. Try a coarser mesh or a larger budget"
            raise InputError(Mistake(("mesh",), problem))
        scale = _scale(outcome.probes)
        distances = [
            _distance(outcome.probes, rival.probes, scale) if rival and rival.status == "ok" else np.nan
            for rival in (found.get(self.other.digest), found.get(coarser.digest))
        ]
        other = None if np.isnan(distances[0]) else self.other
        return Reference(variant, outcome.probes, scale, other, *distances)


def _scale(probes: Mapping[str, Record]) -> dict[str, float]:
    sizes = {
        name: float(np.linalg.norm(record.value - record.value[0], axis=1).max()) for name, record in probes.items()
    }
    moving = {name: size for name, size in sizes.items() if size > 0}
    if not moving:
        raise InputError(Mistake(("probe",), "no probe changes: errors have no scale"))
    return moving


def _distance(these: Mapping[str, Record], those: Mapping[str, Record], scale: Mapping[str, float]) -> float:
    return max(
        float(np.linalg.norm(these[name].value - those[name].value, axis=1).max()) / size
        for name, size in scale.items()
    )
