"""What effects do to a gas, as properties: analyses and checks ask a scene for properties, not for effects."""

import operator
from collections.abc import Callable
from dataclasses import dataclass, field, fields
from functools import reduce
from itertools import zip_longest
from typing import Any

from idealgas.columns import SIDES
from idealgas.toml.issues import Key


def _sums(a: tuple[float, ...], b: tuple[float, ...]) -> tuple[float, ...]:
    return tuple(map(operator.add, a, b))


def _first_not_none(a: Any, b: Any) -> Any:
    """The first of the two, or the second if that is None."""
    return b if a is None else a


def _merge(a: tuple[Any, ...], b: tuple[Any, ...]) -> tuple[Any, ...]:
    """The entries of the first, where that has None or False those of the second."""
    return tuple(y if x is None else x or y for x, y in zip_longest(a, b))


def _plain(value: Any, both: Callable[[Any, Any], Any]) -> Any:
    """A property of the plain box, and what it is with two effects."""
    return field(default=value, metadata={"both": both})


@dataclass(frozen=True)
class Properties:
    """Properties of a gas. The defaults are those of the plain box: smooth elastic discs in a reflecting box.

    True by default; true for a scene if true for each of its effects:

    uniform: in equilibrium the gas is the same everywhere in the box. straight_flight: discs fly along straight
    lines between events. elastic: no energy is lost in the motion along the line of centres, or normal to a wall.
    fixed_walls: all walls stay where they are. allows_monte_carlo: it has a meaning for discs without positions.
    allows_time_steps: the time-driven method can simulate it. is_scalable: the box may grow or shrink around the gas,
    as nothing in it has a fixed position.

    False by default; true for a scene if true for any of its effects:

    driven: energy is put in by a wall that moves at a given velocity. dissipative: energy is lost when discs collide
    with discs or walls. has_rough_walls: walls take momentum along themselves. drives_discs: discs at rest are set in
    motion. varies: a temperature, pressure, velocity or acceleration changes in time. vibrates: a side does. one_way:
    discs pass a wall in one direction only. escapes: discs leave the gas.

    inertia: moment of inertia of a disc in units of mass * radius²; None if discs do not spin. periodic: which axes
    are. acceleration: of all discs between events at the start, length/time². later_accelerations: the same from later
    times on. emits: temperature of each thermal wall at the start, by number; None for those that reflect. bath:
    temperature at the start of a heat bath that gives discs new velocities wherever they are; None without one.
    later_temperatures: of walls and heat bath. thermostat_rate: per disc, 1/time. last_wall_removed_at: time from which
    on no wall is inside the box; infinite if one always is. changes: times at which a value changes in a step, or a
    gate opens or closes. shear: rate at which sides shear the gas, 1/time.
    """

    uniform: bool = _plain(True, operator.and_)
    straight_flight: bool = _plain(True, operator.and_)
    elastic: bool = _plain(True, operator.and_)
    fixed_walls: bool = _plain(True, operator.and_)
    allows_monte_carlo: bool = _plain(True, operator.and_)
    allows_time_steps: bool = _plain(True, operator.and_)
    is_scalable: bool = _plain(True, operator.and_)
    driven: bool = _plain(False, operator.or_)
    dissipative: bool = _plain(False, operator.or_)
    has_rough_walls: bool = _plain(False, operator.or_)
    drives_discs: bool = _plain(False, operator.or_)
    varies: bool = _plain(False, operator.or_)
    vibrates: bool = _plain(False, operator.or_)
    one_way: bool = _plain(False, operator.or_)
    escapes: bool = _plain(False, operator.or_)
    inertia: float | None = _plain(None, _first_not_none)
    periodic: tuple[bool, bool] = _plain((False, False), _merge)
    acceleration: tuple[float, float] = _plain((0.0, 0.0), _sums)
    later_accelerations: tuple[tuple[float, float], ...] = _plain((), operator.add)
    emits: tuple[float | None, ...] = _plain((None,) * len(SIDES), _merge)
    bath: float | None = _plain(None, _first_not_none)
    thermostat_rate: float = _plain(0.0, max)
    shear: float = _plain(0.0, max)
    later_temperatures: tuple[float, ...] = _plain((), operator.add)
    last_wall_removed_at: float = _plain(0.0, max)
    changes: tuple[float, ...] = _plain((), operator.add)

    @property
    def lossless(self) -> bool:
        """Whether no energy is lost at all when discs collide with discs or walls."""
        return not self.dissipative

    @property
    def spins(self) -> bool:
        """Whether discs have an angular velocity."""
        return self.inertia is not None

    @property
    def temperatures(self) -> frozenset[float]:
        """Temperatures of the thermal walls and the heat bath, at any time."""
        found = (*self.emits, self.bath, *self.later_temperatures)
        return frozenset(temperature for temperature in found if temperature is not None)

    @property
    def isolated(self) -> bool:
        """Whether no heat comes through the walls or from a heat bath."""
        return not self.temperatures

    @property
    def conserves_energy(self) -> bool:
        """Whether nothing but heat, from walls or a heat bath, changes the energy of motion and spin."""
        return self.lossless and self.straight_flight and self.fixed_walls and not self.escapes

    @property
    def conserves_motion(self) -> bool:
        """Whether the total kinetic energy is conserved."""
        return self.conserves_energy and self.isolated and not self.spins

    @property
    def empty(self) -> bool:
        """Whether there never is a wall inside the box."""
        return self.last_wall_removed_at == 0

    @property
    def strongest_pull(self) -> tuple[float, float]:
        """Acceleration of all discs along x and y, each when it is strongest, length/time²."""
        x, y = (max(each, key=abs) for each in zip(self.acceleration, *self.later_accelerations, strict=True))
        return x, y

    @property
    def falls(self) -> tuple[bool, bool]:
        """Along which axes gravity acts between periodic sides, where nothing ends the fall."""
        x, y = (on and g != 0 for on, g in zip(self.periodic, self.strongest_pull, strict=True))
        return x, y

    @property
    def frictionless(self) -> bool:
        """Whether nothing takes momentum along periodic sides: smooth walls take none along themselves."""
        return self.empty and self.bath is None and (all(self.periodic) or not self.has_rough_walls)

    @property
    def conserves_momentum(self) -> tuple[bool, bool]:
        """Along which axes nothing changes the momentum of the discs."""
        x, y = (self.frictionless and on and not fall for on, fall in zip(self.periodic, self.falls, strict=True))
        return x and not self.shear, y

    def __and__(self, other: "Properties") -> "Properties":
        """Properties of a gas with the effects of both."""
        pairs = ((entry, getattr(self, entry.name), getattr(other, entry.name)) for entry in fields(self))
        return Properties(**{entry.name: entry.metadata["both"](mine, others) for entry, mine, others in pairs})


@dataclass(frozen=True)
class ActiveEffect:
    """An effect that a scene has: its name, the keys that turn it on, and what it changes."""

    name: str
    keys: tuple[Key, ...]
    properties: Properties


def combine(effects: tuple[ActiveEffect, ...]) -> Properties:
    """Properties of a scene with these effects."""
    return reduce(Properties.__and__, (effect.properties for effect in effects), Properties())


def lacking(effects: tuple[ActiveEffect, ...], *names: str) -> tuple[str, ...]:
    """Which of the effects lack one of these properties, by their names."""
    return tuple(e.name for e in effects if not all(getattr(e.properties, name) for name in names))
