"""Periodic sides: a disc that leaves through one side enters through the opposite one."""

from collections.abc import Iterator

import numpy as np

from idealgas.columns import IMAGE, SIDES, sides_across
from idealgas.effects.effect import EffectSpec, Sample, Start, Tables
from idealgas.effects.properties import ActiveEffect, Properties
from idealgas.physics import periodic as law
from idealgas.toml.issues import Issue, Key

NAME = "periodic sides"

PERIODIC = "periodic"
"""Word for a periodic side of the box."""


def _find(tables: Tables) -> ActiveEffect | None:
    sides = tables.sides
    keys: tuple[Key, ...] = tuple(("box", name) for name, side in zip(SIDES, sides, strict=False) if side == PERIODIC)
    if not keys:
        return None
    properties = Properties(allows_monte_carlo=False, periodic=(sides[0] == PERIODIC, sides[2] == PERIODIC))
    return ActiveEffect(NAME, keys, properties)


def _check(tables: Tables) -> Iterator[Issue]:
    """Periodic sides opposite one that is not."""
    for axis in range(2):
        names = [SIDES[side] for side in sides_across(axis)]
        periodic = [tables.sides[side] == PERIODIC for side in sides_across(axis)]
        if any(periodic) and not all(periodic):
            this, other = names if periodic[0] else names[::-1]
            keys: tuple[Key, ...] = (("box", this), ("box", other))
            yield Issue(keys, "periodic on one side only", f"{other} not periodic", f"{this} and {other} periodic")


def _make(tables: Tables, start: Start) -> law.Periodic | None:
    if PERIODIC not in tables.sides:
        return None
    crossings, image = (np.zeros((len(start.gas), *IMAGE.shape), IMAGE.dtype) for _ in range(2))
    return law.Periodic(tables.sides[0] == PERIODIC, tables.sides[2] == PERIODIC, *tables.size, crossings, image)


def _joined(*names: str) -> str:
    return "".join(f'{name} = "periodic"\n' for name in names)


EFFECT = EffectSpec(
    name=NAME,
    field="periodic",
    side=PERIODIC,
    side_text=f'"{PERIODIC}"',
    find=_find,
    check=_check,
    make=_make,
    disc_state=lambda periodic: {IMAGE: periodic.image},
    begin_epoch=law.begin_epoch,
    samples=(Sample(box=lambda side: _joined(*SIDES)),),
    sample_together=Sample(box=lambda side: _joined("left", "right")),
)
