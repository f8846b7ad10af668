"""Means of an evolution once it is steady; adiabatic exponent and isothermal work of a gas that a piston compresses."""

import math

import numpy as np

from idealgas.analysis.core.autoregression import error_of_mean
from idealgas.analysis.core.chambers import outward
from idealgas.analysis.core.equilibration import detect_equilibration
from idealgas.analysis.core.observables import Observable
from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.evolution.account import Series
from idealgas.analysis.evolution.pressure_series import PressureSeries
from idealgas.analysis.evolution.theory import STEPS, Law, is_crowded, room, work_integral
from idealgas.analysis.theory.values import Theory
from idealgas.log import Log

LEAST_CHANGE = 0.05
"""Smallest change of the logarithm of the area from which an adiabatic exponent follows."""

ROUND_TRIPS = 8.0
"""Least number of round trips of a disc within a stroke with which the error of γ is right.

In 40 runs each, the rms of deviation over error is 1.03 with 8 of them, and 0.57 with 0.8: hits of few round trips are
more regular than their differences from instant to instant show.
"""

PARTS = 256
"""Largest number of parts of the way of a piston whose work gives the error of all of it."""

ROUNDING = 1e-9
"""Relative change below which a temperature is constant."""


def mean_position(log: Log, series: PressureSeries | None, law: Law | None) -> tuple[Estimate | None, float | None]:
    """Mean position of the only piston, with a mass, once it is steady, compared with theory, and since when it is."""
    masses = [piston.mass for piston in log.scene.piston]
    if len(masses) != 1 or not masses[0] or series is None or series.track is None:
        return None, None
    times, (places,) = series.track[0], series.track[1].values()
    start = detect_equilibration([Observable(places)])
    if start is None:
        return None, None
    theory = None if law is None or law.piston is None else Theory(law.piston, law.piston_error, law.text)
    return mean(places[start:], theory), float(times[start])


def mean_temperature(temperature: np.ndarray, law: Law | None) -> Estimate | None:
    """Mean of a temperature (F,) once it is steady, compared with equilibrium; None where it is constant or not steady.

    None too without a law of equilibrium.
    """
    if law is None or not law.steady or np.ptp(temperature) <= ROUNDING * temperature.max():
        return None
    start = detect_equilibration([Observable(temperature)])
    return None if start is None else mean(temperature[start:], float(law.temperature[-1]))


def adiabatic_exponent(temperature: np.ndarray, law: Law | None) -> Estimate | None:
    """Exponent γ of P A^γ = const from a temperature (F,) and the area: 1 + ln(T₂/T₁)/ln(A₁/A₂) between the ends.

    Its theory is the same of the adiabat of these discs, 2 for an ideal gas, and its error that of the changes of the
    temperature between instants against the adiabat. None where no piston compresses the gas without heat.
    """
    if law is None or law.area is None or not (temperature > 0).all():
        return None
    compression = math.log(law.area[0] / law.area[-1])
    if abs(compression) < LEAST_CHANGE:
        return None
    gains, expected = np.diff(np.log(temperature)), np.diff(np.log(law.temperature))
    error, samples = error_of_mean(gains - expected)
    value, theory = (1 + float(changes.sum()) / compression for changes in (gains, expected))
    return Estimate(value, len(gains) * error / abs(compression), samples, theory)


def short_stroke(log: Log, exponent: Estimate | None, time: np.ndarray, temperature: np.ndarray) -> tuple[str, ...]:
    """Caveat of γ from a temperature (F,) at times (F,) between which discs hardly cross the gas."""
    if exponent is None:
        return ()
    speed = math.sqrt(2 * float(temperature.mean()) / (math.pi * float(log.discs.mass.mean())))  # mean of |vx|
    trips = float(time[-1] - time[0]) * speed / (2 * log.box[log.scene.piston[0].axis])
    if trips >= ROUND_TRIPS:
        return ()
    return (f"Discs make only {trips:.2g} round trips within the stroke: the error of γ may be up to twice too large.",)


def isothermal_work(log: Log, pistons: Series, given: Series) -> Estimate | None:
    """Work of the only piston on a gas at the temperature of a heat bath, compared with that of a slow piston, energy.

    Its theory is N T ∫ Z dA/A, N T ln(A₁/A₂) for an ideal gas, and its error that of the work on parts of the way
    against theory. None where no heat bath of one temperature holds that of a gas on one side of a driven piston, or
    where the area hardly changes.

    Args:
        log: with the piston.
        pistons: coordinates of each piston at the times of samples (P,), length.
        given: energy that the discs got before from each wall and piston (P,), energy.
    """
    properties, gas = log.scene.properties, log.discs
    ((name, place),) = pistons.items() if len(pistons) == 1 else (("", np.empty(0)),)
    piston, work = next(iter(log.scene.piston), None), given.get(name)
    uniform = (
        properties.straight_flight
        and properties.collisions_conserve_energy
        and properties.empty
        and not properties.escapes
    )
    if piston is None or work is None or piston.mass or not uniform or len(properties.temperatures) != 1:
        return None
    if properties.shear or len(gas.species_names) > 1 or gas.unlike or not outward(log, piston):
        return None
    some = np.unique(np.linspace(0, len(place) - 1, PARTS + 1).astype(int))
    lengths = room(log, place[some])
    if abs(math.log(lengths[0] / lengths[-1])) < LEAST_CHANGE or is_crowded(log, float(lengths.min())):
        return None
    grid = np.linspace(lengths.min(), lengths.max(), STEPS + 1)
    expected = -len(gas) * next(iter(properties.temperatures)) * np.diff(work_integral(log, grid, lengths))
    gains = np.diff(work[some])
    error, samples = error_of_mean(gains - expected)
    return Estimate(float(gains.sum()), len(gains) * error, samples, float(expected.sum()))
