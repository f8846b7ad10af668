"""To which gases the laws of cooling apply, and what they say of a log."""

import numpy as np

from idealgas.analysis.theory import granular, hard_discs
from idealgas.analysis.theory.granular import GranularParameters
from idealgas.errors import NotApplicableError
from idealgas.log import Log

LOSS_ERROR, TIME_ERROR, RATIO_ERROR = 0.015, 0.025, 0.05
"""Relative errors of the loss per collision, of Haff's time and of the temperature ratio by theory.

As simulations found: 20 runs each of 300 discs at φ = 0.05, with e = 0.8 to 0.98 without spin, and with e = 0.9 or 0.95
and β = 0, 0.5 and 0.9.
"""

CUMULANT_ERROR = 0.05
"""Relative error of a₂: terms of higher order in it."""


def granular_parameters(log: Log) -> GranularParameters:
    """Coefficients of the collisions of the discs of a log.

    Raises:
        NotApplicableError: unless equal discs lose energy in collisions with each other, and nothing else changes it.
    """
    properties, scene = log.scene.properties, log.scene
    found = GranularParameters(
        1.0 if scene.restitution is None else scene.restitution.normal,
        -1.0 if scene.rotation is None else scene.rotation.roughness,
        properties.inertia,
    )
    others = scene.lacking("straight_flight", "fixed_walls", "isolated", "empty")
    why = ""
    if found.normal == 1 and abs(found.roughness) == 1:
        why = "collisions of its discs lose no energy"
    elif others or not (all(log.periodic) or _harmless_walls(log)):
        why = f"more than collisions of discs changes its energy ({', '.join(others) or 'walls'})"
    elif not log.has_positions or not log.has_events:
        why = "it takes events with positions"
    elif len(log.discs.species_names) > 1:
        why = "its discs are of several species, and the laws are those of equal discs"
    elif not log.discs.radius[0] > 0 or not log.discs.kinetic_energy > 0:
        why = "its discs never meet"
    if why:
        raise NotApplicableError(f"{log.path}: {why}")
    return found


def _harmless_walls(log: Log) -> bool:
    """Whether discs keep their energy when they meet walls."""
    table = log.scene.restitution
    return not log.scene.properties.has_rough_walls and (table is None or table.wall == 1)


def collision_rate(log: Log, temperature: float) -> float | None:
    """Collision rate of a disc with Maxwellian velocities, 1/time; None above the range of theory."""
    gas = log.discs
    contacts = hard_discs.box_contacts(gas.radius[:1], [len(gas)], gas.box, log.periodic)[0, 0]
    rate = float(contacts) * hard_discs.mean_relative_speed(temperature, float(gas.mass[0]))
    return rate if np.isfinite(rate) else None


def expected_series(
    parameters: GranularParameters, rate: float | None, temperature: float, spin: float, time: np.ndarray
) -> tuple[np.ndarray, np.ndarray] | None:
    """Temperatures of motion and spin (F,) of the uniform gas at times (F,); None without a rate or a theory."""
    if rate is None or parameters.normal < granular.TESTED_FROM:
        return None
    return granular.homogeneous_cooling(parameters, rate, temperature, spin, time)
