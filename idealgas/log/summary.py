"""What a run tells of itself at its end, as its log has it."""

import json
import math
from collections.abc import Mapping, Sequence
from dataclasses import asdict, dataclass, fields
from typing import Any, Self


@dataclass(frozen=True)
class Summary:
    """What a run came to, all of the log included if it was resumed.

    completed: whether the run reached the end that its scene asks for. end_time: time at which it ended. events: number
    of events, the sum of disc_collisions (of two discs), wall_hits (of discs with walls and the piston) and kicks (by a
    heat bath). trials: number of pairs tried by the Monte Carlo method. rows: event rows, two for a disc collision.
    epochs: number of them.

    energy_change: of the discs since the start, in units of energy. energy_drift: the same of discs and piston, with
    what collisions lost and less what walls and a heat bath gave, relative to the largest of these: rounding errors
    only.
    deepest_overlap: of two discs, in units of the sum of their radii; farthest_outside: reach of a disc out of the box,
    in units of its diameter. Both are taken at the starts of epochs and at the end; in the method of time steps
    the overlap is that of all collisions, each of which has one.

    seconds: wall time of this run without start-up and compilation; compile_seconds: that of compilation.

    threads: number of threads of this run at its end; threads_because: why it is no other. shared_slices: pieces of
    work that they shared; given_up_slices: those of them that one thread had to do again.
    """

    completed: bool
    end_time: float
    events: int
    disc_collisions: int
    wall_hits: int
    kicks: int
    trials: int
    rows: int
    epochs: int
    energy_change: float
    energy_drift: float
    deepest_overlap: float
    farthest_outside: float
    seconds: float
    compile_seconds: float
    threads: int
    threads_because: str
    shared_slices: int
    given_up_slices: int

    @classmethod
    def of(cls, found: Mapping[str, Any]) -> Self:
        """Make a summary from the fields that a log has; `found` raises its own error for a missing one."""
        return cls(**{field.name: found[field.name] for field in fields(cls)})

    def as_dict(self) -> dict[str, Any]:
        """The fields by name, ready for JSON."""
        return asdict(self)


def parse_summary(names: Sequence[bytes], values: Sequence[bytes]) -> dict[str, Any]:
    """The fields of a summary by name, from the rows of a log. Raises ValueError for what a summary cannot say."""
    types = {field.name: field.type for field in fields(Summary)}
    found: dict[str, Any] = {}
    for name, value in zip(names, values, strict=True):
        key = name.decode()
        if key in found:
            raise ValueError(f"{key} is there twice")
        found[key] = json.loads(value)
        if not _fits(found[key], types.get(key, float | None)):
            raise ValueError(f"{key}: {value.decode()}")
    return found


def _fits(value: Any, kind: Any) -> bool:
    """Whether a value is of a type: text, a truth value, a whole number from 0 on, a finite number, or that or None."""
    if kind is str or isinstance(value, str):
        return kind is str and isinstance(value, str)
    if kind is bool or isinstance(value, bool):
        return kind is bool and isinstance(value, bool)
    if kind is int:
        return isinstance(value, int) and value >= 0
    if value is None:
        return kind is not float
    return isinstance(value, int | float) and math.isfinite(value)
