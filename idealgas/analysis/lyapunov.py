"""Measure Lyapunov exponents: how fast small deviations grow and digits are lost.

With `--exponents K`, the K largest exponents are measured; for N discs the whole spectrum has 4N exponents.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.result import Result
from idealgas.errors import UserError
from idealgas.fields import OMITTED
from idealgas.log import Log
from idealgas.presentation.tables import SHOWN_ROWS, Number, Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate, mean, ratio
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.stream import ReadProgress
from idealgas.tallies.tangent_space import MOST_NUMBERS, TangentVectors, must_have_tangent_map

if TYPE_CHECKING:
    from matplotlib.figure import Figure

ALIGNMENT = 20
"""Events per disc before growth is measured, while the deviations align with the directions of fastest growth."""

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
        exponents: the largest exponents in decreasing order, 1/time.
        mean_free_time: mean free time, averaged over the window and over the discs, time.
        digits: number of decimal digits lost per mean free time (no unit).
        localisation: exp(S)/N, where S = -Σ p ln p and p is the share of a disc in the square of the leading deviation.
            It is 1/N if the deviation is confined to a single disc, and 1 if all discs have equal shares.
        entropy: sum of the positive exponents (Kolmogorov-Sinai entropy), 1/time; None without the whole spectrum.
        pairing: largest |λ_i + λ_(4N+1-i)|, which is 0 for conservative motion, 1/time; None without the whole
            spectrum.
        zeros: number of exponents that are zero because of conservation laws: two for the energy and two for each
            conserved component of the momentum.
        largest_zero: largest magnitude among the exponents that should be zero, 1/time; measured over a time t, it is
            of order ln(t)/t. None without the whole spectrum.
        time: (n,), times from the start of the measurement.
        growth: (n,), natural logarithm of the leading deviation.
    """

    window: Window
    number: int
    exponents: tuple[Estimate, ...]
    mean_free_time: float
    digits: Estimate
    localisation: Estimate
    entropy: Estimate | None
    pairing: float | None
    zeros: int
    largest_zero: float | None
    time: Annotated[np.ndarray, OMITTED]
    growth: Annotated[np.ndarray, OMITTED]

    def lifetime(self, digits: int) -> float:
        """Return the time in which an error in the last of `digits` digits grows to the size of the value itself."""
        return digits * math.log(10) / self.exponents[0].value

    def plain_tables(self) -> list[Table]:
        """Return the tables of the exponents (cut short if there are many), of chaos, and of the loss of digits."""
        exponents = [(f"λ{k}", estimate) for k, estimate in enumerate(self.exponents, 1)]
        notes = [str(self.window), "theory is not available; the largest exponent grows with N"]
        chaos = [
            ("digits lost per collision of a disc (no unit)", self.digits),
            ("fraction of the discs in the leading deviation (no unit)", self.localisation),
        ]
        if self.entropy is not None:
            chaos.append(("Kolmogorov–Sinai entropy: sum of all λ > 0 (1/time)", self.entropy))
            notes.append(f"exponents form pairs λ and −λ to within {self.pairing:.1g}")
            notes.append(f"{self.zeros} exponents vanish by conservation laws, to within {self.largest_zero:.1g}")
        rows = [(f"{digits} digits", Number(self.lifetime(digits), ".3g")) for digits in PRECISIONS]
        return [
            replace(estimates("Lyapunov exponents (1/time)", exponents, notes), most=SHOWN_ROWS),
            estimates(f"Chaos; mean free time {self.mean_free_time:.4g}", chaos),
            Table("Time after which all digits are lost", ("precision", "time"), rows),
        ]

    def summary(self) -> str:
        """Return the headline: the growth rate of deviations and the loss of digits; neither has a theory."""
        return (
            f"Small deviations grow at a rate of λ = {format_estimate(self.exponents[0])}: each collision of a disc "
            f"costs {format_estimate(self.digits)} digits, and float64 has lost its 16 digits after t = "
            f"{self.lifetime(16):.3g}; theory is not available."
        )

    def figure(self) -> "Figure":
        """Draw the growth of the leading deviation and, if several exponents were measured, the spectrum."""
        from idealgas.presentation.style import BLACK, COLOURS, GREY, panels

        figure, axes = panels(1 + (len(self.exponents) > 1))
        largest = self.exponents[0].value
        shown = self.time <= 2 * self.lifetime(32) if self.time[-1] > 2 * self.lifetime(32) else slice(None)
        time, digits = self.time[shown], self.growth[shown] / math.log(10)
        axes[0].plot(time, digits, color=COLOURS[0], label="leading deviation")
        axes[0].plot(time, largest * time / math.log(10), "--", color=BLACK, label=f"λ = {largest:.4g}")
        for lost in PRECISIONS:
            if lost < digits[-1]:
                axes[0].axhline(lost, color=GREY, linewidth=0.8)
        axes[0].set(xlabel="time", ylabel="growth (decimal digits)")
        axes[0].legend()
        for ax in axes[1:]:
            ax.plot(
                range(1, len(self.exponents) + 1),
                [estimate.value for estimate in self.exponents],
                ".",
                color=COLOURS[0],
            )
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
        events per disc is discarded. The standard errors are those of the mean growth rates.

        Raises:
            UserError: if the log does not contain events of smooth elastic discs from an exact method, if a side of
                the box is neither periodic nor a plain wall at rest, if more than 4N exponents are requested, or if
                the window has fewer than 52 events per disc.
        """
        must_have_tangent_map(log)
        number = len(log.discs)
        if exponents > 4 * number:
            raise UserError(f"exponents: {number} discs have {4 * number} (got {exponents})")
        if 4 * number * exponents > MOST_NUMBERS:
            raise UserError(f"exponents: at most {MOST_NUMBERS // (4 * number)} of {number} discs (got {exponents})")
        window = measure(log, [], start, end)
        steps = list(_steps(log, window, exponents, progress))[ALIGNMENT:]
        if len(steps) < FEWEST:
            raise UserError(
                f"{log.path}: too short for Lyapunov exponents, which require {ALIGNMENT + FEWEST} events per disc"
            )
        durations, logs, shares, collisions = (np.array(column) for column in zip(*steps, strict=True))
        spectrum = tuple(ratio(logs[:, k], durations) for k in range(exponents))
        free_time = number * durations.sum() / (2 * collisions.sum()) if collisions.any() else math.inf
        values = np.array([estimate.value for estimate in spectrum])
        zeros = 2 * (1 + sum(log.scene.properties.conserves_momentum))
        whole = exponents == 4 * number
        middle = slice(2 * number - zeros // 2, 2 * number + zeros // 2)
        return Lyapunov(
            window,
            number,
            spectrum,
            free_time,
            _scaled(spectrum[0], free_time / math.log(10)),
            mean(shares),
            ratio(np.where(values > 0, logs, 0.0).sum(axis=1), durations) if whole else None,
            float(np.abs(values + values[::-1]).max()) if whole else None,
            zeros,
            float(np.abs(values[middle]).max()) if whole else None,
            durations.cumsum(),
            logs[:, 0].cumsum(),
        )


def _scaled(estimate: Estimate, factor: float) -> Estimate:
    return Estimate(estimate.value * factor, estimate.standard_error * factor, estimate.independent_samples)


def _steps(
    log: Log, window: Window, exponents: int, progress: ReadProgress | None
) -> Iterator[tuple[float, np.ndarray, float, int]]:
    """Yield, for each interval of N event rows, its duration, growth, localisation and number of collisions.

    The growth (K,) is the logarithm of the factor by which each deviation grew; the localisation is that of the leading
    deviation, see `Lyapunov`.
    """
    number, masses = len(log.discs), log.discs.mass
    if exponents == 4 * number:  # conjugate pairs stay conjugate, so that their exponents are ±λ in each interval
        components = np.arange(4 * number).reshape(number, 4)
        start = np.zeros((4 * number, 4 * number))
        start[[*components[:, :2].ravel(), *components[::-1, :1:-1].ravel()], range(4 * number)] = 1.0
    else:
        start = np.linalg.qr(np.random.default_rng(0).normal(size=(4 * number, exponents)))[0]
    weight = np.repeat(np.sqrt(masses), 4)[:, None]
    followed = TangentVectors(log, window.start, (start / weight).reshape(number, 4, exponents))
    begun, collisions = window.start, 0
    for now, pairs in followed.until(window.end, number, progress):
        collisions += pairs
        if now > begun:
            q, r = np.linalg.qr(followed.now(now).reshape(4 * number, exponents) * weight)
            shares = (q[:, 0] ** 2).reshape(number, 4).sum(axis=1)
            shares = shares[shares > 0]
            localisation = math.exp(-float(shares @ np.log(shares))) / number
            yield now - begun, np.log(np.abs(np.diag(r))), localisation, collisions
            followed.values[:] = (q / weight).reshape(number, 4, exponents)
            begun, collisions = now, 0
