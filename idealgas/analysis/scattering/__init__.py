"""Measure density and current correlations in space and time: F(k, t), its self part, S(k, ω) and currents.

The box must be periodic; the wave vectors are parallel to its sides. The analysis also gives the two parts of the van
Hove function, G_s(r, t) and G_d(r, t), and the non-Gaussian parameter of the displacements.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.caveats import narrow
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result
from idealgas.analysis.scattering.displacements import Curve, VanHove, curve_of, non_gaussian, van_hove
from idealgas.analysis.scattering.distinct import Distinct, distinct_parts
from idealgas.analysis.scattering.sums import APART, BINS, FARTHEST, Sums, read, segments, wave_numbers
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate, time_series
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.equilibrium import ensemble
from idealgas.tallies.stream import ReadProgress
from idealgas.theory import enskog, hard_discs
from idealgas.theory.waves import sound_of_discs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEP = 0.25
"""Time between two instants, in units of 1/(k √(T/m)), the time in which a disc of thermal speed flies 1/k."""

LAGS, FEWEST_LAGS = 65, 17
"""Number of lags at which a wave is measured, and the smallest number of lags."""

FEWEST_DECAYS = 100.0
"""Smallest length of the window, in decay times of the longest wave, for which segments are independent."""


@dataclass(frozen=True)
class ScatteringWave:
    """Correlations of the waves of one wave number.

    Attributes:
        name, k: the wave number as text and as a number, 1/length.
        time: (L,), lags.
        density: F(k, t) = ⟨ρ(t)ρ*(0)⟩/N, where ρ = Σ exp(-ikx) (no unit).
        self_part: F_s(k, t) = ⟨exp(-ik(x(t) - x(0)))⟩ (no unit).
        longitudinal, transverse: correlation of the current Σ v exp(-ikx), where v is the velocity component parallel
            or perpendicular to k, over N, (length/time)².
        frequency, spectrum: (W,), ω, 1/time, and S(k, ω) = ∫ F exp(iωt) dt, with a cos² taper of the lags, time.
        structure: S(k) = F(k, 0) (no unit).
        longitudinal_square, transverse_square: mean squares ⟨|j|²⟩/N of the two currents, (length/time)²; k² times the
            first is the second moment of S(k, ω).
        early: F_s at the first nonzero lag.
    """

    name: str
    k: float
    time: np.ndarray
    density: Curve
    self_part: Curve
    longitudinal: Curve
    transverse: Curve
    frequency: np.ndarray
    spectrum: Curve
    structure: Estimate
    longitudinal_square: Estimate
    transverse_square: Estimate
    early: Estimate


SMALL_ERRORS = "Standard errors of some curves may be up to 1.3 times too small, especially for the longest wave."
"""Caveat of all results; in the calibration, the rms deviation over the standard error reached 1.26."""


@dataclass(frozen=True)
class Scattering(Result):
    """Density and current correlations of the gas of one log.

    Attributes:
        window: window of time that was used.
        thermal_speed: √(T/m), length/time.
        waves: correlations of each wave number, from the longest to the shortest wave.
        van_hove: self part of the van Hove function for each wave, after the time in which a free disc of thermal speed
            flies 4/k.
        distinct: distinct part at t = 0 and at the same times; empty for a single disc.
        time: (D,), times.
        non_gaussian: (D,), ⟨Δr⁴⟩/(2⟨Δr²⟩²) - 1 for the displacements in these times (no unit).
    """

    window: Window
    thermal_speed: float
    waves: tuple[ScatteringWave, ...]
    van_hove: tuple[VanHove, ...]
    distinct: tuple[Distinct, ...]
    time: np.ndarray
    non_gaussian: Curve

    def plain_tables(self) -> list[Table]:
        """Return the tables of S(k) and the currents, of the correlations of each wave, and of the displacements."""
        rows = [
            (f"{name}, {wave.name}", estimate)
            for wave in self.waves
            for name, estimate in (
                ("S(k) (no unit)", wave.structure),
                ("⟨|j|²⟩/N along k ((length/time)²)", wave.longitudinal_square),
                ("⟨|j|²⟩/N across k ((length/time)²)", wave.transverse_square),
                (f"F_s at t = {wave.time[1]:.3g} (no unit)", wave.early),
            )
        ]
        notes = [
            str(self.window),
            "theory: (1 − S/N) T/m; free flight and the first collision",
            "errors from 32 segments; in 150 runs, the rms deviation exceeded the error for the current along k of the "
            "longest wave (by a factor of 1.23), S(k, ω) of the shortest wave (1.23) and the current across k of the "
            "third wave (1.19)",
        ]
        tables = [estimates("Waves of density and current", rows, notes)]
        for wave in self.waves:
            curves = {"F": wave.density, "F_s": wave.self_part, "along": wave.longitudinal, "across": wave.transverse}
            tables.append(_series(f"Correlations, {wave.name}", {"t": wave.time}, curves))
            tables.append(_series(f"Spectrum, {wave.name}", {"ω": wave.frequency}, {"S(k, ω)": wave.spectrum}))
        for moved in self.van_hove:
            columns = {"r": moved.distance, "normal": moved.gaussian}
            tables.append(_series(f"Displacements, G_s(r, {moved.time:.4g})", columns, {"G_s": moved.density}))
        for around in self.distinct:
            title = f"Other discs, G_d(r, {around.time:.4g})"
            tables.append(_series(title, {"r": around.distance}, {"G_d": around.density}))
        title = "Non-Gaussian parameter of displacements (no unit)"
        return [*tables, _series(title, {"t": self.time}, {"α₂": self.non_gaussian})]

    def summary(self) -> str:
        """Return the headline: S(k) of the longest wave, and whether the moments of all waves agree with theory."""
        rows = [
            (f"{name}, {wave.name}", estimate)
            for wave in self.waves
            for name, estimate in (
                ("along", wave.longitudinal_square),
                ("across", wave.transverse_square),
                ("F_s", wave.early),
            )
        ]
        first = self.waves[0]
        return f"S(k) is {format_estimate(first.structure)} at {first.name}; currents and F_s: {agreement(rows)}."

    def figure(self) -> "Figure":
        """Draw F, F_s, S(k, ω), both currents, α₂, G_s and G_d; free flight and the normal distribution are dashed."""
        from idealgas.presentation.style import BAND, COLOURS, curve_style, panels

        figure, (density, self_part, spectrum, along, across, gaussian, displaced, distinct) = panels(4, 2)
        for index, wave in enumerate(self.waves):
            colour, line, _ = curve_style(index)
            rate, square = wave.k * self.thermal_speed, self.thermal_speed**2
            for ax, x, curve, unit in (
                (density, wave.time * rate, wave.density, 1.0),
                (self_part, wave.time * rate, wave.self_part, 1.0),
                (spectrum, wave.frequency / rate, wave.spectrum, 1 / rate),
                (along, wave.time * rate, wave.longitudinal, square),
                (across, wave.time * rate, wave.transverse, square),
            ):
                y, error = curve.value / unit, curve.error / unit
                ax.plot(x, y, line, color=colour, label=wave.name)
                ax.fill_between(x, y - error, y + error, color=colour, alpha=BAND, linewidth=0)
        free = np.linspace(0, 5, 100)
        self_part.theory(free, np.exp(-(free**2) / 2), label="free flight")
        y, error = self.non_gaussian.value, self.non_gaussian.error
        gaussian.errorbar(self.time, y, error, fmt="o-", ms=3, color=COLOURS[0], capsize=2)
        gaussian.set(xscale="log", xlabel="t (time)", ylabel="non-Gaussian parameter α₂ (no unit)")
        for index, moved in enumerate(self.van_hove):
            colour, line, _ = curve_style(index)
            x, unit = moved.distance / math.sqrt(moved.square), 1 / moved.square
            y, error = moved.density.value / unit, moved.density.error / unit
            displaced.plot(x, y, line, color=colour, label=f"t = {moved.time:.4g}")
            displaced.fill_between(x, y - error, y + error, color=colour, alpha=BAND, linewidth=0)
        displaced.theory(x, moved.gaussian * moved.square, label="normal distribution")
        displaced.set(yscale="log", xlabel="r/√⟨Δr²⟩ (no unit)", ylabel="G_s(r, t) ⟨Δr²⟩ (no unit)")
        displaced.legend()
        for index, around in enumerate(self.distinct, -1):  # the colours of G_s, and a new colour for t = 0
            colour, line, _ = curve_style(index % len(self.distinct))
            x, y, error = around.distance, around.density.value, around.density.error
            distinct.plot(x, y, line, color=colour, label=f"t = {around.time:.4g}")
            distinct.fill_between(x, y - error, y + error, color=colour, alpha=BAND, linewidth=0)
        distinct.set(xlabel="r (length)", ylabel="G_d(r, t) (1/length²)")
        distinct.legend()
        density.set_ylabel("F(k, t) (no unit)")
        self_part.set_ylabel("self part F_s(k, t) (no unit)")
        spectrum.set(xlabel="ω/(k √(T/m)) (no unit)", ylabel="S(k, ω) k √(T/m) (no unit)")
        along.set_ylabel("current along k, over T/m (no unit)")
        across.set_ylabel("current across k, over T/m (no unit)")
        for ax in (density, self_part, along, across):
            ax.set_xlabel("k √(T/m) t (no unit)")
        for ax in (density, self_part, spectrum, along, across):
            ax.legend()
        return figure


class ScatteringAnalysis(Analysis):
    """Density and current correlations."""

    position = 85
    headline = "waves.*.structure"
    supports_polydispersity = False
    results = (Scattering,)
    sections = (
        Section(
            "Scattering",
            "F(k, t), its self part beside free flight, S(k, ω), currents, both parts of the van Hove function, α₂",
        ),
    )
    reads = "wave numbers"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Scattering:
        """Measure how density waves and current waves decay between two times of a log.

        Standard errors follow from the scatter of 32 segments of the window. At any density, theory for the currents at
        t = 0 is exact: ⟨|j|²⟩/N = (1 - S(k)/N) T/m, as the total momentum is 0. F_s at the first lag is compared with
        free flight up to the first collision, which occurs at Enskog's rate.

        Raises:
            UserError: if the box is not periodic, if there are several species or effects other than periodic sides, or
                if the window is too short.
        """
        if len(log.discs.species_names) > 1 or not all(log.periodic):
            raise NotApplicableError(f"{log.path}: scattering requires a gas of one species in a periodic box")
        window = measure(log, [], start, end, needs=("uniform", "conserves_motion", "interacting"))
        speed, side = math.sqrt(ensemble(log).temperature / float(log.discs.mass[0])), max(log.box)
        waves, displaced, moments = [], [], []
        numbers = (2 * math.pi / side * wave_numbers(log)).tolist()
        for done, k in enumerate(numbers, 1):
            lags = min(LAGS, int(window.duration / 8 / (STEP / (k * speed))) + 1)
            if lags >= FEWEST_LAGS:
                time = STEP / (k * speed) * np.arange(lags)
                series = read(log, window, k, float(time[1]), lags)
                edges = np.linspace(0, FARTHEST * math.sqrt(_mean_square(log, float(time[APART]))), BINS + 1)
                sums = list(segments(log, k, lags, series, edges))
                waves.append(_wave(log, k, time, sums, speed))
                displaced.append(van_hove(float(time[APART]), edges, sums))
                moments.append((time, np.array([segment.moments for segment in sums])))
            if progress is not None:
                progress(done, len(numbers))
        if not waves:
            least = 8 * FEWEST_LAGS * STEP * float(2 * log.discs.radius[0]) / (2 * math.pi * speed)
            raise UserError(f"{log.path}: window too short for waves as long as a diameter (allowed >= {least:.3g})")
        caveats = (SMALL_ERRORS, *narrow(log), *_too_short(log, window, numbers[0], waves[0].k))
        distinct = distinct_parts(log, window, [0.0, *(self_part.time for self_part in displaced)])
        return Scattering(
            window, speed, tuple(waves), tuple(displaced), distinct, *non_gaussian(moments), caveats=caveats
        )


def _wave(log: Log, k: float, time: np.ndarray, sums: list[Sums], speed: float) -> ScatteringWave:
    """Return the correlations of a wave from the sums of all segments; speed: √(T/m)."""
    density, self_part, along, across, *_ = (np.array(parts) for parts in zip(*sums, strict=True))
    taper = np.cos(math.pi / 2 * time / time[-1]) ** 2 * np.where(time > 0, 2.0, 1.0) * time[1]
    frequency = math.pi / time[-1] * np.arange(len(time) // 2 + 1)
    spectrum = density @ (taper[:, None] * np.cos(time[:, None] * frequency))
    current = speed**2 * (1 - float(density[:, 0].mean()) / len(log.discs))
    return ScatteringWave(
        name=f"k = {k:.4g}",
        k=k,
        time=time,
        density=curve_of(density),
        self_part=curve_of(self_part),
        longitudinal=curve_of(along),
        transverse=curve_of(across),
        frequency=frequency,
        spectrum=curve_of(spectrum),
        structure=_first(density, 0),
        longitudinal_square=_first(along, 0, current),
        transverse_square=_first(across, 0, current),
        early=_first(self_part, 1, *_free_flight(log, float(time[1]), k)),
    )


def _series(title: str, argument: dict[str, np.ndarray], curves: dict[str, Curve]) -> Table:
    """Return a table of curves with their standard errors."""
    columns: dict[str, np.ndarray | None] = {**argument}
    for name, curve in curves.items():
        columns |= {name: curve.value, f"± {name}": curve.error}
    return time_series(title, columns)


def _first(parts: np.ndarray, lag: int, theory: float | None = None, theory_error: float = 0.0) -> Estimate:
    """Return the estimate of a correlation at one lag, given its values in all segments (S, L)."""
    curve = curve_of(parts)
    return Estimate(float(curve.value[lag]), float(curve.error[lag]), float(len(parts)), theory, theory_error)


def _free_flight(log: Log, time: float, k: float) -> tuple[float | None, float]:
    """Return the theoretical F_s after a time, and its error; None if a disc collides once or more in this time.

    The initial slope of the velocity correlation is exact; the contribution of its second derivative counts as error.
    """
    gas, collisions = log.discs, _correlation_rate(log) * time
    if gas.packing_fraction > hard_discs.HIGHEST or collisions >= 1:
        return None, 0.0
    relative = 1 - 1 / len(gas)
    half = (k * time) ** 2 * ensemble(log).temperature / float(gas.mass[0]) * relative / 2
    value = math.exp(-k * k * relative * _mean_square(log, time) / 4)
    return value, value * (half * collisions**2 / 24 + half**2 / (2 * len(gas)))


def _correlation_rate(log: Log) -> float:
    """Return the decay rate T/(mD) of the velocity correlation, 1/time, with Enskog's D.

    At packing fractions above HIGHEST, D is calculated with the contact value at HIGHEST.
    """
    gas, temperature, mass = log.discs, ensemble(log).temperature, float(log.discs.mass[0])
    chi = hard_discs.fluid_contact_value(min(gas.packing_fraction, hard_discs.HIGHEST))
    diffusion = enskog.diffusion(2 * float(gas.radius[0]), len(gas) / gas.area, temperature, mass, chi)
    return temperature / (mass * diffusion)


def _mean_square(log: Log, time: float) -> float:
    """Return the mean square displacement 4(T/m)(ωt - 1 + exp(-ωt))/ω² in a large gas, length²; ω: decay rate."""
    rate = _correlation_rate(log)
    square = 4 * ensemble(log).temperature / float(log.discs.mass[0])
    return square * (rate * time + math.expm1(-rate * time)) / rate**2


def _too_short(log: Log, window: Window, longest: float, k: float) -> Iterator[str]:
    """Yield caveats if the window is too short for the longest waves, or for waves of wave number k to decay."""
    if k != longest:
        yield f"The window is too short for waves longer than that of k = {k:.4g}."
    gas, temperature, phi = log.discs, ensemble(log).temperature, log.discs.packing_fraction
    if phi > hard_discs.HIGHEST:
        yield f"Above φ = {hard_discs.HIGHEST:g} it is not known how fast waves decay; error bars may be too small."
        return
    mass, diameter, density = float(gas.mass[0]), 2 * float(gas.radius[0]), len(gas) / gas.area
    fluid, chi = sound_of_discs(phi, temperature, mass, diameter), hard_discs.fluid_contact_value(phi)
    shear = enskog.viscosity(diameter, density, temperature, mass, chi) / (mass * density)
    rate = min(min(fluid.damping, fluid.spreading, shear) * k**2, k * math.sqrt(temperature / mass))
    if (number := window.duration * rate) < FEWEST_DECAYS:
        yield f"The window is {number:.2g} decay times of the longest wave long; error bars require {FEWEST_DECAYS:g}."
