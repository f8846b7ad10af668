"""Measure the speed and the damping of sound from the longest density waves in a periodic box.

In theory, the speed follows from the equation of state, and the damping from Enskog's viscosities and thermal
conductivity.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.caveats import narrow
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result
from idealgas.errors import UserError
from idealgas.fields import OMITTED
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.equilibrium import ensemble
from idealgas.tallies.stream import ReadProgress, trajectories
from idealgas.theory import hard_discs
from idealgas.theory.ensemble import composition
from idealgas.theory.waves import Decay, Fluid, fit, sound_of_discs

if TYPE_CHECKING:
    from matplotlib.figure import Figure

STEPS = 12
"""Number of instants per expected period or decay time of the sound, whichever is shorter."""

DECAYS, PERIODS = 3.0, 6.0
"""Longest time for which a wave is followed, in expected decay times and in periods, whichever is shorter."""

SEGMENTS = 32
"""Number of parts into which the window is divided for the standard errors."""

ROUGH = 0.025
"""Largest relative standard error of the speed for which the error bars are reliable."""

FEWEST_DECAYS = 100
"""Smallest number of decay times of sound in the window for reliable error bars."""

MOST_FRAMES = 2**17
"""Largest number of instants at which a wave is measured."""

HYDRODYNAMIC = 0.5
"""Largest k times the mean free path, and k times the diameter, for which waves are hydrodynamic."""


ERRORS = Fluid(speed=0.001, damping=0.05, spreading=0.1, exponent=0.001)
"""Relative errors of the theory for long waves, due to the equation of state and to Enskog's coefficients."""

FASTER = 0.15
"""Fraction of Γk/c by which the sound of waves of finite length may be faster than theory.

At φ = 0.3 with 300, 600 and 2400 discs, sound is faster by 2.6 ± 0.7 %, 1.9 ± 0.2 % and 1.3 ± 0.4 %. In two
dimensions the correlations of currents have long-time tails, so that the neglected terms decrease more slowly than k².
"""


@dataclass(frozen=True)
class SoundWave:
    """The longest density waves along one axis of the box, or along both.

    Attributes:
        axes: names of the axes.
        wavelength: length of the waves.
        lag: (L,), lags, time.
        correlation: (L,), ⟨ρ(lag)ρ*(0)⟩/N (no unit).
        error: (L,), standard error of the correlation.
        fitted: hydrodynamic correlation fitted to the measured one.
        theory: theoretical correlation; None if theory is not available.
        speed: speed of sound, length/time.
        damping: damping Γ, length²/time.
        spreading: thermal diffusivity χ, length²/time.
        exponent: adiabatic exponent γ (no unit).
    """

    axes: str
    wavelength: float
    lag: np.ndarray
    correlation: np.ndarray
    error: np.ndarray
    fitted: Annotated[Decay, OMITTED]
    theory: Annotated[Decay | None, OMITTED]
    speed: Estimate
    damping: Estimate
    spreading: Estimate
    exponent: Estimate


@dataclass(frozen=True)
class Sound(Result):
    """Sound in the gas of one log.

    Attributes:
        window: window of time that was used.
        frames: number of instants at which waves were measured.
        waves: longest waves along each periodic axis; in a periodic square box, a single entry for both axes.
    """

    window: Window
    frames: int
    waves: tuple[SoundWave, ...]

    def plain_tables(self) -> list[Table]:
        """Return a table for each wave: speed and damping of sound, thermal diffusivity and adiabatic exponent."""
        tables = [
            estimates(
                f"Waves along {wave.axes}, {wave.wavelength:.4g} long",
                [
                    ("speed of sound (length/time)", wave.speed),
                    ("damping of sound Γ (length²/time)", wave.damping),
                    ("thermal diffusivity (length²/time)", wave.spreading),
                    ("adiabatic exponent γ (no unit)", wave.exponent),
                ],
            )
            for wave in self.waves
        ]
        notes = (
            f"{self.window}, {self.frames} instants",
            "theory: speed from the virial series; damping and diffusivity from Enskog's viscosities and thermal "
            "conductivity",
        )
        return [replace(tables[0], notes=notes), *tables[1:]]

    def summary(self) -> str:
        """Return the headline: speed and γ of the first wave, and whether those of all waves agree with theory."""
        rows = [
            (f"{name} along {wave.axes}", estimate)
            for wave in self.waves
            for name, estimate in (("speed", wave.speed), ("γ", wave.exponent))
        ]
        (_, speed), (_, exponent), *_ = rows
        measured = (
            f"The speed of sound is {format_estimate(speed)}, γ is {format_estimate(exponent)} (2 for an ideal gas)"
        )
        return f"{measured}; {agreement(rows, 'hydrodynamics')}."

    def figure(self) -> "Figure":
        """Draw the correlation of each wave against time, with its fit and, dashed, its theory."""
        from idealgas.presentation.style import COLOURS, GREY, panels

        figure, axes = panels(len(self.waves))
        for ax, wave in zip(axes, self.waves, strict=True):
            every = max(len(wave.lag) // 60, 1)
            lag, values_at_lags, error = (values[::every] for values in (wave.lag, wave.correlation, wave.error))
            ax.errorbar(lag, values_at_lags, error, fmt="o", ms=3, color=COLOURS[0], capsize=2, label="measured")
            fine = np.linspace(0, wave.lag[-1], 500)
            ax.plot(fine, wave.fitted.at(fine), color=COLOURS[1], linewidth=1.2, label="fit: heat and sound")
            if wave.theory is not None:
                ax.theory(fine, wave.theory.at(fine), _doubt(fine, wave), "theory (hydrodynamics)", GREY)
            ax.axhline(0, color="#bbbbbb", linewidth=0.8, zorder=1)
            ax.set_xlabel("t (time)")
            wave_in_words = f"waves along {wave.axes}, {wave.wavelength:.4g} long: c = {wave.speed.value:.4g}"
            ax.set_ylabel(f"⟨ρ(t) ρ*(0)⟩/N (no unit), {wave_in_words}")
            ax.legend()
        return figure


class SoundAnalysis(Analysis):
    """Sound in a gas of one species."""

    position = 90
    headline = "waves.*.speed"
    supports_polydispersity = False
    results = (Sound,)
    sections = (Section("Sound", "Correlation in time of the longest waves of density, hydrodynamics dashed"),)
    reads = "frames"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Sound:
        """Measure the speed and the damping of sound between two times of a log.

        The amplitude ρ(t) = Σ exp(-ikx) of the longest wave along each periodic axis is followed in time. Its
        correlation is fitted with linear hydrodynamics, that is, sound and heat conduction. Standard errors follow from
        the jackknife over 32 parts of the window.

        Raises:
            UserError: if there are no events, no periodic axis, several species or effects other than periodic sides,
                or if the window is too short to follow a wave.
        """
        if len(composition(log.discs).name) > 1:
            raise UserError(f"{log.path}: sound requires a gas of one species")
        if not any(log.periodic):
            raise UserError(f"{log.path}: sound requires a box with periodic sides")
        window = measure(log, [], start, end, needs=("uniform", "conserves_motion", "interacting"))
        alone = [(axis,) for axis in (0, 1) if log.periodic[axis]]
        groups: Sequence[tuple[int, ...]] = [(0, 1)] if len(alone) == 2 and log.box[0] == log.box[1] else alone
        waves, frames = [], 0
        for axes in groups:
            expected, errors = _expected(log, 2 * math.pi / log.box[axes[0]])
            step, lags = _steps(log, window, expected)
            times = np.minimum(window.start + step * np.arange(int(window.duration / step) + 1), window.end)
            waves.append(
                _wave(log, axes, (expected, errors), step * np.arange(lags), _amplitudes(log, times, axes, progress))
            )
            frames += len(times)
        caveats = [sentence for wave in waves for sentence in _caveats(log, window, wave)]
        return Sound(window, frames, tuple(waves), caveats=(*narrow(log), *caveats))


def _doubt(time: np.ndarray, wave: SoundWave) -> np.ndarray:
    """Return the error of the theoretical correlation of a wave at times (L,), from the errors of its coefficients."""
    assert wave.theory is not None
    law, square = wave.theory, np.zeros_like(time)
    for name in ("speed", "damping", "spreading"):
        value = getattr(law.fluid, name) + getattr(wave, name).theory_error
        square += (law._replace(fluid=law.fluid._replace(**{name: value})).at(time) - law.at(time)) ** 2
    return np.sqrt(square)


def _expected(log: Log, k: float) -> tuple[Decay, Fluid | None]:
    """Return the theoretical correlation of waves of wave number k, and the relative errors of its coefficients.

    The errors are None above φ = 0.62, where the virial series ends.
    """
    gas, temperature = log.discs, ensemble(log).temperature
    phi, mass, diameter = gas.packing_fraction, float(gas.mass[0]), 2 * float(gas.radius[0])
    fluid = sound_of_discs(phi, temperature, mass, diameter)
    short = FASTER * fluid.damping * k / fluid.speed
    errors = Fluid(*(math.hypot(error, short) for error in ERRORS)) if phi <= hard_discs.HIGHEST else None
    return Decay(1 / float(hard_discs.inverse_compressibility(phi)), k, fluid), errors


def _steps(log: Log, window: Window, expected: Decay) -> tuple[float, int]:
    """Return the time between two instants, and the number of instants over which a wave is followed."""
    k, fluid = expected.k, expected.fluid
    decay_time, period = 1 / (fluid.damping * k**2), 2 * math.pi / (fluid.speed * k)
    longest = min(DECAYS * decay_time, PERIODS * period, window.duration / 8)
    step = max(min(period, decay_time) / STEPS, window.duration / MOST_FRAMES)
    lags = int(longest / step) + 1
    if lags < STEPS:
        raise UserError(f"{log.path}: window too short for waves to be followed (allowed >= {8 * STEPS * step:.3g})")
    return step, lags


def _amplitudes(log: Log, times: np.ndarray, axes: tuple[int, ...], progress: ReadProgress | None) -> np.ndarray:
    """Return Σ exp(-ikx) over all discs at G times for the longest wave along each of A axes, (A, G), complex."""
    amplitudes = np.empty((len(axes), len(times)), complex)
    for instants, places, _ in trajectories(log, times, progress):
        for a, axis in enumerate(axes):
            phase = places[:, :, axis] * (2 * math.pi / log.box[axis])
            amplitudes[a, instants] = np.cos(phase).sum(axis=1) - 1j * np.sin(phase).sum(axis=1)
    return amplitudes


def correlations(amplitudes: np.ndarray, lags: int, segments: int) -> np.ndarray:
    """Return ⟨ρ(t + lag) ρ*(t)⟩ for amplitudes (A, G) in each segment of starting times t, (segments, lags).

    The correlation is averaged over the A amplitudes and over the starting times in a segment.
    """
    starts = amplitudes.shape[1] - lags + 1
    edges = np.linspace(0, starts, segments + 1).astype(int)[:-1]
    counts = np.diff(np.append(edges, starts))
    early = amplitudes[:, :starts].conj()
    products = ((amplitudes[:, lag : lag + starts] * early).real.mean(axis=0) for lag in range(lags))
    return np.stack([np.add.reduceat(product, edges) / counts for product in products], axis=1)


def _wave(
    log: Log, axes: tuple[int, ...], theory: tuple[Decay, Fluid | None], lag: np.ndarray, amplitudes: np.ndarray
) -> SoundWave:
    """Return the results for waves along the axes from their amplitudes (A, G), theory and its relative errors."""
    expected, errors = theory
    parts = correlations(amplitudes, len(lag), SEGMENTS) / len(log.discs)
    whole = parts.mean(axis=0)
    thermal = ensemble(log).temperature / float(log.discs.mass[0])
    fitted = fit(lag, whole, expected._replace(size=float(whole[0])), thermal)
    rest = (whole * SEGMENTS - parts) / (SEGMENTS - 1)
    refits = [] if fitted is None else [fit(lag, part, fitted, thermal) for part in rest]
    without = [refit.fluid for refit in refits if refit is not None]
    if fitted is None or len(without) < SEGMENTS:
        raise UserError(f"{log.path}: the density waves are not those of a fluid, or too few for a fit")
    error = np.sqrt((SEGMENTS - 1) * np.var(without, axis=0))  # the jackknife
    quantities = {
        name: Estimate(value, float(error[j]), float(SEGMENTS), *((of, of * errors[j]) if errors else ()))
        for j, (name, value, of) in enumerate(zip(Fluid._fields, fitted.fluid, expected.fluid, strict=True))
    }
    return SoundWave(
        axes=" and ".join("xy"[axis] for axis in axes),
        wavelength=log.box[axes[0]],
        lag=lag,
        correlation=whole,
        error=parts.std(axis=0, ddof=1) / math.sqrt(SEGMENTS),
        fitted=fitted,
        theory=expected if errors else None,
        **quantities,
    )


def _caveats(log: Log, window: Window, wave: SoundWave) -> Iterator[str]:
    """Yield a caveat for each condition that a wave does not meet."""
    gas, k, fluid = log.discs, wave.fitted.k, wave.fitted.fluid
    diameter = 2 * float(gas.radius[0])
    short = max(diameter, hard_discs.mean_free_path(diameter, len(gas) / gas.area, gas.packing_fraction))
    if k * short > HYDRODYNAMIC:
        yield (
            f"The waves along {wave.axes} are {wave.wavelength / short:.3g} mean free paths or diameters long; "
            f"hydrodynamics requires {2 * math.pi / HYDRODYNAMIC:.3g}."
        )
    if fluid.damping * k > fluid.speed:
        yield f"The waves along {wave.axes} decay within a period and are hardly sound waves."
    if (part := wave.speed.standard_error / wave.speed.value) > ROUGH:
        yield (
            f"The speed of sound along {wave.axes} is known to within {100 * part:.2g} %; above {100 * ROUGH:g} % the "
            "error bars of the speed and of γ are up to a fifth too small."
        )
    if (number := window.duration * fluid.damping * k**2) < FEWEST_DECAYS:
        yield (
            f"The window is {number:.2g} decay times of the waves along {wave.axes} long; error bars require "
            f"{FEWEST_DECAYS}."
        )
