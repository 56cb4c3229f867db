"""Models: bodies with their supports, loads and probes."""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from types import MappingProxyType
from typing import Annotated, Any, Literal, Self, TypeVar

import numpy as np
from numpy.typing import ArrayLike, NDArray
from pydantic import PlainValidator, PrivateAttr, ValidationInfo, field_validator, model_validator

from ancf import _core
from ancf.bodies import SHAPES, Plate
from ancf.errors import InputError, Mistake, Mistakes, from_core, one_of, show
from ancf.inputs import Input, OnBody, numbers, table
from ancf.loads import History, Load
from ancf.mapped import Surface
from ancf.memory import MODEL, check_memory
from ancf.places import Domain
from ancf.probes import QUANTITIES, Probe, Quantity
from ancf.supports import Support

_Item = TypeVar("_Item", bound=Input)


class Model(Input):
    """Bodies, what holds them, what acts on them and what to record of them.

    Parameters
    ----------
    bodies : mapping of str to body
        Each body under its name.
    supports, loads, probes : sequence, optional
        As many as there are.

    Raises
    ------
    InputError
        If a name, place or point does not exist, with every mistake found.

    Examples
    --------
    >>> from ancf import Gravity, Material, Probe, Rectangle, Support
    >>> rubber = Material(E=1e5, nu=0.3, density=7810.0)
    >>> model = Model(
    ...     bodies={"plate": Rectangle(size=(0.3, 0.3), divisions=(8, 8), thickness=0.01, material=rubber)},
    ...     supports=[Support(at="corner:x0y0", fix=["r"])],
    ...     loads=[Gravity(acceleration=(0.0, 0.0, -9.81))],
    ...     probes=[Probe(name="A", at=(0.3, 0.3))],
    ... )
    >>> model.elements, model.dofs
    (64, 726)
    """

    bodies: Mapping[str, Annotated[Plate, PlainValidator(table(*SHAPES, Surface, key="shape"))]]
    supports: Sequence[Annotated[Support, PlainValidator(table(Support))]] = ()
    loads: Sequence[Load] = ()
    probes: Sequence[Annotated[Probe, PlainValidator(table(Probe))]] = ()

    _assembled: _core.Model = PrivateAttr()

    @field_validator("bodies")
    @classmethod
    def _not_empty(cls, bodies: Mapping[str, Plate]) -> Mapping[str, Plate]:
        if not bodies:
            raise ValueError("must hold at least one body")
        return MappingProxyType(dict(bodies))

    @field_validator("supports", "loads", "probes")
    @classmethod
    def _find_bodies(cls, items: Sequence[_Item], info: ValidationInfo) -> tuple[_Item, ...]:
        bodies = info.data.get("bodies")
        mistakes = Mistakes()
        found = []
        for index, item in enumerate(items):
            with mistakes.gather(index):
                found.append(item.find_body(bodies) if bodies and isinstance(item, OnBody) else item)
        mistakes.check()
        return tuple(found)

    @model_validator(mode="after")
    def _check_references(self) -> Self:
        mistakes = Mistakes()
        names = [probe.name for probe in self.probes]
        for index, name in enumerate(names):
            if name in names[:index]:
                mistakes.add(("probes", index, "name"), "is the name of another probe", name)
        for index, support in enumerate(self.supports):
            with mistakes.gather("supports", index):
                support.check_coordinates(self.bodies[support.body].element)
        check_memory(self.bodies, dict.fromkeys(self.bodies, MODEL))
        core = self._assemble_bodies()
        for key, items in (("supports", self.supports), ("loads", self.loads), ("probes", self.probes)):
            for index, item in enumerate(items):
                at = getattr(item, "at", None)
                with mistakes.gather(key, index):
                    if isinstance(item, OnBody) and isinstance(at, tuple):
                        _check_inside(core, item.body, at)
                    if isinstance(item, Support):
                        item.check_symmetry(core, self.bodies[item.body].element)
        mistakes.check()
        self._assembled = self.assemble("constant")
        return self

    def __eq__(self, other: object) -> bool:
        # The compiled model follows from the rest.
        return isinstance(other, Model) and dict(self) == dict(other)

    __hash__ = None  # type: ignore[assignment]

    def __reduce__(self) -> tuple[Callable[[type[Self], dict[str, Any]], Self], tuple[type[Self], dict[str, Any]]]:
        # The compiled model is made anew in the copy.
        return _make, (type(self), dict(self) | {"bodies": dict(self.bodies)})

    def __deepcopy__(self, memo: dict[int, Any] | None = None) -> Self:
        make, arguments = self.__reduce__()
        return make(*arguments)

    def _assemble_bodies(self) -> _core.Model:
        core = _core.Model()
        for name, body in self.bodies.items():
            with from_core("bodies", name):
                body.add(core, name)
        return core

    def assemble(self, history: History) -> _core.Model:
        """Return the compiled model, with `history` for the loads that have none."""
        core = self._assemble_bodies()
        for index, support in enumerate(self.supports):
            with from_core("supports", index):
                support.add(core, self.bodies[support.body].element)
        for index, load in enumerate(self.loads):
            with from_core("loads", index):
                load.add(core, history)
        return core

    @property
    def elements(self) -> int:
        """How many elements there are."""
        return self._assembled.elements

    @property
    def dofs(self) -> int:
        """How many nodal coordinates are not fixed."""
        return self._assembled.dofs

    def rigid_motions(self) -> list[tuple[str, str]]:
        """Return the rigid motions at rest that no support holds: for each the body and the motion in words."""
        return self._assembled.rigid_motions()

    def domain(self, body: str) -> Domain:
        """Return the ranges of the natural coordinates x and y of a body, or raise `InputError` if there is none."""
        self._check_body(body)
        return self._assembled.domain(body)

    def nodes(self, body: str) -> NDArray[np.float64]:
        """Return the natural coordinates of the nodes of a body.

        Parameters
        ----------
        body : str
            Its name.

        Returns
        -------
        ndarray, shape (nodes, 2)
            Node after node, x fastest.

        Raises
        ------
        InputError
            If there is no such body.
        """
        self._check_body(body)
        return self._assembled.nodes(body)

    def samples(self, body: str, of: Literal["membrane", "bending"] = "bending") -> NDArray[np.float64]:
        """Return where the elements of a body sample their strain.

        Parameters
        ----------
        body : str
            Its name.
        of : {"bending", "membrane"}, default "bending"
            The strain: curvature or membrane strain, of solid elements the same.

        Returns
        -------
        ndarray, shape (elements, points, 2)
            Natural coordinates, for `evaluate` as ``samples.reshape(-1, 2)``.

        Raises
        ------
        InputError
            If there is no such body.
        """
        self._check_body(body)
        with from_core():
            return self._assembled.samples(body, of)

    def nodal_coordinates(self) -> NDArray[np.float64]:
        """Return all nodal coordinates at rest.

        Returns
        -------
        ndarray, shape (n,)
            Body after body, node after node (x fastest), vector after vector (r, r_x, r_y), three components each; m,
            and 1 for gradients. A rigid spin about the origin with the angular velocity w has the nodal velocities
            ``np.cross(w, model.nodal_coordinates().reshape(-1, 3)).ravel()``.
        """
        return self._assembled.reference()

    def evaluate(
        self,
        body: str,
        points: ArrayLike,
        quantity: Quantity,
        q: ArrayLike,
        v: ArrayLike | None = None,
    ) -> NDArray[np.float64]:
        """Return a quantity at material points for given nodal coordinates.

        Parameters
        ----------
        body : str
            Its name.
        points : array_like, shape (points, 2)
            Natural coordinates.
        quantity : str
            One of those of `Probe`.
        q : array_like, shape (states, n)
            Nodal coordinates.
        v : array_like, shape (states, n), optional
            Their velocities, needed for "velocity".

        Returns
        -------
        ndarray, shape (states, points, components)
            In the units of `Probe`.

        Raises
        ------
        InputError
            If there is no such body or quantity, a point is outside, or an array has another shape.
        """
        mistakes = Mistakes()
        with mistakes.gather():
            self._check_body(body)
        if quantity not in QUANTITIES:
            mistakes.add(("quantity",), one_of(QUANTITIES, quantity), quantity)
        if quantity == "velocity" and v is None:
            mistakes.add(("v",), "is needed for velocity")
        mistakes.check()
        places = numbers("points", points, "points", 2, finite=False)
        # States of a motion that went wrong may not be finite.
        states = numbers("q", q, "states", self._assembled.coordinates, finite=False)
        rates = None if v is None else numbers("v", v, *states.shape, finite=False)
        try:
            return self._assembled.evaluate(body, places, quantity, states, rates)
        except _core.InputError as error:
            raise InputError(Mistake(("points",), f"allowed is {error.allowed}", error.value)) from None

    def _check_body(self, body: str) -> None:
        if body not in self.bodies:
            raise InputError(Mistake(("body",), one_of(self.bodies, body), show(body)))


def _make(cls: type[_Item], values: dict[str, Any]) -> _Item:
    return cls(**values)


def _check_inside(core: _core.Model, body: str, at: tuple[float, float]) -> None:
    try:
        core.locate(body, np.array([at]))
    except _core.InputError as error:
        raise InputError(Mistake(("at",), f"allowed is {error.allowed}", show(at))) from None
