"""Strokes of one kind, the free energy by their work, and where the works forward and back cross."""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from idealgas.analysis.core.fields import OMITTED
from idealgas.analysis.core.statistics import Estimate, parts_of
from idealgas.analysis.theory.values import Theory

FEWEST_EFFECTIVE = 200.0
"""Effective number of strokes in ⟨exp(-W/T)⟩, (Σx)²/Σx², below which its error may be too small.

That of the strokes outwards of the example is by a seventh at 200.
"""

FEWEST_STROKES = 10
"""Least number of strokes in each direction for the ratio of their distributions."""

DIGITS = 9
"""Decimals in which two strokes of the same kind agree."""

Protocol = tuple[tuple[float, float], ...]
"""Velocities of a piston and for how long: (time, length/time)."""


@dataclass(frozen=True)
class Process:
    """Strokes of one kind: all begin in equilibrium with the heat bath and move the piston in the same way.

    name: from where to where, in which time. ends: positions of the piston, length. protocol: its motion. work: (n,),
    energy that the piston gave in each stroke. start_energy: (n,), kinetic energy of all discs before each. mean_work:
    of a stroke. free_energy: ΔF = -T ln⟨exp(-W/T)⟩. kinetic_energy: mean of start_energy; in equilibrium it is NT, with
    the variance NT² in its error. All are energies.
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
    """Distributions P_F of the work of strokes and P_R of minus the work of the same strokes back.

    name: of the process. free_energy: work at which they cross, by Crooks ΔF, energy. slope: T d ln(P_F/P_R)/dW (no
    unit), by Crooks 1. forward, back: the works of the strokes, energy.
    """

    name: str
    free_energy: Estimate
    slope: Estimate
    forward: Annotated[np.ndarray, OMITTED]
    back: Annotated[np.ndarray, OMITTED]


def expectation_of(found: Estimate) -> Theory | None:
    """Theory of an estimate; None without one."""
    return None if found.theory is None else Theory(found.theory, found.theory_error, "")


def process(
    ends: tuple[float, float],
    protocol: Protocol,
    work: np.ndarray,
    energy: np.ndarray,
    temperature: float,
    number: int,
    difference: Theory | None,
) -> Process:
    """Process of strokes with some work (n,) and energy before (n,), with ΔF by theory."""
    least = float(work.min())
    weight = _independent(np.exp(-(work - least) / temperature))
    free, error = least - temperature * math.log(weight.value), temperature * weight.standard_error / weight.value
    return Process(
        f"from {ends[0]:g} to {ends[1]:g} in {sum(duration for duration, _ in protocol):g}",
        ends,
        protocol,
        work,
        energy,
        _independent(work),
        _estimate(free, error, len(work), difference),
        Estimate(float(energy.mean()), temperature * math.sqrt(number / len(work)), math.inf, number * temperature),
    )


def joined(same: Sequence[Process], temperature: float, number: int) -> Process:
    """Strokes of one kind of several runs together."""
    work, energy = (np.concatenate([getattr(one, name) for one in same]) for name in ("work", "start_energy"))
    first = same[0]
    return process(first.ends, first.protocol, work, energy, temperature, number, expectation_of(first.free_energy))


def poorly_sampled(one: Process, temperature: float) -> Iterator[str]:
    """Sentence on a process in which few strokes decide the mean of exp(-W/T)."""
    weight = np.exp(-(one.work - one.work.min()) / temperature)
    if (effective := float(weight.sum() ** 2 / (weight**2).sum())) < FEWEST_EFFECTIVE:
        yield (
            f"⟨exp(−W/T)⟩ {one.name} is as good as that of {effective:.3g} strokes; below {FEWEST_EFFECTIVE:g} its "
            "error may be too small."
        )


def crossings(processes: Sequence[Process], temperature: float) -> tuple[Crossing, ...]:
    """Crossings of all processes that are also made backwards, each once."""
    known = {(one.ends, one.protocol): one for one in processes}
    found = []
    for (ends, protocol), one in list(known.items()):
        del known[ends, protocol]
        back = known.get((ends[::-1], tuple((duration, -velocity) for duration, velocity in protocol[::-1])))
        if back is not None and min(len(one.work), len(back.work)) >= FEWEST_STROKES:
            found += [_crossing(one, back, temperature)]
    return tuple(one for one in found if one is not None)


def _crossing(forward: Process, back: Process, temperature: float) -> Crossing | None:
    """Crossing of two distributions by logistic regression: Shirts et al., Phys. Rev. Lett. 91, 140601 (2003).

    ln(P_F/P_R) = a + bW/T has the largest likelihood of the works being forward or back. The errors are those of a
    regression whose numbers of strokes are given. None where the distributions do not overlap.
    """
    works = np.concatenate((forward.work, -back.work)) / temperature
    n, m, middle = len(forward.work), len(back.work), works.mean()
    is_forward, columns = np.arange(n + m) < n, np.stack((np.ones(n + m), works - middle))
    found = np.zeros(2)
    for _ in range(50):
        chance = 1 / (1 + np.exp(-np.clip(math.log(n / m) + found @ columns, -500, 500)))
        information = (columns * (chance * (1 - chance))) @ columns.T
        if not np.linalg.det(information) > 1e-12:
            return None
        step = np.linalg.solve(information, columns @ (is_forward - chance))
        found += step
        if np.abs(step).max() < 1e-10:
            break
    covariance = np.linalg.inv(information)
    covariance[0, 0] -= 1 / n + 1 / m
    a, b = found.tolist()
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
    """Mean of independent values."""
    n = len(values)
    return _estimate(values.mean(), values.std(ddof=1) / math.sqrt(n) if n > 1 else math.nan, n, None)


def _estimate(value: float, error: float, samples: int, theory: Theory | None) -> Estimate:
    return Estimate(float(value), float(error), float(samples), *parts_of(theory))
