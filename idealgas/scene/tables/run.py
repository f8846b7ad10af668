"""The tables that say what a run is called, how it goes and what it writes."""

from typing import Annotated, Literal

from pydantic import Discriminator, Field, Tag

from idealgas.toml.table import Positive, Table, Whole

Threads = Annotated[
    Annotated[Literal["auto"], Tag("(word)")] | Annotated[int, Field(ge=1, le=256), Tag("(number)")],
    Discriminator(lambda threads: "(word)" if isinstance(threads, str) else "(number)"),
]


class Header(Table):
    """`[scene]`: what the scene is called, and the seed of its random numbers."""

    title: str = Field(default="", description="one line for people")
    seed: Whole = Field(
        default=0, ge=0, lt=2**63, description="whole number from which all random numbers of the scene follow"
    )


class Run(Table):
    """`[run]`: the method and when to stop, whichever of the stop rules comes first; at least one is given."""

    method: Literal["event_driven", "brute_force", "time_driven", "monte_carlo"] = Field(
        default="event_driven", description="how events are found"
    )
    until: Positive | None = Field(default=None, description="time")
    events: Whole | None = Field(default=None, ge=1, lt=2**63, description="number of pair collisions and wall hits")
    collisions_per_disc: Positive | None = Field(
        default=None, description="average number of pair collisions per disc (2 * collisions / N)"
    )
    trials: Whole | None = Field(default=None, ge=1, lt=2**62, description="with monte_carlo: number of pairs tried")
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
    threads: Threads = Field(
        default=1,
        exclude=True,
        description='whole number, or "auto"; with event_driven, how many threads share the work: the log is the same',
    )


class Log(Table):
    """`[log]`: what the run writes."""

    events: bool = Field(default=True, description="every event on record; without, the checkpoints only")
    compression: Literal["gzip", "none"] = Field(default="gzip", description="of the event columns")
    pressure: bool = Field(
        default=False, description="momentum that flows and that walls take, in every sample: pressure without events"
    )
    heat_flow: bool | None = Field(
        default=None, description="with pressure: heat that flows, in every sample, for its conductivity without events"
    )
    checkpoint_every: Whole = Field(default=1, ge=1, lt=2**31, description="epochs between checkpoints")
    snapshot_every: Positive | None = Field(default=None, description="time between snapshots; none if absent")
    fsync: bool = Field(default=False, description="whether what is flushed also survives a loss of power")
