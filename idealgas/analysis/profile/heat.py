"""Energy that walls give to the discs, and heat that flows from one thermal side to the other."""

import math

import numpy as np

from idealgas.analysis.profile.theory import conduction
from idealgas.columns import sides_across
from idealgas.log import Log
from idealgas.physics.collision_rates import contact_value
from idealgas.statistics.estimates import Estimate, ratio
from idealgas.tallies.equilibration import Window
from idealgas.theory import enskog, hard_discs
from idealgas.theory.values import Theory

SHEARED_SIDES = "bottom and top"
"""Name of the two sheared sides together; only the sum of their energies is meaningful."""


def heat_of_walls(log: Log, window: Window) -> dict[str, Estimate]:
    """Return the energy per time that each wall gave to the discs, by the name of the wall, from the logged samples.

    The two sheared sides form one entry, because a disc that crosses them receives energy from both, and how this
    energy is divided between them is a convention.
    """
    steps, gains = _gains(log, window)
    heat = {wall.name: gains[:, k] for k, wall in enumerate(log.walls[: gains.shape[1]]) if gains[:, k].any()}
    if log.scene.properties.shear and (sides := {"bottom", "top"} & heat.keys()):
        heat[SHEARED_SIDES] = np.sum([heat.pop(name) for name in sides], axis=0)
    return {name: ratio(gain, steps) for name, gain in heat.items()}


def heat_flow(log: Log, axis: int, window: Window) -> Estimate | None:
    """Return the heat per time that flows from the lower to the upper of the two thermal sides across an axis.

    It is the mean of the heat that one side gives and the heat that the other side takes, and it is compared with
    Fourier's law with Enskog's conductivity. The result is None unless the two sides have different temperatures.
    """
    sides = sides_across(axis)
    temperatures = [log.scene.properties.emits[side] for side in sides]
    steps, gains = _gains(log, window)
    if None in temperatures or temperatures[0] == temperatures[1] or not gains.size:
        return None
    low, high = (gains[:, side] for side in sides)
    return ratio((low - high) / 2, steps, _fourier(log, axis))


def _fourier(log: Log, axis: int) -> Theory | None:
    """Return the heat per time according to Fourier's law; None if theory is not available.

    The conductivity is proportional to √T, so that T^(3/2) is linear in position.
    """
    gas, ends = log.discs, conduction(log, axis)
    if ends is None or gas.packing_fraction > hard_discs.HIGHEST:
        return None
    phi = gas.packing_fraction
    state = 2 * float(gas.radius[0]), len(gas) / gas.area, 1.0, float(gas.mass[0]), float(contact_value(phi))
    fall = ends.low**1.5 - ends.high**1.5
    flow = enskog.conductivity(*state) * fall * 2 / 3 / log.box[axis] * log.box[1 - axis]
    of_jumps = 1.5 * ends.error * (math.sqrt(ends.low) + math.sqrt(ends.high)) / abs(fall)
    return Theory(flow, abs(flow) * math.hypot(enskog.relative_error("conductivity", phi), of_jumps), "Fourier's law")


def _gains(log: Log, window: Window) -> tuple[np.ndarray, np.ndarray]:
    """Return the time steps (n,) between samples in the window, and the energy (n, walls) that walls gave in each."""
    if "wall_energy" not in log.observables:
        return np.empty(0), np.empty((0, 0))
    time, given = log.observables["wall_energy"]
    inside = (time >= window.start) & (time <= window.end)
    steps, gains = np.diff(time[inside]), np.diff(given[inside], axis=0)
    return steps[steps > 0], gains[steps > 0]
