"""The summary of a run, which is stored in the log once the run has reached its end."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

from idealgas.log.rules import LONGEST

KINDS = ("disc_collisions", "wall_hits", "thermostat_collisions")
"""Fields whose sum, plus `steered`, is the number of events."""

STEERED = "steered"
OPTIONAL = (STEERED, "escaped")
"""Fields that are omitted if they are 0."""


@dataclass(frozen=True)
class Summary:
    """Summary of a run. If the run was resumed, the summary covers the whole log.

    Attributes:
        completed: whether the run reached the end that its scene specifies.
        end_time: simulated time at the end.
        events: number of events, the sum of the next three fields and `steered`.
        disc_collisions: number of collisions of two discs.
        wall_hits: number of collisions with walls and pistons.
        thermostat_collisions: number of thermostat collisions.
        trials: number of pairs tried by the Monte Carlo method.
        rows: number of event rows: two for each collision of two discs and one for any other event.
        epochs: number of epochs.
        energy_change: change in the energy of the discs since the start, energy.
        energy_drift: violation of energy conservation due to rounding: the change in the energy of discs and pistons,
            plus the energy lost in collisions, minus the energy received from walls, the heat bath and changes to the
            scene, relative to the largest of these energies.
        deepest_overlap: deepest overlap of two discs, relative to the sum of their radii, among the states at the
            beginning of each epoch and at the end; with time steps, among all collisions.
        max_wall_penetration: largest distance by which a disc extended beyond a side that is not periodic, in the same
            states, in diameters.
        seconds: elapsed real time of the latest run without start-up and compilation, s.
        compile_seconds: elapsed real time of compilation, s.
        threads: number of threads that shared the work of the latest run; 1 if no time slice was shared.
        threads_reason: reason for this number of threads.
        shared_slices: number of time slices that were shared by several threads.
        aborted_slices: number of shared time slices that a single thread had to repeat.
        steered: number of events in which a velocity, or gravity, was changed from outside the gas.
        escaped: number of discs that have left the gas; their last events count as wall hits.
    """

    completed: bool
    end_time: float
    events: int
    disc_collisions: int
    wall_hits: int
    thermostat_collisions: int
    trials: int
    rows: int
    epochs: int
    energy_change: float
    energy_drift: float
    deepest_overlap: float
    max_wall_penetration: float
    seconds: float
    compile_seconds: float
    threads: int
    threads_reason: str
    shared_slices: int
    aborted_slices: int
    steered: int = 0
    escaped: int = 0

    @classmethod
    def of(cls, values: Mapping[str, Any]) -> Self:
        """Return a summary with the given fields; for a missing required field, `values` raises its own error."""
        names = [field.name for field in fields(cls)]
        return cls(**{name: values[name] for name in names if name in values or name not in OPTIONAL})

    def as_dict(self) -> dict[str, Any]:
        """Return the fields by name, in a form suitable for JSON; `steered` and `escaped` are omitted if they are 0."""
        return {name: value for name, value in asdict(self).items() if value or name not in OPTIONAL}


def parse_summary(names: Sequence[bytes], values: Sequence[bytes]) -> dict[str, Any]:
    """Return the fields of a summary by name, parsed from rows of a log. Raises ValueError if a value is invalid."""
    types = {field.name: field.type for field in fields(Summary)}
    parsed: dict[str, Any] = {}
    for name, value in zip(names, values, strict=True):
        key = name.decode()
        if key in parsed:
            raise ValueError(f"{key} appears twice")
        parsed[key] = json.loads(value)
        if not _fits(parsed[key], types.get(key, float | None)):
            raise ValueError(f"{key}: {value.decode()}")
    if parsed.get("threads") == 0:
        raise ValueError("threads: 0")
    if {"rows", "events", *KINDS} <= parsed.keys():
        events, rows = sum(parsed[kind] for kind in KINDS) + parsed.get(STEERED, 0), parsed["rows"]
        if parsed["events"] != events or rows not in (0, events + parsed["disc_collisions"]):
            raise ValueError(f"{parsed['events']:,} events in {rows:,} rows ({' + '.join(KINDS)}: {events:,})")
    return parsed


def _fits(value: Any, kind: Any) -> bool:
    """Return whether a value fits the type of a field.

    Types are str, bool, int (at least 0 and below 2⁶³), float (absolute value up to LONGEST), and float or None.
    """
    if kind is str or isinstance(value, str):
        return kind is str and isinstance(value, str)
    if kind is bool or isinstance(value, bool):
        return kind is bool and isinstance(value, bool)
    if kind is int:
        return isinstance(value, int) and 0 <= value < 2**63
    if value is None:
        return kind is not float
    return isinstance(value, int | float) and abs(value) <= LONGEST
