"""The evolution in words."""

from idealgas.analysis.core.words import format_estimate
from idealgas.analysis.evolution.measure import Evolution


def evolution_summary(result: Evolution) -> list[str]:
    """Sentences on a piston at rest or its way, on discs beyond a gate, and on a temperature that changed."""
    said = []
    first, last = result.temperature[[0, -1]]
    if max(first, last) > CHANGED * min(first, last):
        said.append(f"The temperature went from {first:.4g} to {last:.4g}.")
    if result.rest:
        said.append(f"The piston rests at {format_estimate(result.rest)}.")
    elif result.track:
        said.append("The piston went from {:.4g} to {:.4g}.".format(*result.track[1][[0, -1]]))
    said += [f"At the end {share[-1]:.1%} of {name} are beyond the gate." for name, share in result.beyond.items()]
    return said


CHANGED = 1.2
"""Ratio of two temperatures from which on they are said to differ."""
