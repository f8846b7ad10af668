"""Specification of an effect: its table in a scene, its state in a run, and its columns in the log."""

from abc import ABC, abstractmethod
from collections.abc import Callable, Container, Iterable, Mapping
from typing import Any, ClassVar, Generic, NamedTuple, TypeVar

import numpy as np

from idealgas.columns import SIDES, Arrays, Column, Kind, Values
from idealgas.effects.properties import ActiveEffect, Properties
from idealgas.effects.schedule import Change
from idealgas.state import Gas
from idealgas.toml.issues import Issue, Key
from idealgas.toml.table import Table

State = TypeVar("State")
"""State of an effect in a run: arrays and numbers."""


class Tables(NamedTuple):
    """The part of a scene that an effect uses.

    Attributes:
        table: table of the effect, None if absent; for an effect with an array of tables, a tuple in which
            invalid tables are None.
        size: width and height of the box, length.
        sides: left, right, bottom and top side, each a word or a table; empty if the table of the box is invalid.
        walls: wall segments, with None for invalid tables, followed by fixed discs.
    """

    table: Any
    size: tuple[float, float]
    sides: tuple[Any, ...]
    walls: tuple[Any, ...]


class GasAtStart(NamedTuple):
    """The discs at time 0, from which an effect makes its state.

    Attributes:
        gas: the discs.
        seed: seed of the scene.
        acceleration: acceleration of the discs at time 0, summed over the effects, length/time².
        angular_velocity: (N,) angular velocities given in the scene, 1/time; 0 if not given.
        spin_temperature: (N,) temperature of the spins, energy; 0 for discs whose spins are not drawn at random.
        later_accelerations: accelerations after each later step, length/time².
    """

    gas: Gas
    seed: int
    acceleration: tuple[float, float]
    angular_velocity: np.ndarray
    spin_temperature: np.ndarray
    later_accelerations: tuple[tuple[float, float], ...] = ()


SAMPLE_DISCS = 1000


class BenchmarkSample(NamedTuple):
    """Addition of an effect to the scene of the benchmark, SAMPLE_DISCS discs at temperature 1 in a square box.

    Attributes:
        name: suffix to the name of the effect, if it has several samples.
        box: function that returns additional keys of `[box]` for a given side length of the box.
        tables: function that returns further tables for a given side length of the box.
    """

    name: str = ""
    box: Callable[[float], str] = lambda side: ""
    tables: Callable[[float], str] = lambda side: ""


class Later(NamedTuple):
    """The time in a log from which a new scene continues.

    Attributes:
        time: time at which the clock of the new scene starts.
        species: names of the species that still have discs at this time.
        sampled: function sampled(column) that returns the value of a column of the samples at this time.
    """

    time: float
    species: Container[str]
    sampled: Callable[[str], np.ndarray]


class Effect(ABC, Generic[State]):
    """Base of all effects. A subclass defines the tables of the effect, its state in a run and its columns in the log.

    The state consists of arrays and numbers, which `make` returns and the engine changes. Most methods take the state
    as their first argument. Methods that an effect does not override leave the gas unchanged.

    Attributes:
        name: name in output and messages.
        field: field of the bundle of all effects (`idealgas.effects.bundle`).
        key: key of its table in a scene; empty if it has no table but is a kind of side or a key in other tables.
        table: its table, a Pydantic model.
        many: whether the scene has an array of such tables.
        description: description of the table for the JSON Schema.
        side: kind of side of the box: a word, or a table with a single key.
        side_text: how such a side is written in a scene.
        energy_part: field of `idealgas.run.energy.Energy` that contains `energy`; empty if the effect adds no energy.
        energy_column: column of this energy in the samples; None if the samples do not contain it.
        energy_is_inner: whether this energy is of the discs, so that collisions may convert it into kinetic energy.
        events: kind of event that only this effect causes and that is counted; None if there is none.
        shearable: whether the effect is the same everywhere, so that the gas may be sheared.
        samples: additions to the scene of the benchmark.
        sample_together: addition to the benchmark scene with all effects; the first entry of `samples` if None.
    """

    name: ClassVar[str]
    field: ClassVar[str]
    key: ClassVar[str] = ""
    table: ClassVar[type[Table] | None] = None
    many: ClassVar[bool] = False
    description: ClassVar[str] = ""
    side: ClassVar[str | type[Table] | None] = None
    side_text: ClassVar[str] = ""
    energy_part: ClassVar[str] = ""
    energy_column: ClassVar[Column | None] = None
    energy_is_inner: ClassVar[bool] = False
    events: ClassVar[Kind | None] = None
    shearable: ClassVar[bool] = False
    samples: ClassVar[tuple[BenchmarkSample, ...]]
    sample_together: ClassVar[BenchmarkSample | None] = None

    @abstractmethod
    def properties(self, tables: Tables) -> Properties | None:
        """Return the properties of a gas with these tables or sides of the box; None if they do not change the gas."""

    def check(self, tables: Tables) -> Iterable[Issue]:
        """Return issues with the table that depend on the box or the walls; called only if the scene has the effect."""
        return ()

    def continued(self, table: Any, later: Later) -> Any:
        """Return the table, or tuple of tables, for a scene that continues from a later time."""
        return table.after(later.time) if hasattr(table, "after") else table

    def exists(self, tables: Tables, start: GasAtStart) -> bool:
        """Whether a run has a state of this effect, by default whether the scene has the effect."""
        return self.find(tables) is not None

    @abstractmethod
    def make(self, tables: Tables, start: GasAtStart) -> State:
        """Return the state at time 0; called only if the effect `exists`."""

    def state_at_start(self, tables: Tables, start: GasAtStart) -> State | None:
        """Return the state at time 0; None if there is none."""
        return self.make(tables, start) if self.exists(tables, start) else None

    def disc_state(self, state: State) -> Arrays:
        """Return the arrays of the state that have an entry for each disc, which checkpoints store.

        Arrays whose columns are also columns of events are stored in event rows and snapshots too.
        """
        return {}

    def constants(self, state: State) -> Arrays:
        """Return the values for each disc that the log stores only once, at the start."""
        return {}

    def values(self, state: State, local_time: float) -> Values:
        """Return the values at a local time that do not belong to individual discs, for checkpoints and samples."""
        return {}

    def restore(self, state: State, arrays: Mapping[str, np.ndarray]) -> None:
        """Set the state to the values of a checkpoint, except for arrays with an entry for each disc.

        arrays: columns of the checkpoint by name.
        """

    def energy(self, state: State, gas: Gas, local_time: float) -> float:
        """Return the energy that the effect contributes at a local time, mass length²/time².

        With gravity, the positions in `gas` are unwrapped.
        """
        return 0.0

    def gives_energy(self, state: State) -> bool:
        """Whether walls exchange energy with discs because of this effect."""
        return False

    def own_walls(self, state: State) -> tuple[int, ...]:
        """Numbers of the walls whose own energy is in the energy account, so that they supply none from outside."""
        return ()

    def driving_speed(self, state: State, gas: Gas) -> float:
        """Estimated increase in the mean speed of the discs due to the effect, length/time.

        The lengths of epochs and the units of sums depend on this estimate.
        """
        return 0.0

    def driving_energy(self, state: State, gas: Gas) -> float:
        """Largest energy that the effect can give to a disc while the disc crosses the box, mass length²/time²."""
        return 0.0

    def begin_epoch(self, state: State, time: float, length: float) -> None:
        """Prepare the state for an epoch that begins at a given time in the run; length: duration of the epoch."""

    def end_epoch(self, state: State, length: float) -> None:
        """Measure local times from the end of the epoch; length: duration of the epoch."""

    def reverse(self, state: State) -> None:
        """Reverse the velocities in the state; called at the start of an epoch."""

    def schedule(self, tables: Tables, start: GasAtStart) -> Iterable[Change]:
        """Return the scheduled changes of values in the state, after time 0."""
        return ()

    def change(self, state: State, item: int, value: float) -> State:
        """Return the state with a new value for an item, as in `schedule`."""
        return state

    def find(self, tables: Tables) -> ActiveEffect | None:
        """Return the keys that turn the effect on, and its properties; None if the scene does not have the effect."""
        keys: tuple[Key, ...]
        if self.many:
            tables_and_keys = ((table, (self.key, i)) for i, table in enumerate(tables.table) if table is not None)
            keys = tuple(dict.fromkeys(getattr(table, "declared", key) for table, key in tables_and_keys))
        elif self.key:
            keys = ((self.key,),) if tables.table is not None else ()
        else:
            sides = zip(SIDES, tables.sides, strict=False)
            keys = tuple(("box", name) for name, side in sides if side == self.side or type(side) is self.side)
        properties = self.properties(tables) if keys or not self.key else None
        return None if properties is None else ActiveEffect(self.name, keys, properties)
