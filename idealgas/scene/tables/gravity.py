"""The table of gravity."""

from pydantic import Field

from idealgas.scene.properties import Effect, Properties
from idealgas.toml.table import Table, Vector

NAME = "gravity"


class Gravity(Table):
    """`[gravity]`: the same acceleration everywhere."""

    acceleration: Vector = Field(description="[gx, gy], length/time²")


def effect(gravity: Gravity | None) -> Effect | None:
    """What gravity changes, if there is any."""
    if gravity is None:
        return None
    properties = Properties(
        uniform=False,
        straight_flight=False,
        allows_monte_carlo=False,
        drives_discs=True,
        acceleration=gravity.acceleration,
    )
    return Effect(NAME, (("gravity",),), properties)
