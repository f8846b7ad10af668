"""Runs of the shipped scenes held against theory."""

from typing import Any

import h5py
import numpy as np
from scipy import stats
from tools.calibration_estimates import estimates, of

from idealgas import Log
from idealgas.statistics.estimates import Estimate

STANDARD_ERRORS = 4
LEAST_P = 0.001


def agrees(result: Estimate, resolution: float) -> None:
    """Within STANDARD_ERRORS of theory, with an error below `resolution` times it."""
    assert result.standard_error < resolution * abs(result.theory)
    assert abs(result.deviation) < STANDARD_ERRORS, result


def all_agree(log: Log, resolution: float, analysis: str, *quantities: str, **options: Any) -> None:
    """Estimates of an analysis agree with theory. quantities: patterns of their names in CSV, without the analysis."""
    rows = list(estimates(log, of(analysis, *quantities, **options)))
    assert rows
    for name, estimate, _ in rows:
        print(name, estimate)
        agrees(estimate, resolution)


def of_runs(values, expected) -> Estimate:
    """Mean of independent runs, with the error that their spread gives."""
    values = np.array(values)
    return Estimate(float(values.mean()), float(stats.sem(values)), len(values), float(expected))


def kinetic_at_even_times(log):
    """(F,) of the snapshots."""
    with h5py.File(log.path) as file:
        velocity = file["particles/discs/velocity/value"][:]
    return (log.discs.mass * (velocity**2).sum(axis=2)).sum(axis=1) / 2
