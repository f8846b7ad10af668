"""Strokes of one kind, the free energy from their work, and the crossing of the forward and reverse distributions."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, field
from typing import Annotated

import numpy as np

from idealgas.fields import OMITTED
from idealgas.statistics.estimates import Estimate, parts_of
from idealgas.theory.values import Theory

FEWEST_EFFECTIVE = 200.0
"""Smallest effective number of strokes (Σx)²/Σx², where x = exp(-W/T), for a reliable error of ⟨exp(-W/T)⟩.

At 200, the error for the outward strokes of the example is too small by a seventh.
"""

FEWEST_STROKES = 10
"""Smallest number of strokes in each direction for which the two distributions are compared."""

DIGITS = 9
"""Number of decimals to which positions and durations of strokes of the same kind must agree."""

Protocol = tuple[tuple[float, float], ...]
"""Durations (time) and velocities (length/time) of the successive pieces of the motion of a piston."""


@dataclass(frozen=True)
class WorkProcess:
    """Strokes of one kind: all begin in equilibrium with the heat bath and move the piston in the same way.

    Attributes:
        name: initial position, final position and duration, in words.
        ends: initial and final position of the piston, length.
        protocol: motion of the piston.
        work: (n,), energy that the piston gave to the gas in each stroke.
        start_energy: (n,), kinetic energy of all discs before each stroke.
        mean_work: mean work of a stroke, energy.
        free_energy: ΔF = -T ln⟨exp(-W/T)⟩, energy.
        kinetic_energy: mean of start_energy; in equilibrium it is NT, and its error follows from the variance NT².
    """

    name: str
    ends: tuple[float, float]
    protocol: Protocol
    work: np.ndarray
    start_energy: np.ndarray
    mean_work: Estimate
    free_energy: Estimate
    kinetic_energy: Estimate


@dataclass(frozen=True)
class Crossing:
    """Comparison of the distribution P_F of the work W with the distribution P_R of -W of the reverse strokes.

    Attributes:
        name: name of the process.
        free_energy: value at which the distributions cross, which equals ΔF by Crooks' theorem, energy.
        slope: T d ln(P_F/P_R)/dW, which is 1 by Crooks' theorem (no unit).
        forward: (n,), work of the strokes, energy.
        back: (m,), work of the reverse strokes, energy.
    """

    name: str
    free_energy: Estimate
    slope: Estimate
    forward: Annotated[np.ndarray, OMITTED] = field(default_factory=lambda: np.empty(0))
    back: Annotated[np.ndarray, OMITTED] = field(default_factory=lambda: np.empty(0))


def expectation_of(estimate: Estimate) -> Theory | None:
    """Return the theoretical value of an estimate and its error; None if there is none."""
    return None if estimate.theory is None else Theory(estimate.theory, estimate.theory_error, "")


def process(
    ends: tuple[float, float],
    protocol: Protocol,
    work: np.ndarray,
    energy: np.ndarray,
    temperature: float,
    number: int,
    difference: Theory | None,
) -> WorkProcess:
    """Return the results for strokes of one kind.

    Args:
        ends: initial and final position of the piston, length.
        protocol: motion of the piston.
        work: (n,), work of each stroke, energy.
        energy: (n,), kinetic energy of all discs before each stroke.
        temperature: temperature of the heat bath, energy.
        number: number of discs.
        difference: theoretical ΔF; None if it is not known.
    """
    least = float(work.min())
    weight = _independent(np.exp(-(work - least) / temperature))
    free, error = least - temperature * math.log(weight.value), temperature * weight.standard_error / weight.value
    return WorkProcess(
        f"from {ends[0]:g} to {ends[1]:g} in {sum(duration for duration, _ in protocol):g}",
        ends,
        protocol,
        work,
        energy,
        _independent(work),
        _estimate(free, error, len(work), difference),
        Estimate(float(energy.mean()), temperature * math.sqrt(number / len(work)), math.inf, number * temperature),
    )


def joined(same: Sequence[WorkProcess], temperature: float, number: int) -> WorkProcess:
    """Return the results for all strokes of one kind from several runs."""
    work, energy = (np.concatenate([getattr(run, name) for run in same]) for name in ("work", "start_energy"))
    first = same[0]
    return process(first.ends, first.protocol, work, energy, temperature, number, expectation_of(first.free_energy))


def poorly_sampled(process: WorkProcess, temperature: float) -> Iterator[str]:
    """Yield a caveat if a few strokes dominate the mean of exp(-W/T)."""
    weight = np.exp(-(process.work - process.work.min()) / temperature)
    if (effective := float(weight.sum() ** 2 / (weight**2).sum())) < FEWEST_EFFECTIVE:
        yield (
            f"The effective number of strokes in ⟨exp(−W/T)⟩ {process.name} is only {effective:.3g}; below "
            f"{FEWEST_EFFECTIVE:g} the standard error may be too small."
        )


def crossings(processes: Sequence[WorkProcess], temperature: float) -> tuple[Crossing, ...]:
    """Return the crossing for each process that is also made in reverse; each pair of processes appears once."""
    known = {(forward.ends, forward.protocol): forward for forward in processes}
    pairs = []
    for (ends, protocol), forward in list(known.items()):
        del known[ends, protocol]
        back = known.get((ends[::-1], tuple((duration, -velocity) for duration, velocity in protocol[::-1])))
        if back is not None and min(len(forward.work), len(back.work)) >= FEWEST_STROKES:
            pairs += [_crossing(forward, back, temperature)]
    return tuple(forward for forward in pairs if forward is not None)


def _crossing(forward: WorkProcess, back: WorkProcess, temperature: float) -> Crossing | None:
    """Return the crossing of two distributions from a logistic regression; None if they do not overlap.

    The parameters of ln(P_F/P_R) = a + bW/T maximise the likelihood that strokes with the measured works are forward or
    reverse strokes (Shirts et al., Phys. Rev. Lett. 91, 140601 (2003)). The errors are those of a regression in which
    the numbers of strokes in both directions are fixed.
    """
    works = np.concatenate((forward.work, -back.work)) / temperature
    n, m, middle = len(forward.work), len(back.work), works.mean()
    is_forward, columns = np.arange(n + m) < n, np.stack((np.ones(n + m), works - middle))
    coefficients = np.zeros(2)
    for _ in range(50):
        chance = 1 / (1 + np.exp(-np.clip(math.log(n / m) + coefficients @ columns, -500, 500)))
        information = (columns * (chance * (1 - chance))) @ columns.T
        if not np.linalg.det(information) > 1e-12:
            return None
        step = np.linalg.solve(information, columns @ (is_forward - chance))
        coefficients += step
        if np.abs(step).max() < 1e-10:
            break
    covariance = np.linalg.inv(information)
    covariance[0, 0] -= 1 / n + 1 / m
    a, b = coefficients.tolist()
    gradient = np.array([-1 / b, a / b**2])
    error = math.sqrt(max(float(gradient @ covariance @ gradient), 0.0))
    return Crossing(
        forward.name,
        _estimate((middle - a / b) * temperature, error * temperature, n + m, expectation_of(forward.free_energy)),
        _estimate(b, math.sqrt(covariance[1, 1]), n + m, Theory(1.0, 0.0, "")),
        forward.work,
        back.work,
    )


def _independent(values: np.ndarray) -> Estimate:
    """Return the mean of independent values with its standard error."""
    n = len(values)
    return _estimate(values.mean(), values.std(ddof=1) / math.sqrt(n) if n > 1 else math.nan, n, None)


def _estimate(value: float, error: float, samples: int, theory: Theory | None) -> Estimate:
    return Estimate(float(value), float(error), float(samples), *parts_of(theory))
