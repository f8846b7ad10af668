"""A scene: what a TOML file may say, table by table. Reduced units, k_B = 1; a whole number will do for any number.

An effect is a table of its own: one class here and one field of `Scene`, `None` when absent.
"""

from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import BaseModel, ConfigDict, Field, PrivateAttr, model_validator
from pydantic_core import PydanticCustomError

from idealgas.scene.checks import Fault, faults
from idealgas.scene.origin import Origin

LARGEST = 1e30
"""Bound on every number, so that no product of a few of them overflows."""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Field(gt=0, le=LARGEST)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST)]
Vector = Annotated[tuple[Number, Number], Field(strict=False)]


class Table(BaseModel):
    """A TOML table: no key beyond its own, no value of another type, nothing changed later."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)


class Header(Table):
    """`[scene]`"""

    title: str = Field(default="", description="one line for people")
    seed: int = Field(
        default=0, ge=0, lt=2**63, description="whole number from which all random numbers of the scene follow"
    )


class Box(Table):
    """`[box]`: reflecting sides; the corner at the lower left is the origin."""

    size: Annotated[tuple[Positive, Positive], Field(strict=False)] = Field(description="[width, height], length")


class Species(Table):
    """`[[species]]`: discs of one kind. Exactly one of temperature, speed and velocities says how they move."""

    name: str = Field(pattern=r"^[^\W\d][\w-]*$", description="a word, its own for each species")
    count: int = Field(ge=1, lt=2**31, description="number of discs, >= 1")
    radius: Positive = Field(description="radius > 0, length")
    mass: Positive = Field(default=1.0, description="mass")
    temperature: NotNegative | None = Field(
        default=None, description="energy; Gaussian velocities, kinetic energy count * T"
    )
    speed: NotNegative | None = Field(default=None, description="length/time; equal speeds, random directions")
    velocities: Annotated[tuple[Vector, ...], Field(strict=False)] | None = Field(
        default=None, description="length/time; one [vx, vy] for each disc"
    )
    placement: Literal["random", "lattice"] = Field(
        default="random", description="how the discs are put into the region"
    )
    region: Annotated[tuple[Number, Number, Number, Number], Field(strict=False)] | None = Field(
        default=None, description="[x0, y0, x1, y1], length: whole discs lie in it; the box if absent"
    )


class Disc(Table):
    """`[[disc]]`: one disc."""

    position: Vector = Field(description="[x, y] of the centre, length")
    velocity: Vector = Field(default=(0.0, 0.0), description="[vx, vy], length/time")
    radius: Positive = Field(description="radius > 0, length")
    mass: Positive = Field(default=1.0, description="mass")


class Run(Table):
    """`[run]`: the method and when to stop, whichever of the stop rules comes first; at least one is given."""

    method: Literal["event_driven", "brute_force"] = Field(default="event_driven", description="how events are found")
    until: Positive | None = Field(default=None, description="time")
    events: int | None = Field(default=None, ge=1, lt=2**63, description="number of pair collisions and wall hits")
    collisions_per_disc: Positive | None = Field(
        default=None, description="pair collisions a disc takes part in, averaged over all discs (2 * collisions / N)"
    )


class Log(Table):
    """`[log]`: what the run writes."""

    events: bool = Field(default=True, description="every event on record; without, the checkpoints only")
    compression: Literal["gzip", "none"] = Field(default="gzip", description="of the event columns")
    checkpoint_every: int = Field(default=1, ge=1, lt=2**31, description="epochs between checkpoints")


class Scene(Table):
    """A whole scene, checked: its numbers are in range, its discs fit, its run has an end."""

    scene: Header = Field(default_factory=Header, description="[scene]: title, seed")
    box: Box = Field(description="[box]: size")
    species: Annotated[tuple[Species, ...], Field(strict=False)] = Field(default=(), description="[[species]] tables")
    disc: Annotated[tuple[Disc, ...], Field(strict=False)] = Field(default=(), description="[[disc]] tables")
    run: Run = Field(description="[run]: until, events or collisions_per_disc")
    log: Log = Field(default_factory=Log, description="[log]: events, compression, checkpoint_every")

    _origin: Origin = PrivateAttr(default_factory=Origin)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if found := list(faults(self.box, self.species, self.disc, self.run)):
            raise PydanticCustomError("faults", "{summary}", {"summary": str(found[0]), "faults": found})
        return self

    def from_origin(self, origin: Origin) -> Self:
        """This scene, knowing where it was written."""
        self._origin = origin
        return self

    def report(self, faults: Sequence[Fault]) -> list[str]:
        """Lines for people about faults that show only later, with the place of the key each names."""
        return self._origin.report(faults)

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the tables that add something to smooth elastic discs in a reflecting box."""
        plain = {"scene", "box", "species", "disc", "run", "log"}
        return tuple(name for name in type(self).model_fields if name not in plain and getattr(self, name) is not None)
