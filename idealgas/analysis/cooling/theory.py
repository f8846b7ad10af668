"""Theory of a gas that cools uniformly, with the errors of the predictions."""

import math
from dataclasses import dataclass

import numpy as np

from idealgas.errors import NotApplicableError
from idealgas.log import Log
from idealgas.theory import granular
from idealgas.theory.granular import GranularParameters
from idealgas.theory.values import Theory

LOSS_ERROR, TIME_ERROR, RATIO_ERROR = 0.015, 0.025, 0.05
"""Relative errors of theory for the loss per collision, Haff's time and the temperature ratio.

They were estimated from simulations of 300 discs at φ = 0.05, with 20 runs for each set of coefficients: e = 0.8 to
0.98 for smooth discs, and e = 0.9 or 0.95 with β = 0, 0.5 and 0.9 for rough discs.
"""

CUMULANT_ERROR = 0.05
"""Relative error of the predicted a₂, due to neglected terms of higher order in a₂."""

UNTESTED = f"Theory is not available below e = {granular.TESTED_FROM:g}."


@dataclass(frozen=True)
class CoolingTheory:
    """Predictions for a gas that cools uniformly; None where theory is not available.

    Attributes:
        law: (F,), translational temperature, energy.
        spin_law: (F,), rotational temperature, energy.
        last_temperature: translational temperature at the last time, energy.
        loss: fraction of the temperature that is lost per collision of a disc.
        haff: Haff's time τ.
        fourth: fourth cumulant a₂ of the velocities of smooth discs.
        temperature_ratio: ratio of the rotational to the translational temperature.
    """

    law: np.ndarray | None = None
    spin_law: np.ndarray | None = None
    last_temperature: Theory | None = None
    loss: Theory | None = None
    haff: Theory | None = None
    fourth: Theory | None = None
    temperature_ratio: Theory | None = None


def cooling_theory(
    parameters: GranularParameters, rate: float, start: tuple[float, float], time: np.ndarray, number: int, dof: int
) -> CoolingTheory:
    """Return the predictions of the theory of homogeneous cooling; all None if e is below the tested range.

    Args:
        parameters: coefficients of the collisions.
        rate: collision rate of a disc at time 0, 1/time; inf if it is not known.
        start: translational and rotational temperatures at time 0, energy.
        time: (F,), times.
        number: number of discs.
        dof: number of degrees of freedom.
    """
    if parameters.normal < granular.TESTED_FROM:
        return CoolingTheory()
    few = 1 / dof

    def expected(value: float, *errors: float) -> Theory:
        """Return a predicted value with the given relative errors, added in quadrature."""
        return Theory(value, math.hypot(*errors) * abs(value), "homogeneous cooling")

    law = spin_law = haff = last = None
    if math.isfinite(rate):
        rate /= dof / (2 * number)  # if momentum is conserved, fewer degrees of freedom share the energy
        law, spin_law = granular.homogeneous_cooling(parameters, rate, *start, time)
        haff = expected(granular.cooling_time(parameters, rate), TIME_ERROR, few)
        last = Theory(float(law[-1]), float(law_error(law, haff.error / haff.value)[-1]), haff.source)
    spin_ratio = granular.temperature_ratio(parameters)
    return CoolingTheory(
        law=law,
        spin_law=spin_law,
        last_temperature=last,
        loss=expected(granular.cooling_per_collision(parameters) * 2 * number / dof, LOSS_ERROR, few),
        haff=haff,
        fourth=None if parameters.rough else expected(granular.fourth_cumulant(parameters.normal), CUMULANT_ERROR),
        temperature_ratio=None if spin_ratio is None else expected(spin_ratio, RATIO_ERROR),
    )


def parameters_of(log: Log) -> GranularParameters:
    """Return the coefficients of the collisions in a log.

    Raises:
        NotApplicableError: unless equal discs lose energy in their collisions and nothing else changes the energy.
    """
    scene, properties = log.scene, log.scene.properties
    parameters = GranularParameters(
        1.0 if scene.restitution is None else scene.restitution.normal,
        -1.0 if scene.rotation is None else scene.rotation.roughness,
        properties.inertia,
    )
    effects = scene.lacking("straight_flight", "fixed_walls", "isolated", "empty", "interacting")
    elastic_walls = not properties.has_rough_walls and (scene.restitution is None or scene.restitution.wall == 1)
    why = ""
    if laws := scene.lacking("constant_restitution"):
        why = f"collisions with constant coefficients of restitution (got {', '.join(laws)}); use `idealgas evolution`"
    elif parameters.normal == 1 and abs(parameters.roughness) == 1:
        why = "collisions that lose energy, but collisions in this gas conserve it"
    elif effects or not (all(log.periodic) or elastic_walls):
        others = ", ".join(effects) or "walls"
        why = f"that only collisions between discs change the energy (got {others}); use `idealgas evolution`"
    elif not log.has_positions or not log.has_events:
        why = "events with positions"
    elif len(log.discs.species_names) > 1:
        why = "equal discs, but this gas has several species"
    elif not log.discs.radius[0] > 0 or not log.discs.kinetic_energy > 0:
        why = "discs that collide, but these discs have no radius or do not move"
    if why:
        raise NotApplicableError(f"{log.path}: cooling requires {why}")
    return parameters


def law_error(law: np.ndarray, relative: float) -> np.ndarray:
    """Return the errors (F,) of temperatures predicted by Haff's law, for a relative error dτ/τ of Haff's time.

    Since T = T₀/(1 + t/τ)², dT/T = 2 (t/τ)/(1 + t/τ) dτ/τ.

    Args:
        law: (F,), predicted temperatures, energy.
        relative: relative error dτ/τ.
    """
    return 2 * (1 - np.sqrt(np.minimum(law / law[0], 1))) * relative * law
