"""Tables of a scene for the box, the discs, the run and the log; the effects define their own tables."""

from typing import TYPE_CHECKING, Annotated, Any, Literal, Self

from pydantic import AfterValidator, Discriminator, Field, Tag
from pydantic_core import PydanticKnownError

from idealgas.catalogue import commands
from idealgas.columns import SIDES
from idealgas.effects import EFFECTS
from idealgas.effects.periodic import PERIODIC
from idealgas.effects.schedule import SteppedTable
from idealgas.effects.shear import ShearedSide
from idealgas.scene.sizes import Density, Normal, Size, Uniform, Values, sizes_of
from idealgas.toml.dump import toml_value
from idealgas.toml.table import LARGEST, NotNegative, Number, Positive, Real, Table, Vector, Whole, Word, either

WORDS = ("reflecting", *(effect.side for effect in EFFECTS if isinstance(effect.side, str)))
"""Kinds of sides that are written as a single word."""

TABLES = tuple(effect.side for effect in EFFECTS if isinstance(effect.side, type))
"""Kinds of sides that are written as a table with a single key."""


def _description() -> str:
    *texts, last = ('"reflecting"', *(effect.side_text for effect in EFFECTS if effect.side))
    return f"{', '.join(texts)} or {last}"


if TYPE_CHECKING:
    Side = Any
    Radius = Any
    Mass = Any
else:
    Side = either(Literal[WORDS], *TABLES)
    Radius = either(Positive, Uniform, Normal, Values)
    Mass = either(Positive, Density)

_SIDE = _description()


class Box(Table):
    """`[box]`: size and sides; the origin is the lower left corner."""

    size: Annotated[tuple[Positive, Positive], Field(strict=False)] = Field(description="[width, height], length")
    left: Side = Field(default="reflecting", description=_SIDE)
    right: Side = Field(default="reflecting", description=_SIDE)
    bottom: Side = Field(default="reflecting", description=_SIDE)
    top: Side = Field(default="reflecting", description=_SIDE)

    @property
    def sides(self) -> tuple[Side, Side, Side, Side]:
        """Left, right, bottom and top sides."""
        return self.left, self.right, self.bottom, self.top

    @property
    def periodic(self) -> tuple[bool, bool]:
        """Whether the box is periodic along x and along y."""
        return self.left == PERIODIC, self.bottom == PERIODIC or isinstance(self.bottom, ShearedSide)

    def after(self, time: float) -> Self:
        """Return the box for a scene that starts at the given time of this scene."""
        sides = zip(SIDES, self.sides, strict=True)
        later = {name: side.after(time) for name, side in sides if isinstance(side, SteppedTable)}
        return self.model_copy(update=later)


class Species(Table):
    """`[[species]]`: discs of one kind, whose motion is set by exactly one of temperature, speed and velocities."""

    name: Word = Field(description="a unique word")
    count: Whole = Field(ge=1, lt=2**31, description="number of discs, >= 1, including discs in [start] and [[disc]]")
    radius: Radius = Field(
        description="radius > 0, length, or { uniform = [a, b] }, { normal = [mean, s.d.] } or { values = [r, ...] }"
    )
    mass: Mass = Field(default=1.0, description="mass, or { density = mass per area }")
    temperature: NotNegative | None = Field(
        default=None, description="energy; Gaussian velocities with total kinetic energy count * T"
    )
    speed: NotNegative | None = Field(default=None, description="length/time; speed of all discs, in random directions")
    velocities: Annotated[tuple[Vector, ...], Field(strict=False)] | None = Field(
        default=None, description="length/time; one [vx, vy] for each disc"
    )
    angular_velocity: Number | None = Field(default=None, description="1/time; with [rotation], 0 if absent")
    spin_temperature: NotNegative | None = Field(
        default=None, description="energy; with [rotation]: Gaussian spins with total rotational energy count * T/2"
    )
    placement: Literal["random", "lattice", "triangular", "compressed"] = Field(
        default="random", description="how the discs are placed in the region"
    )
    region: Annotated[tuple[Number, Number, Number, Number], Field(strict=False)] | None = Field(
        default=None,
        description="[x0, y0, x1, y1], length, which contains whole discs; if absent, the box up to the piston",
    )

    @property
    def sizes(self) -> tuple[Size, ...]:
        """Sizes and numbers of the discs."""
        return sizes_of(self.radius, self.mass, self.count)

    @property
    def largest_radius(self) -> float:
        """Largest radius of the discs, length; 0 for a distribution of radii if there are no discs."""
        return max((size.radius for size in self.sizes), default=0.0)


class Disc(Table):
    """`[[disc]]`: a single disc. A fixed disc is a wall, not part of the gas; only its position and radius matter."""

    position: Vector = Field(description="[x, y] of the centre, length")
    velocity: Vector = Field(default=(0.0, 0.0), description="[vx, vy], length/time")
    radius: Positive = Field(description="radius > 0, length")
    mass: Positive = Field(default=1.0, description="mass")
    angular_velocity: Number | None = Field(default=None, description="1/time; with [rotation], 0 if absent")
    species: Word | None = Field(
        default=None, description='name of its species, which need not be in [[species]]; if absent, "disc"'
    )
    fixed: bool | None = Field(default=None, description="whether the disc is a scatterer that never moves")


Instant = Annotated[
    Annotated[Literal["end"], Tag("(word)")] | Annotated[Real, Field(ge=0, le=LARGEST), Tag("(number)")],
    Discriminator(lambda time: "(word)" if isinstance(time, str) else "(number)"),
]


class StartTable(Table):
    """`[start]`: discs with positions and velocities from a log or a file, instead of `[[disc]]` tables."""

    log: str | None = Field(default=None, description="path of a log, relative to this file")
    file: str | None = Field(
        default=None, description="path of a .npz, .csv, .gsd or .extxyz file, relative to this file"
    )
    time: Instant = Field(default="end", description='time of the state in the log or file, or "end"')
    velocities: Literal["keep", "new", "reversed"] = Field(
        default="keep", description="velocities as in the state, newly drawn as in [[species]], or reversed"
    )
    overlap: NotNegative | None = Field(
        default=None, description="largest accepted overlap, length; if absent, the largest overlap in the log's state"
    )
    number: Whole | None = Field(default=None, ge=1, lt=2**31, description="number of discs; follows from the state")
    digest: str | None = Field(default=None, max_length=64, description="digest of the state; set in logs")

    @property
    def source(self) -> str | None:
        """Path of the log or file; None for discs from Python."""
        return self.log or self.file


Threads = Annotated[
    Annotated[Literal["auto"], Tag("(word)")] | Annotated[int, Field(ge=1, le=256), Tag("(number)")],
    Discriminator(lambda threads: "(word)" if isinstance(threads, str) else "(number)"),
]


def _known(name: str) -> str:
    if name not in commands():
        raise PydanticKnownError("literal_error", {"expected": ", ".join(map(toml_value, commands()))})
    return name


AnalysisName = Annotated[str, AfterValidator(_known), Field(json_schema_extra={"enum": list(commands())})]
"""Name of an analysis, which is the name of its command."""


class Header(Table):
    """`[scene]`: title, description, analyses to show, and seed of the random-number generator."""

    title: str = Field(default="", description="title on one line")
    description: str = Field(default="", description="what the scene shows, in paragraphs; the report begins with it")
    shows: Annotated[tuple[AnalysisName, ...], Field(strict=False)] = Field(
        default=(),
        description="names of the analyses that answer the question of the scene, most important first; the report "
        "begins with them. If absent, they are chosen according to the effects",
    )
    seed: Whole = Field(
        default=0, ge=0, lt=2**63, description="whole number that determines all random numbers of the scene"
    )


class Run(Table):
    """`[run]`: method and one or more stop rules; the run ends as soon as one of them is met."""

    method: Literal["event_driven", "brute_force", "time_driven", "monte_carlo"] = Field(
        default="event_driven", description="how events are found"
    )
    until: Positive | None = Field(default=None, description="time at which the run ends")
    events: Whole | None = Field(default=None, ge=1, lt=2**63, description="number of pair collisions and wall hits")
    collisions_per_disc: Positive | None = Field(
        default=None, description="average number of pair collisions per disc (2 * collisions / N)"
    )
    trials: Whole | None = Field(default=None, ge=1, lt=2**62, description="with monte_carlo: number of pairs tried")
    dt: Positive | None = Field(default=None, description="with time_driven, which requires it: time step")
    precision: Literal["float32", "float64", "double-double"] | None = Field(
        default=None, description="with brute_force: precision of numbers, about 7, 16 (default) or 32 digits"
    )
    v_ref: Positive | None = Field(
        default=None,
        description="with monte_carlo: relative speed at which a trial pair of the largest discs always collides; "
        "if absent, 5 times the largest initial speed",
    )
    impact: Literal["symmetric", "one_sided"] | None = Field(
        default=None, description="with monte_carlo: whether impact parameters have both signs (default) or only one"
    )
    threads: Threads = Field(
        default=1,
        exclude=True,
        description='whole number or "auto"; with event_driven: number of threads, which does not affect the log',
    )


class LogTable(Table):
    """`[log]`: contents and storage of the log."""

    events: bool = Field(default=True, description="whether events are recorded, not only checkpoints and samples")
    compression: Literal["gzip", "none"] = Field(default="gzip", description="compression of the data")
    pressure: bool = Field(
        default=False,
        description="whether samples contain momentum flow and wall impulses, which give pressure without events",
    )
    heat_flow: bool | None = Field(
        default=None,
        description="with pressure: whether samples contain the heat flow, which gives the thermal conductivity "
        "without events",
    )
    checkpoint_every: Whole = Field(default=1, ge=1, lt=2**31, description="epochs between checkpoints")
    snapshot_every: Positive | None = Field(default=None, description="time between snapshots; none if absent")
    fsync: bool = Field(default=False, description="whether each commit waits until its data are on the disk")
