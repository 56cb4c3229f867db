"""The axes of a chart: which settings vary, and over which values."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from itertools import product
from math import inf
from typing import Any, TypeAlias

from ancf.errors import InputError, Mistake, one_of, show
from ancf.materials import Material
from ancf.places import is_number
from ancf.run import Dynamic, Modes, Static
from ancf.scene import Scene
from ancf.sweep import Variant
from ancf.sweep.variant import OF_BODIES

Axes: TypeAlias = Mapping[str, Sequence[Any]]

_SPACE: Axes = {
    "element": ("thin36", "thin48", "full48a"),
    "membrane": ("projected", "full", "lobatto"),
    "mesh": (0.125, 0.25, 0.5, 1.0),
}
_MOTION: Axes = {
    "method": ("hht", "tr_bdf2", "esdirk", "energy_momentum", "verlet", "rk"),
    "rtol": (1e-1, 1e-2, 1e-3),
}
_STATICS: Axes = {"mesh": (0.25, 0.5, 1.0, 2.0, 4.0), "newton": ("mip", "plain")}
_OUTPUTS = 5


def default_axes(scene: Scene) -> Axes:
    """Return the axes that suit a scene."""
    return {**_SPACE, **(_STATICS if isinstance(scene.run, Static) else _MOTION)}


def read_axes(texts: Sequence[str], scene: Scene) -> Axes:
    """Read axes as they are given on the command line.

    Parameters
    ----------
    texts : sequence of str
        Each a name, which takes its default values, or a name and its values: "mesh=0.5,1,2", "method=hht,esdirk".
    scene : Scene
        What is charted.

    Returns
    -------
    mapping of str to sequence
        Values of each axis.

    Raises
    ------
    InputError
        If there is no such setting, an axis has no values, or they are impossible.
    """
    defaults = default_axes(scene)
    axes: dict[str, Sequence[Any]] = {}
    for text in texts:
        name, given, values = text.partition("=")
        known = ("mesh", *OF_BODIES, *Material.model_fields, *type(scene.run).model_fields)
        if name not in known:
            raise InputError(Mistake(("axes", name), one_of(known, name)))
        if not given and name not in defaults:
            problem = f"give it values, as {name}=1,2; without values {one_of(defaults, name)}"
            raise InputError(Mistake(("axes", name), problem))
        axes[name] = read_values(name, values) if given else defaults[name]
        if name in ("mesh", "rtol") and not all(is_number(value) and 0 < value < inf for value in axes[name]):
            raise InputError(Mistake(("axes", name), "must be numbers greater than 0", show(values)))
    return axes


def read_values(name: str, text: str) -> list[Any]:
    """Read values with commas between them.

    Raises
    ------
    InputError
        If one is missing.
    """
    if not all(text.split(",")):
        raise InputError(Mistake((name,), "must be values with commas between them", show(text)))
    return [_value(part) for part in text.split(",")]


def _value(text: str) -> Any:
    try:
        return json.loads(text)
    except ValueError:
        return text


def grid(scene: Scene, axes: Axes) -> list[Variant]:
    """Return all combinations of values that have a meaning, each scene once, the cheapest first."""
    base = with_few_outputs(scene)
    found: dict[str, Variant] = {}
    for values in product(*axes.values()):
        settings = dict(zip(axes, values, strict=True))
        element, membrane = str(settings.get("element", "")), settings.get("membrane")
        if element.startswith("full48"):
            # A solid has no membrane to choose.
            settings.pop("membrane", None)
        elif membrane == "lobatto" and element == "thin48":
            continue
        variant = Variant.of(base, **settings)
        found.setdefault(variant.digest, variant)
    return sorted(found.values(), key=lambda variant: variant.effort)


def with_few_outputs(scene: Scene) -> Scene:
    """Return the scene with few outputs, where methods would otherwise be compared by their outputs."""
    run = scene.run
    if isinstance(run, Dynamic):
        outputs = [run.until * (index + 1) / _OUTPUTS for index in range(_OUTPUTS)]
        run = Dynamic(**{key: value for key, value in run if key not in ("outputs", "every")}, outputs=outputs)
    elif isinstance(run, Modes):
        raise InputError(Mistake(("run", "kind"), "must be static or dynamic: charts show probes", show("modes")))
    elif run.path == "arc":
        raise InputError(Mistake(("run", "path"), "charts compare states at equal load factors", show("arc")))
    return Scene(scene.title, scene.model, run, scene.material_names)
