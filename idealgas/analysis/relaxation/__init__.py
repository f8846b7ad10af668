"""Measure the relaxation of the velocities to the Maxwell-Boltzmann distribution.

The relaxation time is the time constant of an exponential fitted to the kurtosis of the velocities; its standard error
follows from the fluctuations of a gas with this number of discs. Several logs are drawn in one figure. DIR is the
folder of a sweep with the analysis "relaxation".
"""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.relaxation.acceptance import Acceptance, acceptance, acceptance_tables
from idealgas.analysis.relaxation.speeds import (
    SpeedDistributions,
    check_steady,
    colliding_span,
    critical_distance,
    fit_decay,
    reduced_energy,
    reduced_energy_cdf,
    relative_entropy,
    speed_distributions,
    speed_table,
)
from idealgas.analysis.result import Result, RunResult
from idealgas.errors import UserError
from idealgas.fields import Key, reported
from idealgas.log import Log
from idealgas.presentation.tables import Cell, Number, Table, format_estimate, with_error
from idealgas.statistics.estimates import Estimate, ks_distance
from idealgas.tallies.collisions import collisions_per_disc
from idealgas.tallies.equilibrium import ensemble
from idealgas.tallies.stream import ReadProgress, frames

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from idealgas.presentation.style import Panel

SAMPLES = 320

SETTLED = 3.0
"""Number of relaxation times after which a gas counts as settled; 5 % of the initial deviation then remains."""

LINEAR = 2.0
"""Relaxation time of the kurtosis near equilibrium, in collisions per disc, for equal discs.

It follows from the first Sonine approximation for elastic discs in two dimensions: van Noije & Ernst, Granular Matter
1, 57 (1998). Far from equilibrium it is longer: nearly 3 for the entire relaxation from equal speeds.
"""

MAXWELLIAN = 2.0
"""Kurtosis of the velocities in an infinite gas in equilibrium."""

FEW = 100
"""Smallest number of discs for which the standard error of the relaxation time is reliable."""

HEADS = ("", "N", "relaxation time", "± s.e.", "settled", "indistinguishable")

NOTES = (
    "The relaxation time is that of the kurtosis. After three relaxation times 5 % of the deviation is left: settled.",
    "Indistinguishable: first time at which the speeds pass a Kolmogorov-Smirnov test at the 5 % level.",
    "A collision counts for both discs. Near equilibrium theory predicts a relaxation time of "
    f"{LINEAR:g} collisions per disc; far from equilibrium it is longer.",
)

DISTANCES = (0.001, 0.002, 0.005, 0.01, 0.02, 0.05, 0.1, 0.2, 0.5)
"""Ticks on the logarithmic axis of Kolmogorov-Smirnov distances."""


@dataclass(frozen=True)
class Relaxation(RunResult):
    """Relaxation of the gas of one log at K instants.

    All quantities are calculated from the reduced energy x = m v²/2T of a disc, whose equilibrium distribution has the
    density exp(-x) for any mass. As the energy is conserved, the excess of Boltzmann's H = ⟨ln f⟩ over its equilibrium
    value is the relative entropy of the distribution with respect to the equilibrium distribution.

    Attributes:
        path: path of the log.
        number: number of discs.
        time: (K,), times.
        collisions: (K,), collisions per disc since the first instant.
        kurtosis: (K,), ⟨v⁴⟩/⟨v²⟩² in reduced energies: 1 for equal speeds, 2 in equilibrium.
        distance: (K,), Kolmogorov-Smirnov distance from the equilibrium distribution.
        entropy: (K,), H - H_eq per disc.
        equilibrium_kurtosis: mean kurtosis for this number of discs in equilibrium.
        critical_distance: distance that one in twenty gases with this number of discs exceeds in equilibrium.
        in_time: fitted relaxation time of the kurtosis, time; None if the initial kurtosis is within its fluctuations
            in equilibrium.
        in_collisions: the same relaxation time in collisions per disc.
        indistinguishable_after: time and collisions per disc at the first instant at which the distance is below the
            critical distance; None if there is no such instant.
        acceptance: acceptance of Monte Carlo trials; None for other methods.
        speeds: speed distributions; None unless they were counted.
    """

    path: str
    number: int
    time: np.ndarray
    collisions: Annotated[np.ndarray, Key("collisions_per_disc")]
    kurtosis: np.ndarray
    distance: np.ndarray
    entropy: np.ndarray
    equilibrium_kurtosis: float
    critical_distance: float
    in_time: Annotated[Estimate | None, Key("relaxation_time")]
    in_collisions: Annotated[Estimate | None, Key("relaxation_collisions_per_disc")]
    indistinguishable_after: dict[str, float] | None
    acceptance: Acceptance | None
    speeds: Annotated[SpeedDistributions | None, Key("speed_distributions")]

    @property
    @reported
    def settled_time(self) -> float | None:
        """Time after which the gas counts as settled; None if no relaxation time was fitted."""
        return SETTLED * self.in_time.value if self.in_time else None


@dataclass(frozen=True)
class Relaxations(Result):
    """Relaxation of the gas of each log."""

    logs: tuple[Relaxation, ...]

    def plain_tables(self) -> list[Table]:
        """Return the tables of speed distributions (if they were counted), relaxation times and Monte Carlo trials."""
        in_time = [_row(r, r.in_time, "time", float(r.time[0])) for r in self.logs]
        in_collisions = [_row(r, r.in_collisions, "collisions_per_disc") for r in self.logs]
        tried = {r.path: r.acceptance for r in self.logs if r.acceptance is not None}
        return [
            *(speed_table(r.path, r.speeds) for r in self.logs if r.speeds is not None),
            Table("Relaxation to Maxwell-Boltzmann, in units of time", HEADS, in_time, NOTES),
            Table("The same in collisions per disc", HEADS, in_collisions),
            *(acceptance_tables(tried) if tried else ()),
        ]

    def summary(self) -> str:
        """Return the headline: the relaxation time of each gas, and the theoretical value near equilibrium."""
        times = [
            f"{log.number} discs in {format_estimate(log.in_collisions)}" for log in self.logs if log.in_collisions
        ]
        theory = (
            f"Theory: {LINEAR:g} near equilibrium; not available for the whole relaxation from equal speeds, which is "
            "slower."
        )
        if not times:
            return f"No relaxation is seen: the velocities are those of equilibrium from the start. {theory}"
        return (
            f"Velocities relax to the Maxwell–Boltzmann distribution: {', '.join(times)} collisions per disc. {theory}"
        )

    def figure(self) -> "Figure":
        """Draw the kurtosis with its fit, the Kolmogorov-Smirnov distance and Boltzmann's H against time.

        With several logs, the left column shows the same quantities against collisions per disc.
        """
        from idealgas.presentation.style import panels

        if len(self.logs) == 1:
            figure, axes = panels(3)
            _draw(axes, self, in_time=True)
        else:
            figure, axes = panels(3, columns=2)
            _draw(axes[::2], self, in_time=False)
            _draw(axes[1::2], self, in_time=True)
        return figure


class RelaxationAnalysis(Analysis):
    """Relaxation to equilibrium."""

    position = 60
    headline = "relaxation_time"
    results = (Relaxation, Relaxations)
    sections = (
        Section(
            "Relaxation",
            "Kurtosis of the velocity, Kolmogorov-Smirnov distance and Boltzmann's H on the way to equilibrium",
        ),
    )
    options = (
        Option(
            "every",
            float,
            "Also show the speed distribution every X trials (Monte Carlo) or X units of time (other runs).",
            positive=True,
            metavar="X",
        ),
    )
    start = "the log's start"
    end = "after 40 collisions per disc"
    reads = "instants"

    @staticmethod
    def measure(
        log: Log,
        start: float | None = None,
        end: float | None = None,
        progress: ReadProgress | None = None,
        every: float | None = None,
    ) -> Relaxation:
        """Follow the relaxation of the speeds to the Maxwell-Boltzmann distribution, and fit the relaxation time.

        Raises:
            UserError: if no two discs collide in the window, or if the kinetic energy of the discs is not constant, so
                that they do not approach a stationary distribution.
        """
        check_steady(log)
        first, last = colliding_span(log, start, end)
        time, number, equilibrium = np.linspace(first, last, SAMPLES + 1), len(log.discs), ensemble(log)
        distance, entropy, kurtosis = np.empty((3, len(time)))
        for k, state in enumerate(frames(log, time, progress)):
            energy = reduced_energy(log, state.velocity, equilibrium)
            if not energy.any():
                raise UserError(f"{log.path}: no disc moves at t = {state.time:g}")
            distance[k], entropy[k] = ks_distance(energy, reduced_energy_cdf), relative_entropy(energy)
            kurtosis[k] = number * (energy**2).sum() / energy.sum() ** 2
        collisions, critical = collisions_per_disc(log, time), critical_distance(number)
        target = 2 / (1 + 2 / equilibrium.dof)
        after = None
        if len(below := np.flatnonzero(distance < critical)):
            after = {"time": float(time[below[0]]), "collisions_per_disc": float(collisions[below[0]])}
        in_collisions = fit_decay(collisions, kurtosis, number, target)
        return Relaxation(
            path=str(log.path),
            number=number,
            time=time,
            collisions=collisions,
            kurtosis=kurtosis,
            distance=distance,
            entropy=entropy,
            equilibrium_kurtosis=target,
            critical_distance=critical,
            in_time=fit_decay(time - first, kurtosis, number, target),
            in_collisions=in_collisions,
            indistinguishable_after=after,
            acceptance=acceptance(log),
            speeds=None if every is None else speed_distributions(log, every, start, end),
            caveats=tuple(_caveats(in_collisions, collisions, kurtosis, number, first > log.start_time)),
        )

    @staticmethod
    def combine(results: Sequence[Relaxation]) -> Relaxations:
        """Combine the results of several logs, in the given order."""
        return Relaxations(tuple(results))


def _caveats(
    fit: Estimate | None, collisions: np.ndarray, kurtosis: np.ndarray, number: int, late: bool
) -> Iterator[str]:
    """Yield caveats on a relaxation time in collisions per disc; late: whether the window starts late."""
    if fit is None:
        return
    if collisions[-1] < fit.value:
        yield (
            f"The log is followed for {collisions[-1]:.2g} collisions per disc, less than the fitted relaxation time "
            f"{fit.value:.2g}, which is therefore an extrapolation."
        )
    if kurtosis[0] > MAXWELLIAN:
        yield (
            f"The error of the relaxation time assumes equal initial speeds; here a few discs are faster than "
            f"most (kurtosis {kurtosis[0]:.3g}, in equilibrium 2), and chance decides how soon they meet others."
        )
    if number < FEW:
        yield f"The error of the relaxation time was calibrated with 200 and 500 discs; this gas has {number}."
    if late:
        yield "The error of the relaxation time assumes a start with equal speeds; later curves scatter more."


def _row(result: Relaxation, fit: Estimate | None, unit: str, start: float = 0.0) -> tuple[Cell, ...]:
    after = result.indistinguishable_after
    return (
        result.path,
        Number(result.number, "d"),
        *(with_error(fit.value, fit.standard_error) if fit else (Number(None, absent="none seen"), Number(None))),
        Number(SETTLED * fit.value if fit else None, ".4g"),
        Number(after[unit] - start if after else None, ".3g", absent="not reached"),
    )


def _draw(axes: "Sequence[Panel]", relaxations: Relaxations, in_time: bool) -> None:
    """Draw three panels against time, or against collisions per disc."""
    from matplotlib.ticker import FixedLocator, NullLocator

    from idealgas.presentation.style import BLACK, curve_style

    kurtosis, distance, entropy = axes
    for k, result in enumerate(relaxations.logs):
        colour, line, _ = curve_style(k)
        name = f"{Path(result.path).stem}, N = {result.number}"
        x, fit = (result.time, result.in_time) if in_time else (result.collisions, result.in_collisions)
        kurtosis.plot(x, result.kurtosis, line, color=colour, linewidth=1.2, label=name)
        if fit is not None:
            start, target = result.kurtosis[0], result.equilibrium_kurtosis
            model = target + (start - target) * np.exp(-(x - x[0]) / fit.value)
            kurtosis.plot(x, model, color=colour, linewidth=2.5, alpha=0.35, label="fitted exponential")
        distance.plot(x, result.distance, line, color=colour, linewidth=1.2, label=name)
        beyond = "exceeded in 5 % of equilibrium gases"
        distance.axhline(result.critical_distance, color=colour, linestyle=":", linewidth=1, label=beyond)
        entropy.plot(x, result.entropy, line, color=colour, linewidth=1.2, label=name)
        for ax in axes:
            ax.set_xlim(x[0], x[-1])
            ax.time_axis() if in_time else ax.set_xlabel("collisions per disc (no unit)")
    kurtosis.axhline(MAXWELLIAN, color=BLACK, linestyle="--", label="Maxwell-Boltzmann")
    kurtosis.set_ylabel("kurtosis ⟨v⁴⟩/⟨v²⟩² (no unit)")
    distance.set(ylabel="KS distance (no unit)", yscale="log")
    distance.yaxis.set_major_locator(FixedLocator(DISTANCES))
    distance.yaxis.set_major_formatter("{x:g}")
    distance.yaxis.set_minor_locator(NullLocator())
    entropy.axhline(0, color=BLACK, linestyle="--", label="equilibrium")
    entropy.set_ylabel("H − H in equilibrium, per disc (no unit)")
    for ax in axes:
        ax.legend()
