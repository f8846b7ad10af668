"""Gravity: a constant acceleration."""

from collections.abc import Iterator

import numpy as np
from pydantic import Field

from idealgas.columns import SIDES, Column, sides_across
from idealgas.effects.effect import EffectSpec, EnergyPart, Sample, Start, Tables
from idealgas.effects.properties import Properties
from idealgas.physics import gravity as law
from idealgas.state import Gas
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Table, Vector


class Gravity(Table):
    """`[gravity]`: the same acceleration everywhere."""

    acceleration: Vector = Field(description="[gx, gy], length/time²")


def _properties(tables: Tables) -> Properties:
    return Properties(
        uniform=False,
        straight_flight=False,
        allows_monte_carlo=False,
        drives_discs=True,
        acceleration=tables.own.acceleration,
    )


def _check(tables: Tables) -> Iterator[Issue]:
    """Gravity without acceleration, or along periodic sides, where discs would accelerate indefinitely."""
    key: Key = ("gravity", "acceleration")
    acceleration = tables.own.acceleration
    if not any(acceleration):
        yield Issue((key,), "no acceleration", str(list(acceleration)), "no [gravity], or one that pulls")
    for axis, component in enumerate(acceleration):
        low, high = (SIDES[side] for side in sides_across(axis))
        if component and tables.sides[2 * axis] == "periodic":
            keys = (key, ("box", low), ("box", high))
            what = f"gravity through the periodic sides {low} and {high}"
            yield Issue(keys, what, f"a component of {component}", "0, or sides that end the fall")


def _make(_: Tables, start: Start) -> law.Gravity | None:
    """The acceleration of all effects: discs follow their sum."""
    return law.Gravity(*start.acceleration) if any(start.acceleration) else None


def _energy(gravity: law.Gravity, gas: Gas, _: float) -> float:
    return -float((gas.mass * (gas.position @ np.array(gravity))).sum())


EFFECT = EffectSpec(
    name="gravity",
    field="gravity",
    key="gravity",
    table=Gravity,
    description="[gravity]: acceleration",
    properties=_properties,
    check=_check,
    make=_make,
    make_always=True,
    energy=EnergyPart("potential", _energy, Column("potential_energy", "f8", (), "energy")),
    samples=(Sample(tables=lambda side: f"[gravity]\nacceleration = [0, {-1 / side!r}]\n"),),
)
