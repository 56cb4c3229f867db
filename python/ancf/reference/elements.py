"""The element types by name."""

from typing import Literal, TypeAlias

from .arrays import FloatArray
from .element import Element
from .material import Material
from .shape import BICUBIC, QUARTIC
from .solid import Solid
from .thin import CurvatureKind, MembraneRule, Thin

ElementKind: TypeAlias = Literal["thin36", "thin48", "full48a", "full48b"]

NODAL_VECTORS: dict[ElementKind, tuple[str, ...]] = {
    "thin36": ("r", "r_x", "r_y"),
    "thin48": ("r", "r_x", "r_y", "r_xy"),
    "full48a": ("r", "r_x", "r_y", "r_z"),
    "full48b": ("r", "r_x", "r_y", "r_z"),
}


def make(
    kind: ElementKind,
    sides: tuple[float, float],
    reference: FloatArray,
    thickness: float,
    material: Material,
    *,
    membrane: MembraneRule,
    curvature: CurvatureKind,
) -> Element:
    """Make a block of elements; membrane and curvature are those of thin elements, a solid has none."""
    shape = BICUBIC if kind in ("thin48", "full48b") else QUARTIC
    if "r_z" in NODAL_VECTORS[kind]:
        return Solid(shape, *sides, reference, thickness, material)
    return Thin(shape, *sides, reference, thickness, material, membrane, curvature)
