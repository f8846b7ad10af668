"""The equation of state Z(φ) from many pressures, beside its theories, and the virial coefficients in it."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from idealgas.analysis.core.statistics import Estimate, agree, mean_of_replicates
from idealgas.analysis.pressure.measure import PAIRS, Pressure
from idealgas.analysis.theory import hard_discs
from idealgas.errors import UserError

FITTED = 0.25
"""Packing fraction up to which virial coefficients are fitted."""

FREE_TERMS = 3
"""Coefficients from B2 on that are fitted; those of the terms that follow are kept at their known values."""


@dataclass(frozen=True)
class Sample:
    """Z of one run. theory: at its N, in its box."""

    packing_fraction: float
    number: int
    compressibility: Estimate


@dataclass(frozen=True)
class State:
    """A packing fraction: Z of all its runs, whose theory is that at their N, and of endless gases.

    infinite: Z less what theory says the finite N and box make; theory: the series, resummed. virial: to B10.
    """

    packing_fraction: float
    number: int
    runs: int
    compressibility: Estimate
    infinite: Estimate
    virial: float
    henderson: float

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "packing_fraction": self.packing_fraction,
            "number": self.number,
            "runs": self.runs,
            "compressibility": self.compressibility.as_dict(),
            "infinite": self.infinite.as_dict(),
            "virial_series_to_B10": self.virial,
            "henderson": self.henderson,
        }


@dataclass(frozen=True)
class EquationOfState:
    """States in order of φ. b2: in units of the discs' area, theory 2; b3: over b2²; None with too few states."""

    states: tuple[State, ...]
    b2: Estimate | None
    b3: Estimate | None

    def check(self) -> bool:
        """Whether Z agrees with theory at every φ. UserError if that cannot be said."""
        return agree(state.infinite for state in self.states)

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {
            "states": [state.as_dict() for state in self.states],
            "B2": self.b2.as_dict() if self.b2 else None,
            "B3": self.b3.as_dict() if self.b3 else None,
        }


def sample_of(measured: Pressure) -> Sample:
    """Z of a run by the virial of its pairs."""
    pairs = next(route.compressibility for route in measured.routes if route.name == PAIRS)
    return Sample(measured.packing_fraction, measured.number, pairs)


def equation_of_state(samples: Sequence[Sample]) -> EquationOfState:
    """Put runs of the same N and φ together. UserError where theory knows no Z of a run."""
    together: dict[tuple[float, int], list[Sample]] = {}
    for sample in samples:
        if sample.compressibility.theory is None:
            raise UserError(
                f"no equation of state: no theory for a gas of packing fraction {sample.packing_fraction:g}"
            )
        together.setdefault((round(sample.packing_fraction, 9), sample.number), []).append(sample)
    states = tuple(_state(runs) for _, runs in sorted(together.items()))
    b2, b3 = _virial_coefficients(states)
    return EquationOfState(states, b2, b3)


def _state(runs: Sequence[Sample]) -> State:
    phi, n = float(np.mean([run.packing_fraction for run in runs])), len(runs)
    together = mean_of_replicates([run.compressibility for run in runs])
    expected = together.theory or math.nan
    endless = float(hard_discs.compressibility(phi))
    part = endless / expected
    return State(
        phi,
        runs[0].number,
        n,
        together,
        infinite=Estimate(together.value * part, together.standard_error * part, together.independent_samples, endless),
        virial=float(hard_discs.virial_series(phi)),
        henderson=float(hard_discs.henderson_compressibility(phi)),
    )


def _virial_coefficients(states: Sequence[State]) -> tuple[Estimate | None, Estimate | None]:
    """B2 and B3 by weighted least squares to (Z - 1)/2φ = Σ b_k (2φ)^(k - 2), whose later terms are known."""
    used = [s for s in states if 0 < s.packing_fraction <= FITTED and s.infinite.standard_error > 0]
    if len(used) <= FREE_TERMS:
        return None, None
    density = np.array([2 * s.packing_fraction for s in used])
    known = np.array(hard_discs.VIRIAL[1 + FREE_TERMS :])
    powers = np.vander(density, len(hard_discs.VIRIAL) - 1, increasing=True)
    y = np.array([s.infinite.value - 1 for s in used]) / density - powers[:, FREE_TERMS:] @ known
    error = np.array([s.infinite.standard_error for s in used]) / density
    design = powers[:, :FREE_TERMS] / error[:, None]
    covariance = np.linalg.inv(design.T @ design)
    b = covariance @ design.T @ (y / error)
    samples = float(sum(s.infinite.independent_samples for s in used))
    b2 = Estimate(float(2 * b[0]), float(2 * np.sqrt(covariance[0, 0])), samples, theory=2.0)
    ratio = b[1] / b[0] ** 2
    slope = np.array([-2 * b[1] / b[0] ** 3, 1 / b[0] ** 2])
    b3_error = float(np.sqrt(slope @ covariance[:2, :2] @ slope))
    return b2, Estimate(float(ratio), b3_error, samples, theory=hard_discs.VIRIAL[2])
