"""Pistons: walls across the whole box that move."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass
from typing import Any, Literal

import numpy as np
from pydantic import Field

from idealgas.columns import FIRST_SEGMENT, OUTWARD, SIDES, Column, Point, Values, axis_of
from idealgas.effects.effect import SAMPLE_DISCS, BenchmarkSample, Effect, GasAtStart, Later, Tables
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
from idealgas.effects.wall import PermanentWall
from idealgas.jit import aligned
from idealgas.physics import piston as law
from idealgas.physics.steering import reversed_velocity
from idealgas.state import Gas
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Number, Positive, Rectangle, Word

NAME = "piston"
"""Default name of an inner piston among the walls."""


class PistonTable(SteppedTable):
    """`[[piston]]`: a wall across the whole box that replaces one side, or moves inside the box between two gases.

    It either moves at a prescribed velocity or has a finite mass and is accelerated by gravity along its axis. A piston
    of finite mass that replaces a side is pushed against the gas by an external pressure. Every piston is reflected at
    the sides of the box.
    """

    in_steps = ("velocity", "pressure")

    side: Literal["left", "right", "bottom", "top"] | None = Field(
        default=None, description="side of the box that the piston replaces; right if absent and not inner"
    )
    inner: Literal["x", "y"] | None = Field(
        default=None, description="axis along which an inner piston moves between two gases; used instead of side"
    )
    position: Number | None = Field(
        default=None,
        description="initial coordinate, length; if absent, that of its side or, if inner, the middle of the box",
    )
    velocity: NumberInSteps | None = Field(
        default=None,
        description="velocity along the axis, length/time, or steps [[0, v], [t, v], …]; with a mass, initial velocity",
    )
    mass: Positive | None = Field(default=None, description="mass > 0; requires pressure unless the piston is inner")
    pressure: NotNegativeInSteps | None = Field(
        default=None, description="external pressure, force per length of the piston, or steps [[0, P], [t, P], …]"
    )
    name: Word | None = Field(
        default=None, description='unique name of an inner piston in the log, a word; "piston" if absent'
    )

    @property
    def axis(self) -> int:
        """0 if the piston moves along x, 1 if it moves along y."""
        return axis_of(SIDES.index(self.wall)) if self.inner is None else "xy".index(self.inner)

    @property
    def wall(self) -> str:
        """Name of the piston among the walls: the side that it replaces, or the name of an inner piston."""
        return (self.side or "right") if self.inner is None else self.name or NAME

    @property
    def outward(self) -> float:
        """Direction from the gas to the piston along its axis, +1 or -1; 0 for an inner piston."""
        return sum(OUTWARD[SIDES.index(self.wall)]) if self.inner is None else 0.0

    def outward_from(self, position: Any, size: tuple[float, float]) -> np.ndarray:
        """Direction (N,) along the axis from each disc to the piston, +1 or -1.

        position: (N, 2) initial positions of the discs, length. size: width and height of the box, length.
        """
        above = np.asarray(position)[:, self.axis] > self.start(size)
        return np.where(above, -1.0, 1.0) if self.inner else np.full(len(above), self.outward)

    def stop(self, size: tuple[float, float]) -> float:
        """Coordinate of the side of the box that the piston replaces, length."""
        return size[self.axis] if self.outward > 0 else 0.0

    def start(self, size: tuple[float, float]) -> float:
        """Coordinate of the piston at time 0, length."""
        if self.position is not None:
            return self.position
        return size[self.axis] / 2 if self.inner else self.stop(size)

    @property
    def start_velocity(self) -> float:
        """Velocity at time 0, length/time."""
        return value_at(self.velocity, 0.0) or 0.0

    @property
    def velocity_steps(self) -> tuple[tuple[float, float], ...]:
        """Pairs of a time and the prescribed velocity (length/time) that holds from this time on."""
        return steps_of(self.velocity)

    def room(self, size: tuple[float, float]) -> Rectangle:
        """Rectangle that the gas may fill at the start: the box, bounded by the piston if this is an outer piston."""
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
        """Acceleration along the axis between hits, length/time², at a time or an array of times.

        gravity: constant acceleration of all discs, length/time².
        """
        pressure = value_at(self.pressure or 0.0, time)
        if self.mass is None:
            return 0.0 * pressure
        return gravity[self.axis] - self.outward * pressure * size[1 - self.axis] / self.mass

    @property
    def times(self) -> tuple[float, ...]:
        """Times after 0 at which the external pressure or the velocity changes."""
        return tuple(time for time, _ in (*steps_of(self.pressure)[1:], *self.velocity_steps[1:]))


@dataclass(frozen=True)
class InnerPiston(PermanentWall):
    """An inner piston among the walls inside the box, at its initial position.

    The left face of the piston is on the side of smaller coordinates.
    """

    start: Point
    end: Point
    action: str
    name: str
    place: Key
    radius = 0.0


def inner_pistons(tables: Sequence[PistonTable | None], size: tuple[float, float]) -> tuple[InnerPiston, ...]:
    """Return the inner pistons among the tables; invalid tables are None.

    size: width and height of the box, length.
    """
    pistons = []
    for k, table in enumerate(tables):
        if table is not None and table.inner is not None:
            place = table.start(size)
            ends = ((place, 0.0), (place, size[1])) if table.axis == 0 else ((size[0], place), (0.0, place))
            pistons.append(InnerPiston(*ends, table.action, table.wall, ("piston", k, "position")))
    return tuple(pistons)


def _columns(number: int) -> tuple[Column, Column]:
    """Columns of the positions and velocities of the given number of pistons."""
    places = Column("piston_position", "f8", (number,), "length")
    return places, Column("piston_velocity", "f8", (number,), "length/time")


def _sample(side: float) -> str:
    pressure = 1.2 * SAMPLE_DISCS / side**2
    return f'[[piston]]\nside = "top"\nposition = {0.95 * side!r}\nmass = 100\npressure = {pressure!r}\n'


def _inner_sample(side: float) -> str:
    return '[[piston]]\ninner = "x"\nmass = 100\n'


class PistonEffect(Effect[np.ndarray]):
    """Pistons: walls across the whole box that move."""

    name = "piston"
    field = "piston"
    key = "piston"
    table = PistonTable
    many = True
    description = "[[piston]] tables"
    energy_part = "piston"
    samples = (BenchmarkSample(tables=_sample), BenchmarkSample("inner", tables=_inner_sample))

    def properties(self, tables: Tables) -> Properties:
        pistons = [piston for piston in tables.table if piston is not None]
        times = tuple(sorted({time for piston in pistons for time in piston.times}))
        return Properties(
            uniform=False,
            fixed_walls=False,
            allows_monte_carlo=False,
            allows_time_steps=False,
            is_scalable=False,
            driven=any(p.mass is None and any(velocity for _, velocity in p.velocity_steps) for p in pistons),
            drives_discs=True,
            changes=times,
            varies=bool(times),
        )

    def check(self, tables: Tables) -> Iterator[Issue]:
        """Yield issues of pistons whose names are taken or have no effect."""
        walls = [wall for wall in tables.walls if wall is not None and not isinstance(wall, InnerPiston)]
        taken = {wall.name: "a wall" for wall in walls} | dict.fromkeys(SIDES, "a side of the box")
        for k, piston in enumerate(tables.table):
            if piston is None:
                continue
            key: Key = ("piston", k, "name" if piston.name else "inner")
            if piston.inner is None and piston.name:
                yield Issue((key,), "only inner pistons have names", f'"{piston.name}"', "no name")
            elif piston.inner and piston.wall in taken:
                yield Issue((key,), f"name taken by {taken[piston.wall]}", f'"{piston.wall}"', "a unique name")
            elif piston.inner:
                taken[piston.wall] = "another piston"

    def continued(self, table: tuple[PistonTable, ...], later: Later) -> tuple[PistonTable, ...]:
        if not table:
            return ()
        places, velocities = (later.sampled(column.name) for column in _columns(len(table)))
        moved = []
        for piston, place, velocity in zip(table, places, velocities, strict=True):
            motion = {"velocity": float(velocity)} if piston.mass is not None else {}
            moved.append(piston.after(later.time).model_copy(update={"position": float(place), **motion}))
        return tuple(moved)

    def make(self, tables: Tables, start: GasAtStart) -> np.ndarray:
        size, first = tables.size, FIRST_SEGMENT + len(tables.walls) - sum(p.inner is not None for p in tables.table)
        pistons = aligned(len(tables.table), law.PISTON)
        for record, table in zip(pistons, tables.table, strict=True):
            record.x, record.v = table.start(size), table.start_velocity
            record.a = table.acceleration(size, start.acceleration)
            record.m, record.length, record.axis = table.mass or 0.0, size[table.axis], table.axis
            record.outward = table.outward
            record.wall = first if table.inner else SIDES.index(table.wall)
            first += table.inner is not None
        return pistons

    def values(self, pistons: np.ndarray, local_time: float) -> Values:
        motion = np.array([law.piston_motion(record, local_time) for record in pistons])
        return dict(zip(_columns(len(pistons)), motion.T.copy(), strict=True))

    def restore(self, pistons: np.ndarray, arrays: Mapping[str, np.ndarray]) -> None:
        pistons["x"], pistons["v"] = (arrays[column.name] for column in _columns(len(pistons)))
        pistons["t"] = 0.0

    def energy(self, pistons: np.ndarray, _: Gas, local_time: float) -> float:
        motions = ((piston, law.piston_motion(piston, local_time)) for piston in pistons if piston.m > 0)
        return float(sum(law.piston_energy(piston.m, x, v, piston.a) for piston, (x, v) in motions))

    def gives_energy(self, pistons: np.ndarray) -> bool:
        return True

    def own_walls(self, pistons: np.ndarray) -> tuple[int, ...]:
        return tuple(int(record.wall) for record in pistons if record.m > 0)

    def driving_speed(self, pistons: np.ndarray, gas: Gas) -> float:
        return float(np.abs(pistons["v"]).max())

    def driving_energy(self, pistons: np.ndarray, gas: Gas) -> float:
        return float(np.abs(pistons["m"] * pistons["a"]).sum()) * max(gas.box)

    def end_epoch(self, piston: np.ndarray, length: float) -> None:
        law.end_epoch(piston, length)

    def reverse(self, pistons: np.ndarray) -> None:
        """Reverse the velocities of pistons of finite mass; prescribed velocities remain."""
        for record in pistons:
            if record.m > 0:
                record.v = reversed_velocity(record.v)

    def schedule(self, tables: Tables, start: GasAtStart) -> Iterator[Change]:
        """Yield the changes of the acceleration (item 2 k) and the prescribed velocity (item 2 k + 1) of piston k."""
        for k, table in enumerate(tables.table):
            for time, _ in steps_of(table.pressure)[1:]:
                yield Change(time, 2 * k, table.acceleration(tables.size, start.acceleration, time))
            for time, velocity in table.velocity_steps[1:]:
                yield Change(time, 2 * k + 1, velocity)

    def change(self, pistons: np.ndarray, item: int, value: float) -> np.ndarray:
        pistons[item // 2]["v" if item % 2 else "a"] = value
        return pistons


EFFECT = PistonEffect()
