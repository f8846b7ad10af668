"""A profile in words."""

import numpy as np

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.words import format_estimate
from idealgas.analysis.profile.measure import Profile

CLEAR = 5.0
"""Difference of two strips, in standard errors, from which on it is said."""


def profile_summary(result: Profile) -> list[str]:
    """Sentences on density and temperature of the first and the last known strip, where a law has them differ."""
    said: list[str] = []
    if result.law is None:
        return said
    for entry in result.species:
        for name, column in (("density", entry.density), ("temperature", entry.temperature)):
            known = [(x, e) for x, e in zip(result.middles, column, strict=True) if np.isfinite(e.standard_error)]
            if len(known) > 1 and _differ(known[0][1], known[-1][1]):
                ends = (f"{format_estimate(e)} at {result.axis} = {x:.4g}" for x, e in (known[0], known[-1]))
                said.append(f"The {name} of {entry.species} goes from {' to '.join(ends)}.")
    return said


def _differ(first: Estimate, last: Estimate) -> bool:
    return abs(first.value - last.value) > CLEAR * np.hypot(first.standard_error, last.standard_error)
