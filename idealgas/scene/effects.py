"""The tables of effects. An absent table, or one whose numbers change nothing, leaves the effect out of a run."""

import math
from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from idealgas.scene.table import NotNegative, Number, Positive, Table, Vector

SIDES = ("left", "right", "bottom", "top")


class ThermalSide(Table):
    """`{ thermal = T }`: a side that emits the discs it takes at a temperature."""

    thermal: Positive = Field(description="temperature > 0, energy")


def _tag(side: Any) -> str:
    return "(table)" if isinstance(side, (dict, ThermalSide)) else "(word)"


Side = Annotated[
    Annotated[Literal["reflecting", "periodic"], Tag("(word)")] | Annotated[ThermalSide, Tag("(table)")],
    Discriminator(_tag),
]


class Wall(Table):
    """`[[wall]]`: a segment whose body and ends are solid, at rest. One that opens or closes is a gate.

    It is there until `opens_at`, and again from `closes_at` on; with `closes_at` alone it is absent until then. A disc
    in the way of a closing gate stays on the side of its centre: it may leave, and bounces where it comes nearer. One
    that cannot rise out against gravity bounces as deep in the gate as it is.
    """

    start: Vector = Field(alias="from", description="[x, y] of one end, length")
    end: Vector = Field(alias="to", description="[x, y] of the other end, length")
    temperature: Positive | None = Field(
        default=None, description="temperature > 0, energy, at which it emits discs; it reflects if absent"
    )
    opens_at: Positive | None = Field(default=None, description="time > 0 from which it is not there")
    closes_at: Positive | None = Field(default=None, description="time > 0 from which it is there again")
    name: str | None = Field(
        default=None, pattern=r"^[^\W\d][\w-]*$", description="a word of its own; in the log; if absent its number"
    )

    @property
    def absence(self) -> tuple[float, float]:
        """From when to when it is not there; both infinite for a wall that always is."""
        if self.opens_at is None and self.closes_at is not None:
            return 0.0, self.closes_at
        return self.opens_at or math.inf, self.closes_at or math.inf

    @property
    def there_at_start(self) -> bool:
        """Whether it is there at time 0."""
        return self.absence[0] > 0


class Gravity(Table):
    """`[gravity]`: the same acceleration everywhere."""

    acceleration: Vector = Field(description="[gx, gy], length/time²")


class Rotation(Table):
    """`[rotation]`: discs have a spin, and a tangential coefficient couples it to their motion.

    The coefficient runs from -1 (smooth) to 1 (perfectly rough); energy is conserved at these two. A piston is smooth.
    """

    inertia: float = Field(
        default=0.5, gt=0, le=1, description="moment of inertia in units of mass * radius²: 0.5 for a uniform disc"
    )
    roughness: float = Field(default=1.0, ge=-1, le=1, description="of discs, -1 to 1")
    wall_roughness: float = Field(default=-1.0, ge=-1, le=1, description="of a disc with a wall, -1 to 1")


class Restitution(Table):
    """`[restitution]`: discs part more slowly than they met.

    A disc that collided less than the contact duration ago collides elastically: this keeps a gas from infinitely many
    collisions in a finite time (Luding & McNamara, Granular Matter 1, 113 (1998)).
    """

    normal: float = Field(default=1.0, ge=0, le=1, description="of two discs, 0 to 1")
    wall: float = Field(default=1.0, ge=0, le=1, description="of a disc with a wall or piston, 0 to 1")
    contact_duration: Positive | None = Field(
        default=None, description="time > 0; if absent 1e-6 * mean diameter / mean speed at the start"
    )

    @property
    def elastic(self) -> bool:
        """Whether nothing is lost."""
        return self.normal == 1 and self.wall == 1


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
