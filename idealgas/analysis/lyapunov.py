"""Measure Lyapunov exponents: how fast small deviations grow and digits are lost.

With `--exponents K`, the K largest exponents are measured. The whole spectrum of N discs has 4N exponents, and 2 more
for each piston of finite mass; discs that do not interact have 4 each.
"""

import math
from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from itertools import chain
from typing import TYPE_CHECKING, Annotated, NamedTuple, cast

import numpy as np

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.result import Result
from idealgas.errors import UserError
from idealgas.fields import OMITTED
from idealgas.log import Log
from idealgas.presentation.tables import SHOWN_ROWS, Number, Table, estimates, format_estimate
from idealgas.statistics.estimates import ENOUGH_REPLICATES, Estimate, mean, ratio
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.stream import ReadProgress
from idealgas.tallies.tangent_space import MOST_NUMBERS, Bodies, TangentVectors, must_have_tangent_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALIGNMENT = 20
"""Mean number of events per disc before growth is measured, while deviations align with the directions of growth."""

FEWEST = 32
"""Smallest number of intervals, of one event per disc each, in which growth is measured."""

PRECISIONS = (7, 16, 32)
"""Numbers of decimal digits for which the time until they are lost is predicted."""


@dataclass(frozen=True)
class Lyapunov(Result):
    """Lyapunov exponents of a gas.

    Attributes:
        window: window of time that was used.
        number: number N of discs.
        exponents: the largest exponents in decreasing order, 1/time; means over the discs if these do not interact.
        per_collision: largest exponent per collision of a disc with another disc or a wall (no unit).
        mean_free_time: mean time between collisions of a disc with other discs or, if there are none, with walls,
            averaged over the window and over the discs, time.
        digits: number of decimal digits lost per mean free time (no unit).
        localisation: exp(S)/N, where S = -Σ p ln p and p is the share of a disc in the square of the leading deviation.
            It is 1/N if the deviation is confined to a single disc, and 1 if all discs have equal shares. None for
            independent discs.
        entropy: sum of the positive exponents (Kolmogorov-Sinai entropy), 1/time; None without the whole spectrum.
        pairing: largest |λ_i + λ_j| of the i-th exponent from the top and the j = i-th from the bottom, which is 0 for
            elastic motion, 1/time; None without the whole spectrum, or if collisions are not elastic.
        zeros: number of exponents that are zero because of conservation laws: two for the energy and two for each
            conserved component of the momentum; 0 if collisions are not elastic.
        largest_zero: largest magnitude among the exponents that should be zero, 1/time; measured over a time t, it is
            of order ln(t)/t. None without the whole spectrum, or without such exponents.
        time: (n,), times from the start of the measurement.
        growth: (n,), natural logarithm of the leading deviation.
    """

    window: Window
    number: int
    exponents: tuple[Estimate, ...]
    per_collision: Estimate
    mean_free_time: float
    digits: Estimate
    localisation: Estimate | None
    entropy: Estimate | None
    pairing: float | None
    zeros: int
    largest_zero: float | None
    time: Annotated[np.ndarray, OMITTED]
    growth: Annotated[np.ndarray, OMITTED]

    def lifetime(self, digits: int) -> float:
        """Return the time in which an error in the last of `digits` digits grows to the value; infinite if λ1 <= 0."""
        rate = self.exponents[0].value
        return digits * math.log(10) / rate if rate * self.time[-1] > 1e-9 else math.inf  # less is due to rounding

    def plain_tables(self) -> list[Table]:
        """Return the tables of the exponents (cut short if there are many), of chaos, and of the loss of digits."""
        exponents = [(f"λ{k}", estimate) for k, estimate in enumerate(self.exponents, 1)]
        notes = [str(self.window), "theory is not available"]
        chaos = [
            ("λ1 per collision with a wall or a disc (no unit)", self.per_collision),
            ("digits lost per collision of a disc (no unit)", self.digits),
        ]
        if self.localisation is not None:
            notes[-1] += "; the largest exponent grows with N"
            chaos.append(("fraction of the discs in the leading deviation (no unit)", self.localisation))
        elif self.number > 1:
            notes.append(f"means over {self.number:,} independent discs")
        if self.entropy is not None:
            chaos.append(("Kolmogorov–Sinai entropy: sum of all λ > 0 (1/time)", self.entropy))
        if self.pairing is not None:
            notes.append(f"exponents form pairs λ and −λ to within {self.pairing:.1g}")
        if self.largest_zero is not None:
            notes.append(f"{self.zeros} exponents vanish due to conservation laws, to within {self.largest_zero:.1g}")
        never = "never" if math.isinf(self.lifetime(1)) else None
        rows = [(f"{digits} digits", Number(self.lifetime(digits), ".3g", instead=never)) for digits in PRECISIONS]
        return [
            replace(estimates("Lyapunov exponents (1/time)", exponents, notes), most=SHOWN_ROWS),
            estimates(f"Chaos; mean free time {self.mean_free_time:.4g}", chaos),
            Table("Time after which all digits are lost", ("precision", "time"), rows),
        ]

    def summary(self) -> str:
        """Return the headline: the growth rate of deviations and the loss of digits; neither has a theory."""
        if math.isinf(self.lifetime(1)):
            return f"Small deviations do not grow exponentially: λ = {format_estimate(self.exponents[0])}."
        return (
            f"Small deviations grow at a rate of λ = {format_estimate(self.exponents[0])}: each collision of a disc "
            f"costs {format_estimate(self.digits)} digits, and float64 has lost its 16 digits after t = "
            f"{self.lifetime(16):.3g}; theory is not available."
        )

    def figure(self) -> "Figure":
        """Draw the growth of the leading deviation and, if several exponents were measured, the spectrum."""
        from idealgas.presentation.style import BLACK, COLOURS, GREY, panels

        figure, axes = panels(1 + (len(self.exponents) > 1))
        values = [estimate.value for estimate in self.exponents]
        shown = slice(max(self.time.searchsorted(2 * self.lifetime(32), "right"), 2))
        time, digits = self.time[shown], self.growth[shown] / math.log(10)
        axes[0].plot(time, digits, color=COLOURS[0], label="leading deviation")
        axes[0].plot(time, values[0] * time / math.log(10), "--", color=BLACK, label=f"λ = {values[0]:.4g}")
        for lost in PRECISIONS:
            if lost < digits[-1]:
                axes[0].axhline(lost, color=GREY, linewidth=0.8)
        axes[0].set(xlabel="time", ylabel="growth (decimal digits)")
        axes[0].legend()
        for ax in axes[1:]:
            ax.plot(range(1, len(values) + 1), values, ".", color=COLOURS[0])
            ax.axhline(0, color=GREY, linewidth=0.8)
            ax.set(xlabel="index of the exponent", ylabel="exponent (1/time)")
        return figure


class LyapunovAnalysis(Analysis):
    """Lyapunov exponents of smooth elastic discs in a box, from the tangent map of each flight and collision."""

    position = 105
    headline = "exponents.0"
    results = (Lyapunov,)
    options = (
        Option(
            "exponents",
            int,
            "Number of exponents to measure, from the largest down; 4N is the whole spectrum.",
            default=1,
            least=1,
            metavar="K",
        ),
    )
    sections = (Section("Chaos", "Growth of a small deviation of all positions and velocities"),)

    @staticmethod
    def measure(
        log: Log,
        start: float | None = None,
        end: float | None = None,
        progress: ReadProgress | None = None,
        exponents: int = 1,
    ) -> Lyapunov:
        """Measure Lyapunov exponents between two times of a log.

        The exact tangent map propagates deviations through the recorded flights and collisions, and the deviations are
        orthogonalised once per event per disc (Benettin et al., Meccanica 15, 9 (1980)). The growth during the first 20
        events per disc is discarded. The standard errors are those of the mean growth rates. Discs that do not interact
        are independent systems with 4 exponents each; the result is the mean over the discs.

        Raises:
            UserError: if the log does not contain events from an exact method, if the tangent map of an effect is not
                available, if more exponents are requested than exist, or if the window has fewer than 52 events per
                disc.
        """
        must_have_tangent_map(log)
        bodies, number, gas = Bodies(log), len(log.discs), log.scene.properties
        dimension = len(bodies.free)
        if exponents > dimension:
            who = "each disc has" if bodies.systems > 1 else f"{number} discs have"
            raise UserError(f"exponents: {who} {dimension} (got {exponents})")
        if exponents > (most := MOST_NUMBERS // (4 * len(bodies.mass))):
            raise UserError(f"exponents: at most {most} for {number} discs (got {exponents})")
        window = measure(log, [], start, end)
        per_disc = (log.row_at(window.end, "right") - log.row_at(window.start, "right")) / number
        if per_disc < ALIGNMENT + FEWEST:
            raise UserError(
                f"{log.path}: too short for Lyapunov exponents, which require {ALIGNMENT + FEWEST} events per disc"
            )
        aligned, rows = window.start + window.duration * ALIGNMENT / per_disc, []
        total = np.zeros((bodies.systems, exponents))
        for step in _steps(log, (window.start, aligned, window.end), bodies, exponents, progress):
            rows.append((step.duration, step.growth.mean(axis=0), step.localisation, step.met.mean()))
            total += step.growth
        durations, growth, shares, met = (np.array(column) for column in zip(*rows, strict=True))
        duration, met, events = durations.sum(), step.met.sum(), np.diff(met, prepend=0.0)
        free_time = number * duration / (met - step.hits or met)
        time, series = durations.cumsum(), growth[:, 0].cumsum()
        average = cast(Callable[[np.ndarray, np.ndarray], Estimate], ratio)
        if bodies.systems >= ENOUGH_REPLICATES:  # each disc is a sample of its own
            growth, durations, events = total, np.full(number, duration), step.met
            average = _ratio_of_discs
        spectrum = tuple(average(growth[:, k], durations) for k in range(exponents))
        values = np.array([estimate.value for estimate in spectrum])
        keeps_energy = not (gas.driven or gas.vibrates or gas.varies)
        zeros = 2 * (keeps_energy + sum(gas.conserves_momentum)) if gas.elastic else 0
        whole, middle = exponents == dimension, values[(dimension - zeros) // 2 : (dimension + zeros) // 2]
        return Lyapunov(
            window,
            number,
            spectrum,
            average(growth[:, 0], events),
            free_time,
            spectrum[0].times(free_time / math.log(10)),
            mean(shares) if bodies.systems < number else None,
            average(np.where(values > 0, growth, 0.0).sum(axis=1), durations) if whole else None,
            float(np.abs(values + values[::-1]).max()) if whole and gas.elastic else None,
            zeros,
            float(np.abs(middle).max()) if whole and zeros else None,
            time,
            series,
        )


def _ratio_of_discs(numerator: np.ndarray, denominator: np.ndarray) -> Estimate:
    """Return the ratio of the means of two quantities (N,) over N independent discs."""
    value, number = numerator.sum() / denominator.sum(), len(numerator)
    scatter = np.std(numerator - value * denominator, ddof=1) / denominator.mean()
    return Estimate(float(value), float(scatter) / math.sqrt(number), float(number))


class _Step(NamedTuple):
    """Growth in an interval with N collisions of a disc; the last interval may contain fewer.

    Attributes:
        duration: length of the interval, time.
        growth: (S, K), logarithm of the factor by which each of K deviations of each of S independent systems grew.
        localisation: that of the leading deviation, see `Lyapunov`.
        met: (N,), number of collisions of each disc since the deviations were aligned; valid until the next step.
        hits: number of these collisions that were with walls or pistons.
    """

    duration: float
    growth: np.ndarray
    localisation: float
    met: np.ndarray
    hits: int


def _steps(
    log: Log, times: tuple[float, float, float], bodies: Bodies, exponents: int, progress: ReadProgress | None
) -> Iterator[_Step]:
    """Propagate deviations, and orthogonalise those of each independent system at the end of each interval.

    times: start of the deviations, time at which they are aligned and from which growth is yielded, and end. These are
    no times of events, because the mean free time after an event differs from that after any time.
    """
    number, systems, free, moving = len(log.discs), bodies.systems, bodies.free, len(bodies.mass) - 1
    start, random = np.zeros((4 * moving // systems, exponents)), np.random.default_rng(0)
    half = len(free) // 2
    if exponents == 2 * half:  # conjugate pairs stay conjugate, so that their exponents are ±λ in each interval
        axes = np.linalg.qr(random.normal(size=(half, half)))[0]
        start[free[:half], :half], start[free[half:], half:] = axes, axes[:, ::-1]
    else:
        start[free] = np.linalg.qr(random.normal(size=(len(free), exponents)))[0]
    weight = np.repeat(np.sqrt(bodies.mass[:-1]), 4).reshape(systems, -1, 1)
    values = np.zeros((moving + 1, 4, exponents))
    values[:-1] = (start / weight).reshape(moving, 4, exponents)
    begun, followed = times[0], TangentVectors(log, times[0], bodies, values)
    for now in chain(followed.until(times[1], number, progress), followed.until(times[2], number, progress)):
        if now > begun:
            q, r = np.linalg.qr(followed.now(now)[:-1].reshape(systems, -1, exponents) * weight)
            if now > times[1]:
                growth = np.log(np.abs(np.diagonal(r, axis1=1, axis2=2)))
                shares = (q[0, :, 0] ** 2).reshape(-1, 4).sum(axis=1)
                shares = shares[shares > 0]
                localisation = math.exp(-float(shares @ np.log(shares))) / number
                met, hits = np.split(followed.collisions, [number])
                yield _Step(now - begun, growth, localisation, met, hits.sum())
            else:
                followed.collisions[:] = 0
            followed.values[:-1] = (q / weight).reshape(moving, 4, exponents)
            begun = now
