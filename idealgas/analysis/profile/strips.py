"""All strips of a profile together: the slope of the temperature, and a test against theory."""

from dataclasses import dataclass

import numpy as np

from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.profile.theory import Expected
from idealgas.analysis.theory.values import Theory

FEWEST_FRAMES = 32
"""Smallest number of frames with a disc in a strip for an estimate of its temperature."""

LEAST_VISITS = 50.0
"""Expected number of discs in a strip, summed over all frames, below which it is left out: it hardly is normal."""


@dataclass(frozen=True)
class StripTest:
    """χ² test of all strips of a profile against theory.

    chi_squared: sum of the squares of normal deviates, one for each wave (no unit). waves: their number. p_value:
    probability of at least this sum by chance and the errors of theory.
    """

    chi_squared: float
    waves: int
    p_value: float


def strip_test(series: np.ndarray, weight: np.ndarray, error: np.ndarray) -> StripTest | None:
    """Test of a series (F, K) over K strips whose deviations from theory are 0 on the average; None with few discs.

    Strips of one gas fluctuate together, as discs are not lost and long waves die out slowly. So each wave across the
    gas is a number of its own, with the error of its own time series: waves w of increasing order in the part of the
    discs below a place, with Σ weight w w' = 0 for any two of them and for each with a constant. Instantaneous
    amplitudes of independent discs are then uncorrelated exactly, and their relaxation is nearly that of modes of the
    gas. Each amplitude over its error becomes a normal deviate by Student's distribution.

    Args:
        series: one for each frame and strip, with a mean of weight times a constant by theory, or of 0.
        weight: (K,), mean number of discs in a strip by theory.
        error: (K,), error of theory of the mean of the series; in each wave strips add up as badly as they can.
    """
    from scipy import special

    kept = weight * len(series) >= LEAST_VISITS
    series, weight, error = series[:, kept], weight[kept], error[kept]
    place = (np.cumsum(weight) - weight / 2) / weight.sum() if len(weight) else weight
    powers = np.cos(np.pi * np.outer(place, np.arange(len(place))))
    waves = np.linalg.qr(np.sqrt(weight)[:, None] * powers)[0] / np.sqrt(weight)[:, None]
    squares = []
    for wave in waves.T[1:]:
        found = mean(series @ wave, Theory(0.0, float(error @ np.abs(wave)), "theory"))
        if found.deviation is None:
            continue
        p_value = 2 * special.stdtr(max(found.independent_samples - 1, 1.0), -abs(found.deviation))
        squares.append(special.chdtri(1, max(p_value, 1e-300)))
    if not squares:
        return None
    return StripTest(float(sum(squares)), len(squares), float(special.chdtrc(len(squares), sum(squares))))


def gradient(
    counts: np.ndarray, energies: np.ndarray, middles: np.ndarray, expected: Expected | None, s: int
) -> Estimate | None:
    """Slope of the temperature from counts and energies (F, K) of the discs in strips; a slope is linear in all T.

    Theory may be too high at one end and too low at the other.
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
    return mean(lever @ temperature + influence @ lever, theory)
