"""Tables of the evolution of a gas in time."""

from collections.abc import Mapping, Sequence

import numpy as np

from idealgas.analysis.core.tables import Number, Table, format_estimate
from idealgas.analysis.evolution.measure import Evolution, source_label
from idealgas.analysis.evolution.pressure_series import PressureSeries

ROWS = 9
"""Number of instants that are shown; the picture and CSV have all."""

CHANGED = 1.2
"""Ratio of two temperatures above which the summary reports a change."""


def evolution_tables(result: Evolution) -> list[Table]:
    """Tables of temperature and of discs beyond the gate, of the pressure, and of the energies."""
    series = {"kinetic energy per disc": result.temperature}
    if result.law is not None:
        series["law"] = result.law.temperature
    if result.spin is not None:
        series["I ω² per disc"] = result.spin
    series |= {f"fraction of {name} beyond the gate": share for name, share in result.beyond.items()}
    energy = {f"energy of {name}": values for name, values in result.parts.items()}
    energy |= {source_label(name): values for name, values in result.given.items()}
    energy |= {f"lost by {name}": values for name, values in result.dissipated.items()}
    if result.piston is not None:
        energy["piston position"] = result.piston
    energy["balance, relative"] = result.balance
    notes = (f"law: {result.law.text if result.law else 'none for this scene'}",)
    return [
        _in_time("Time series", result.time, series, notes),
        *([_pressure(result.pressure)] if result.pressure else []),
        _in_time("Energy", result.samples, energy),
    ]


def _pressure(series: PressureSeries) -> Table:
    columns = {"area": series.area}
    for name in series.shown:
        columns |= {f"P on {name}": series.pressure[name], f"± s.e. ({name})": series.error[name]}
    return _in_time("Pressure on walls, means over bins of time", series.middles, columns)


def _in_time(title: str, time: np.ndarray, columns: Mapping[str, np.ndarray], notes: Sequence[str] = ()) -> Table:
    values = zip(*(column.tolist() for column in (time, *columns.values())), strict=True)
    return Table(title, ("t", *columns), [tuple(map(Number, row)) for row in values], notes, most=ROWS)


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
