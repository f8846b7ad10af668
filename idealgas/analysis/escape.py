"""Measure how discs leave the gas through holes: the number left in time, and escapes per length of path.

Theory is the limit of small holes in an ergodic box: a disc of speed v leaves at the rate v ℓ/(π A) through holes of
length ℓ in walls around an area A.
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
"""Number of instants of the series."""

RARE, OFTEN = 0.1, 10.0
"""Collisions of a disc per escape up to which speeds persist, and from which on the gas is in equilibrium."""

BILLIARD = (
    "Discs hardly ever collide. Theory then requires walls that lead every path to the hole, such as walls that bulge "
    "inwards; those of a circle or a rectangle do not."
)
"""Caveat for discs that only walls deflect."""


@dataclass(frozen=True)
class Escape(Result):
    """Escape of discs through the holes of one log.

    Attributes:
        discs: number of discs at the start of the window.
        escaped: number of these discs that escaped.
        time: (INSTANTS,), times.
        left: (INSTANTS,), number of discs in the gas.
        expected: (INSTANTS,), mean of this number by theory; None without theory.
        spread: (INSTANTS,), its standard deviation, including the error of theory; None without theory.
        per_path: escapes per length of path, 1/length; None under gravity.
        mean_time: time that discs spend in the gas per escape. If escapes do not depend on the time already spent, this
            is the mean escape time, even if not all discs have left.
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
        """Return the tables of the rates and of the number of discs left."""
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
        """Return the number of discs that escaped, and whether their rate agrees with theory."""
        estimate = self.per_path or self.mean_time
        quantity = "escapes per length of path" if self.per_path else "time per escape"
        verdict = agreement([(quantity, estimate)])
        return f"{self.escaped} of {self.discs} discs escaped, {format_estimate(estimate)} {quantity}; {verdict}."

    def figure(self) -> "Figure":
        """Draw the number of discs in the gas with its theory, on a logarithmic scale if less than a tenth is left."""
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
    sections = (Section("Escape", "Number of discs in the gas against time, beside theory"),)
    start = "the log's start"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Escape:
        """Measure how fast discs leave the gas through absorbing walls.

        Errors are those of a Poisson number of escapes. Theory is given for discs of one radius in a box with walls at
        rest and without gravity; the length of the holes and the area are those for the centres of the discs.

        Raises:
            UserError: if no wall absorbs discs, or if the log has no events or no escapes in the window.
        """
        if not log.escapes:
            raise NotApplicableError(f"{log.path}: escape requires a wall that absorbs discs, and this gas has none")
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
            what = "Theory" if theory is None else "Theory of the number left"
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
    """Return the times of the escapes in order, the total time and path of all discs, and the number of collisions.

    A collision of two discs is counted twice, once for each.
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
    """Return the number of escapes per length of path, ℓ/(π A), 1/length.

    The relative error is the sum of ℓ/P, where P is the whole perimeter that discs touch, as a hole depletes the gas in
    front of it; 2φ for the density at the wall; the error for a slit of width ℓ in `effusion`, as discs stream out
    together; and the uncertain part of ℓ around corners of absorbing and other walls.

    Args:
        log: log of the gas.
        number: mean number of discs in the gas.

    Raises:
        NoTheoryError: if theory does not apply.
    """
    scene, gas, radius = log.scene, log.discs, float(log.discs.radius[0])
    if np.ptp(gas.radius) > 0:
        raise NoTheoryError("discs have several radii")
    if not (scene.properties.straight_flight and scene.properties.fixed_walls):
        raise NoTheoryError("gravity acts on the discs, or walls move")
    if any(wall.absorbing and (wall.absences or wall.is_permeable) for wall in scene.walls):
        raise NoTheoryError("a hole opens or closes, or lets discs pass")
    reach = reach_of(log, radius)
    if not reach.holes > 0 or not reach.area > 0:
        raise NoTheoryError("discs do not reach a hole")
    rate = reach.holes / (math.pi * reach.area)
    path = hard_discs.mean_free_path(2 * radius, number / gas.area, number / len(gas) * gas.packing_fraction)
    together = LAW_OFF_PER_PATH * reach.holes / path
    doubt = reach.holes / reach.perimeter + reach.shared / reach.holes + 2 * gas.packing_fraction + together
    if doubt >= 1:
        raise NoTheoryError(f"the holes are {reach.holes / path:.2g} mean free paths long, not small")
    return Theory(rate, rate * doubt, "ℓ/(π A) of a small hole")


def _expected(
    log: Log, speed: np.ndarray, rate: Theory, time: np.ndarray, collisions: float
) -> tuple[np.ndarray, np.ndarray]:
    """Return the mean and standard deviation of the number of discs left, (INSTANTS,), from speeds (N,) at time 0.

    Discs that hardly ever collide keep their speeds. Discs of a gas in equilibrium leave at the rate of its mean speed.
    Without heat from outside the gas cools, as each disc that leaves carries 3T/2 with it: then N ∝ (1 + t/4τ)⁻⁴.

    Raises:
        NoTheoryError: if theory does not apply.
    """
    properties, mass, number = log.scene.properties, float(log.discs.mass[0]), len(speed)
    mixes, lossy = collisions >= OFTEN, properties.dissipative or properties.spins
    if RARE < collisions < OFTEN or len(properties.temperatures) > 1 or properties.varies:
        raise NoTheoryError("discs neither keep their speeds nor come to equilibrium before they leave")
    if mixes and (np.ptp(log.discs.mass) > 0 or lossy):
        raise NoTheoryError(
            "while discs leave, the temperature is not known for mixtures, or with energy losses or spins"
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
