"""Sums over the discs in each strip, the slope of the temperature, and a test of all strips against theory."""

from dataclasses import dataclass

import numpy as np

from idealgas.analysis.profile.theory import Expected
from idealgas.log import Log
from idealgas.physics.shear import flow_at
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.stream import ReadProgress, frames
from idealgas.theory.conserved import centre_of_mass_velocity
from idealgas.theory.values import Theory

FEWEST_FRAMES = 32
"""Smallest number of frames in which a strip must contain a disc for its temperature to be estimated."""

LEAST_VISITS = 50.0
"""Smallest expected number of discs in a strip, summed over all frames, that is nearly normally distributed."""


@dataclass(frozen=True)
class StripTest:
    """χ² test of all strips of a profile against theory.

    Attributes:
        chi_squared: sum of the squares of the normal deviates of the waves (no unit).
        waves: number of waves.
        p_value: probability that chance alone gives at least this sum, given the errors of the theory.
    """

    chi_squared: float
    waves: int
    p_value: float


def collect(
    log: Log, axis: int, flow: int | None, times: np.ndarray, edges: np.ndarray, progress: ReadProgress | None
) -> tuple[np.ndarray, np.ndarray, np.ndarray]:
    """Return sums over the discs in each strip at F times.

    The velocity v is relative to the mean flow in the strip if gravity drives a flow and, between sheared sides, to the
    shear flow; u is the velocity along the axis `flow`.

    Returns:
        sums: (F, S, K, 5), sums of 1, m v²/2, I ω², m u and m over the discs of each species in each strip.
        carried: (F, K, 3), sums of m vx², m vy² and m vx vy over the discs in each strip.
        stored: (F, K), total momentum, perpendicular to the axis, of the discs below a line, averaged over all lines in
            a strip.
    """
    gas, frame = log.discs, centre_of_mass_velocity(log.scene, log.discs)
    shape = (len(gas.species_names), len(edges) - 1)
    sums, carried = np.zeros((len(times), *shape, 5)), np.zeros((len(times), shape[1], 5))
    stored = np.zeros((len(times), shape[1]))
    rate, height = log.scene.properties.shear, log.box[1]
    inertia = np.zeros(len(gas)) if log.inertia is None else log.inertia
    for k, state in enumerate(frames(log, times, progress)):
        place = state.position[:, axis]
        within = (place - edges[0]) / (edges[1] - edges[0])
        strip = np.clip(within.astype(np.int64), 0, shape[1] - 1)
        cell = gas.species.astype(np.int64) * shape[1] + strip
        spin = state.angular_velocity if state.angular_velocity is not None else np.zeros(len(gas))
        velocity = state.velocity - frame
        velocity[:, 0] -= flow_at(state.position[:, 1] - frame[1] * state.time, rate, height)
        energy = gas.mass * (velocity**2).sum(axis=1) / 2
        momentum = gas.mass * (0.0 if flow is None else state.velocity[:, flow])
        for c, value in enumerate((np.ones(len(gas)), energy, inertia * spin**2, momentum, gas.mass)):
            sums[k, ..., c] = np.bincount(cell, value, shape[0] * shape[1]).reshape(shape)
        px, py = gas.mass * velocity.T
        vx, vy = velocity.T
        for c, value in enumerate((px * vx, py * vy, px * vy, px, py)):
            carried[k, :, c] = np.bincount(strip, value, shape[1])
        across = gas.mass * velocity[:, 1 - axis]
        lower = np.bincount(strip, across, shape[1])
        stored[k] = np.cumsum(lower) - lower + np.bincount(strip, across * (strip + 1 - within), shape[1])
    momentum, mass = sums[..., 3], sums[..., 4]
    mean_velocity = momentum.sum(axis=0) / np.maximum(mass.sum(axis=0), np.finfo(float).tiny)
    sums[..., 1] -= mean_velocity * momentum - mean_velocity**2 * mass / 2
    if flow is not None:
        whole, u = mass.sum(axis=1), momentum.sum(axis=(0, 1)) / np.maximum(mass.sum(axis=(0, 1)), np.finfo(float).tiny)
        carried[..., flow] -= 2 * u * carried[..., 3 + flow] - u**2 * whole
        carried[..., 2] -= u * carried[..., 4 - flow]
    return sums, carried[..., :3], stored


def strip_test(series: np.ndarray, weight: np.ndarray, error: np.ndarray, memory: float = 0.0) -> StripTest | None:
    """Test whether a series (F, K) over K strips agrees with theory; return None if there are too few discs.

    The strips of one gas fluctuate together, because the number of discs is conserved and long waves decay slowly. The
    test therefore uses waves across the gas, each with the standard error of its own time series. The waves w are
    cosines of increasing order, as functions of the fraction of the discs below a position, which are made orthogonal
    to each other and to a constant: Σ weight w w' = 0. For independent discs the amplitudes at one instant are then
    exactly uncorrelated, and they relax nearly like modes of the gas. Student's distribution converts the ratio of each
    amplitude to its standard error into a normal deviate.

    Args:
        series: values in each frame and strip; according to theory their mean is the weight times a constant, or 0.
        weight: (K,), theoretical mean number of discs in each strip.
        error: (K,), error of the theoretical mean of the series; in each wave the errors of all strips are assumed to
            add up.
        memory: number of frames per independent frame, if it is known; otherwise 0.
    """
    from scipy import special

    kept = weight * len(series) >= LEAST_VISITS
    series, weight, error = series[:, kept], weight[kept], error[kept]
    place = (np.cumsum(weight) - weight / 2) / weight.sum() if len(weight) else weight
    powers = np.cos(np.pi * np.outer(place, np.arange(len(place))))
    waves = np.linalg.qr(np.sqrt(weight)[:, None] * powers)[0] / np.sqrt(weight)[:, None]
    squares = []
    for wave in waves.T[1:]:
        amplitude = mean(series @ wave, Theory(0.0, float(error @ np.abs(wave)), "theory"), memory)
        if amplitude.deviation is None:
            continue
        p_value = 2 * special.stdtr(max(amplitude.independent_samples - 1, 1.0), -abs(amplitude.deviation))
        squares.append(special.chdtri(1, max(p_value, 1e-300)))
    if not squares:
        return None
    return StripTest(float(sum(squares)), len(squares), float(special.chdtrc(len(squares), sum(squares))))


def gradient(
    counts: np.ndarray, energies: np.ndarray, middles: np.ndarray, expected: Expected | None, s: int, memory: float
) -> Estimate | None:
    """Return the slope of the temperature, given the counts and energies (F, K) of the discs in strips.

    The slope is a linear function of the temperatures. The error of its theoretical value assumes that theory is too
    high at one end and too low at the other. memory: number of frames per independent frame.
    """
    known = np.count_nonzero(counts, axis=0) >= FEWEST_FRAMES
    if np.count_nonzero(known) < 2:
        return None
    counts, energies, place = counts[:, known], energies[:, known], middles[known]
    weight = counts.mean(axis=0)
    away = place - np.average(place, weights=weight)
    lever = weight * away / (weight @ away**2)
    temperature = energies.mean(axis=0) / weight
    influence = (energies - temperature * counts) / weight
    theory = None
    if expected is not None:
        along = expected.share[s] * expected.temperature[s, known]
        slope = float(lever @ along) if np.ptp(along) > 0 else 0.0
        theory = Theory(slope, 2 * expected.error / float(np.ptp(place)), expected.law)
    return mean(lever @ temperature + influence @ lever, theory, memory)
