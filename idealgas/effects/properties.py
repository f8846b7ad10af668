"""Properties that effects give to a gas; analyses and checks depend on these properties, not on the effects."""

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
    """Return a, or b if a is None."""
    return b if a is None else a


def _merge(a: tuple[Any, ...], b: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the entries of a; those that are None or False are replaced by the entries of b."""
    return tuple(y if x is None else x or y for x, y in zip_longest(a, b))


def _property(default: Any, combine: Callable[[Any, Any], Any]) -> Any:
    """Dataclass field for a property of the gas.

    default: value for the plain box. combine: function that combines the values of two effects.
    """
    return field(default=default, metadata={"combine": combine})


@dataclass(frozen=True)
class Properties:
    """Properties of a gas. The defaults are those of the plain box: smooth elastic discs in a reflecting box.

    Attributes that are True by default. A scene has such a property if all of its effects have it:
        uniform: in equilibrium the gas is the same everywhere in the box.
        straight_flight: discs move on straight lines between events.
        elastic: collisions do not change the energy of the motion along the line of centres, or normal to a wall.
        fixed_walls: all walls remain at their positions.
        allows_monte_carlo: the effect is defined for discs without positions.
        allows_time_steps: the time-driven method can simulate the effect.
        constant_restitution: discs collide with constant coefficients of restitution and roughness.
        interacting: discs collide with each other.
        is_scalable: the box may grow or shrink around the gas, because nothing in it has a fixed position.

    Attributes that are False by default. A scene has such a property if any of its effects has it:
        driven: a wall that moves at a prescribed velocity does work on the gas.
        dissipative: energy is lost when discs collide with discs or walls.
        collisions_give_energy: discs gain energy when they collide.
        has_rough_walls: walls exert tangential forces.
        drives_discs: discs at rest are set in motion.
        varies: a temperature, pressure, velocity or acceleration changes with time.
        vibrates: a side vibrates.
        one_way: discs pass a wall in one direction only.
        escapes: discs leave the gas.

    Attributes:
        inertia: moment of inertia of a disc in units of mass * radius²; None if discs do not spin.
        periodic: whether the sides along x and along y are periodic.
        acceleration: initial acceleration of all discs between events, length/time².
        later_accelerations: accelerations after each later step, length/time².
        emits: initial temperature of each thermal wall, by number of the wall; None for walls that reflect.
        bath: initial temperature of the heat bath, which gives discs new velocities anywhere; None without a bath.
        thermostat_rate: rate at which each disc collides with the heat bath, 1/time.
        shear: shear rate imposed by sheared sides, 1/time.
        later_temperatures: later temperatures of walls and heat bath.
        last_wall_removed_at: time after which there is no wall inside the box; infinite if there is always one.
        changes: times at which a value changes stepwise, or a gate opens or closes.
    """

    uniform: bool = _property(True, operator.and_)
    straight_flight: bool = _property(True, operator.and_)
    elastic: bool = _property(True, operator.and_)
    fixed_walls: bool = _property(True, operator.and_)
    allows_monte_carlo: bool = _property(True, operator.and_)
    allows_time_steps: bool = _property(True, operator.and_)
    constant_restitution: bool = _property(True, operator.and_)
    interacting: bool = _property(True, operator.and_)
    is_scalable: bool = _property(True, operator.and_)
    driven: bool = _property(False, operator.or_)
    dissipative: bool = _property(False, operator.or_)
    collisions_give_energy: bool = _property(False, operator.or_)
    has_rough_walls: bool = _property(False, operator.or_)
    drives_discs: bool = _property(False, operator.or_)
    varies: bool = _property(False, operator.or_)
    vibrates: bool = _property(False, operator.or_)
    one_way: bool = _property(False, operator.or_)
    escapes: bool = _property(False, operator.or_)
    inertia: float | None = _property(None, _first_not_none)
    periodic: tuple[bool, bool] = _property((False, False), _merge)
    acceleration: tuple[float, float] = _property((0.0, 0.0), _sums)
    later_accelerations: tuple[tuple[float, float], ...] = _property((), operator.add)
    emits: tuple[float | None, ...] = _property((None,) * len(SIDES), _merge)
    bath: float | None = _property(None, _first_not_none)
    thermostat_rate: float = _property(0.0, max)
    shear: float = _property(0.0, max)
    later_temperatures: tuple[float, ...] = _property((), operator.add)
    last_wall_removed_at: float = _property(0.0, max)
    changes: tuple[float, ...] = _property((), operator.add)

    @property
    def collisions_conserve_energy(self) -> bool:
        """Whether collisions of discs with discs or walls neither take energy from the discs nor add any."""
        return not (self.dissipative or self.collisions_give_energy)

    @property
    def spins(self) -> bool:
        """Whether discs have an angular velocity."""
        return self.inertia is not None

    @property
    def temperatures(self) -> frozenset[float]:
        """Temperatures of the thermal walls and the heat bath, at any time."""
        values = (*self.emits, self.bath, *self.later_temperatures)
        return frozenset(temperature for temperature in values if temperature is not None)

    @property
    def isolated(self) -> bool:
        """Whether there is no heat flow through the walls or from a heat bath."""
        return not self.temperatures

    @property
    def shares_energy(self) -> bool:
        """Whether discs exchange energy with each other or with a source of heat."""
        return self.interacting or not self.isolated

    @property
    def conserves_energy(self) -> bool:
        """Whether only heat, from walls or a heat bath, can change the energy of translation and spin."""
        return self.collisions_conserve_energy and self.straight_flight and self.fixed_walls and not self.escapes

    @property
    def conserves_motion(self) -> bool:
        """Whether the total kinetic energy is conserved."""
        return self.conserves_energy and self.isolated and not self.spins

    @property
    def empty(self) -> bool:
        """Whether there is never a wall inside the box."""
        return self.last_wall_removed_at == 0

    @property
    def strongest_pull(self) -> tuple[float, float]:
        """Strongest acceleration of all discs along x, and along y, at any time, length/time²."""
        x, y = (max(each, key=abs) for each in zip(self.acceleration, *self.later_accelerations, strict=True))
        return x, y

    @property
    def free_fall_axes(self) -> tuple[bool, bool]:
        """Whether gravity acts along x, and along y, with periodic sides, so that nothing stops the fall."""
        x, y = (on and g != 0 for on, g in zip(self.periodic, self.strongest_pull, strict=True))
        return x, y

    @property
    def frictionless(self) -> bool:
        """Whether no friction acts on the gas along periodic sides; smooth walls exert no tangential force."""
        return self.empty and self.bath is None and (all(self.periodic) or not self.has_rough_walls)

    @property
    def conserves_momentum(self) -> tuple[bool, bool]:
        """Whether the total momentum of the discs is conserved along x, and along y."""
        x, y = (
            self.frictionless and on and not fall for on, fall in zip(self.periodic, self.free_fall_axes, strict=True)
        )
        return x and not self.shear, y

    def __and__(self, properties: "Properties") -> "Properties":
        """Return the properties of a gas that has the effects of both."""
        pairs = ((entry, getattr(self, entry.name), getattr(properties, entry.name)) for entry in fields(self))
        return Properties(**{entry.name: entry.metadata["combine"](first, second) for entry, first, second in pairs})


@dataclass(frozen=True)
class ActiveEffect:
    """An effect that a scene has: its name, the keys that turn it on, and its properties."""

    name: str
    keys: tuple[Key, ...]
    properties: Properties


def combine(effects: tuple[ActiveEffect, ...]) -> Properties:
    """Return the properties of a scene with these effects."""
    return reduce(Properties.__and__, (effect.properties for effect in effects), Properties())


def lacking(effects: tuple[ActiveEffect, ...], *names: str) -> tuple[str, ...]:
    """Names of the effects that lack at least one of the given properties."""
    return tuple(e.name for e in effects if not all(getattr(e.properties, name) for name in names))
