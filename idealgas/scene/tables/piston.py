"""The table of a piston."""

from typing import Literal

from pydantic import Field

from idealgas.document.table import NotNegative, Number, Positive, Table
from idealgas.scene.tables.box import SIDES
from idealgas.scene.tables.gravity import Gravity


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
        return SIDES.index(self.side) // 2

    @property
    def outward(self) -> float:
        """+1 if it is above the gas on its axis, -1 if below."""
        return 1.0 if SIDES.index(self.side) % 2 else -1.0

    def stop(self, size: tuple[float, float]) -> float:
        """Coordinate of its side of the box."""
        return size[self.axis] if self.outward > 0 else 0.0

    def start(self, size: tuple[float, float]) -> float:
        """Coordinate at time 0."""
        return self.stop(size) if self.position is None else self.position

    def acceleration(self, size: tuple[float, float], gravity: Gravity | None) -> float:
        """Along the axis, between hits, length/time²."""
        if self.mass is None:
            return 0.0
        weight = gravity.acceleration[self.axis] if gravity else 0.0
        return weight - self.outward * (self.pressure or 0.0) * size[1 - self.axis] / self.mass
