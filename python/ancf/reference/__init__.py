"""The same mathematics in plain NumPy and SciPy, written to be read beside the paper.

The tests compare the compiled core with it. It is slow, takes one rectangular mesh, and needs the extra "reference".

The paper is K. Dufva and A. A. Shabana, Analysis of thin plate structures using the absolute nodal coordinate
formulation, Proc. IMechE Part K 219 (2005) 345-355.
"""

from .dynamics import GeneralizedAlpha, Motion, simulate
from .mesh import RectangleMesh
from .model import Model
from .newton import NewtonError, NewtonOptions
from .statics import StaticResult, negative_eigenvalues, solve_static
from .thin36 import Material, Thin36

__all__ = [
    "GeneralizedAlpha",
    "Material",
    "Model",
    "Motion",
    "NewtonError",
    "NewtonOptions",
    "RectangleMesh",
    "StaticResult",
    "Thin36",
    "negative_eigenvalues",
    "simulate",
    "solve_static",
]
