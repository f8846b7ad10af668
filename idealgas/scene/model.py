"""A scene: what a TOML file may say, table by table. Reduced units, k_B = 1; a whole number will do for any number.

An effect is a table of its own: one class here and one field of `Scene`, `None` when absent.
"""

from collections.abc import Sequence
from typing import Annotated, Literal, Self

from pydantic import Field, PrivateAttr, model_validator
from pydantic_core import PydanticCustomError

from idealgas.scene.checks import faults
from idealgas.scene.defaults import contact_duration
from idealgas.scene.effects import Gravity, Piston, Restitution, Rotation, Side, ThermalSide, Wall
from idealgas.scene.fault import Fault
from idealgas.scene.origin import Origin
from idealgas.scene.table import NotNegative, Number, Positive, Table, Vector

_SIDE = '"reflecting", "periodic" or { thermal = T }'


class Header(Table):
    """`[scene]`"""

    title: str = Field(default="", description="one line for people")
    seed: int = Field(
        default=0, ge=0, lt=2**63, description="whole number from which all random numbers of the scene follow"
    )


class Box(Table):
    """`[box]`: the corner at the lower left is the origin."""

    size: Annotated[tuple[Positive, Positive], Field(strict=False)] = Field(description="[width, height], length")
    left: Side = Field(default="reflecting", description=_SIDE)
    right: Side = Field(default="reflecting", description=_SIDE)
    bottom: Side = Field(default="reflecting", description=_SIDE)
    top: Side = Field(default="reflecting", description=_SIDE)

    @property
    def sides(self) -> tuple[Side, Side, Side, Side]:
        """Left, right, bottom and top."""
        return self.left, self.right, self.bottom, self.top

    @property
    def joined(self) -> tuple[bool, bool]:
        """Whether left and right, and bottom and top, are joined: periodic."""
        return self.left == "periodic", self.bottom == "periodic"


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
    angular_velocity: Number | None = Field(default=None, description="1/time; with [rotation], 0 if absent")
    spin_temperature: NotNegative | None = Field(
        default=None, description="energy; with [rotation]: Gaussian spins, rotational energy count * T/2"
    )
    placement: Literal["random", "lattice"] = Field(
        default="random", description="how the discs are put into the region"
    )
    region: Annotated[tuple[Number, Number, Number, Number], Field(strict=False)] | None = Field(
        default=None,
        description="[x0, y0, x1, y1], length: whole discs lie in it; if absent the box, up to the piston",
    )


class Disc(Table):
    """`[[disc]]`: one disc."""

    position: Vector = Field(description="[x, y] of the centre, length")
    velocity: Vector = Field(default=(0.0, 0.0), description="[vx, vy], length/time")
    radius: Positive = Field(description="radius > 0, length")
    mass: Positive = Field(default=1.0, description="mass")
    angular_velocity: Number | None = Field(default=None, description="1/time; with [rotation], 0 if absent")


class Run(Table):
    """`[run]`: the method and when to stop, whichever of the stop rules comes first; at least one is given."""

    method: Literal["event_driven", "brute_force", "time_driven", "monte_carlo"] = Field(
        default="event_driven", description="how events are found"
    )
    until: Positive | None = Field(default=None, description="time")
    events: int | None = Field(default=None, ge=1, lt=2**63, description="number of pair collisions and wall hits")
    collisions_per_disc: Positive | None = Field(
        default=None, description="pair collisions a disc takes part in, averaged over all discs (2 * collisions / N)"
    )
    trials: int | None = Field(default=None, ge=1, lt=2**62, description="with monte_carlo: number of pairs tried")
    dt: Positive | None = Field(default=None, description="with time_driven, and required there: step, time")
    precision: Literal["float32", "float64", "double-double"] | None = Field(
        default=None, description="with brute_force: of its numbers, about 7, 16 (as if absent) or 32 digits"
    )
    v_ref: Positive | None = Field(
        default=None,
        description="with monte_carlo: relative speed at which a pair of the largest discs collides for certain; "
        "if absent 5 times the largest speed at the start",
    )
    impact: Literal["symmetric", "one_sided"] | None = Field(
        default=None, description="with monte_carlo: whether impact parameters have both signs, as if absent, or one"
    )


class Log(Table):
    """`[log]`: what the run writes."""

    events: bool = Field(default=True, description="every event on record; without, the checkpoints only")
    compression: Literal["gzip", "none"] = Field(default="gzip", description="of the event columns")
    checkpoint_every: int = Field(default=1, ge=1, lt=2**31, description="epochs between checkpoints")
    snapshot_every: Positive | None = Field(default=None, description="time between snapshots; none if absent")
    fsync: bool = Field(default=False, description="whether what is flushed also survives a loss of power")


class Scene(Table):
    """A whole scene, checked: its numbers are in range, its discs fit, its run has an end."""

    scene: Header = Field(default_factory=Header, description="[scene]: title, seed")
    box: Box = Field(description="[box]: size")
    species: Annotated[tuple[Species, ...], Field(strict=False)] = Field(default=(), description="[[species]] tables")
    disc: Annotated[tuple[Disc, ...], Field(strict=False)] = Field(default=(), description="[[disc]] tables")
    wall: Annotated[tuple[Wall, ...], Field(strict=False)] = Field(default=(), description="[[wall]] tables")
    gravity: Gravity | None = Field(default=None, description="[gravity]: acceleration")
    rotation: Rotation | None = Field(default=None, description="[rotation]: inertia, roughness, wall_roughness")
    restitution: Restitution | None = Field(default=None, description="[restitution]: normal, wall, contact_duration")
    piston: Piston | None = Field(default=None, description="[piston]: side, position, velocity or mass and pressure")
    run: Run = Field(description="[run]: until, events or collisions_per_disc")
    log: Log = Field(default_factory=Log, description="[log]: events, compression, checkpoint_every, ...")

    _origin: Origin = PrivateAttr(default_factory=Origin)

    @model_validator(mode="after")
    def _check(self) -> Self:
        if found := list(faults(self)):
            raise PydanticCustomError("faults", "{summary}", {"summary": str(found[0]), "faults": found})
        return self

    def resolved(self) -> Self:
        """This scene with all defaults filled in that follow from other tables."""
        update: dict[str, Table] = {}
        if self.piston:
            update["piston"] = self.piston.model_copy(update={"position": self.piston.start(self.box.size)})
        if self.restitution and not self.restitution.elastic:
            duration = contact_duration(self.restitution, self.species, self.disc)
            update["restitution"] = self.restitution.model_copy(update={"contact_duration": duration})
        return self.model_copy(update=update)

    def from_origin(self, origin: Origin) -> Self:
        """This scene, knowing where it was written."""
        self._origin = origin
        return self

    def report(self, faults: Sequence[Fault]) -> list[str]:
        """Lines for people about faults that show only later, with the place of the key each names."""
        return self._origin.report(faults)

    @property
    def effects(self) -> tuple[str, ...]:
        """Which of EFFECTS the scene calls for."""
        thermal = any(isinstance(side, ThermalSide) for side in self.box.sides) or any(w.temperature for w in self.wall)
        called = (
            self.gravity,
            any(self.box.joined),
            self.wall,
            self.rotation,
            self.restitution and not self.restitution.elastic,
            thermal,
            self.piston,
        )
        return tuple(name for name, call in zip(EFFECTS, called, strict=True) if call)


EFFECTS = ("gravity", "periodic sides", "wall segments", "rotation", "restitution", "thermal walls", "piston")
"""What a scene may add to smooth elastic discs in a reflecting box; no code of the others runs."""
