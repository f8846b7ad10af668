"""Summary of the evolution of a gas in sentences."""

from collections.abc import Iterator
from dataclasses import replace
from typing import TYPE_CHECKING

import numpy as np

from idealgas.analysis.check import agreement
from idealgas.presentation.tables import format_estimate

if TYPE_CHECKING:
    from idealgas.analysis.evolution import Evolution

RETURNED = 0.2
"""Fraction of the discs that must have returned from beyond a wall for the summary to state the maximum there."""


def evolution_summary(result: "Evolution") -> str:
    """Return sentences on the temperature and its prediction, the pistons, and the discs beyond a wall."""
    return " ".join([*_temperatures(result), *_pistons(result), *_beyond(result)])


def _change(values: np.ndarray) -> str:
    """Return a predicate that describes the change of a series (F,) from its first to its last value."""
    first, last = (f"{value:.4g}" for value in values[[0, -1]])
    return f"stays at {first}" if first == last else f"goes from {first} to {last}"


def _temperatures(result: "Evolution") -> Iterator[str]:
    law, change = result.law, f"The kinetic energy per disc {_change(result.temperature)}"
    if law is None:
        yield f"{change}; theory is not available."
    elif mean := result.mean_temperature:
        yield f"{change}; its mean once steady is {format_estimate(mean)}; {agreement([('', mean)], 'equilibrium')}."
    elif law.steady:
        yield f"{change}; equilibrium theory predicts {law.temperature[-1]:.4g}."
    else:
        yield f"{change}; theory predicts {law.temperature[-1]:.4g} at the end."
    for name, values in result.chambers.items() if len(result.chambers) == 2 else ():
        where = f"{name.capitalize()}{'' if name.startswith('between') else ' of the piston'}"
        yield f"{where}, the energy per disc {_change(values)}."


def _pistons(result: "Evolution") -> Iterator[str]:
    if rest := result.rest:
        yield f"Mean piston position {format_estimate(rest)}; {agreement([('X', rest)], 'equilibrium')}."
    for name, places in result.pistons.items():
        if len(places) and not result.rest:
            yield f"The {name} {_change(places)}."
    if exponent := result.adiabatic_exponent:
        verdict = agreement([("γ", exponent)], "the adiabat of these discs")
        yield f"γ = 1 + ln(T₂/T₁)/ln(A₁/A₂) = {format_estimate(exponent)}; {verdict}. An ideal gas has γ = 2."
    if work := result.isothermal_work:
        verdict = agreement([("work", work)], "a slow piston at constant T")
        yield f"The work of the piston on the discs is {format_estimate(work)}; {verdict}."


def _beyond(result: "Evolution") -> Iterator[str]:
    for name, share in result.beyond.items():
        known = result.spread.get(name)
        expected = [] if known is None else [(name, replace(known, value=share[-1], theory=known.value))]
        discs = f"species '{name}'" if len(result.beyond) > 1 else "the discs"
        verdict = agreement(expected, "equilibrium")
        most = int(share.argmax())
        if share[most] > share[-1] + RETURNED:
            yield f"Up to {100 * share[most]:.1f} % of {discs} are beyond the wall, at t = {result.time[most]:.4g}."
        yield f"At the end {100 * share[-1]:.1f} % of {discs} are beyond the wall; {verdict}."
