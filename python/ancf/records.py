"""Records over the states of a run."""

from __future__ import annotations

from dataclasses import dataclass, field

import numpy as np
from numpy.typing import NDArray

from ancf.supports import Support

FloatArray = NDArray[np.float64]


@dataclass(frozen=True, eq=False)
class Record:
    """What a probe recorded.

    Parameters
    ----------
    t : ndarray, shape (states,)
        Times, s, or load factors.
    value : ndarray, shape (states, components)
        In the unit of the quantity, see `Probe`.
    """

    t: FloatArray
    value: FloatArray


@dataclass(frozen=True, eq=False)
class Energy:
    """Energies.

    Parameters
    ----------
    t : ndarray, shape (states,)
        Times, s, or load factors.
    kinetic, membrane, bending : ndarray, shape (states,)
        J.
    loads : ndarray, shape (states,)
        The work that the loads and moved supports have done, J.
    dissipated : ndarray, shape (states,)
        What damping has taken, J. What the balance still misses is the work of the integrator.
    """

    t: FloatArray
    kinetic: FloatArray
    membrane: FloatArray
    bending: FloatArray
    loads: FloatArray
    dissipated: FloatArray


@dataclass(frozen=True, eq=False)
class Reaction:
    """What a support exerts on its body: a force at a point and a moment about it.

    They do the work that is done at the nodal coordinates which the support holds: the force in a translation, the
    moment in a rotation about the point. A coordinate that several supports hold belongs to the first of them. Inertia
    and damping count. Of rigid bodies (the method "rigid") with several supports the reactions are not determined: nan.

    Parameters
    ----------
    support : Support
        Which.
    t : ndarray, shape (states,)
        Times, s, or load factors.
    point : ndarray, shape (states, 3)
        The mean position of the nodes at the place of the support, m.
    force : ndarray, shape (states, 3)
        N.
    moment : ndarray, shape (states, 3)
        About the point, N m; about another one, p, it is ``moment + np.cross(point - p, force)``.
    """

    support: Support = field(repr=False)
    t: FloatArray
    point: FloatArray
    force: FloatArray
    moment: FloatArray
