"""Periodic sides: a disc that leaves through one comes back through the one that faces it."""

from collections.abc import Sequence

from idealgas.scene.properties import Effect, Properties
from idealgas.sides import SIDES
from idealgas.toml.error import Key

NAME = "periodic sides"

PERIODIC = "periodic"
"""What a side of the box is called that is."""


def effect(sides: Sequence[object]) -> Effect | None:
    """What periodic sides change, if there are any among the sides of the box."""
    keys: tuple[Key, ...] = tuple(("box", name) for name, side in zip(SIDES, sides, strict=False) if side == PERIODIC)
    if not keys:
        return None
    return Effect(
        NAME, keys, Properties(allows_monte_carlo=False, periodic=(sides[0] == PERIODIC, sides[2] == PERIODIC))
    )
