"""Materials."""

from __future__ import annotations

from typing import Annotated

from pydantic import Field

from ancf.inputs import Input, Positive


class Material(Input):
    """A linear elastic, isotropic material, with damping if wanted.

    Parameters
    ----------
    E : float
        Young's modulus, Pa, greater than 0, from 1e-30 to 1e30.
    nu : float
        Poisson's ratio, between -1 and 0.5, both excluded.
    density : float, optional
        kg/m3, not negative. Needed for motion and for gravity.
    mass_damping : float, default 0
        1/s, not negative: a force against the velocity, proportional to the mass.
    viscosity : float, default 0
        s, not negative: Kelvin-Voigt damping, a stress ``viscosity`` times that of the strain rate.

    Raises
    ------
    InputError
        If a value is impossible.

    Examples
    --------
    >>> steel = Material(E=2.07e11, nu=0.3, density=7810.0)
    """

    E: Positive
    nu: Annotated[float, Field(gt=-1, lt=0.5)]
    density: Annotated[float, Field(ge=0)] = 0.0
    mass_damping: Annotated[float, Field(ge=0)] = 0.0
    viscosity: Annotated[float, Field(ge=0)] = 0.0
