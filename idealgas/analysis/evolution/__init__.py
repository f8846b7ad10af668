"""Follow temperature, pressure, discs beyond a wall, pistons and energies over time, and compare them with theory.

Theory predicts Haff's law for the temperature of a cooling gas, the adiabat for a slow piston, the mean position of a
piston under pressure, and the equilibrium of isolated gases, gases under gravity and gases in heat baths. The pressure
is the mechanical pressure on the walls. With a piston, the figure shows the pressure against the area, with the
isotherm and the adiabat through the initial state.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.evolution.account import Series, account
from idealgas.analysis.evolution.means import (
    adiabatic_exponent,
    isothermal_work,
    mean_position,
    mean_temperature,
    short_stroke,
)
from idealgas.analysis.evolution.pressure_series import PressureSeries, draw_pressure, draw_state, pressure_series
from idealgas.analysis.evolution.summary import evolution_summary
from idealgas.analysis.evolution.theory import EvolutionLaw, equilibrium_spread, expected_law, first_passable
from idealgas.analysis.result import Result
from idealgas.errors import UserError
from idealgas.fields import OPTIONAL, reported
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, time_series
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.chambers import beside_pistons, piston_names
from idealgas.tallies.stream import ReadProgress, frames, span
from idealgas.theory.conserved import centre_of_mass_energy, centre_of_mass_velocity

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTANTS = 257
"""Number of times in the time series."""

MOST_IN_COLUMN = 3
"""Largest number of panels that the figure stacks in a single column."""

MOST_SAMPLES = 2**14
"""Largest number of samples of the energy."""


@dataclass(frozen=True)
class Evolution(Result):
    """Evolution of a gas at F evenly spaced times, and at P times at which samples were stored during the run.

    Attributes:
        time: (F,), times.
        temperature: (F,), mean of m v²/2 over the discs, energy.
        spin: (F,), mean of I ω² over the discs, energy; None without spin.
        beyond: (F,), fraction of the discs beyond the first gate or permeable wall along an axis, by species.
        spread: these fractions in equilibrium with free passage between both sides, by species; their error is the
            standard deviation of a binomial distribution.
        law: theoretical prediction at these times; None without theory.
        samples: (P,), times of the samples, thinned evenly to at most MOST_SAMPLES.
        parts: (P,), terms of the energy, by name.
        given: (P,), energy received since the start from each wall, each piston (its work) and a heat bath, by name.
        pistons: (P,), coordinate of each piston, length, by name.
        balance: (P,), change since the start of the energy of discs and pistons that no source or loss explains,
            relative to the largest term of the energy; it is due to rounding errors only.
        dissipated: (P,), energy lost since the start in collisions between discs and at walls, by name.
        pressure: mechanical pressure on walls in time bins; None without events or wall hits.
        rest: mean position of a single piston of finite mass once it is steady, length; None without such a piston, or
            if the position does not become steady.
        rest_start: time at which the position of the piston becomes steady; None if `rest` is None.
        mean_temperature: mean temperature once it is steady, energy; None if the temperature is constant or does not
            become steady, or if the law does not describe an equilibrium.
        adiabatic_exponent: γ from the temperatures and areas at the start and end; None unless a piston compresses the
            gas without heat exchange.
        isothermal_work: work of a piston on a gas at the temperature of a heat bath, energy; None otherwise.
        chambers: (F,), mean of m v²/2 over the discs on each side of inner pistons, energy, by name as in
            `beside_pistons`.
    """

    time: np.ndarray
    temperature: np.ndarray
    spin: Annotated[np.ndarray | None, OPTIONAL]
    beyond: Series
    spread: dict[str, Estimate]
    law: EvolutionLaw | None
    samples: np.ndarray
    parts: Series
    given: Series
    pistons: Series
    balance: np.ndarray
    dissipated: Series
    pressure: PressureSeries | None = None
    rest: Estimate | None = None
    rest_start: float | None = None
    chambers: Series = field(default_factory=dict)
    mean_temperature: Estimate | None = None
    adiabatic_exponent: Estimate | None = None
    isothermal_work: Estimate | None = None

    @property
    def track(self) -> tuple[np.ndarray, Series] | None:
        """Times and coordinates of each piston, averaged over short blocks or from samples; None without pistons."""
        if self.pressure and self.pressure.track:
            return self.pressure.track
        return (self.samples, self.pistons) if self.pistons else None

    @property
    @reported
    def end(self) -> dict[str, float]:
        """Last value of each series, by name."""
        series = {"temperature": self.temperature, "spin": self.spin, **self.pistons, "balance": self.balance}
        return {name: float(values[-1]) for name, values in series.items() if values is not None and len(values)}

    def plain_tables(self) -> list[Table]:
        """Return the tables of temperatures and discs beyond a wall, of the pressure, of the energies, and of means."""
        law = self.law
        series = {
            "t": self.time,
            "kinetic energy per disc": self.temperature,
            "law": law.temperature if law else None,
            "I ω² per disc": self.spin,
            **{f"kinetic energy per disc, {name}": values for name, values in self.chambers.items()},
            **{f"law, {name}": values for name, values in (law.chambers if law else {}).items()},
            **{f"fraction of {name} beyond the wall": share for name, share in self.beyond.items()},
        }
        notes = [f"law: {law.text if law else 'none for this scene'}"]
        notes += [
            f"beyond the wall in equilibrium: {share.value:.1%} ± {share.standard_error:.1%} of {name} (binomial)"
            for name, share in self.spread.items()
        ]
        means = {
            "mean temperature once steady (energy)": self.mean_temperature,
            "mean position of the piston once steady (length)": self.rest,
            "γ = 1 + ln(T₂/T₁)/ln(A₁/A₂) (no unit; 2 for an ideal gas)": self.adiabatic_exponent,
            "work of the piston at constant T (energy)": self.isothermal_work,
        }
        rows = [(name, estimate) for name, estimate in means.items() if estimate is not None]
        tables = [time_series("Time series", series, notes)]
        if bins := self.pressure:
            columns = {"t": bins.middles, "area": bins.area}
            for name in bins.shown:
                columns |= {f"P on {name}": bins.pressure[name], f"± s.e. ({name})": bins.error[name]}
            tables.append(time_series("Pressure on walls, means over bins of time", columns))
        energy = {
            "t": self.samples,
            **{f"energy of {name}": values for name, values in self.parts.items()},
            **{_source_label(name, self): values for name, values in self.given.items()},
            **{f"lost by {name}": values for name, values in self.dissipated.items()},
            **{f"{name} position": place for name, place in self.pistons.items()},
            "balance, relative": self.balance,
        }
        totals = [estimates("Means and totals", rows)] if rows else []
        return [*tables, time_series("Energy", energy), *totals]

    def summary(self) -> str:
        """Return sentences on the temperature and its prediction, the pistons, and the discs beyond a wall."""
        return evolution_summary(self)

    def figure(self) -> "Figure":
        """Draw the temperature with its law dashed, discs beyond a wall, pressure, pistons and energies from walls.

        With a piston, the last panel shows the pressure against the area, with the isotherm and the adiabat through the
        initial state.
        """
        from idealgas.presentation.style import BLACK, COLOURS, curve_style, panels

        series, law, has_piston = self.pressure, self.law, self.track is not None
        states = series is not None and has_piston and np.ptp(series.area) > 0
        shown = [self.beyond, series, has_piston, self.given, states]
        number = 1 + sum(map(bool, shown))
        figure, axes = panels(-(-number // 2), 2) if number > MOST_IN_COLUMN else panels(number)
        for ax in axes[number:]:
            ax.remove()
        ax, *remaining = axes = axes[:number]
        rest = iter(remaining)
        ax.plot(self.time, self.temperature, color=COLOURS[0], label="kinetic energy per disc")
        if self.spin is not None:
            ax.plot(self.time, self.spin, color=COLOURS[1], label="I ω² per disc")
        several = any(name.startswith("between") for name in self.chambers)
        for k, (name, values) in enumerate(self.chambers.items(), 1 if self.spin is None else 2):
            colour, line, _ = curve_style(k)
            ax.plot(self.time, values, line, color=colour, label=_chamber_label(name, several))
            if law and law.chambers:
                ax.plot(self.time, law.chambers[name], "--", color=colour)
        if law is not None:
            ax.plot(self.time, law.temperature, "--", color=BLACK, label=law.text)
        low, high = self.temperature.min(), self.temperature.max()
        if high > 10 * low > 0:
            ax.set_yscale("log")
        elif high - low < 1e-6 * high:  # constant, except for rounding errors
            ax.set_ylim(0.9 * low, 1.1 * high)
        ax.set_ylabel("temperature (energy, k_B = 1)")
        if self.beyond:
            ax = next(rest)
            for k, (name, share) in enumerate(self.beyond.items()):
                colour, line, _ = curve_style(k)
                ax.plot(self.time, share, line, color=colour, label=name)
            ax.set(ylim=(-0.05, 1.05), ylabel="fraction beyond the wall (no unit)")
        if series:
            draw_pressure(next(rest), series, law)
        if self.track:
            ax = next(rest)
            for k, (name, places) in enumerate(self.track[1].items()):
                colour, line, _ = curve_style(k)
                ax.plot(self.track[0], places, line, color=colour, label=name)
            if law is not None and law.piston is not None:
                ax.theory(None, law.piston, law.piston_error, f"theory: mean position {law.piston:.4g}")
            ax.set_ylabel("piston position (length)")
        if self.given:
            ax = next(rest)
            for k, (name, energy) in enumerate(self.given.items()):
                colour, line, marker = curve_style(k)
                label = _source_label(name, self)
                ax.plot(self.samples, energy, line, marker=marker, ms=3, color=colour, label=label)
            ax.set_ylabel("energy (k_B = 1)")
        for ax in axes:
            ax.time_axis()
        if series and states:
            draw_state(next(rest), series, self.rest_start)
        for ax in axes:
            ax.legend()
        return figure


class EvolutionAnalysis(Analysis):
    """Evolution in time."""

    position = 20
    supports_escapes = True
    headline = "rest"
    results = (Evolution,)
    sections = (
        Section(
            "Evolution",
            "Temperature with its law dashed, then discs beyond a wall, pressure, pistons and energy, against time",
        ),
    )
    start = "the log's start"
    reads = "frames"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Evolution:
        """Follow temperature, pressure, energies, pistons and discs beyond a wall over time.

        The gas need not be in equilibrium. Where theory is available, it predicts the temperature in equilibrium, in a
        gas that cools due to collisions (Haff's law), or in a gas that is compressed by a moving piston (the adiabat).

        Raises:
            UserError: if the log does not cover the times or contains no samples of the energy.
        """
        first, last = span(log, start, end)
        observables = log.observables.thinned(MOST_SAMPLES)
        samples = observables["kinetic_energy"][0]
        if not len(samples):
            raise UserError(f"{log.path}: no samples of the energy")
        inside = (samples >= first) & (samples <= last)
        frames = _frames(log, first, last, progress) if log.has_events else _samples(log, observables, inside)
        observed = {name: values for name, (_, values) in observables.items()}
        *energies, balance = account(log, samples, observed)
        parts, given, lost = ({name: values[inside] for name, values in part.items()} for part in energies)
        pistons = {name: observed["piston_position"][inside, k] for k, name in enumerate(piston_names(log.scene))}
        pressure = pressure_series(log, first, last)
        track = pressure.track if pressure else None
        start_position = float(np.interp(first, track[0], next(iter(track[1].values())))) if track else 0.0
        law = expected_law(log, frames[0], frames[-1], start_position)
        exponent = adiabatic_exponent(frames[1], law)
        return Evolution(
            *frames[:-1],
            equilibrium_spread(log, last) if frames[3] else {},
            law,
            samples[inside],
            parts,
            given,
            pistons,
            balance[inside],
            lost,
            pressure,
            *mean_position(log, pressure, law),
            frames[-1],
            mean_temperature(frames[1], law),
            exponent,
            isothermal_work(log, pistons, given),
            caveats=(*(law.caveats if law else ()), *short_stroke(log, exponent, *frames[:2])),
        )


def _source_label(name: str, result: Evolution) -> str:
    """Return the heading for the energy that discs received from a wall, a piston or a heat bath."""
    return f"work done by the {name}" if name in result.pistons else f"energy from {name}"


def _chamber_label(name: str, several: bool) -> str:
    """Return the label for the gas between two pistons, or between a side of the box and a piston."""
    return name if name.startswith("between") else f"{name} of the piston{'s' if several else ''}"


# ── measurement ──

Frames = tuple[np.ndarray, np.ndarray, np.ndarray | None, Series, Series]
"""Values of `time`, `temperature`, `spin`, `beyond` and `chambers` of an Evolution."""


def _samples(log: Log, observables: Mapping[str, tuple[np.ndarray, np.ndarray]], inside: np.ndarray) -> Frames:
    """Return the time series from the samples stored during the run, for a log without events."""
    time, kinetic = observables["kinetic_energy"]
    n, spin = len(log.discs) - observables["escaped"][1][inside] if log.escapes else len(log.discs), None
    n = np.maximum(n, 1)
    if "rotational_energy" in observables:
        spin = 2 * observables["rotational_energy"][1][inside] / n
    return time[inside], (kinetic - centre_of_mass_energy(log.scene, log.discs))[inside] / n, spin, {}, {}


def _frames(log: Log, first: float, last: float, progress: ReadProgress | None) -> Frames:
    """Return the time series at evenly spaced times, from the events in a log."""
    gas, frame, inertia = log.discs, centre_of_mass_velocity(log.scene, log.discs), log.inertia
    wall = first_passable(log)
    number = np.bincount(gas.species)
    time = np.linspace(first, last, INSTANTS)
    temperature, spin, beyond = np.empty(len(time)), np.empty(len(time)), np.empty((len(time), len(number)))
    chambers = beside_pistons(log)
    apart = {name: np.empty(len(time)) for name in chambers}
    for k, state in enumerate(frames(log, time, progress)):
        energy = gas.mass * ((state.velocity - frame) ** 2).sum(axis=1) / 2
        temperature[k] = state.mean(energy)
        for name, members in chambers.items():
            apart[name][k] = state.mean(energy, members)
        if inertia is not None and state.angular_velocity is not None:
            spin[k] = state.mean(inertia * state.angular_velocity**2)
        if wall:
            axis, place = wall
            beyond[k] = np.bincount(gas.species, state.position[:, axis] > place, len(number)) / number
    shares = dict(zip(gas.species_names, beyond.T, strict=True)) if wall else {}
    return time, temperature, None if inertia is None else spin, shares, apart
