"""The energy balance of a motion, and what is said when it does not hold."""

from __future__ import annotations

from typing import TYPE_CHECKING

import numpy as np

if TYPE_CHECKING:
    from ancf.records import Energy
    from ancf.run import Dynamic

_GAIN = 0.05
_LOSS = 0.2
"""Shares of the largest energy. Pendulums whose steps are short enough stay below 0.004 and 0.015."""

FROM_NOWHERE = "energy comes from nowhere"
"""How the warning of a gain begins."""


class EnergyWarning(RuntimeWarning):
    """The energy balance of a motion is off: its steps are too long, and it is not to be trusted."""


def balance_warnings(run: Dynamic, energy: Energy, moved: bool) -> tuple[str, ...]:
    """Say where the energy balance of a motion is off.

    Parameters
    ----------
    run : Dynamic
        How the motion was found.
    energy : Energy
        Its energies.
    moved : bool
        Whether supports are moved.

    Returns
    -------
    tuple of str
        A line for energy that comes from nowhere, or if none does for energy that the integrator takes; nothing about a
        motion whose balance holds. What an integrator takes under error control is within the tolerance, and not told.

    Notes
    -----
    No damping can make kinetic + strain energy - work of the loads grow. So a gain is told even where the dissipation,
    summed by the trapezoidal rule, is inaccurate, and from any earlier state on, so that losses do not hide it. States
    between steps are interpolated, and with them the strains: they do not count.
    """
    # Under error control steps end at the outputs.
    steps = energy.t / run.step if run.step is not None else np.zeros_like(energy.t)
    ends = (np.abs(steps - np.round(steps)) < 1e-6) | (energy.t == run.until)
    if not np.any(ends):
        return ()
    strain = energy.membrane + energy.bending
    t, *parts = (x[ends] for x in (energy.t, energy.kinetic, strain, energy.loads, energy.dissipated))
    kinetic, strain, loads, dissipated = parts
    largest = float(np.max(np.abs(parts)))
    with np.errstate(invalid="ignore"):
        mechanical = kinetic + strain - loads
        gain = mechanical - np.minimum.accumulate(mechanical)
        loss = np.maximum.accumulate(mechanical + dissipated) - (mechanical + dissipated)
    which = "the motion, or the work of the moved supports," if moved else "the motion"
    gained = (gain, _GAIN, f"{FROM_NOWHERE}: kinetic + membrane + bending - loads rises", "is wrong")
    taken = (loss, _LOSS, "the integrator takes energy: all of it - loads falls", "is damped more than the model says")
    cure = "a smaller step, error control (rtol)" if run.step is not None else "a smaller rtol"
    for amount, allowed, what, wrong in (gained, taken) if run.step is not None else (gained,):
        beyond = np.flatnonzero(amount > allowed * largest)
        if len(beyond):
            most = float(amount.max())
            return (
                f"{what} by {most:.3g} J, {most / largest:.0%} of the largest energy, beyond {allowed:.0%} at "
                f"t = {t[beyond[0]]:.6g} s; {which} {wrong} from there on. "
                f'Try: {cure} or method = "energy_momentum"',
            )
    return ()
