"""Equipartition as a test of equilibrium: a gas that comes to it slowly looks steady while it is still far from it."""

import math

import numpy as np
from scipy import special

from idealgas.analysis.core.composition import composition
from idealgas.analysis.core.equilibrium import known_ensemble
from idealgas.analysis.core.statistics import mean
from idealgas.analysis.core.steadiness import ROUNDING
from idealgas.analysis.theory.conserved import is_ergodic
from idealgas.log import Log

UNLIKELY = 1e-5
"""Probability with which chance gives a gas in equilibrium a temperature that is taken not to be its own."""

FAR = 2.0
"""Standard deviations of a temperature from instant to instant that its average over time hardly ever differs by.

Error bars of a gas whose energy is exchanged more slowly than the log is long tell nothing.
"""


def why_not_shared(log: Log, energies: np.ndarray) -> str:
    """Why the energy of a gas is not shared as in equilibrium, as part of a sentence; empty if it may be.

    energies: (B, S, 2), sums of m vx² and of m vy² over the discs of each species in blocks of time, energy; or
    (B, 1, 2), over all discs. Velocities are relative to the gas as a whole where nothing stops that.
    """
    ensemble, gas = known_ensemble(log), composition(log.discs)
    if ensemble is None or not is_ergodic(log.scene, log.discs):
        return ""
    if len(log.discs) == 1 and ensemble.dof < math.inf:  # it has no other to share with
        return ""
    number = gas.number[:, None]
    expected, names = number * ensemble.of_axes, [f" of {name}" for name in gas.name]
    if energies.shape[1] == 1:
        expected, number, names = expected.sum(axis=0, keepdims=True), number.sum(keepdims=True), [""]
    for s, name in enumerate(names):
        for axis, letter in enumerate("xy"):
            theory = float(expected[s, axis] / number[s, 0])
            found = mean(energies[:, s, axis] / number[s], theory)
            dof, deviation = max(found.independent_samples - 1, 1.0), abs(found.deviation or 0.0)
            far = FAR * theory * math.sqrt(2.0 / number[s, 0]) + ROUNDING * ensemble.temperature
            if abs(found.value - theory) > far or special.stdtr(dof, -deviation) < UNLIKELY / 2:
                return f"m v{letter}²{name} is {found.value:.4g} on average, and {theory:.4g} in equilibrium"
    return ""
