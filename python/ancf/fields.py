"""Fields over time as files for ParaView and PyVista: a collection (.pvd) of unstructured grids (.vtu), one a state.

PyVista writes the grids, with the writer of VTK itself; it is an optional dependency, ``ancf[fields]``.
"""

from __future__ import annotations

import os
from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ancf.errors import InputError, Mistake, one_of, show
from ancf.inputs import whole
from ancf.modal import ModalResult
from ancf.model import Model
from ancf.output import replacing
from ancf.probes import QUANTITIES, Quantity
from ancf.result import Result
from ancf.run import Dynamic
from ancf.surface import Grid

if TYPE_CHECKING:
    import pyvista

FloatArray = NDArray[np.float64]

FIELDS: tuple[Quantity, ...] = (
    "displacement",
    "velocity",
    "normal",
    "membrane_force",
    "moment",
    "shear_force",
    "stress_top",
    "stress_middle",
    "stress_bottom",
    "von_mises_top",
    "von_mises_middle",
    "von_mises_bottom",
)
"""What is written unless quantities are chosen; velocity in motion only."""

_FACETS = 2500
_VALUES = 500_000
_INSTALL = 'needs PyVista, which is not installed: pip install "ancf[fields]"'


def write_fields(
    result: Result,
    path: str | os.PathLike[str],
    subdivisions: int | None = None,
    quantities: Sequence[Quantity] | None = None,
) -> None:
    """Write every state of a result, see `Result.write_fields`."""
    wanted = FIELDS if quantities is None else tuple(quantities)
    for index, quantity in enumerate(wanted):
        if quantity not in QUANTITIES:
            raise InputError(Mistake(("quantities", index), one_of(QUANTITIES, quantity), show(quantity)))
    if not isinstance(result.run, Dynamic):
        wanted = tuple(quantity for quantity in wanted if quantity != "velocity")
    surface = _Surface(result.model, subdivisions)

    def grids() -> Iterator[pyvista.UnstructuredGrid]:
        for states in surface.parts(len(result.t)):
            q, v = result.q[states], result.v[states]
            places = surface.values("position", q)
            values = {quantity: surface.values(quantity, q, v) for quantity in wanted}
            for index, place in enumerate(places):
                yield surface.grid(place, {quantity: value[index] for quantity, value in values.items()})

    _write(Path(path), result.t, grids())


def write_modes(result: ModalResult, path: str | os.PathLike[str], subdivisions: int | None = None) -> None:
    """Write every mode of a result, see `ModalResult.write_fields`."""
    surface = _Surface(result.model, subdivisions)
    state = result.q[None]
    (place,), (displacement,) = surface.values("position", state), surface.values("displacement", state)

    def grids() -> Iterator[pyvista.UnstructuredGrid]:
        for modes in surface.parts(len(result.frequency)):
            shapes = surface.values("position", result.shapes[modes])
            for frequency, shape in zip(result.frequency[modes], shapes, strict=True):
                grid = surface.grid(place, {"shape": shape, "displacement": displacement})
                grid.field_data["frequency"] = [frequency]
                yield grid

    _write(Path(path), np.arange(1.0, len(result.frequency) + 1), grids())


def check_fields(path: str | os.PathLike[str]) -> None:
    """Raise `InputError` unless fields can be written to such a file.

    Parameters
    ----------
    path : str or path
        The collection.
    """
    ending = Path(path).suffix
    if ending != ".pvd":
        raise InputError(Mistake((str(path),), f"must end in .pvd, not {show(ending)}"))
    try:
        import pyvista  # noqa: F401, PLC0415  Optional, and it takes longer to import than most scenes to run.
    except ImportError:
        raise InputError(Mistake((str(path),), _INSTALL)) from None


class _Surface:
    """The middle surfaces of all bodies as facets.

    Parameters
    ----------
    model : Model
        Whose.
    subdivisions : int, optional
        Facets along each side of an element.
    """

    def __init__(self, model: Model, subdivisions: int | None) -> None:
        if subdivisions is not None:
            whole("subdivisions", subdivisions, 1, 100)
        self._model = model
        self._grids = [
            Grid.of(model, body, _FACETS) if subdivisions is None else Grid.divided(model, body, subdivisions)
            for body in model.bodies
        ]
        facets, first = [], 0
        for grid in self._grids:
            columns, rows = grid.points.shape[:2]
            number = first + np.arange(columns * rows).reshape(columns, rows)
            corners = [number[:-1, :-1], number[1:, :-1], number[1:, 1:], number[:-1, 1:]]
            facets.append(np.stack(corners, axis=-1).reshape(-1, 4))
            first += columns * rows
        self._facets = np.concatenate(facets)
        self._bodies = np.repeat(np.arange(len(facets)), [len(part) for part in facets])
        self._points = np.concatenate([grid.points.reshape(-1, 2) for grid in self._grids])

    def parts(self, states: int) -> Iterator[slice]:
        """Cut states into parts whose values fit in the memory."""
        size = max(1, _VALUES // len(self._points))
        return (slice(first, first + size) for first in range(0, states, size))

    def values(self, quantity: Quantity, q: FloatArray, v: FloatArray | None = None) -> FloatArray:
        """Return a quantity at all points in states of shape (states, n): (states, points, components)."""
        parts = [self._model.evaluate(grid.body, grid.points.reshape(-1, 2), quantity, q, v) for grid in self._grids]
        return np.concatenate(parts, axis=1)

    def grid(self, places: FloatArray, fields: dict[str, FloatArray]) -> pyvista.UnstructuredGrid:
        """Return the surfaces with their points in the given places, and fields at them."""
        import pyvista  # noqa: PLC0415  As above.

        cells = np.insert(self._facets, 0, 4, axis=1).ravel()
        kinds = np.full(len(self._facets), pyvista.CellType.QUAD, dtype=np.uint8)
        grid = pyvista.UnstructuredGrid(cells, kinds, places)
        for name, values in fields.items():
            grid.point_data[name] = values[:, 0] if values.shape[1] == 1 else values
        grid.point_data["natural_coordinates"] = self._points
        grid.cell_data["body"] = self._bodies
        return grid


def _write(path: Path, times: FloatArray, grids: Iterable[pyvista.UnstructuredGrid]) -> None:
    """Write one grid for each time, and the collection that names them; what an earlier run left is replaced."""
    check_fields(path)
    folder = path.with_suffix("")
    folder.mkdir(exist_ok=True)
    numbered = [(folder / f"{index:05d}.vtu", time) for index, time in enumerate(times)]
    root = ElementTree.Element("VTKFile", type="Collection", version="1.0", byte_order="LittleEndian")
    collection = ElementTree.SubElement(root, "Collection")
    for file, time in numbered:
        attributes = {"timestep": repr(float(time)), "part": "0", "file": f"{folder.name}/{file.name}"}
        ElementTree.SubElement(collection, "DataSet", attributes)
    ElementTree.indent(root)
    with replacing(*(file for file, _ in numbered), path) as (*files, temporary):
        for file, grid in zip(files, grids, strict=True):
            grid.save(file)
        ElementTree.ElementTree(root).write(temporary, encoding="utf-8", xml_declaration=True)
    kept = {file for file, _ in numbered}
    for file in folder.glob("*.vtu"):
        if file not in kept:
            file.unlink()
