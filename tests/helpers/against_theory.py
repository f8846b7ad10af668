"""Runs of the shipped scenes held against theory."""

import h5py
import numpy as np
from scipy import stats

from idealgas.analysis.core.statistics import Estimate

STANDARD_ERRORS = 4
LEAST_P = 0.001


def agrees(found: Estimate, resolution: float) -> None:
    """Within STANDARD_ERRORS of theory, with an error below `resolution` times it."""
    assert found.standard_error < resolution * abs(found.theory)
    assert abs(found.deviation) < STANDARD_ERRORS, found


def of_runs(values, expected) -> Estimate:
    """Mean of independent runs, with the error that their spread gives."""
    values = np.array(values)
    return Estimate(float(values.mean()), float(stats.sem(values)), len(values), float(expected))


def kinetic_at_even_times(log):
    """(F,) of the snapshots."""
    with h5py.File(log.path) as file:
        velocity = file["particles/discs/velocity/value"][:]
    return (log.discs.mass * (velocity**2).sum(axis=2)).sum(axis=1) / 2
