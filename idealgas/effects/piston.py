"""A piston: a wall across the whole box that moves."""

from collections.abc import Iterator, Mapping
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import Field

from idealgas.columns import FIRST_SEGMENT, OUTWARD, SIDES, Column, Point, Values, axis_of
from idealgas.effects.effect import SAMPLE_DISCS, EffectSpec, EnergyPart, Sample, Start, Tables
from idealgas.effects.properties import Properties
from idealgas.effects.schedule import (
    Change,
    NotNegativeInSteps,
    NumberInSteps,
    SteppedTable,
    description,
    steps_of,
    value_at,
)
from idealgas.effects.wall import LastingWall
from idealgas.jit import aligned
from idealgas.physics import piston as law
from idealgas.physics.steering import reversed_velocity
from idealgas.state import Gas
from idealgas.toml.issues import Key
from idealgas.toml.table import Number, Positive, Rectangle

POSITION = Column("piston_position", "f8", (), "length")
VELOCITY = Column("piston_velocity", "f8", (), "length/time")

NAME = "piston"
"""Name of an inner piston among the walls."""


class Piston(SteppedTable):
    """`[piston]`: a wall across the whole box that replaces one side, or moves inside the box between two gases.

    It moves at a given velocity, or it has a mass, and gravity along its axis. One that replaces a side is pressed on
    the gas by the external pressure. At a side of the box it is reflected.
    """

    in_steps = ("velocity", "pressure")

    side: Literal["left", "right", "bottom", "top"] | None = Field(
        default=None, description="the side that it replaces; right if absent and not inner"
    )
    inner: Literal["x", "y"] | None = Field(
        default=None, description="axis along which it moves inside the box, between two gases; instead of side"
    )
    position: Number | None = Field(
        default=None,
        description="coordinate at the start, length; if absent that of its side, of an inner one the middle",
    )
    velocity: NumberInSteps | None = Field(
        default=None,
        description="length/time along the axis, or steps [[0, v], [t, v], …]; with a mass that at the start",
    )
    mass: Positive | None = Field(default=None, description="mass > 0; unless it is inner, together with pressure")
    pressure: NotNegativeInSteps | None = Field(
        default=None, description="external pressure, force per length of the piston, or steps [[0, P], [t, P], …]"
    )

    @property
    def axis(self) -> int:
        """0 if it moves along x, 1 along y."""
        return axis_of(SIDES.index(self.wall)) if self.inner is None else "xy".index(self.inner)

    @property
    def wall(self) -> str:
        """Name of the wall that it is: the side that it replaces, or its own name."""
        return (self.side or "right") if self.inner is None else NAME

    @property
    def outward(self) -> float:
        """+1 if it is above the gas on its axis, -1 if below; 0 if it is inner."""
        return sum(OUTWARD[SIDES.index(self.wall)]) if self.inner is None else 0.0

    def outward_from(self, position: Any, size: tuple[float, float]) -> np.ndarray:
        """Direction (N,) from each disc to it, +1 or -1; position: (N, 2), of the discs at the start, length."""
        above = np.asarray(position)[:, self.axis] > self.start(size)
        return np.where(above, -1.0, 1.0) if self.inner else np.full(len(above), self.outward)

    def stop(self, size: tuple[float, float]) -> float:
        """Coordinate of the side of the box that it replaces."""
        return size[self.axis] if self.outward > 0 else 0.0

    def start(self, size: tuple[float, float]) -> float:
        """Coordinate at time 0."""
        if self.position is not None:
            return self.position
        return size[self.axis] / 2 if self.inner else self.stop(size)

    @property
    def start_velocity(self) -> float:
        """Velocity at time 0, length/time."""
        return value_at(self.velocity, 0.0) or 0.0

    @property
    def velocity_steps(self) -> tuple[tuple[float, float], ...]:
        """Times from which it has its given velocities, and these, length/time."""
        return steps_of(self.velocity)

    def room(self, size: tuple[float, float]) -> Rectangle:
        """What the gas has at the start: the box, up to a piston that is in it and not inner."""
        low, high = [0.0, 0.0], list(size)
        if self.inner is None and 0 <= (start := self.start(size)) <= size[self.axis]:
            (high if self.outward > 0 else low)[self.axis] = start
        return low[0], low[1], high[0], high[1]

    @property
    def action(self) -> str:
        """Short description for output."""
        if self.mass is None:
            return f"piston of velocity {description(self.velocity)}"
        pressed = "" if self.inner else f" under pressure {description(self.pressure)}"
        return f"piston of mass {self.mass:g}{pressed}"

    def acceleration(self, size: tuple[float, float], gravity: tuple[float, float], time: Any = 0.0) -> Any:
        """Along the axis, between hits, length/time², at a time or an array of times.

        gravity: constant acceleration of all discs, length/time².
        """
        pressure = value_at(self.pressure or 0.0, time)
        if self.mass is None:
            return 0.0 * pressure
        return gravity[self.axis] - self.outward * pressure * size[1 - self.axis] / self.mass

    @property
    def times(self) -> tuple[float, ...]:
        """Times after 0 at which its pressure or velocity changes."""
        return tuple(time for time, _ in (*steps_of(self.pressure)[1:], *steps_of(self.velocity)[1:]))


@dataclass(frozen=True)
class InnerPiston(LastingWall):
    """An inner piston among the walls inside the box, where it is at the start. Its left is the lower side."""

    start: Point
    end: Point
    action: str
    name: str = NAME
    place: Key = ("piston", "position")
    radius = 0.0


def inner_piston(table: Piston | None, size: tuple[float, float]) -> tuple[InnerPiston, ...]:
    """The inner piston of a box of a size, if there is one."""
    if table is None or table.inner is None:
        return ()
    place = table.start(size)
    ends = ((place, 0.0), (place, size[1])) if table.axis == 0 else ((size[0], place), (0.0, place))
    return (InnerPiston(*ends, table.action),)


def _properties(tables: Tables) -> Properties:
    piston = tables.own
    return Properties(
        uniform=False,
        fixed_walls=False,
        allows_monte_carlo=False,
        allows_time_steps=False,
        is_scalable=False,
        driven=piston.mass is None and any(velocity for _, velocity in steps_of(piston.velocity)),
        drives_discs=True,
        changes=piston.times,
        varies=bool(piston.times),
    )


def _make(tables: Tables, start: Start) -> np.ndarray:
    table, size = tables.own, tables.size
    piston = aligned(1, law.PISTON)
    record = piston[0]
    record.x, record.v = table.start(size), table.start_velocity
    record.a = table.acceleration(size, start.acceleration)
    record.m, record.length, record.axis = table.mass or 0.0, size[table.axis], table.axis
    record.outward = table.outward
    record.wall = FIRST_SEGMENT - 1 + len(tables.walls) if table.inner else SIDES.index(table.wall)
    return piston


def _schedule(tables: Tables, start: Start) -> Iterator[Change]:
    """Changes of the acceleration, item 0, and of a given velocity, item 1."""
    for time, _ in steps_of(tables.own.pressure)[1:]:
        yield Change(time, 0, tables.own.acceleration(tables.size, start.acceleration, time))
    for time, velocity in steps_of(tables.own.velocity)[1:]:
        yield Change(time, 1, velocity)


def _change(piston: np.ndarray, item: int, value: float) -> np.ndarray:
    piston[0]["v" if item else "a"] = value
    return piston


def _values(piston: np.ndarray, local_time: float) -> Values:
    position, velocity = law.piston_motion(piston[0], local_time)
    return {POSITION: float(position), VELOCITY: float(velocity)}


def _restore(piston: np.ndarray, values: Mapping[str, Any]) -> None:
    record = piston[0]
    record.x, record.v, record.t = values[POSITION.name], values[VELOCITY.name], 0.0


def _energy(piston: np.ndarray, _: Gas, local_time: float) -> float:
    record = piston[0]
    position, velocity = law.piston_motion(record, local_time)
    return float(law.piston_energy(record.m, position, velocity, record.a)) if record.m > 0 else 0.0


def _own_wall(piston: np.ndarray) -> int | None:
    return int(piston[0].wall) if piston[0].m > 0 else None


def _reverse(piston: np.ndarray) -> None:
    """Turn a piston with a mass around; a given velocity stays."""
    if piston[0].m > 0:
        piston[0].v = reversed_velocity(piston[0].v)


def _sample(side: float) -> str:
    pressure = 1.2 * SAMPLE_DISCS / side**2
    return f'[piston]\nside = "top"\nposition = {0.95 * side!r}\nmass = 100\npressure = {pressure!r}\n'


def _inner_sample(side: float) -> str:
    return '[piston]\ninner = "x"\nmass = 100\n'


EFFECT = EffectSpec(
    name="piston",
    field="piston",
    key="piston",
    table=Piston,
    description="[piston]: side or inner, position, velocity or mass, pressure",
    properties=_properties,
    make=_make,
    schedule=_schedule,
    change=_change,
    values=_values,
    restore=_restore,
    energy=EnergyPart("piston", _energy),
    gives_energy=lambda piston: True,
    own_wall=_own_wall,
    reverse=_reverse,
    end_epoch=law.end_epoch,
    samples=(Sample(tables=_sample), Sample("inner", tables=_inner_sample)),
)
