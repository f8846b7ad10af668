"""Tables of profiles of density and temperature."""

from dataclasses import replace

import numpy as np

from idealgas.analysis.core.statistics import Estimate
from idealgas.analysis.core.tables import Table, describe, estimates, format_estimate
from idealgas.analysis.profile.measure import Profile


def profile_tables(result: Profile) -> list[Table]:
    """Tables of density and temperature of each species in every strip, and of the heat given by walls."""
    axis = result.axis
    strips = [f"{axis} = {low:.4g} to {high:.4g}" for low, high in zip(result.edges, result.edges[1:], strict=False)]
    tables = []
    for entry in result.species:
        columns = [("density (1/length²)", entry.density), ("temperature, m v²/2", entry.temperature)]
        columns += [("temperature, I ω²", entry.spin)] if entry.spin is not None else []
        tables += [estimates(f"{entry.species}: {name}", zip(strips, column, strict=True)) for name, column in columns]
    if gradients := [(entry.species, entry.gradient) for entry in result.species if entry.gradient is not None]:
        tables.append(estimates(f"Temperature gradient along {axis} (energy/length)", gradients))
    if result.heat:
        tables.append(estimates("Energy from each wall per time", result.heat.items()))
    notes = (f"{describe(result.window)}, {result.frames} frames", f"theory: {result.law or 'none for this scene'}")
    return [replace(tables[0], notes=notes), *tables[1:]]


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
