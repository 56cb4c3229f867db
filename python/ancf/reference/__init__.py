"""The same mathematics in plain NumPy and SciPy, written to be read beside the paper.

The tests compare the compiled core with it. It is slow, takes one body, and needs the extra "reference".

The paper is K. Dufva and A. A. Shabana, Analysis of thin plate structures using the absolute nodal coordinate
formulation, Proc. IMechE Part K 219 (2005) 345-355.
"""

from .dynamics import Method, Motion, simulate
from .integrators import EnergyMomentum, GeneralizedAlpha, RungeKutta, Verlet
from .material import Material
from .mesh import RectangleMesh
from .model import Model
from .newton import NewtonError, NewtonOptions
from .statics import StaticResult, negative_eigenvalues, solve_static
from .surface import annulus, cylinder, plane, sphere

__all__ = [
    "EnergyMomentum",
    "GeneralizedAlpha",
    "Material",
    "Method",
    "Model",
    "Motion",
    "NewtonError",
    "NewtonOptions",
    "RectangleMesh",
    "RungeKutta",
    "StaticResult",
    "Verlet",
    "annulus",
    "cylinder",
    "negative_eigenvalues",
    "plane",
    "simulate",
    "solve_static",
    "sphere",
]
