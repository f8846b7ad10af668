"""All effects of a scene as a single argument of the engines, with one field per effect; absent effects are None.

In compiled code a field is always passed to a function before it is compared with None, because numba removes `if
gravity is not None` only in a function whose argument is None. Absent effects therefore produce no machine code.
"""

import math
from collections import namedtuple
from collections.abc import Iterator, Mapping
from dataclasses import replace
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.columns import COUNTED, Arrays, Column, Values
from idealgas.effects import EFFECTS
from idealgas.effects.effect import Effect
from idealgas.physics import stress
from idealgas.physics.exact_sum import add_sums, clear
from idealgas.physics.periodic import unwrapped
from idealgas.state import Gas

ENERGIES = ("wall_energy", "dissipated", "bath_energy", "step_energy")
"""Fields that are sums of energies."""

FIELDS = (*(effect.field for effect in EFFECTS), *ENERGIES, "flow", "schedule")
"""Fields of the bundle: all effects, the sums over a run, and the scheduled changes."""

if TYPE_CHECKING:

    class Effects(tuple):
        """Parameters and state of all effects; mypy cannot see the fields, which are derived from `EFFECTS`."""

        def __new__(cls, **fields: Any) -> "Effects":
            """Create a bundle with these fields; all other fields are None."""
            ...

        def __getattr__(self, name: str) -> Any: ...

        def _replace(self, **fields: Any) -> "Effects": ...

        _fields: tuple[str, ...]

else:
    Effects = namedtuple("Effects", FIELDS, defaults=[None] * len(FIELDS), module=__name__)
    Effects.__doc__ = """Parameters and state of all effects of a scene; None for effects that it does not have.

    In addition to the fields of `EFFECTS`:

    Attributes:
        wall_energy: (walls,) SUM, energy that each wall gave to discs, mass length²/time²; None if no wall gives any.
        dissipated: (1 + walls,) SUM, energy dissipated in collisions of two discs, then in hits on each wall that is
            not thermal, mass length²/time²; None if nothing is dissipated. For a wall at rest, `wall_energy` is minus
            this energy.
        bath_energy: (1,) SUM, energy that the heat bath gave to discs, mass length²/time²; None without a heat bath.
        step_energy: (1,) SUM, energy gained when a potential or velocities are changed, mass length²/time²; None if
            neither can happen.
        flow: accumulated momentum flow of the gas; None if it is not recorded.
        schedule: scheduled changes (time, index of the effect, item, value) in order of time; None without changes.
    """


def for_kernels(effects: Effects) -> Effects:
    """Return the effects without the fields that kernels do not need, and without gravity if it is currently zero.

    The periodic sides receive the shear, which moves their images.
    """
    gravity = effects.gravity if effects.gravity is not None and any(effects.gravity) else None
    periodic = effects.periodic if effects.shear is None else effects.periodic._replace(shear=effects.shear)
    return effects._replace(gravity=gravity, periodic=periodic, schedule=None, steering=None, step_energy=None)


def present(effects: Effects) -> Iterator[tuple[Effect[Any], Any]]:
    """Yield the effects that are present in a bundle, each with its state."""
    for effect in EFFECTS:
        if (state := getattr(effects, effect.field)) is not None:
            yield effect, state


def begin_epoch(effects: Effects, time: float, length: float) -> None:
    """Prepare all effects for an epoch that begins at a given time in the run; length: duration of the epoch."""
    for effect, state in present(effects):
        effect.begin_epoch(state, time, length)


def end_epoch(effects: Effects, length: float) -> None:
    """Finish an epoch: make the local times of all effects count from the end of the epoch.

    length: duration of the epoch, time.
    """
    for effect, state in present(effects):
        effect.end_epoch(state, length)


def next_change(effects: Effects, time: float) -> float:
    """Earliest scheduled change after the given time; infinite if there is none."""
    return next((later for later, *_ in effects.schedule or () if later > time), math.inf)


def changed(effects: Effects, after: float, until: float) -> Effects:
    """Return the effects after all scheduled changes with `after` < time <= `until`.

    `step_energy` is not updated.
    """
    for time, effect, item, value in effects.schedule or ():
        if after < time <= until:
            field = EFFECTS[effect].field
            effects = effects._replace(**{field: EFFECTS[effect].change(getattr(effects, field), item, value)})
    return effects


def energy_parts(effects: Effects, gas: Gas, local_time: float = 0.0) -> dict[str, float]:
    """Energies that the effects contribute, mass length²/time², by field of `idealgas.run.energy.Energy`."""
    if effects.gravity is not None:
        position = unwrapped(gas.position, effects.periodic)
        if effects.absorbing is not None:
            position = np.nan_to_num(position)  # the positions of discs that have left are nan
        gas = replace(gas, position=position)
    return {
        effect.energy_part: effect.energy(state, gas, local_time)
        for effect, state in present(effects)
        if effect.energy_part
    }


def inner_energy(effects: Effects, gas: Gas) -> float:
    """Energy of the discs at time 0 that collisions may convert into kinetic energy, mass length²/time²."""
    return sum(effect.energy(state, gas, 0.0) for effect, state in present(effects) if effect.energy_is_inner)


def counted(effects: Effects) -> tuple[Column, ...]:
    """Columns for the counts of the events that these effects cause."""
    return tuple(COUNTED[effect.events] for effect, _ in present(effects) if effect.events is not None)


def disc_state(effects: Effects) -> Arrays:
    """Arrays of the effects with an entry for each disc, for checkpoints; their times count from the checkpoint."""
    return {column: values for effect, state in present(effects) for column, values in effect.disc_state(state).items()}


def disc_constants(effects: Effects) -> Arrays:
    """Values for each disc that the log stores only once, in addition to motion, radius and mass."""
    return {column: values for effect, state in present(effects) for column, values in effect.constants(state).items()}


def whole_state(effects: Effects, local_time: float = 0.0) -> Values:
    """Values of the effects that do not belong to individual discs, for checkpoints and samples.

    local_time: local time at which the values are computed.
    """
    return {
        column: value
        for effect, state in present(effects)
        for column, value in effect.values(state, local_time).items()
    }


def restore_effects(effects: Effects, arrays: Mapping[str, np.ndarray]) -> None:
    """Set the effects to the state of a checkpoint.

    arrays: columns of the checkpoint by name.
    """
    for column, values in disc_state(effects).items():
        values[:] = arrays[column.name]
    for effect, state in present(effects):
        effect.restore(state, arrays)


def with_own_sums(effects: Effects) -> Effects:
    """Return the same effects with separate sums, set to 0, for a thread whose sums are added to the others later."""
    sums = {name: None if (total := getattr(effects, name)) is None else total.copy() for name in ENERGIES}
    separate = effects._replace(flow=stress.copy_of(effects.flow), **sums)
    clear_sums(separate)
    return separate


def clear_sums(effects: Effects) -> None:
    """Set all sums and numbers of collisions to 0."""
    for sums in _sums(effects):
        clear(sums)
    for counts in _counts(effects):
        counts[...] = 0
    if effects.flow is not None:
        effects.flow.buffer.number[0] = 0


def add_sums_of(effects: Effects, part: Effects) -> None:
    """Add the sums and numbers of collisions of another bundle of the same effects to those of `effects`.

    part: the other bundle, whose buffer must be empty.
    """
    for total, sums in zip(_sums(effects), _sums(part), strict=True):
        add_sums(total, sums)
    for number, counts in zip(_counts(effects), _counts(part), strict=True):
        number += counts


def _sums(effects: Effects) -> list[np.ndarray]:
    """Return all arrays of type SUM."""
    arrays = [] if effects.flow is None else stress.sums_of(effects.flow)
    return [*arrays, *(sums for name in ENERGIES if (sums := getattr(effects, name)) is not None)]


def _counts(effects: Effects) -> list[np.ndarray]:
    """Return all arrays of numbers of collisions."""
    return [] if effects.flow is None else stress.counts_of(effects.flow)
