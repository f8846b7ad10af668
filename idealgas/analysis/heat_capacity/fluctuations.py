"""Heat capacity from the fluctuations of the energy, and its theoretical value.

The energy at any time follows from the events in a log. In addition, samples of the energy are stored at the start of
each epoch, whose duration depends on the speeds of the discs at that time. With `log.snapshot_every`, samples are also
stored at evenly spaced times, which are independent of the state of the gas.
"""

import math
from dataclasses import dataclass

import numpy as np

from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.physics.piston import piston_energy
from idealgas.statistics.autoregression import inefficiency
from idealgas.statistics.estimates import Estimate, estimate, mean
from idealgas.tallies.equilibration import equilibrated_from, measure
from idealgas.tallies.observables import Observable
from idealgas.theory import hard_discs, values
from idealgas.theory.conserved import centre_of_mass_energy, degrees_of_freedom
from idealgas.theory.values import Theory

FEWEST = 16
"""Smallest number of samples from which fluctuations are measured."""

LEAST_SAMPLES = 128
"""Smallest number of independent samples for a heat capacity from fluctuations; the error of a variance is then 13 %.

With fewer samples, a variance that is too small by chance also has an error that is too small. In synthetic series, the
rms deviation in units of the error is 1.46 with 32 samples, 1.24 with 64 and 1.11 with 100.
"""

LARGEST_ERROR = 0.5
"""Largest relative standard error of a heat capacity from fluctuations."""

FEW_IN_COLUMN = 0.47
"""N times the relative error of the theoretical heat capacity of N discs under gravity at fixed energy.

The theory assumes many discs. The error is the maximum over all heights of the box, from exact integration over the
states of 2 to 20 point particles.
"""

SOURCE = "degrees of freedom"
"""Name of the theory of the heat capacity."""


@dataclass(frozen=True)
class EnergySeries:
    """Energies of a gas at n times after equilibration.

    Along axes with conserved momentum, the motion of the gas as a whole is excluded from the energies.

    Attributes:
        kinetic: (n,), translational kinetic energy of the discs, energy.
        energy: (n,), translational, rotational and potential energy of the discs, plus the energy of a piston of finite
            mass, energy.
        position: (n,), coordinate of the piston, length; None without such a piston.
        start: first of these times.
    """

    kinetic: np.ndarray
    energy: np.ndarray
    position: np.ndarray | None
    start: float


def energy_series(log: Log, start: float | None = None, end: float | None = None) -> EnergySeries:
    """Return the energies between two times, by default from detected equilibrium to the end of the log.

    For a log with events, the energies at the edges of the time blocks in the window are used. For a log without
    events, or with a piston, stored samples are used.

    Raises:
        UserError: if there are no samples, or too few samples in equilibrium.
    """
    if log.has_events:
        window = measure(log, [], start, end)
        if not log.scene.piston:
            return _in_events(log, window.edges[window.first :])
        start = window.start
    return _in_samples(log, start, log.end_time if end is None else end)


def _in_events(log: Log, times: np.ndarray) -> EnergySeries:
    """Return the energies of the discs at given times (n,), from the events."""
    gas, kinetic, inner = log.discs, np.zeros(len(times)), np.zeros(len(times))
    for k, state in enumerate(log.frames(times)):
        kinetic[k] = gas.mass @ (state.velocity**2).sum(axis=1) / 2
        if any(log.gravity):
            inner[k] -= gas.mass @ (state.position @ np.array(log.gravity))
        if log.inertia is not None and state.angular_velocity is not None:
            inner[k] += log.inertia @ state.angular_velocity**2 / 2
    kinetic -= centre_of_mass_energy(log.scene, log.discs)
    return EnergySeries(kinetic, kinetic + inner, None, float(times[0]))


def _in_samples(log: Log, start: float | None, end: float) -> EnergySeries:
    """Return the energies from stored samples between two times, evenly spaced if possible."""
    scene, observed = log.scene, log.observables
    time = observed["kinetic_energy"][0]
    if len(time) < 2 or not np.diff(time).max() > 0:
        raise UserError(f"{log.path}: no samples of the energy")
    first_time = log.start_time if start is None else start
    if every := scene.log.snapshot_every:
        at = np.flatnonzero(np.isin(time, every * np.arange(end // every + 1)) & (time >= first_time) & (time <= end))
    else:
        step = np.diff(time).max()
        grid = np.arange(first_time, end + 1e-9 * step, step)
        at = np.unique(time.searchsorted(grid - 1e-9 * step))  # a sample may be off the grid by a rounding error
        at = at[(at >= time.searchsorted(first_time)) & (at < time.searchsorted(end, "right"))]
    common = centre_of_mass_energy(log.scene, log.discs)
    kinetic, energy = (observed[name][1][at] - common for name in ("kinetic_energy", "energy"))
    position = None
    if scene.piston and scene.piston[0].mass:
        (piston,) = scene.piston
        position, velocity = (observed[name][1][at, 0] for name in ("piston_position", "piston_velocity"))
        pull = piston.acceleration(scene.box.size, scene.properties.acceleration)
        energy = energy + piston_energy(piston.mass, position, velocity, pull)
    first = 0
    if start is None:
        first = equilibrated_from(log, time[at], (Observable(kinetic), Observable(energy)))
    if len(at) - first < FEWEST:
        few = "too few samples of the energy in equilibrium"
        raise UserError(
            f"{log.path}: {few} (got {len(at) - first}; {FEWEST} needed); store more with log.snapshot_every"
        )
    position = None if position is None else position[first:]
    return EnergySeries(kinetic[first:], energy[first:], position, float(time[at[first]]))


def bath_fluctuations(energy: np.ndarray, n: int, bath: float, other: float, capacity: Theory | None) -> Estimate:
    """Return the heat capacity per disc in a heat bath, Var(E)/(N T²), corrected for the variance of the mean.

    Args:
        energy: (n,), energies at successive times.
        n: number of discs N.
        bath: temperature of the bath, energy.
        other: contribution to C that is not due to discs: 3/2 for the position and motion of a piston, otherwise 0.
        capacity: theoretical heat capacity per disc; None without theory.
    """
    energy = energy - energy.mean()
    lost = mean(energy).standard_error ** 2
    return estimate(
        lambda e, square: ((square - e**2 + lost) / bath**2 - other) / n, energy, energy**2, theory=capacity
    )


def kinetic_fluctuations(kinetic: np.ndarray, n: int, dof: int, other: float, capacity: Theory | None) -> Estimate:
    """Return the heat capacity per disc from the variance of the kinetic energy K at fixed energy E, for finite N.

    All states of equal energy are equally probable. If the other terms of the energy contribute a constant heat
    capacity, K/E is therefore distributed as Beta(a, b), where a = D/2 and a + b = C, and r = a Var(K)/⟨K⟩² equals
    b/(a + b + 1). Source: Lebowitz, Percus & Verlet, Phys. Rev. 153, 250 (1967).

    Args:
        kinetic: (n,), kinetic energies at successive times.
        n: number of discs N.
        dof: number of degrees of freedom D of the translational motion of the discs.
        other: contribution to C that is not due to discs: 3/2 for the position and motion of a piston, otherwise 0.
        capacity: theoretical heat capacity per disc; None without theory.
    """
    a = dof / 2
    kinetic = kinetic / kinetic.mean() - 1
    lost = mean(kinetic).standard_error ** 2

    def per_disc(k: float, square: float) -> float:
        r = a * (square - k**2 + lost) / (1 + k) ** 2
        return (a + r * (a + 1) / (1 - r) - other) / n

    return estimate(per_disc, kinetic, kinetic**2, theory=capacity)


def too_few(capacity: Estimate, series: np.ndarray) -> str:
    """Return why fluctuations do not determine the heat capacity, as part of a sentence; empty if they do.

    Args:
        capacity: heat capacity from the fluctuations.
        series: (n,), fluctuating energies.
    """
    samples, error = len(series) / inefficiency(series), capacity.standard_error
    if samples < LEAST_SAMPLES:
        why = f"{samples:.0f} independent samples of the energy are too few ({LEAST_SAMPLES} needed)"
    elif 0 < error <= LARGEST_ERROR * capacity.value:
        return ""
    else:
        why = f"the error is too large ({capacity.value:.2g} ± {error:.2g})"
    return f"{why}; use a longer run or, without events, more frequent samples"


def expected_capacity(log: Log, series: EnergySeries) -> tuple[Theory | None, float | None]:
    """Return the theoretical C per disc and, with a piston, C_P - C_A per disc (k_B = 1); None without theory.

    Each degree of freedom contributes 1/2, and each conserved component of the momentum removes a degree of freedom.
    The position of a disc under gravity contributes 1 - x² eˣ/(eˣ - 1)², where x = m g h/T and h is the height that its
    centre can reach; for N discs at fixed energy, the relative error of this expression is of order 1/N. A piston
    contributes T (∂P/∂T)²/(-∂P/∂A) in total, which is Z²/(Z + φZ') per disc, where Z' = dZ/dφ.
    """
    scene, gas, part = log.scene, log.discs, 0.0
    motion = degrees_of_freedom(log.scene, log.discs) / (2 * len(gas))
    per_disc = motion + (0.5 if scene.properties.spins else 0.0)
    pull = np.array(log.gravity)
    mixture = len(gas.species_names) > 1 or bool(gas.unlike)
    if pull.any():
        if not (scene.properties.fixed_walls and scene.properties.empty) or pull.all() or mixture:
            return None, None
        axis = int(np.flatnonzero(pull)[0])
        temperature = float(series.kinetic.mean() / (len(gas) * motion))
        x = float(gas.mass[0] * abs(pull[axis]) * (gas.box[axis] - 2 * gas.radius[0]) / temperature)
        per_disc += 1 - x * x * math.exp(-x) / math.expm1(-x) ** 2
        part = FEW_IN_COLUMN / len(gas) if scene.properties.isolated else 0.0
        if part > values.LARGEST_ERROR:
            return None, None
    if series.position is None:
        return Theory(per_disc, part * per_disc, SOURCE), None
    if mixture or not scene.properties.interacting:
        return None, None
    (piston,) = scene.piston
    across = gas.box[1 - piston.axis]
    room = abs(series.position.mean() - (gas.box[piston.axis] - piston.stop(gas.box)))
    phi = gas.packing_fraction * gas.area / (room * across)
    if phi > hard_discs.HIGHEST:
        return None, None
    step = 1e-4 * phi
    z, above, below = (float(hard_discs.compressibility_factor(phi + shift)) for shift in (0.0, step, -step))
    excess = z * z / (z + phi * (above - below) / (2 * step))
    return Theory(per_disc + excess, 0.0, SOURCE), excess
