"""What an effect is: its table in a scene, its state in a run, and what the log keeps of it."""

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
    """The part of a scene that an effect sees.

    Attributes:
        own: its table, None if absent; for an effect with an array of tables a tuple, with None for invalid ones.
        size: width and height of the box, length.
        sides: what the left, right, bottom and top side are; empty while the table of the box is invalid.
        walls: wall segments, None for invalid ones, then fixed discs.
    """

    own: Any
    size: tuple[float, float]
    sides: tuple[Any, ...]
    walls: tuple[Any, ...]


class Start(NamedTuple):
    """The discs at time 0, for an effect that makes its state.

    Attributes:
        gas: the discs.
        seed: seed of the scene.
        acceleration: of the discs at time 0, summed over the effects, length/time².
        angular_velocity: (N,) as the scene gives it, 1/time; 0 where it does not.
        spin_temperature: (N,) energy; 0 where spins are not drawn at random.
        later_accelerations: from later times on.
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
        of: the energy, from the effect's state, the gas (under gravity with unwrapped positions) and the local time.
        observed: its column in the samples; None if they have none.
        inner: whether it belongs to the discs and collisions may turn it into kinetic energy.
    """

    part: str
    of: Callable[[State, Gas, float], float]
    observed: Column | None = None
    inner: bool = False


SAMPLE_DISCS = 1000


class Sample(NamedTuple):
    """What an effect adds to the scene of the benchmark: SAMPLE_DISCS discs at temperature 1 in a square box.

    Attributes:
        name: added to the name of the effect, if it has several samples.
        box: keys of `[box]`, from the length of the box's sides.
        tables: further tables, from the same length.
    """

    name: str = ""
    box: Callable[[float], str] = lambda side: ""
    tables: Callable[[float], str] = lambda side: ""


@dataclass(frozen=True)
class EffectSpec(Generic[State]):
    """One effect, with functions of its state, which `make` returns and the engine then changes.

    Attributes:
        name: in output and messages.
        field: of the bundle of all effects (`idealgas.effects.bundle`).
        properties: how its tables, or sides of the box, change the gas; None if they change nothing.
        make: the state at time 0; called if the scene has the effect.
        make_always: whether `make` is called for every scene; it then may return None.
        key: of its table in a scene; empty if it is only a kind of side, or a key of other tables.
        table: its table, a Pydantic model.
        many: whether the scene has an array of such tables.
        description: of the table, for the JSON Schema.
        side: a kind of side of the box: a word, or a table with one key.
        side_text: how such a side is written.
        check: issues of its table that need the box or the walls; called if the scene has the effect and a valid box.
        disc_state: the arrays of the state, one entry per disc, that a checkpoint stores; those that are columns of
            events are in event rows and snapshots too.
        constants: values per disc that the log stores once, at the start.
        values: values of the effect as a whole that checkpoints and samples store, at a local time.
        restore: set the state to the values of a checkpoint, by name, except for those per disc.
        energy: the part of the energy that it adds.
        gives_energy: whether walls give energy to discs, or take some.
        own_walls: numbers of walls whose energy is part of the energy account, so that they give none from outside.
        counted: total number of its own events.
        begin_epoch: prepare the state for an epoch that begins at a time, counted from the start of the run, and has a
            length (time).
        reverse: turn the velocities of the state around, at the start of an epoch.
        end_epoch: count local times from the end of an epoch of some length (time).
        schedule: changes in time of values of the state, after time 0.
        change: the state with another value of an item.
        samples: scenes of the benchmark.
        sample_together: its part in the scene of all effects together; the first of the samples if None.
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
        """The keys that turn the effect on and what it changes; None if the scene does not have it."""
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
