"""Fields over time as files for ParaView and PyVista: a collection (.pvd) of unstructured grids (.vtu), one a state.

PyVista writes the grids, with the writer of VTK itself; it is an optional dependency, ``ancf[fields]``.
"""

from __future__ import annotations

import os
from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Any
from xml.etree import ElementTree

import numpy as np
from numpy.typing import NDArray

from ancf.errors import InputError, Mistake, one_of, show
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

_FACETS = 10_000
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

    def grid(state: int) -> pyvista.UnstructuredGrid:
        q, v = result.q[state], result.v[state]
        return surface.grid(q, {quantity: surface.values(quantity, q, v) for quantity in wanted})

    _write(Path(path), result.t, grid)


def write_modes(result: ModalResult, path: str | os.PathLike[str], subdivisions: int | None = None) -> None:
    """Write every mode of a result, see `ModalResult.write_fields`."""
    surface = _Surface(result.model, subdivisions)
    displacement = surface.values("displacement", result.q)
    normal = surface.values("normal", result.q)

    def grid(mode: int) -> pyvista.UnstructuredGrid:
        shape = surface.values("position", result.shapes[mode])
        made = surface.grid(result.q, {"shape": shape, "displacement": displacement, "normal": normal})
        made.field_data["frequency"] = result.frequency[[mode]]
        return made

    _write(Path(path), np.arange(1, len(result.frequency) + 1), grid)


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
        if subdivisions is not None and (not isinstance(subdivisions, int) or not 1 <= subdivisions <= 100):
            raise InputError(Mistake(("subdivisions",), "must be a whole number from 1 to 100", show(subdivisions)))
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

    def values(self, quantity: Quantity, q: FloatArray, v: FloatArray | None = None) -> FloatArray:
        """Return a quantity at all points: (points, components), or (points,) where it has one."""
        velocity = None if v is None else v[None]
        parts = [
            self._model.evaluate(grid.body, grid.points.reshape(-1, 2), quantity, q[None], velocity)[0]
            for grid in self._grids
        ]
        values = np.concatenate(parts)
        return values[:, 0] if values.shape[1] == 1 else values

    def grid(self, q: FloatArray, fields: dict[str, FloatArray]) -> pyvista.UnstructuredGrid:
        """Return the surfaces in a state, with fields at their points."""
        import pyvista  # noqa: PLC0415  As above.

        cells = np.insert(self._facets, 0, 4, axis=1).ravel()
        kinds = np.full(len(self._facets), pyvista.CellType.QUAD, dtype=np.uint8)
        grid = pyvista.UnstructuredGrid(cells, kinds, self.values("position", q))
        for name, values in fields.items():
            grid.point_data[name] = values
        grid.point_data["natural_coordinates"] = self._points
        grid.cell_data["body"] = self._bodies
        return grid


def _write(path: Path, times: Iterable[float], grid: Callable[[int], Any]) -> None:
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
        for index, file in enumerate(files):
            grid(index).save(file)
        ElementTree.ElementTree(root).write(temporary, encoding="utf-8", xml_declaration=True)
    kept = {file for file, _ in numbered}
    for file in folder.glob("*.vtu"):
        if file not in kept:
            file.unlink()
