"""The effects of a scene as arguments of the engines: one field an effect, None if the scene does not have it.

A field is only ever passed on as an argument: numba removes `if gravity is not None` from a function whose argument is
None, so that no machine code is made for an absent effect.
"""

import math
from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np

from idealgas.physics import periodic, piston, restitution, stress, thermostat, wall
from idealgas.physics.exact_sum import add_sums, clear
from idealgas.physics.gravity import Gravity
from idealgas.physics.periodic import Periodic
from idealgas.physics.restitution import Restitution
from idealgas.physics.rotation import Rotation
from idealgas.physics.stress import StressAccumulator
from idealgas.physics.thermal import Thermal
from idealgas.physics.thermostat import Thermostat


class Effects(NamedTuple):
    """Parameters and state of all effects of a scene; None for an effect that the scene does not have.

    Attributes:
        gravity: constant acceleration.
        periodic: periodic sides, and each disc's image.
        segments: (S,) SEGMENT, wall segments and gates inside the box.
        rotation: spins of rough discs.
        restitution: inelastic collisions.
        thermal: walls with a temperature.
        piston: (1,) PISTON.
        thermostat: heat bath that kicks the discs.
        wall_energy: (walls,) SUM, energy that each wall gave to discs, mass length²/time²; None if no wall gives any.
        dissipated: (1 + walls,) SUM, energy that was lost in collisions of two discs, then in hits of each wall that
            emits none, mass length²/time²; None if nothing is lost. What a wall at rest gave is less by what was lost
            there.
        bath_energy: (1,) SUM, energy that the heat bath gave to discs, mass length²/time²; None without one.
        flow: momentum that the gas carries and passes on; None where it is not recorded.
    """

    gravity: Gravity | None = None
    periodic: Periodic | None = None
    segments: np.recarray | None = None
    rotation: Rotation | None = None
    restitution: Restitution | None = None
    thermal: Thermal | None = None
    piston: np.ndarray | None = None
    thermostat: Thermostat | None = None
    wall_energy: np.recarray | None = None
    dissipated: np.recarray | None = None
    bath_energy: np.recarray | None = None
    flow: StressAccumulator | None = None


AT_BEGIN: dict[str, Callable[[Any, float], None]] = {"periodic": periodic.begin_epoch, "segments": wall.begin_epoch}
"""By name of an effect: the function that prepares it for an epoch, called with the epoch's start (time)."""

AT_END: dict[str, Callable[[Any, float], None]] = {
    "restitution": restitution.end_epoch,
    "piston": piston.end_epoch,
    "thermostat": thermostat.end_epoch,
}
"""By name of an effect: the function that finishes an epoch, called with the epoch's length (time)."""

ENERGIES = ("wall_energy", "dissipated", "bath_energy")
"""Fields that are sums of energies."""

CHANGES: dict[str, Callable[[Any, float], float]] = {"segments": wall.next_change}
"""By name of an effect: the function that gives its next change after a time, at which an epoch must end."""


def begin_epoch(effects: Effects, time: float) -> None:
    """Prepare all effects for an epoch that begins at a time, counted from the start of the run."""
    for name, begin in AT_BEGIN.items():
        if (effect := getattr(effects, name)) is not None:
            begin(effect, time)


def end_epoch(effects: Effects, length: float) -> None:
    """Finish an epoch of some length (time): local times of all effects count from its end."""
    for name, end in AT_END.items():
        if (effect := getattr(effects, name)) is not None:
            end(effect, length)


def with_own_sums(effects: Effects) -> Effects:
    """The same effects with sums of their own, which are 0: what several threads add up can be put together."""
    sums = {name: None if (found := getattr(effects, name)) is None else found.copy() for name in ENERGIES}
    own = effects._replace(flow=stress.copy_of(effects.flow), **sums)
    clear_sums(own)
    return own


def clear_sums(effects: Effects) -> None:
    """Set all sums and numbers of collisions to 0."""
    for sums in _sums(effects):
        clear(sums)
    for counts in _counts(effects):
        counts[...] = 0
    if effects.flow is not None:
        effects.flow.buffer.number[0] = 0


def add_sums_of(effects: Effects, part: Effects) -> None:
    """Add to the sums and numbers of collisions what another bundle of the same effects has; no term waits in that."""
    for total, sums in zip(_sums(effects), _sums(part), strict=True):
        add_sums(total, sums)
    for number, counts in zip(_counts(effects), _counts(part), strict=True):
        number += counts


def _sums(effects: Effects) -> list[np.ndarray]:
    """All arrays of SUM."""
    found = [] if effects.flow is None else stress.sums_of(effects.flow)
    return [*found, *(sums for name in ENERGIES if (sums := getattr(effects, name)) is not None)]


def _counts(effects: Effects) -> list[np.ndarray]:
    """All arrays of numbers of collisions."""
    return [] if effects.flow is None else stress.counts_of(effects.flow)


def next_change(effects: Effects, time: float) -> float:
    """Earliest time, after the given one, at which an effect changes by itself; infinite if none does."""
    present = ((getattr(effects, name), change) for name, change in CHANGES.items())
    return min((change(effect, time) for effect, change in present if effect is not None), default=math.inf)
