"""Measure how a gas whose discs lose energy in collisions cools: Haff's law, a₂, spin and clusters.

The analysis measures the loss per collision and Haff's time, which are compared with theory to first order in the
Sonine expansion. It also measures the fourth cumulant a₂ of the velocities, for rough discs the ratio of the rotational
to the translational temperature, and the scatter of the numbers of discs in small cells, which grows as clusters form.
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.caveats import narrow
from idealgas.analysis.check import agreement
from idealgas.analysis.cooling.theory import UNTESTED, cooling_theory, law_error, parameters_of
from idealgas.analysis.cooling.uniformity import cells_of, nonuniform, scatter_of
from idealgas.analysis.result import Result
from idealgas.errors import NotApplicableError
from idealgas.log import Log, LogState
from idealgas.presentation.tables import Table, estimates, format_estimate, time_series
from idealgas.statistics.estimates import Estimate, estimate, mean, mean_of_part, parts_of, ratio
from idealgas.tallies.collisions import collisions_per_disc
from idealgas.tallies.stream import ReadProgress, frames, span
from idealgas.theory import granular, hard_discs
from idealgas.theory.conserved import centre_of_mass_velocity, degrees_of_freedom

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTANTS = 257
"""Number of times in the time series."""

FEW = 10
"""Number of discs below which a caveat states that theory assumes many discs."""

FEWEST = 16
"""Smallest number of times in the averaging window."""

SETTLED, FOLDS = 20.0, 5.0
"""Collisions per disc and relaxation times of the temperature ratio after which averaging starts."""

SPREAD = 1.0
"""Upper bound on √N times the relative standard deviation of the temperature among runs, for N discs.

In 24 runs each, the product is 0.50 for e = 0.95 (300 discs, cooled to exp(-3.4) T₀), 0.53 for 100 discs, and 0.86 for
e = 0.8.
"""


@dataclass(frozen=True)
class Cooling(Result):
    """Cooling of a gas, followed over F times and compared with the theory of a uniform gas.

    Attributes:
        time: (F,), times.
        collisions: (F,), mean number of collisions per disc up to each time.
        temperature: (F,), translational temperature in the frame of the centre of mass, energy.
        spin: (F,), rotational temperature (the mean of I ω²), energy; None without spin.
        cumulant: (F,), fourth cumulant a₂ of the velocities.
        scatter: (F,), variance over mean of the numbers of discs in equal cells; 1 for points at random positions.
        flow: (F,), mean square momentum of a cell, relative to that of discs that move independently.
        cells: number of cells.
        law: (F,), theoretical translational temperature, energy; None without theory.
        spin_law: (F,), theoretical rotational temperature, energy; None without theory.
        start: start of the averaging window, time.
        end: end of the averaging window, time.
        last_temperature: translational temperature at the end, energy; theory predicts it for a uniform gas.
        loss: fraction of the temperature that is lost per collision of a disc.
        haff: Haff's time τ in T = T₀/(1 + t/τ)², where T₀ is the temperature at time 0.
        fourth: mean of a₂.
        temperature_ratio: mean of `spin` over `temperature`; None unless discs are rough.
        first_scatter: mean of `scatter` over the first tenth of the collisions.
        last_scatter: mean of `scatter` over the last tenth of the collisions.
        last_flow: mean of `flow` over the last tenth of the collisions.
    """

    time: np.ndarray
    collisions: np.ndarray
    temperature: np.ndarray
    spin: np.ndarray | None
    cumulant: np.ndarray
    scatter: np.ndarray
    flow: np.ndarray
    cells: int
    law: np.ndarray | None
    spin_law: np.ndarray | None
    start: float
    end: float
    last_temperature: Estimate
    loss: Estimate
    haff: Estimate
    fourth: Estimate
    temperature_ratio: Estimate | None
    first_scatter: Estimate
    last_scatter: Estimate
    last_flow: Estimate

    def plain_tables(self) -> list[Table]:
        """Return the table of averages and that of the time series."""
        rows = [
            ("T at the end (energy)", self.last_temperature),
            ("fraction of T lost per collision of a disc", self.loss),
            ("Haff's time τ, T = T₀/(1 + t/τ)² (time)", self.haff),
            ("a₂ = ⟨v⁴⟩/2⟨v²⟩² - 1", self.fourth),
        ]
        if self.temperature_ratio is not None:
            rows.append(("rotational over translational temperature", self.temperature_ratio))
        rows += [
            ("scatter of numbers in cells, first tenth", self.first_scatter),
            ("scatter of numbers in cells, last tenth", self.last_scatter),
            ("mean square momentum of cells, relative to independent discs, last tenth", self.last_flow),
        ]
        notes = (
            f"window: t = {self.start:.6g} to {self.end:.6g}",
            f"{self.cells} cells; scatter of numbers: variance over mean; it and momenta are 1 for independent discs",
        )
        columns = {
            "t": self.time,
            "collisions": self.collisions,
            "temperature": self.temperature,
            "law": self.law,
            "I ω² per disc": self.spin,
            "a₂": self.cumulant,
            "scatter": self.scatter,
            "flow": self.flow,
        }
        return [estimates("Cooling", rows, notes), time_series("Time series", columns)]

    def summary(self) -> str:
        """Return how far and how fast the gas cools, and whether both agree with the theory of a uniform gas."""
        last = self.last_temperature
        rows = [("T at the end", last), ("loss per collision", self.loss), ("Haff's time", self.haff)]
        law = "" if last.theory is None else f" (Haff's law: {last.theory:.4g})"
        return (
            f"The temperature falls from {self.temperature[0]:.4g} to {last.value:.4g}{law} in "
            f"{self.collisions[-1]:.4g} collisions per disc, losing a fraction of {format_estimate(self.loss)} "
            f"per collision. T at the end, loss and Haff's time: {agreement(rows, 'the theory of a uniform gas')}."
        )

    def figure(self) -> "Figure":
        """Draw the temperature against time, and the other series against the number of collisions per disc."""
        from idealgas.presentation.style import COLOURS, GREY, panels

        means = [("a₂ (no unit)", self.cumulant, self.fourth)]
        if self.spin is not None and self.temperature_ratio is not None:
            means.append(("spin over motion (no unit)", self.spin / self.temperature, self.temperature_ratio))
        figure, (ax, *middle, last) = panels(2 + len(means))
        shown = self.time > 0
        ax.plot(self.time[shown], self.temperature[shown], color=COLOURS[0], label="temperature")
        if self.spin is not None:
            ax.plot(self.time[shown], self.spin[shown], color=COLOURS[1], label="I ω² per disc")
        doubt = self.haff.theory_error / self.haff.theory if self.haff.theory else 0.0
        for law, label in ((self.law, "law of a uniform gas"), (self.spin_law, None)):
            if law is not None:
                ax.theory(self.time[shown], law[shown], law_error(law, doubt)[shown], label, GREY)
        ax.set(xscale="log", yscale="log", xlabel="t (time)", ylabel="temperature (energy, k_B = 1)")
        window = self.collisions[self.time.searchsorted([self.start, self.end])]
        for panel, (label, series, average) in zip(middle, means, strict=True):
            panel.plot(self.collisions, series, color=COLOURS[5], linewidth=0.9, label="measured")
            panel.plot(window, [average.value] * 2, color=COLOURS[0], label="mean")
            if average.theory is not None:
                panel.theory(None, average.theory, average.theory_error, color=GREY)
            panel.set(xlabel="collisions per disc", ylabel=label)
        last.plot(self.collisions, self.scatter, color=COLOURS[0], label="numbers: variance over mean")
        last.plot(self.collisions, self.flow, color=COLOURS[1], label="momenta: relative mean square")
        last.set(ylabel=f"in {self.cells} cells (no unit)", xlabel="collisions per disc", yscale="log")
        for panel in (ax, *middle, last):
            panel.legend()
        return figure


class CoolingAnalysis(Analysis):
    """Cooling of a granular gas."""

    position = 30
    headline = "loss"
    supports_polydispersity = False
    results = (Cooling,)
    sections = (
        Section(
            "Cooling",
            "Temperature against time; then the cumulant, the temperature ratio of rough discs, and the scatter of "
            "numbers and momenta in cells against collisions per disc; theory dashed",
        ),
    )
    start = "20 collisions per disc, or more with slow spins"
    reads = "frames"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Cooling:
        """Measure how a gas of equal discs cools due to collisions, and compare it with the theory of a uniform gas.

        Raises:
            NotApplicableError: if anything other than collisions between equal discs changes the energy, or if the log
                is too short.
        """
        parameters, dof, number = parameters_of(log), degrees_of_freedom(log.scene, log.discs), len(log.discs)
        first, last = span(log, None, end)
        t0, s0, _ = _moments(log, log.state_at(log.start_time), dof)
        rate = _collision_rate(log, t0)
        # if Haff's law holds, equal numbers of collisions happen between successive times
        tau = granular.cooling_time(parameters, rate) if math.isfinite(rate) else last - first
        time = np.clip(np.geomspace(tau + first, tau + last, INSTANTS) - tau, first, last)
        temperature, spin, cumulant, scatter, flow = np.empty((5, len(time)))
        shape = cells_of(log)
        for k, state in enumerate(frames(log, time, progress)):
            temperature[k], spin[k], cumulant[k] = _moments(log, state, dof)
            scatter[k], flow[k] = scatter_of(log, state, shape)
        collisions = collisions_per_disc(log, time)
        window = _window(log, time, collisions, granular.relaxation(parameters), start)
        theory = cooling_theory(parameters, rate, (t0, s0), time, number, dof)
        # fluctuations of the exchange of energy between motion and spin are removed from `cooled`
        energy = temperature[window] + number / dof * spin[window]
        cooled = energy * (temperature[window] / energy).mean()
        slopes = np.diff(cooled**-0.5) / np.diff(time[window])  # constant if Haff's law holds
        tenths, at_end = collisions / collisions[-1], float(temperature[-1])
        early, late = (mean_of_part(scatter, part) for part in (tenths <= 0.1, tenths >= 0.9))
        together = mean_of_part(flow, tenths >= 0.9)
        ratio_of_spin = mean(spin[window] / temperature[window], theory.temperature_ratio) if parameters.rough else None
        return Cooling(
            time,
            collisions,
            temperature,
            spin if log.inertia is not None else None,
            cumulant,
            scatter,
            flow,
            cells=int(shape.prod()),
            law=theory.law,
            spin_law=None if log.inertia is None else theory.spin_law,
            start=float(time[window[0]]),
            end=float(time[-1]),
            last_temperature=Estimate(
                at_end, SPREAD * at_end / math.sqrt(number), math.inf, *parts_of(theory.last_temperature)
            ),
            loss=ratio(-np.diff(np.log(cooled)), np.diff(collisions[window]), theory.loss),
            haff=estimate(lambda slope: 1 / (slope * math.sqrt(t0)), slopes, theory=theory.haff),
            fourth=mean(cumulant[window], theory.fourth),
            temperature_ratio=ratio_of_spin,
            first_scatter=early,
            last_scatter=late,
            last_flow=together,
            caveats=(
                *([] if number >= FEW else [f"Theory assumes many discs, but this gas has only {number}."]),
                *([] if parameters.normal >= granular.TESTED_FROM else [UNTESTED]),
                *narrow(log),
                *nonuniform(early.value, late.value, together.value, int(shape.prod())),
            ),
        )


def _collision_rate(log: Log, temperature: float) -> float:
    """Return the theoretical collision rate of a disc, 1/time; inf if the gas is too dense for theory."""
    discs = log.discs
    contacts = hard_discs.box_contacts(discs.radius[:1], [len(discs)], log.box, log.periodic)[0, 0]
    return float(contacts) * hard_discs.mean_relative_speed(temperature, float(discs.mass[0]))


def _window(log: Log, time: np.ndarray, collisions: np.ndarray, relaxation: float, start: float | None) -> np.ndarray:
    """Return the indices of the times over which averages are taken.

    Args:
        log: log of the gas.
        time: (F,), times.
        collisions: (F,), number of collisions per disc up to each time.
        relaxation: relaxation time of the temperature ratio, in collisions per disc.
        start: start of the window, time; by default the window starts when the distribution of the velocities and the
            temperature ratio have settled.

    Raises:
        NotApplicableError: if there are too few times in the window.
    """
    settled = max(SETTLED, FOLDS * relaxation)
    window = np.flatnonzero(collisions >= settled if start is None else time >= start)
    if len(window) < FEWEST:
        raise NotApplicableError(
            f"{log.path}: the log has {collisions[-1]:.3g} collisions per disc, and averaging starts after "
            f"{settled:.3g}; run longer, or use --from T to set the start by hand"
        )
    return window


def _moments(log: Log, state: LogState, dof: int) -> tuple[float, float, float]:
    """Return the translational and rotational temperatures, energy, and a₂ for one state of the gas.

    The bias of a₂ due to the finite number of discs is removed: for D degrees of freedom at fixed energy, a₂ is
    -2/(D + 2) on average in equilibrium.
    """
    square = ((state.velocity - centre_of_mass_velocity(log.scene, log.discs)) ** 2).sum(axis=1)
    spin = 0.0
    if log.inertia is not None and state.angular_velocity is not None:
        spin = float((log.inertia * state.angular_velocity**2).mean())
    cumulant = (dof + 2) / dof * (square**2).mean() / (2 * square.mean() ** 2) - 1
    return float((log.discs.mass * square).sum() / dof), spin, float(cumulant)
