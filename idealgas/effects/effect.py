"""Specification of an effect: its table in a scene, its state in a run, and its columns in the log."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from typing import Any, Generic, NamedTuple, TypeVar

import numpy as np

from idealgas.columns import SIDES, Arrays, Column, Values
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
        own: table of the effect, None if absent; for an effect with an array of tables, a tuple with None for invalid
            tables.
        size: width and height of the box, length.
        sides: kinds of the left, right, bottom and top side; empty while the table of the box is invalid.
        walls: wall segments, with None for invalid tables, followed by fixed discs.
    """

    own: Any
    size: tuple[float, float]
    sides: tuple[Any, ...]
    walls: tuple[Any, ...]


class Start(NamedTuple):
    """The discs at time 0, from which an effect makes its state.

    Attributes:
        gas: the discs.
        seed: seed of the scene.
        acceleration: acceleration of the discs at time 0, summed over the effects, length/time².
        angular_velocity: (N,) angular velocities given in the scene, 1/time; 0 if not given.
        spin_temperature: (N,) temperature of the spins, energy; 0 for discs whose spins are not drawn at random.
        later_accelerations: accelerations from later times on, length/time².
    """

    gas: Gas
    seed: int
    acceleration: tuple[float, float]
    angular_velocity: np.ndarray
    spin_temperature: np.ndarray
    later_accelerations: tuple[tuple[float, float], ...] = ()


class EnergyPart(NamedTuple, Generic[State]):
    """A part of the energy that an effect adds.

    Attributes:
        part: a field of `idealgas.run.energy.Energy`.
        of: function that returns the energy, mass length²/time², from the state of the effect, the gas (under gravity
            with unwrapped positions) and the local time.
        observed: column of this energy in the samples; None if the samples do not contain it.
        inner: whether the energy belongs to the discs and collisions may turn it into kinetic energy.
    """

    part: str
    of: Callable[[State, Gas, float], float]
    observed: Column | None = None
    inner: bool = False


SAMPLE_DISCS = 1000


class Sample(NamedTuple):
    """Addition of an effect to the scene of the benchmark, SAMPLE_DISCS discs at temperature 1 in a square box.

    Attributes:
        name: suffix to the name of the effect, if it has several samples.
        box: function that returns the keys of `[box]` from the length of the box's sides.
        tables: function that returns further tables from this length.
    """

    name: str = ""
    box: Callable[[float], str] = lambda side: ""
    tables: Callable[[float], str] = lambda side: ""


@dataclass(frozen=True)
class EffectSpec(Generic[State]):
    """An effect: its names and tables, and functions of its state, which `make` returns and the engine then changes.

    Attributes:
        name: name in output and messages.
        field: field of the bundle of all effects (`idealgas.effects.bundle`).
        properties: returns the properties of a gas with its tables, or sides of the box; None if they change nothing.
        make: returns the state at time 0; called if the scene has the effect.
        make_always: whether `make` is called for every scene; it may then return None.
        key: key of its table in a scene; empty if the effect is only a kind of side, or a key of other tables.
        table: its table, a Pydantic model.
        many: whether the scene has an array of such tables.
        description: description of the table for the JSON Schema.
        side: kind of side of the box: a word, or a table with a single key.
        side_text: form in which such a side is written.
        check: yields those issues of its table that depend on the box or the walls; called if the scene has the effect
            and a valid box.
        disc_state: returns the arrays of the state, with an entry per disc, that a checkpoint stores; arrays that are
            columns of events are also in event rows and snapshots.
        constants: returns the values per disc that the log stores once, at the start.
        values: returns the values that do not belong to a disc, at a local time, for checkpoints and samples.
        restore: sets the state to these values of a checkpoint, by name; arrays with an entry per disc are restored for
            all effects alike.
        energy: part of the energy that the effect adds.
        gives_energy: whether walls give energy to discs, or take it.
        own_walls: numbers of walls whose energy is part of the energy account, so that they add none from outside.
        counted: column with the total number of the effect's events.
        begin_epoch: prepares the state for an epoch, from the time at its start, counted from the start of the run, and
            its length (time).
        reverse: reverses the velocities in the state, at the start of an epoch.
        end_epoch: lets local times count from the end of the epoch, from its length (time).
        schedule: yields the changes in time of values of the state, after time 0.
        change: returns the state with a new value of an item.
        samples: additions to the scene of the benchmark.
        sample_together: addition to the scene with all effects; the first of the samples if None.
    """

    name: str
    field: str
    properties: Callable[[Tables], Properties | None]
    make: Callable[[Tables, Start], State | None]
    samples: tuple[Sample, ...]
    sample_together: Sample | None = None
    make_always: bool = False
    key: str = ""
    table: type[Table] | None = None
    many: bool = False
    description: str = ""
    side: str | type[Table] | None = None
    side_text: str = ""
    check: Callable[[Tables], Iterable[Issue]] = lambda tables: ()
    disc_state: Callable[[State], Arrays] = lambda state: {}
    constants: Callable[[State], Arrays] = lambda state: {}
    values: Callable[[State, float], Values] = lambda state, local_time: {}
    restore: Callable[[State, Mapping[str, np.ndarray]], None] = lambda state, arrays: None
    energy: EnergyPart[State] | None = None
    gives_energy: Callable[[State], bool] = lambda state: False
    own_walls: Callable[[State], tuple[int, ...]] = lambda state: ()
    counted: Column | None = None
    begin_epoch: Callable[[State, float, float], None] = lambda state, time, length: None
    end_epoch: Callable[[State, float], None] = lambda state, length: None
    reverse: Callable[[State], None] = lambda state: None
    schedule: Callable[[Tables, Start], Iterable[Change]] = lambda tables, start: ()
    change: Callable[[State, int, float], State] = lambda state, item, value: state

    def find(self, tables: Tables) -> ActiveEffect | None:
        """Return the keys that turn the effect on and its properties; None if the scene does not have the effect."""
        keys: tuple[Key, ...]
        if self.many:
            tables_and_keys = ((table, (self.key, i)) for i, table in enumerate(tables.own) if table is not None)
            keys = tuple(getattr(table, "place", key) for table, key in tables_and_keys)
        elif self.key:
            keys = ((self.key,),) if tables.own is not None else ()
        else:
            sides = zip(SIDES, tables.sides, strict=False)
            keys = tuple(("box", name) for name, side in sides if side == self.side or type(side) is self.side)
        properties = self.properties(tables) if keys or not self.key else None
        return None if properties is None else ActiveEffect(self.name, keys, properties)
