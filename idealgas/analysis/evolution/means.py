"""Means of steady series, and the adiabatic exponent and isothermal work of a compression."""

import math

import numpy as np

from idealgas.analysis.evolution.account import Series
from idealgas.analysis.evolution.pressure_series import PressureSeries
from idealgas.analysis.evolution.theory import STEPS, EvolutionLaw, is_crowded, room, work_integral
from idealgas.log import Log
from idealgas.statistics.autoregression import error_of_mean
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.chambers import outward
from idealgas.tallies.equilibration import detect_equilibration
from idealgas.tallies.observables import Observable
from idealgas.theory.values import Theory

LEAST_CHANGE = 0.05
"""Smallest change of the logarithm of the area for which an adiabatic exponent or an isothermal work is given."""

ROUND_TRIPS = 8.0
"""Smallest number of round trips of a disc during a stroke for which the error of γ is reliable.

In 40 runs each, the rms deviation of γ in units of its error is 1.03 with 8 round trips and 0.57 with 0.8: if there are
few round trips, hits are more regular than the differences between successive times suggest.
"""

PARTS = 256
"""Largest number of sections of a stroke from whose work the error of the total work is estimated."""

ROUNDING = 1e-9
"""Relative change below which a temperature counts as constant."""


def mean_position(
    log: Log, series: PressureSeries | None, law: EvolutionLaw | None
) -> tuple[Estimate | None, float | None]:
    """Return the mean position of a single piston of finite mass once it is steady, and the time from which it is.

    The estimate includes the theoretical position. Both results are None without such a piston, or if its position does
    not become steady.
    """
    masses = [piston.mass for piston in log.scene.piston]
    if len(masses) != 1 or not masses[0] or series is None or series.track is None:
        return None, None
    times, (places,) = series.track[0], series.track[1].values()
    start = detect_equilibration([Observable(places)])
    if start is None:
        return None, None
    theory = None if law is None or law.piston is None else Theory(law.piston, law.piston_error, law.text)
    return mean(places[start:], theory), float(times[start])


def mean_temperature(temperature: np.ndarray, law: EvolutionLaw | None) -> Estimate | None:
    """Return the mean of a temperature (F,) once it is steady, with the equilibrium temperature as theory.

    The result is None if the temperature is constant or does not become steady, or if the law does not describe an
    equilibrium.
    """
    if law is None or not law.steady or np.ptp(temperature) <= ROUNDING * temperature.max():
        return None
    start = detect_equilibration([Observable(temperature)])
    return None if start is None else mean(temperature[start:], float(law.temperature[-1]))


def adiabatic_exponent(temperature: np.ndarray, law: EvolutionLaw | None) -> Estimate | None:
    """Return the adiabatic exponent γ = 1 + ln(T₂/T₁)/ln(A₁/A₂) from the start and end of a temperature series (F,).

    Theory predicts the value that follows from the adiabat of these discs, which is 2 for an ideal gas. The standard
    error follows from the deviations between the measured and the adiabatic changes of ln T between successive times.
    The result is None unless a piston compresses the gas without heat exchange and changes its area noticeably.
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
    """Return a caveat for γ if discs make too few round trips during the stroke; time and temperature are (F,)."""
    if exponent is None:
        return ()
    speed = math.sqrt(2 * float(temperature.mean()) / (math.pi * float(log.discs.mass.mean())))  # mean of |vx|
    trips = float(time[-1] - time[0]) * speed / (2 * log.box[log.scene.piston[0].axis])
    if trips >= ROUND_TRIPS:
        return ()
    return (f"Discs make only {trips:.2g} round trips during the stroke: the error of γ may be up to twice too large.",)


def isothermal_work(log: Log, pistons: Series, given: Series) -> Estimate | None:
    """Return the work of a single piston on a gas at the temperature of a heat bath, energy.

    Theory predicts -N T ∫ Z dA/A for a slow piston, which is N T ln(A₁/A₂) for an ideal gas. The standard error follows
    from the deviations from theory in sections of the stroke. The result is None unless a driven piston has gas on one
    side only, the gas has the temperature of a heat bath, and its area changes noticeably.

    Args:
        log: log with the piston.
        pistons: (P,), coordinates of each piston at the times of the samples, length, by name.
        given: (P,), energy that the discs have received from each wall and piston, energy, by name.
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
    chosen = np.unique(np.linspace(0, len(place) - 1, PARTS + 1).astype(int))
    lengths = room(log, place[chosen])
    if abs(math.log(lengths[0] / lengths[-1])) < LEAST_CHANGE or is_crowded(log, float(lengths.min())):
        return None
    grid = np.linspace(lengths.min(), lengths.max(), STEPS + 1)
    expected = -len(gas) * next(iter(properties.temperatures)) * np.diff(work_integral(log, grid, lengths))
    gains = np.diff(work[chosen])
    error, samples = error_of_mean(gains - expected)
    return Estimate(float(gains.sum()), len(gains) * error, samples, float(expected.sum()))
