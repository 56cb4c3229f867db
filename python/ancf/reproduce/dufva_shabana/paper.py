"""What the paper says: its two examples, and the figures that it prints."""

from __future__ import annotations

from dataclasses import dataclass

from ancf.bodies import Rectangle
from ancf.loads import Gravity, LineLoad
from ancf.materials import Material
from ancf.model import Model
from ancf.probes import Probe
from ancf.run import Dynamic, Static
from ancf.scene import Scene
from ancf.supports import Support

MESHES = (1, 2, 4, 8, 16)
"""Elements along the cantilever, Fig. 3."""
PENDULUM_MESHES = (1, 2, 4, 8)
"""Elements along each side of the pendulum, Table 1."""
THICKNESSES = (0.01, 0.001, 0.0005)
"""m, Table 2."""


@dataclass(frozen=True)
class Seconds:
    """What the paper prints of a row of its tables.

    Parameters
    ----------
    thin, solid : float
        Simulation times of Model I and Model II, s.
    ratio : float
        Of the two, as printed.
    """

    thin: float
    solid: float
    ratio: float


TABLE_1 = {1: Seconds(2, 8, 4.0), 2: Seconds(7, 42, 6.0), 4: Seconds(133, 885, 6.6), 8: Seconds(8340, 43700, 5.2)}
TABLE_2 = {0.01: Seconds(7, 42, 6.0), 0.001: Seconds(8, 470, 58.8), 0.0005: Seconds(8, 1130, 141.3)}


def cantilever() -> Scene:
    """Return the steel plate of Fig. 3, one element."""
    steel = Material(E=2.07e11, nu=0.3, density=7810.0)
    model = Model(
        bodies={
            "plate": Rectangle(size=(0.5, 0.15), divisions=(1, 1), thickness=1e-3, material=steel, membrane="full")
        },
        supports=[Support(at="edge:x0", clamp=True)],
        loads=[LineLoad(at="edge:x1", per_length=(0.0, 0.0, -30.0 / 0.15))],
        probes=[Probe(name="corner", at=(0.5, 0.15), quantity="displacement")],
    )
    # A single giant step of an element that locks lands on another equilibrium.
    return Scene("Cantilever", model, Static(load_factors=[(index + 1) / 10 for index in range(10)]))


def pendulum() -> Scene:
    """Return the rubber plate of Tables 1 and 2 and Fig. 4 to 6, one element, by what is MATLAB's ode23tb.

    The tolerance is MATLAB's default for the relative one.
    """
    rubber = Material(E=1e5, nu=0.3, density=7810.0)
    model = Model(
        bodies={
            "plate": Rectangle(size=(0.3, 0.3), divisions=(1, 1), thickness=0.01, material=rubber, membrane="full")
        },
        supports=[Support(at="corner:x0y0", fix=["r"])],
        loads=[Gravity(acceleration=(0.0, 0.0, -9.81))],
        probes=[Probe(name="A", at=(0.3, 0.3)), Probe(name="B", at=(0.15, 0.15))],
    )
    run = Dynamic(until=0.3, method="tr_bdf2", rtol=1e-3, outputs=[0.1, 0.2, 0.3])
    return Scene("Pendulum", model, run)
