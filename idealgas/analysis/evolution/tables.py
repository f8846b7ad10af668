"""Tables of the evolution of a gas in time."""

from collections.abc import Mapping, Sequence

import numpy as np

from idealgas.analysis.core.tables import Number, Table
from idealgas.analysis.evolution.course import PressureCourse
from idealgas.analysis.evolution.measure import Evolution

ROWS = 9
"""Number of instants that are shown; the picture and CSV have all."""


def evolution_tables(result: Evolution) -> list[Table]:
    """Tables of temperature and of discs beyond the gate, of the pressure, and of the energies."""
    course = {"m v²/2 a disc": result.temperature}
    if result.law is not None:
        course["law"] = result.law.temperature
    if result.spin is not None:
        course["I ω² a disc"] = result.spin
    course |= {f"{name} beyond the gate": share for name, share in result.beyond.items()}
    energy = {f"energy of {name}": values for name, values in result.parts.items()}
    energy |= {f"given by {name}": values for name, values in result.given.items()}
    energy |= {f"lost by {name}": values for name, values in result.dissipated.items()}
    if result.piston is not None:
        energy["piston at"] = result.piston
    energy["balance, relative"] = result.balance
    notes = (f"law: {result.law.text if result.law else 'none for this scene'}",)
    return [
        _in_time("Course in time", result.time, course, notes),
        *([_pressure(result.pressure)] if result.pressure else []),
        _in_time("Energy", result.samples, energy),
    ]


def _pressure(course: PressureCourse) -> Table:
    columns = {"area": course.area}
    for name in course.shown:
        columns |= {f"P on {name}": course.pressure[name], f"± s.e. ({name})": course.error[name]}
    return _in_time("Pressure on walls, means over bins of time", course.middles, columns)


def _in_time(title: str, time: np.ndarray, columns: Mapping[str, np.ndarray], notes: Sequence[str] = ()) -> Table:
    values = zip(*(column.tolist() for column in (time, *columns.values())), strict=True)
    return Table(title, ("t", *columns), [tuple(map(Number, row)) for row in values], notes, most=ROWS)
