"""The summary of a run, which its log has once the run has reached its end."""

import json
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, Self

from idealgas.log.rules import LONGEST

KINDS = ("disc_collisions", "wall_hits", "thermostat_collisions")
"""Fields whose sum is the number of events, with `steered`."""

STEERED = "steered"
OPTIONAL = (STEERED, "escaped")
"""Fields that are absent where they are 0."""


@dataclass(frozen=True)
class Summary:
    """Summary of a run, over the whole log if it was resumed.

    Attributes:
        completed: whether the run reached the end of its scene.
        end_time: time at the end, time.
        events: number of events, the sum of the next three, and `steered`.
        disc_collisions: number of collisions of two discs.
        wall_hits: number of collisions with walls and the piston.
        thermostat_collisions: number of thermostat collisions.
        trials: number of pairs tried by the Monte Carlo method.
        rows: number of event rows, two for a collision of two discs.
        epochs: number of epochs.
        energy_change: change of the energy of the discs since the start, energy.
        energy_drift: change of the energy of discs and piston, plus losses in collisions, minus the energy from
            walls, a heat bath and changes, relative to the largest of these: rounding errors only.
        deepest_overlap: deepest overlap of two discs at epoch starts and the end, relative to the sum of their radii;
            with time steps that of all collisions.
        max_wall_penetration: largest distance by which a disc reached beyond a side at these times, in diameters; not
            of periodic sides, which no disc can be beyond.
        seconds: wall time of the last run without start-up and compilation, s.
        compile_seconds: wall time of compilation, s.
        threads: number of threads that shared the work of the last run; 1 if they shared no slice.
        threads_reason: reason for this number of threads.
        shared_slices: number of slices of time that several threads shared.
        aborted_slices: number of these that one thread had to repeat.
        steered: number of events in which a velocity, or gravity, was changed from outside.
        escaped: number of discs that have left the gas; their last events are wall hits.
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
    def of(cls, found: Mapping[str, Any]) -> Self:
        """Make a summary from the fields of a log; a missing one raises the error of `found`, unless it may be 0."""
        names = [field.name for field in fields(cls)]
        return cls(**{name: found[name] for name in names if name in found or name not in OPTIONAL})

    def as_dict(self) -> dict[str, Any]:
        """Fields by name, ready for JSON; without `steered` and `escaped` where they are 0."""
        return {name: value for name, value in asdict(self).items() if value or name not in OPTIONAL}


def parse_summary(names: Sequence[bytes], values: Sequence[bytes]) -> dict[str, Any]:
    """Fields of a summary by name, from the rows of a log. Raises ValueError for an invalid value."""
    types = {field.name: field.type for field in fields(Summary)}
    found: dict[str, Any] = {}
    for name, value in zip(names, values, strict=True):
        key = name.decode()
        if key in found:
            raise ValueError(f"{key} appears twice")
        found[key] = json.loads(value)
        if not _fits(found[key], types.get(key, float | None)):
            raise ValueError(f"{key}: {value.decode()}")
    if found.get("threads") == 0:
        raise ValueError("threads: 0")
    if {"rows", "events", *KINDS} <= found.keys():
        events, rows = sum(found[kind] for kind in KINDS) + found.get(STEERED, 0), found["rows"]
        if found["events"] != events or rows not in (0, events + found["disc_collisions"]):
            raise ValueError(f"{found['events']:,} events in {rows:,} rows ({' + '.join(KINDS)}: {events:,})")
    return found


def _fits(value: Any, kind: Any) -> bool:
    """Whether a value has the type of a field: str, bool, int (0 to 2^63), float (to LONGEST), or one or None."""
    if kind is str or isinstance(value, str):
        return kind is str and isinstance(value, str)
    if kind is bool or isinstance(value, bool):
        return kind is bool and isinstance(value, bool)
    if kind is int:
        return isinstance(value, int) and 0 <= value < 2**63
    if value is None:
        return kind is not float
    return isinstance(value, int | float) and abs(value) <= LONGEST
