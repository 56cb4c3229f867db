"""Thin flexible bodies that move and bend far, in the absolute nodal coordinate formulation.

A plate of rubber hangs by one corner and falls from rest:

>>> import ancf
>>> rubber = ancf.Material(E=1e5, nu=0.3, density=7810.0)
>>> plate = ancf.Rectangle(size=(0.3, 0.3), divisions=(2, 2), thickness=0.01, material=rubber, membrane="full")
>>> model = ancf.Model(
...     bodies={"plate": plate},
...     supports=[ancf.Support(at="corner:x0y0", fix=["r"])],
...     loads=[ancf.Gravity(acceleration=(0.0, 0.0, -9.81))],
...     probes=[ancf.Probe(name="A", at=(0.3, 0.3))],
... )
>>> result = ancf.simulate(model, until=0.3, step=5e-3, outputs=[0.1, 0.2, 0.3])
>>> result.status
'ok'
>>> result.probes["A"].t
array([0. , 0.1, 0.2, 0.3])
>>> result.probes["A"].value[-1].round(1)
array([ 0.2,  0.2, -0.4])
>>> result.positions("plate", [(0.15, 0.15)]).shape
(4, 1, 3)

Units are SI. ``result.plot()`` draws it, ``result.animate("motion.gif")`` makes a film of it, `load_scene` reads the
same from a file, and ``ancf run scene.toml -o folder`` runs such a file.
"""

from ancf._core import __version__
from ancf.balance import EnergyWarning
from ancf.bodies import Annulus, Cylinder, Rectangle, Sphere
from ancf.courses import CourseWarning
from ancf.errors import InputError, Interrupted, Mistake, SolveError
from ancf.find_modes import modes
from ancf.loads import Force, Gravity, LineLoad, Moment, Pressure
from ancf.mapped import Surface
from ancf.materials import Material
from ancf.modal import ModalResult
from ancf.model import Model
from ancf.plan import Plan, plan
from ancf.probes import Probe
from ancf.records import Energy, Reaction, Record
from ancf.result import Result
from ancf.run import CheckpointWarning, Dynamic, Modes, PathWarning, Static
from ancf.scene import Scene, load_scene
from ancf.solve import simulate, solve_static
from ancf.supports import Rotation, Shake, Support

__all__ = [
    "Annulus",
    "CheckpointWarning",
    "CourseWarning",
    "Cylinder",
    "Dynamic",
    "Energy",
    "EnergyWarning",
    "Force",
    "Gravity",
    "InputError",
    "Interrupted",
    "LineLoad",
    "Material",
    "Mistake",
    "ModalResult",
    "Model",
    "Modes",
    "Moment",
    "PathWarning",
    "Plan",
    "Pressure",
    "Probe",
    "Reaction",
    "Record",
    "Rectangle",
    "Result",
    "Rotation",
    "Scene",
    "Shake",
    "SolveError",
    "Sphere",
    "Static",
    "Support",
    "Surface",
    "__version__",
    "load_scene",
    "modes",
    "plan",
    "simulate",
    "solve_static",
]
