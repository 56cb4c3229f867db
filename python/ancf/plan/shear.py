"""What no thin element contains: shear through the thickness."""

from __future__ import annotations

import numpy as np

from ancf.model import Model

_POINTS = 9
"""Along a side, to measure it."""


def shear(model: Model) -> dict[str, float]:
    """Estimate what shear through the thickness adds to the deflection of each body, relative.

    Of a cantilever as long as the shorter side, bent by a force at its end: E h^2 / (4 k G L^2) with k = 5/6.

    Source: Timoshenko, Strength of Materials (1940), volume 1, section 39.

    Parameters
    ----------
    model : Model
        The bodies.

    Returns
    -------
    dict of str to float
        For each body.
    """
    q = model.nodal_coordinates()[None, :]
    added = {}
    for name, body in model.bodies.items():
        sides = []
        for axis, (low, high) in enumerate(domain := model.domain(name)):
            points = np.tile(np.mean(domain, axis=1), (_POINTS, 1))
            points[:, axis] = np.linspace(low, high, _POINTS)
            places = model.evaluate(name, points, "position", q)[0]
            sides.append(float(np.linalg.norm(np.diff(places, axis=0), axis=1).sum()))
        added[name] = 0.6 * (1.0 + body.material.nu) * (body.thickness / min(sides)) ** 2
    return added


def told(model: Model, tol: float) -> list[str]:
    """Return a sentence about it if it may matter beside the tolerance."""
    worst = max(shear(model).values())
    if worst <= tol / 2:
        return []
    return [
        "Errors are those of thin plates: shear through the thickness, which they leave out, "
        f"may add about {worst:.1g}. "
        "full48a and full48b have it, but converge to a limit that is too stiff, so that they are not on the ladder."
    ]
