"""What a run asks of an effect; each file beside this one answers for one effect, with its `SLICE`."""

from collections.abc import Callable, Mapping
from dataclasses import dataclass
from typing import Any, NamedTuple

from idealgas.events import Arrays, Column, Values
from idealgas.physics.effects import Effects
from idealgas.scene import Scene
from idealgas.state import Gas


class EnergyPart(NamedTuple):
    """A part of the energy that an effect adds.

    part: a field of `idealgas.run.energy.Energy`. of: the energy, from the effect's state, the gas and the local time.
    observed: the column of the samples that holds it, None if they do not. inner: whether it is of the discs, beside
    their motion, and may become motion in collisions.
    """

    part: str
    of: Callable[[Any, Gas, float], float]
    observed: Column | None = None
    inner: bool = False


def no_arrays(_: Any) -> Arrays:
    """Nothing of a disc."""
    return {}


def no_values(_: Any, __: float) -> Values:
    """Nothing of the whole."""
    return {}


def keep(_: Any, __: Mapping[str, Any]) -> None:
    """There is nothing to restore beyond arrays by disc."""


@dataclass(frozen=True)
class Slice:
    """One effect. The state is what `make` gave, and what the engine has made of it since.

    field: name in the bundle of `idealgas.physics.effects`. make: the state at time 0, from a scene and its discs; None
    if the scene does not call for the effect. disc_state: what a checkpoint keeps of each disc, the state's own arrays;
    those of them that are columns of events are in rows and snapshots too. constants: what the log keeps of each disc
    at the start. values: what checkpoints and samples keep of the effect as a whole, at a local time. restore: give the
    state the values of a checkpoint, by name; arrays by disc are restored without it. gives_energy: whether walls give
    energy to discs, or take some, by this effect. loses_energy: whether energy is lost in collisions by it. own_wall:
    number of a wall whose energy is counted as its own, so that what it gives is not from outside. counted: the total
    of events that only this effect has; a log without the effect has no such column. conserves: whether the account of
    the walls has all energy that is lost by this effect, among all; logs of before have no other.
    """

    field: str
    make: Callable[[Scene, Gas], Any]
    disc_state: Callable[[Any], Arrays] = no_arrays
    constants: Callable[[Any], Arrays] = no_arrays
    values: Callable[[Any, float], Values] = no_values
    restore: Callable[[Any, Mapping[str, Any]], None] = keep
    energy: EnergyPart | None = None
    gives_energy: Callable[[Any], bool] = lambda state: False
    loses_energy: Callable[[Any], bool] = lambda state: False
    own_wall: Callable[[Any], int | None] = lambda state: None
    counted: Column | None = None
    conserves: Callable[[Effects], bool] = lambda effects: True
