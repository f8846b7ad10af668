"""Equilibrium of the gas of a log: whether the gas has one, and how discs share the energy in equilibrium."""

import math
from collections.abc import Sequence

import numpy as np

from idealgas.errors import NotApplicableError
from idealgas.log import Log
from idealgas.statistics.estimates import mean
from idealgas.theory import conserved
from idealgas.theory import ensemble as ensembles
from idealgas.theory.barometric import ColumnProfile
from idealgas.theory.ensemble import Ensemble, composition

UNLIKELY = 1e-5
"""Probability that a gas in equilibrium is refused because of its mean temperatures, regardless of their number."""

FAR = 0.0455
"""Probability that, at one instant, any temperature of a gas in equilibrium is above the upper bound on its mean.

The probability for the lower bound is the same. If a mean lies beyond the bounds, the exchange of energy takes longer
than the log lasts, and standard errors from the log are too small. For the two temperatures of a single species with
many discs, the bounds are two standard deviations of the temperature at one instant.
"""

ON_A_LINE = 8
"""Smallest number of discs of a species that is refused for a low temperature; fewer discs may move along a line."""

ROUNDING = 1e-9
"""Relative change below which a quantity counts as constant."""


def ensemble(log: Log) -> Ensemble:
    """Return the ensemble of the gas of a log.

    Raises:
        UserError: if the temperature in equilibrium does not follow from the scene.
    """
    known = known_ensemble(log)
    if known is None:
        causes = log.scene.lacking("conserves_energy") or log.scene.lacking("isolated")
        alone = "of a single disc"
        changing = "whose values change in time" if log.scene.properties.varies else ""
        given = f"with {', '.join(causes)}" if causes else changing or alone
        raise NotApplicableError(
            f"{log.path}: this analysis requires the temperature of equilibrium, which does not follow from a scene "
            f"{given}; use `idealgas temperature` to measure it"
        )
    return known


def known_ensemble(log: Log) -> Ensemble | None:
    """Return the ensemble of the gas of a log; None if the scene does not fix it (`theory.ensemble.equilibrium`)."""
    return ensembles.equilibrium(log.scene, log.discs, _spin_energy(log))


def column_temperature(log: Log, axis: int) -> float | None:
    """Return the temperature of the gas of a log under gravity along `axis`; None if unknown (`theory.ensemble`)."""
    return ensembles.column_temperature(log.scene, log.discs, _spin_energy(log), axis)


def column_profiles(log: Log, axis: int) -> list[ColumnProfile]:
    """Return density and temperature by height of an isolated gas under gravity along `axis` (`theory.ensemble`)."""
    return ensembles.column_profiles(log.scene, log.discs, _spin_energy(log), axis)


def tends_to_equilibrium(log: Log) -> bool:
    """Return whether discs exchange energy, so that their speeds approach the Maxwell-Boltzmann distribution."""
    if not log.scene.properties.isolated:
        return True
    _, collisions = log.observables["disc_collisions"]
    return bool(len(collisions) and 2 * collisions[-1] >= len(log.discs))


def _spin_energy(log: Log) -> float:
    """Return the initial rotational energy of all discs, energy."""
    if log.inertia is None or (spin := log.state_at(log.start_time).angular_velocity) is None:
        return 0.0
    return float(log.inertia @ spin**2) / 2


def nonstationary_reason(log: Log) -> str:
    """Return why a gas never becomes stationary, as part of a sentence; empty if nothing is known to prevent it.

    Such a gas is driven by a moving wall, or its losses and gains of energy do not balance.
    """
    scene, properties = log.scene, log.scene.properties
    keeps_energy = properties.collisions_conserve_energy and properties.isolated
    if properties.shear and not keeps_energy:
        return ""  # a heat bath or collisions remove the heat of the shear
    if properties.driven:
        return f"the gas is driven ({', '.join(scene.lacking('fixed_walls'))})"
    if any(properties.free_fall_axes) and (properties.frictionless or keeps_energy):
        return "gravity along periodic sides accelerates or heats the gas"
    if properties.vibrates and keeps_energy:
        return "a vibrating side heats the gas"
    gains = properties.vibrates or any(properties.free_fall_axes) or properties.collisions_give_energy
    if properties.dissipative and properties.isolated and not gains:
        return f"the gas loses energy ({', '.join(scene.lacking('collisions_conserve_energy'))})"
    if properties.collisions_give_energy and properties.isolated and not properties.dissipative:
        return f"the gas gains energy ({', '.join(scene.lacking('collisions_conserve_energy'))})"
    return ""


def nonequilibrium_reason(log: Log) -> str:
    """Return why a gas never reaches equilibrium, as part of a sentence; empty if nothing is known to prevent it."""
    if why := nonstationary_reason(log):
        return why
    scene, properties = log.scene, log.scene.properties
    if not properties.shares_energy:
        return conserved.KEPT
    if properties.varies:
        return "values change in time"
    if any(properties.free_fall_axes):
        return "gravity drives a flow along periodic sides"
    if properties.vibrates:
        return "a side vibrates"
    if properties.shear:
        return "sides shear the gas"
    if properties.one_way:
        return "discs pass a wall in one direction only"
    if len(properties.temperatures) > 1:
        sources = "walls" if properties.bath is None else "walls and heat bath"
        return f"{sources} have {len(properties.temperatures)} temperatures"
    if properties.collisions_give_energy:
        return f"collisions give energy ({', '.join(scene.lacking('collisions_conserve_energy'))})"
    if properties.dissipative:
        return f"the gas loses energy ({', '.join(scene.lacking('collisions_conserve_energy'))})"
    return ""


def equipartition_violation(log: Log, energies: np.ndarray) -> str:
    """Return in which way the energies of a gas violate equipartition, as part of a sentence; empty if they may not.

    energies: (B, S, 2), sums of m vx² and of m vy² over the discs of each species in blocks of time, energy; or (B, 1,
    2), sums over all discs. Along axes with conserved momentum, velocities are relative to the centre of mass.
    """
    ensemble, gas = known_ensemble(log), composition(log.discs)
    from scipy import special

    if ensemble is None or not conserved.is_ergodic(log.scene, log.discs):
        return ""
    if len(log.discs) == 1 and ensemble.dof < math.inf:  # no other disc to share its energy with
        return ""
    number = gas.number[:, None]
    expected, names = number * ensemble.of_axes, [f" of {name}" for name in gas.name]
    if energies.shape[1] == 1:
        expected, number, names = expected.sum(axis=0, keepdims=True), number.sum(keepdims=True), [""]
    rows = max(int(np.count_nonzero(expected)), 1)
    chances = np.array([[1 - FAR / rows], [FAR / rows]])
    lowest, highest = np.asarray(special.chdtri(number[:, 0], chances)) / number[:, 0]
    lowest[number[:, 0] < ON_A_LINE] = 0.0
    for s, name in enumerate(names):
        for axis, letter in enumerate("xy"):
            theory = float(expected[s, axis] / number[s, 0])
            if theory == 0:  # fixed discs
                continue
            warmth = mean(energies[:, s, axis] / number[s], theory)
            dof, deviation = max(warmth.independent_samples - 1, 1.0), abs(warmth.deviation or 0.0)
            far = not lowest[s] <= warmth.value / theory <= highest[s]
            far &= abs(warmth.value - theory) > ROUNDING * ensemble.temperature
            if far or special.stdtr(dof, -deviation) < UNLIKELY / rows / 2:
                return f"m v{letter}²{name} is {warmth.value:.4g} on average, and {theory:.4g} in equilibrium"
    return ""


def becomes_uniform(log: Log, start: float | None) -> bool:
    """Return whether the equilibrium density is uniform after time `start`; None for the detected equilibrium.

    Walls inside the box do not matter if all of them have been removed for good.
    """
    gone = log.scene.properties.last_wall_removed_at
    walls_are_gone = 0 < gone < log.end_time and (start is None or start >= gone)
    uneven = [effect.properties for effect in log.scene.active_effects if not effect.properties.uniform]
    return all(walls_are_gone and not effect.empty for effect in uneven)


def must_apply(log: Log, start: float | None, needs: Sequence[str]) -> None:
    """Refuse a log whose scene lacks a required property or, if no start is given, whose gas never becomes stationary.

    Raises:
        NotApplicableError: in either case.
    """
    if strange := log.scene.lacking(*needs):
        raise NotApplicableError(
            f"{log.path}: this analysis requires a gas without {', '.join(strange)}; use `idealgas evolution` to "
            "follow the gas in time"
        )
    if start is None and (why := nonstationary_reason(log)):
        raise not_steady(log, why)


def must_be_shared(log: Log, energies: np.ndarray) -> None:
    """Refuse a log whose gas looks steady but whose temperatures are not those of equilibrium.

    energies: see `equipartition_violation`.
    """
    if why := equipartition_violation(log, energies):
        raise not_steady(log, why)


def kind_of_state(log: Log) -> str:
    """Return the state that a gas reaches: "equilibrium", or "steady state" if energy flows through it."""
    return "steady state" if nonequilibrium_reason(log) else "equilibrium"


def not_steady(log: Log, why: str) -> NotApplicableError:
    """Return the error for a gas that does not become steady, naming commands that apply; why: part of a sentence."""
    steady = not nonstationary_reason(log) and kind_of_state(log) == "steady state"
    state = "a steady state" if steady else "equilibrium"
    follow = "" if log.scene.properties.shear else "`idealgas evolution` to follow the gas in time, or "
    return NotApplicableError(
        f"{log.path}: this analysis requires {state}, but {why}; use {follow}--from T to set the start by hand"
    )
