"""The table of a piston."""

from typing import Literal

from pydantic import Field

from idealgas.scene.properties import Effect, Properties
from idealgas.scene.tables.gravity import Gravity
from idealgas.sides import OUTWARD, SIDES, axis_of
from idealgas.toml.table import NotNegative, Number, Positive, Rectangle, Table

NAME = "piston"


class Piston(Table):
    """`[piston]`: a wall across the whole box that moves in the place of one side and keeps the gas to itself.

    Either it moves at a given velocity whatever hits it, or it has a mass and gives way: the outer pressure, and
    gravity if that acts along its way, press it on the gas. At its side of the box it turns back.
    """

    side: Literal["left", "right", "bottom", "top"] = Field(default="right", description="the side it stands for")
    position: Number | None = Field(default=None, description="coordinate at the start, length; at its side if absent")
    velocity: Number | None = Field(default=None, description="length/time along the axis, kept up against all hits")
    mass: Positive | None = Field(default=None, description="mass > 0, together with pressure")
    pressure: NotNegative | None = Field(default=None, description="outer pressure, force per length of the piston")

    @property
    def axis(self) -> int:
        """0 if it moves along x, 1 along y."""
        return axis_of(SIDES.index(self.side))

    @property
    def outward(self) -> float:
        """+1 if it is above the gas on its axis, -1 if below."""
        return sum(OUTWARD[SIDES.index(self.side)])

    def stop(self, size: tuple[float, float]) -> float:
        """Coordinate of its side of the box."""
        return size[self.axis] if self.outward > 0 else 0.0

    def start(self, size: tuple[float, float]) -> float:
        """Coordinate at time 0."""
        return self.stop(size) if self.position is None else self.position

    def room(self, size: tuple[float, float]) -> Rectangle:
        """What the gas has at the start: the box, up to the piston if that is in it."""
        low, high = [0.0, 0.0], list(size)
        if 0 <= (start := self.start(size)) <= size[self.axis]:
            (high if self.outward > 0 else low)[self.axis] = start
        return low[0], low[1], high[0], high[1]

    @property
    def action(self) -> str:
        """What it does, in words."""
        if self.mass is None:
            return f"piston of velocity {self.velocity:g}"
        return f"piston of mass {self.mass:g} under pressure {self.pressure:g}"

    def acceleration(self, size: tuple[float, float], gravity: Gravity | None) -> float:
        """Along the axis, between hits, length/time²."""
        if self.mass is None:
            return 0.0
        weight = gravity.acceleration[self.axis] if gravity else 0.0
        return weight - self.outward * (self.pressure or 0.0) * size[1 - self.axis] / self.mass


def effect(piston: Piston | None) -> Effect | None:
    """What a piston changes, if there is one."""
    if piston is None:
        return None
    properties = Properties(
        uniform=False,
        fixed_walls=False,
        allows_monte_carlo=False,
        allows_time_steps=False,
        local=False,
        is_scalable=False,
        driven=piston.mass is None and bool(piston.velocity),
        drives_discs=True,
    )
    return Effect(NAME, (("piston",),), properties)
