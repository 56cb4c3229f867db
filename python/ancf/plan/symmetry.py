"""Mirror symmetry: half of a scene that moves as the whole does."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from typing import Any

from ancf.bodies import Cylinder, Plate, Rectangle
from ancf.inputs import Input
from ancf.loads import Force, LineLoad, Moment
from ancf.model import Model
from ancf.probes import Probe
from ancf.scene import Scene
from ancf.supports import Axis, Support

_NORMALS: dict[tuple[str, int], Axis] = {("rectangle", 0): "x", ("rectangle", 1): "y", ("cylinder", 1): "z"}
"""Direction in space of a mirror across the middle of a natural coordinate."""
_BELOW = 1e-9
"""Part of a side by which a place on a mirror is moved to its low side."""


def halved(scene: Scene) -> tuple[Scene, list[int]]:
    """Return the part of a scene on the low side of its mirrors, and the natural coordinates that they halve.

    A plane across the middle of a rectangle, or of the length of a cylinder, is a mirror if loads and supports are
    their own images and all probes lie on its low side.
    Whether the whole also *moves* symmetrically is another matter, see `ancf.plan.planner`.

    Parameters
    ----------
    scene : Scene
        The whole.

    Returns
    -------
    Scene and list of int
        The part; the scene itself and an empty list if there is no mirror.
    """
    halves = []
    for axis in (0, 1):
        half = _halved(scene, axis)
        if half is not None:
            scene = half
            halves.append(axis)
    return scene, halves


def _halved(scene: Scene, axis: int) -> Scene | None:
    model = scene.model
    if len(model.bodies) != 1:
        return None
    [(name, body)] = model.bodies.items()
    normal = _NORMALS.get((body.shape, axis))
    low, high = model.domain(name)[axis]
    middle = 0.5 * (low + high)
    if normal is None or any(probe.at[axis] > middle for probe in model.probes):
        return None
    mirror = _Mirror(axis, "xyz".index(normal), low + high)
    supports = mirror.low_half(list(model.supports))
    loads = mirror.low_half(list(model.loads))
    if supports is None or loads is None:
        return None
    edge = Support(body=name, at=f"edge:{'xy'[axis]}1", symmetry=normal)
    bodies = {name: _half_body(body, axis, middle)}
    return replace(scene, model=Model(bodies=bodies, supports=[*supports, edge], loads=loads, probes=model.probes))


def _half_body(body: Plate, axis: int, middle: float) -> Plate:
    if isinstance(body, Rectangle):
        size = tuple(middle if a == axis else side for a, side in enumerate(body.size))
        return body.model_copy(update={"size": size})
    assert isinstance(body, Cylinder)
    return body.model_copy(update={"length": (body.length[0], middle)})


class _Mirror:
    """The mirror across the middle of the natural coordinate `axis`, whose ends add up to `ends`."""

    def __init__(self, axis: int, normal: int, ends: float) -> None:
        self._axis, self._normal, self._ends = axis, normal, ends
        self._low, self._high = (f"{'xy'[axis]}{end}" for end in (0, 1))

    def low_half(self, items: Sequence[Any]) -> list[Any] | None:
        """Return what of loads or supports lies on the low side; None if they are not their own image."""
        left = list(items)
        kept = []
        while left:
            item = left.pop(0)
            image = self._image(item)
            if image is None:
                return None
            if image == item:
                kept.append(self._own(item))
            elif image in left:
                left.remove(image)
                kept.append(item if self._is_low(item) else image)
            else:
                return None
        return kept

    def _image(self, item: Input) -> Input | None:
        """Return the mirror image of a load or support; None if that is not told."""
        if isinstance(item, Support) and (item.translation or item.shake or item.rotation):
            return None
        # A pressure has neither place nor direction; a moment about an edge is the same on both sides.
        update: dict[str, object] = {}
        if isinstance(item, (Support, Force, LineLoad, Moment)):
            update["at"] = self._place(item.at)
        for key in ("acceleration", "force"):
            if hasattr(item, key):
                update[key] = self._vector(getattr(item, key))
        if isinstance(item, LineLoad):
            update["per_length"] = self._vector(item.per_length)
        return item.model_copy(update=update)

    def _own(self, item: Any) -> Any:
        """Return the part of something that is its own image: half of a force on the mirror, all else as it is."""
        if isinstance(item, Force):
            return item.model_copy(update={"force": tuple(0.5 * part for part in item.force)})
        return item

    def _is_low(self, item: Any) -> bool:
        at = item.at
        return self._low in at if isinstance(at, str) else bool(2 * at[self._axis] < self._ends)

    def _place(self, at: str | tuple[float, float]) -> str | tuple[float, float]:
        if isinstance(at, str):
            swapped = {self._low: self._high, self._high: self._low}
            return next((at.replace(end, other) for end, other in swapped.items() if end in at), at)
        x = [*at]
        # A point on the mirror is its own image to the last bit.
        image = self._ends - x[self._axis]
        x[self._axis] = x[self._axis] if abs(image - x[self._axis]) < 1e-12 * abs(self._ends) else image
        return x[0], x[1]

    def _vector(self, vector: tuple[float, float, float]) -> tuple[float, float, float]:
        x, y, z = (-part if i == self._normal and part else part for i, part in enumerate(vector))
        return x, y, z


def doubled(divisions: tuple[tuple[int, int], ...], halves: Sequence[int]) -> tuple[tuple[int, int], ...]:
    """Return the divisions of the whole from those of the part."""
    x, y = (2 if axis in halves else 1 for axis in (0, 1))
    return tuple((x * a, y * b) for a, b in divisions)


def below(model: Model, probe: Probe, halves: Sequence[int]) -> tuple[float, float]:
    """Return the place of a probe, just on the low side of the mirrors that it lies on."""
    place = list(probe.at)
    for axis in halves:
        low, high = model.domain(probe.body)[axis]
        place[axis] = min(place[axis], 0.5 * (low + high) - _BELOW * (high - low))
    return place[0], place[1]
