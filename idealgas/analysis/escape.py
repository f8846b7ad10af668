"""Measure how discs leave the gas through holes: the number of remaining discs, and escapes per unit path length.

In the limit of small holes in an ergodic box, theory predicts that a disc of speed v leaves at a rate of v ℓ/(π A)
through holes of total length ℓ in the walls around an area A.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.check import agreement
from idealgas.analysis.effusion import LAW_OFF_PER_PATH
from idealgas.analysis.result import Result
from idealgas.columns import Kind
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate, time_series
from idealgas.statistics.estimates import Estimate, parts_of
from idealgas.tallies.reach import NEAR, reach_of
from idealgas.tallies.stream import ReadProgress, span
from idealgas.theory import hard_discs
from idealgas.theory.values import NoTheoryError, Theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTANTS = 257
"""Number of times in the time series."""

RARE, OFTEN = 0.1, 10.0
"""Collisions of a disc per escape up to which discs keep their speeds, and above which the gas stays in equilibrium."""

BILLIARD = (
    "Discs hardly ever collide. Theory then requires walls that lead every path to the hole, such as walls that bulge "
    "inwards; the walls of a circle or a rectangle do not."
)
"""Caveat for discs that are deflected almost only by walls."""


@dataclass(frozen=True)
class Escape(Result):
    """Escape of discs through the holes in one log.

    Attributes:
        discs: number of discs at the start of the window.
        escaped: number of these discs that escaped in the window.
        time: (INSTANTS,), times.
        left: (INSTANTS,), number of discs that remain in the gas.
        expected: (INSTANTS,), theoretical mean number of discs that remain; None without theory.
        spread: (INSTANTS,), standard deviation of `left` about `expected`, including the error of theory; None without
            theory.
        per_path: escapes per unit path length, 1/length; None under gravity.
        mean_time: total time that all discs spend in the gas, divided by the number of escapes, time. If the escape
            rate does not depend on the time already spent in the gas, this is the mean escape time, even if some discs
            have not left yet.
    """

    discs: int
    escaped: int
    time: np.ndarray
    left: np.ndarray
    expected: np.ndarray | None
    spread: np.ndarray | None
    per_path: Estimate | None
    mean_time: Estimate

    def plain_tables(self) -> list[Table]:
        """Return the table of escape rates and that of the number of discs in the gas."""
        rows = {"escapes per path (1/length)": self.per_path, "mean escape time (time)": self.mean_time}
        rates = [(name, estimate) for name, estimate in rows.items() if estimate is not None]
        notes = [f"{self.escaped} of {self.discs} discs escaped"]
        series = {
            "t": self.time,
            "discs in the gas": self.left,
            "theory": self.expected,
            "± (s.d.)": self.spread,
        }
        return [estimates("Escape", rates, notes), time_series("Number of discs in the gas", series)]

    def summary(self) -> str:
        """Return the number of discs that escaped, and whether their escape rate agrees with theory."""
        estimate = self.per_path or self.mean_time
        quantity = "escapes per unit path length" if self.per_path else "time per escape"
        verdict = agreement([(quantity, estimate)])
        return f"{self.escaped} of {self.discs} discs escaped, {format_estimate(estimate)} {quantity}; {verdict}."

    def figure(self) -> "Figure":
        """Draw the measured and theoretical numbers of discs, on a logarithmic scale if less than a tenth remains."""
        from idealgas.presentation.style import COLOURS, panels

        figure, (ax,) = panels(1)
        ax.step(self.time, self.left, where="post", color=COLOURS[0], label="discs in the gas")
        if self.expected is not None:
            ax.theory(self.time, self.expected, self.spread, "theory")
        if 0 < self.left[-1] < self.discs / 10:
            ax.set_yscale("log")
        ax.set_ylabel("discs in the gas (no unit)")
        ax.time_axis()
        ax.legend()
        return figure


class EscapeAnalysis(Analysis):
    """Escape through holes."""

    position = 112
    headline = "per_path"
    supports_escapes = True
    results = (Escape,)
    sections = (Section("Escape", "Number of discs in the gas against time, with theory"),)
    start = "the log's start"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Escape:
        """Measure how fast discs leave the gas through absorbing walls.

        The standard errors assume that the number of escapes follows a Poisson distribution. Theory is available for
        discs of equal radius in a box without gravity and with walls at rest. The length of the holes and the area are
        those accessible to the centres of the discs.

        Raises:
            UserError: if no wall absorbs discs, if the log has no events, or if no disc escapes in the window.
        """
        if not log.escapes:
            raise NotApplicableError(f"{log.path}: escape requires a wall that absorbs discs, but there is none")
        log.require_events()
        first, last = span(log, start, end)
        at, spent, path, collisions = _flights(log, first, last, progress)
        if not len(at):
            raise UserError(f"{log.path}: no disc leaves the gas between t = {first:g} and {last:g}")
        state, escaped = log.state_at(first), len(at)
        speed, time = np.hypot(*state.velocity[state.inside].T), np.linspace(first, last, INSTANTS)
        caveats: tuple[str, ...] = ()
        theory = expected = spread = None
        try:
            theory = _theory(log, spent / (last - first))
            expected, spread = _expected(log, speed, theory, time - first, collisions / escaped)
        except NoTheoryError as error:
            what = "Theory" if theory is None else "Theory for the number of remaining discs"
            caveats = (f"{what} is not available: {error}.",)
        if theory is not None and collisions < escaped:
            caveats = (BILLIARD, *caveats)
        per_path = None
        if not log.has_gravity:
            per_path = Estimate(escaped / path, math.sqrt(escaped) / path, math.inf, *parts_of(theory))
        alike = expected is not None and np.ptp(speed) <= NEAR * speed.max() and collisions < RARE * escaped
        expected_time = theory.times(float(speed.mean())).inverse() if theory and alike else None
        mean_time = Estimate(spent / escaped, spent / escaped**1.5, math.inf, *parts_of(expected_time))
        left = len(speed) - at.searchsorted(time, "right")
        return Escape(len(speed), escaped, time, left, expected, spread, per_path, mean_time, caveats=caveats)


def _flights(
    log: Log, first: float, last: float, progress: ReadProgress | None
) -> tuple[np.ndarray, float, float, int]:
    """Return the times of the escapes, and the total flight time, path length and number of collisions of all discs.

    The times are in ascending order. A collision between two discs counts twice, once for each disc.
    """
    at, spent, path, collisions, done = [np.empty(0)], [0.0], [0.0], 0, 0
    rows = log.row_at(last, "right") - log.row_at(first, "right")
    for flights in log.flights([first, last], columns=("start", "end", "kind", "velocity")):
        duration = flights.end - flights.start
        spent.append(float(duration.sum()))
        path.append(float(np.hypot(*flights.velocity.T) @ duration))
        at.append(flights.end[flights.kind == Kind.ESCAPED])
        collisions += int((flights.kind == Kind.DISC).sum())
        done += len(duration)
        if progress is not None:
            progress(min(done, rows), rows)
    return np.concatenate(at), math.fsum(spent), math.fsum(path), collisions


# ── theory ──


def _theory(log: Log, number: float) -> Theory:
    """Return the theoretical number of escapes per unit path length, ℓ/(π A), 1/length.

    The relative error is the sum of four terms: ℓ/P for the depletion of the gas in front of a hole, where P is the
    total perimeter that discs can touch; 2φ for the density at the wall; the error that `effusion` assigns to a slit of
    width ℓ, from which discs stream out together; and the fraction of ℓ that is uncertain because it lies at corners
    between absorbing and other walls.

    Args:
        log: log of the gas.
        number: time average of the number of discs in the gas.

    Raises:
        NoTheoryError: if theory does not apply.
    """
    scene, gas, radius = log.scene, log.discs, float(log.discs.radius[0])
    if np.ptp(gas.radius) > 0:
        raise NoTheoryError("the discs differ in radius")
    if not (scene.properties.straight_flight and scene.properties.fixed_walls):
        raise NoTheoryError("gravity acts on the discs, or walls move")
    if any(wall.absorbing and (wall.absences or wall.is_permeable) for wall in scene.walls):
        raise NoTheoryError("a hole opens or closes, or lets discs pass")
    reach = reach_of(log, radius)
    if not reach.holes > 0 or not reach.area > 0:
        raise NoTheoryError("discs do not reach a hole")
    rate = reach.holes / (math.pi * reach.area)
    path = hard_discs.mean_free_path(2 * radius, number / gas.area, number / len(gas) * gas.packing_fraction)
    together = (LAW_OFF_PER_PATH * reach.holes / path + 2 * gas.packing_fraction) * scene.properties.interacting
    doubt = reach.holes / reach.perimeter + reach.shared / reach.holes + together
    if doubt >= 1:
        raise NoTheoryError(f"the holes are {reach.holes / path:.2g} mean free paths long, not small")
    return Theory(rate, rate * doubt, "ℓ/(π A) of a small hole")


def _expected(
    log: Log, speed: np.ndarray, rate: Theory, time: np.ndarray, collisions: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the theoretical mean and standard deviation of the number of remaining discs, (INSTANTS,).

    Discs that hardly ever collide keep their speeds. In equilibrium, every disc leaves at the rate that follows from
    the mean speed. If no heat is supplied, the gas cools because each disc that leaves carries an energy of 3T/2 on
    average; the number of discs then decays as (1 + t/4τ)⁻⁴, where τ is the mean escape time at the start.

    Args:
        log: log of the gas.
        speed: (N,), speeds of the discs at the start of the window, length/time.
        rate: escapes per unit path length, 1/length.
        time: (INSTANTS,), times since the start of the window.
        collisions: number of collisions between discs per escape, where each collision counts for both discs.

    Raises:
        NoTheoryError: if theory does not apply.
    """
    properties, mass, number = log.scene.properties, float(log.discs.mass[0]), len(speed)
    mixes, lossy = collisions >= OFTEN, properties.dissipative or properties.spins
    if RARE < collisions < OFTEN or len(properties.temperatures) > 1 or properties.varies:
        raise NoTheoryError("discs neither keep their speeds nor reach equilibrium before they leave")
    if mixes and (np.ptp(log.discs.mass) > 0 or lossy):
        raise NoTheoryError(
            "the temperature of the remaining gas is not known for mixtures, or with energy losses or spins"
        )
    if not mixes and (properties.temperatures or lossy):
        raise NoTheoryError("walls or a heat bath change the speeds of discs that hardly ever collide")
    if mixes:
        temperature = next(iter(properties.temperatures), float(mass * (speed**2).mean() / 2))
        speed = np.array([math.sqrt(math.pi * temperature / (2 * mass))])
    cools = mixes and not properties.temperatures

    def share(per_path: float) -> np.ndarray:
        away = per_path * np.multiply.outer(time, speed)
        lasting = (1 + away / 4) ** -4.0 if cools else np.exp(-away)
        return np.asarray(lasting.mean(axis=1))

    mean = share(rate.value)
    doubt = np.abs(share(rate.value - rate.error) - share(rate.value + rate.error)) / 2
    return number * mean, np.hypot(np.sqrt(number * mean * (1 - mean)), number * doubt)
