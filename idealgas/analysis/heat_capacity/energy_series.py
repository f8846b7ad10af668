"""Energies of a gas at evenly spaced times, from the samples stored during its run; no events are needed.

Samples are stored at the starts of epochs, whose length depends on the speed of the discs at that time, and with
`log.snapshot_every` also at evenly spaced times, which are independent of the state of the gas.
"""

from dataclasses import dataclass

import numpy as np

from idealgas.analysis.core.ensemble import centre_of_mass_energy
from idealgas.analysis.core.equilibration import equilibrated_from, measure
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.physics.piston import piston_energy

FEWEST = 16
"""Smallest number of samples from which fluctuations can be measured."""


@dataclass(frozen=True)
class EnergySeries:
    """Energies of a gas at n sampled times after equilibration.

    kinetic: (n,), kinetic energy of translation of the discs. energy: (n,), energy of the discs by motion, spin and
    position, including that of a piston with a mass. Both are relative to the gas as a whole where nothing stops its
    motion. position: (n,), coordinate of the piston, length; None without one. start: time of the first sample.
    """

    kinetic: np.ndarray
    energy: np.ndarray
    position: np.ndarray | None
    start: float


def energy_series(log: Log, start: float | None = None, end: float | None = None) -> EnergySeries:
    """Sampled energies between two times, by default from detected equilibrium to the end of the log.

    Raises:
        UserError: if there are no samples, or too few in equilibrium.
    """
    scene, observed = log.scene, log.observables
    time = observed["kinetic_energy"][0]
    last = log.end_time if end is None else end
    if len(time) < 2 or not np.diff(time).max() > 0:
        raise UserError(f"{log.path}: no samples of the energy")
    if start is None and log.has_events:
        start = measure(log, [], None, end).start
    first_time = log.start_time if start is None else start
    if every := scene.log.snapshot_every:
        at = np.flatnonzero(np.isin(time, every * np.arange(last // every + 1)) & (time >= first_time) & (time <= last))
    else:
        step = np.diff(time).max()
        grid = np.arange(first_time, last + 1e-9 * step, step)
        at = np.unique(time.searchsorted(grid - 1e-9 * step))  # a sample at a point of the grid, but for rounding
        at = at[(at >= time.searchsorted(first_time)) & (at < time.searchsorted(last, "right"))]
    common = centre_of_mass_energy(log)
    kinetic, energy = (observed[name][1][at] - common for name in ("kinetic_energy", "energy"))
    position = None
    if scene.piston and scene.piston.mass:
        position, velocity = (observed[name][1][at] for name in ("piston_position", "piston_velocity"))
        pull = scene.piston.acceleration(scene.box.size, scene.properties.acceleration)
        energy = energy + piston_energy(scene.piston.mass, position, velocity, pull)
    first = 0
    if start is None:
        first = equilibrated_from(log, time[at], (kinetic, energy))
    if len(at) - first < FEWEST:
        raise UserError(f"{log.path}: {len(at) - first} samples of the energy in equilibrium are too few")
    tail = slice(first, None)
    return EnergySeries(
        kinetic[tail], energy[tail], None if position is None else position[tail], float(time[at[first]])
    )
