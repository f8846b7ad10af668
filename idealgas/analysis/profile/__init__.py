"""Measure density, temperature, flow and pressure in strips along an axis, and the heat given by walls.

Theory predicts a uniform gas in a closed or periodic box and, if the gas is dilute, the barometric law under gravity.
Between two thermal sides T^(3/2) is linear in position, with temperature jumps at the sides, and n T Z is constant.
A flow that gravity drives along periodic sides is compared with Poiseuille flow.
"""

import math
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, Literal

import numpy as np

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.check import PValue, agreement
from idealgas.analysis.profile.flow import LAW, expected_flow
from idealgas.analysis.profile.heat import heat_flow, heat_of_walls
from idealgas.analysis.profile.stress import pressure_of_strips
from idealgas.analysis.profile.strips import FEWEST_FRAMES, StripTest, collect, gradient, strip_test
from idealgas.analysis.profile.theory import Expected, expected_profile, flow_axis, natural_axis
from idealgas.analysis.result import Result
from idealgas.errors import UserError
from idealgas.fields import OMITTED, OPTIONAL
from idealgas.log import Log
from idealgas.presentation.tables import Number, Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate, mean, ratio
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.exchange import across
from idealgas.tallies.stream import ReadProgress
from idealgas.theory.ensemble import composition
from idealgas.theory.values import Theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from idealgas.presentation.style import Panel

BINS = 20
"""Default number of strips."""

DILUTE = 0.02
"""Largest packing fraction in a strip for theories of a dilute gas; the errors of n and T are then about 4 %."""

LAYERED = 0.02
"""Largest fraction by which layering may raise the density in strips at walls before a caveat is printed."""

CLEAR = 5.0
"""Difference between two strips, in standard errors, above which the summary reports it."""

SHEARED = "Errors of the pressure in strips of a sheared gas may be up to 1.4 times too small."
"""Caveat of a profile between sheared sides; the factor was measured in 50 runs of 50 discs."""


@dataclass(frozen=True)
class SpeciesProfile:
    """Profiles of one species, with one value for each strip.

    Attributes:
        species, density: name of the species, and its number density, 1/length².
        temperature: mean m v²/2 of a disc, relative to the flow, energy.
        spin: mean I ω² of a disc, energy; None without spin.
        velocity: mass-weighted velocity of the flow that gravity drives, length/time; None without a flow.
        gradient: slope of a line fitted to the temperatures, weighted by the number of discs, energy/length, or None.
        density_test, temperature_test: tests of all strips together; None unless theory predicts a uniform gas.
    """

    species: str
    density: tuple[Estimate, ...]
    temperature: tuple[Estimate, ...]
    spin: Annotated[tuple[Estimate, ...] | None, OPTIONAL]
    velocity: Annotated[tuple[Estimate, ...] | None, OPTIONAL]
    gradient: Estimate | None
    density_test: StripTest | None
    temperature_test: StripTest | None


@dataclass(frozen=True)
class Profile(Result):
    """Profiles of all species in K strips along one axis.

    Attributes:
        window: window of time that was used.
        axis: "x" or "y".
        flow: axis along which gravity drives a flow, "x" or "y"; None if there is no flow.
        edges: (K + 1,), edges of the strips, length.
        strip: area of one strip, length².
        frames: number of averaged frames.
        law: name of the theory; None if theory is not available.
        species: profiles of each species.
        pressure: components "xx", "yy" and "xy" of the pressure tensor relative to the flow, (K,) each, energy/length².
        heat: energy per time that each wall gives to the discs, by its name; the sheared sides form one entry.
        heat_flow: heat per time between two thermal sides, along the axis; None unless their temperatures differ.
    """

    window: Window
    axis: str
    flow: Annotated[str | None, OPTIONAL]
    edges: np.ndarray
    strip: Annotated[float, OMITTED]
    frames: int
    law: str | None
    species: tuple[SpeciesProfile, ...]
    pressure: dict[str, tuple[Estimate, ...]]
    heat: dict[str, Estimate]
    heat_flow: Annotated[Estimate | None, OPTIONAL] = None

    @property
    def middles(self) -> np.ndarray:
        """Coordinates of the centres of the strips, (K,), length."""
        return (self.edges[1:] + self.edges[:-1]) / 2

    def plain_tables(self) -> list[Table]:
        """Return the tables of density, temperature and pressure in every strip, and of the heat from walls."""
        axis, edges = self.axis, self.edges
        strips = [f"{axis} = {low:.4g} to {high:.4g}" for low, high in pairwise(edges)]
        tables = []
        for entry in self.species:
            columns = {"density (1/length²)": entry.density, "temperature, m v²/2": entry.temperature}
            columns |= {"temperature, I ω²": entry.spin} if entry.spin is not None else {}
            columns |= {f"velocity along {self.flow} (length/time)": entry.velocity} if entry.velocity else {}
            for name, column in columns.items():
                tables.append(estimates(f"{entry.species}: {name}", zip(strips, column, strict=True)))
        if gradients := [(entry.species, entry.gradient) for entry in self.species if entry.gradient is not None]:
            tables.append(estimates(f"Temperature gradient along {axis} (energy/length)", gradients))
        for name, parts in self.pressure.items():
            tables.append(estimates(f"Pressure P_{name} (energy/length²)", zip(strips, parts, strict=True)))
        tests = [
            (name, Number(test.chi_squared, ".4g"), Number(test.waves, "d"), Number(test.p_value, ".3g"))
            for name, test in _tests(self)
        ]
        if tests:
            tables.append(Table("All strips together", ("", "χ²", "waves", "p"), tests))
        if self.heat:
            tables.append(estimates("Energy from each wall per time", self.heat.items()))
        if self.heat_flow:
            flow = [(f"along {axis}, mean of both sides", self.heat_flow)]
            tables.append(estimates("Heat flow between the thermal sides (energy/time)", flow))
        notes = (f"{self.window}, {self.frames} frames", f"theory: {self.law or 'none for this scene'}")
        return [replace(tables[0], notes=notes), *tables[1:]]

    def summary(self) -> str:
        """Return the headline: values in the first and last known strips, and whether all strips agree with theory."""
        middles = [f"{self.axis} = {x:.4g}" for x in self.middles]
        sentences: list[str] = []
        rows: list[tuple[str, Estimate | PValue]] = []
        for entry in self.species:
            columns = {"density": entry.density, "temperature": entry.temperature}
            columns |= {"velocity": entry.velocity} if entry.velocity else {}
            for name, column in columns.items():
                known = [(x, e) for x, e in zip(middles, column, strict=True) if e.standard_error > 0]
                rows += [(f"{name} of {entry.species} at {x}", e) for x, e in known]
                if not known:
                    continue
                (x0, first), (x1, last) = known[0], known[-1]
                if name == "velocity":  # the flow is fastest midway between the sides
                    x1, last = max(known, key=lambda entry: abs(entry[1].value - known[0][1].value))
                if abs(first.value - last.value) > CLEAR * np.hypot(first.standard_error, last.standard_error):
                    ends = f"{format_estimate(first)} at {x0} and {format_estimate(last)} at {x1}"
                    sentences.append(f"The {name} of {entry.species} is {ends}.")
        same = "Nothing differs clearly between the first and the last strip."
        law = f"theory, {self.law}"
        rows += [(f"{name} in all strips", PValue(test.p_value, math.inf)) for name, test in _tests(self)]
        if flow := self.heat_flow:
            verdict = agreement([("heat", flow)], "Fourier's law with Enskog's conductivity")
            sentences.append(f"Heat flows along {self.axis} at a rate of {format_estimate(flow)}; {verdict}.")
        return f"{' '.join(sentences) or same} In strips: {agreement(rows, law)}."

    def figure(self) -> "Figure":
        """Draw density, temperature, pressure and flow; theory is dashed, and spin temperatures are crosses."""
        from idealgas.presentation.style import BLACK, Strips, curve_style, panels

        def draw(ax: "Panel", column: tuple[Estimate, ...], **style: Any) -> None:
            value, error = (np.array([getattr(e, name) for e in column]) for name in ("value", "standard_error"))
            theory, off = np.array([(np.nan if e.theory is None else e.theory, e.theory_error) for e in column]).T
            ax.theory(self.middles, theory, off, None)
            ax.errorbar(self.middles, value, error, ms=4, capsize=2, **style)

        figure, (density, temperature, stress, *flow) = panels(3 if self.flow is None else 4)
        for k, entry in enumerate(self.species):
            colour, _, marker = curve_style(k)
            draw(density, entry.density, fmt=marker, color=colour, label=entry.species)
            draw(temperature, entry.temperature, fmt=marker, color=colour, label=f"{entry.species}: m v²/2")
            if entry.spin is not None:
                draw(temperature, entry.spin, fmt="x", color=colour, label=f"{entry.species}: I ω²")
            if entry.velocity is not None:
                draw(flow[0], entry.velocity, fmt=marker, color=colour, label=entry.species)
        for k, (name, parts) in enumerate(self.pressure.items()):
            colour, _, marker = curve_style(k)
            draw(stress, parts, fmt=marker, color=colour, label=f"P_{name}")
        stress.set_ylabel("pressure tensor (energy/length²)")
        if self.law is not None:
            (*flow, density)[0].plot([], [], "--", color=BLACK, label=f"theory: {self.law}")
            highest = [e.theory or 0.0 for entry in self.species for e in entry.density]
            if max(highest) > 20 * min(highest) > 0:
                density.set_yscale("log")
        for ax in (density, temperature, stress, *flow):
            ax.set_xlabel(f"{self.axis} (length)")
            ax.legend()
        low, high, number = self.edges[0], self.edges[-1], len(self.middles)
        density.strips = Strips("xy".index(self.axis), float(low), float(high), number, self.strip)
        density.set_ylabel("n (1/length²)")
        temperature.set_ylabel("temperature (energy, k_B = 1)")
        for ax in flow:
            ax.set_ylabel(f"velocity along {self.flow} (length/time)")
        return figure


class ProfileAnalysis(Analysis):
    """Profiles of density, temperature, flow and pressure."""

    supports_shear = True
    position = 40
    results = (Profile,)
    sections = (Section("Profile", "Density, temperature and pressure tensor in strips along an axis, theory dashed"),)
    options = (
        Option(
            "along",
            str,
            "Axis of the profile; by default across a flow, along gravity, or between two thermal sides, otherwise x.",
            choices=("x", "y"),
        ),
        Option("bins", int, "Number of strips.", default=BINS, least=1, most=1000),
    )
    reads = "frames"

    @staticmethod
    def measure(
        log: Log,
        along: Literal["x", "y"] | None = None,
        bins: int = BINS,
        start: float | None = None,
        end: float | None = None,
        progress: ReadProgress | None = None,
    ) -> Profile:
        """Measure density, temperature and pressure in strips along an axis, and the heat given by walls.

        Averages are taken over states that are at least one event per disc apart. Where theory is available, it
        predicts a uniform gas, the barometric law, Fourier's law between two thermal walls, or Poiseuille flow. If the
        gas flows, temperatures are relative to the flow.

        Raises:
            UserError: if the log has no events or its discs have no positions, or if the window is empty.
        """
        if not log.has_positions:
            raise UserError(f"{log.path}: a profile requires discs with positions")
        axis = natural_axis(log) if along is None else "xy".index(along)
        reach = 0.0 if log.periodic[axis] else log.discs.radius.min()
        window, edges = measure(log, [], start, end), np.linspace(reach, log.box[axis] - reach, bins + 1)
        window = replace(window, slowest=max(window.slowest, across(log, axis)))
        along_flow = flow_axis(log)
        times = window.edges[window.first :]
        sums, carried, stored = collect(log, axis, along_flow, times, edges, progress)
        pressure = pressure_of_strips(log, axis, edges, times, carried, stored, progress)
        expected = expected_profile(log, axis, edges, window.start)
        flow = expected_flow(log, axis, edges) if along_flow == 1 - axis else None
        strip = float(edges[1] - edges[0]) * log.box[1 - axis]
        spinning = log.inertia is not None
        species = tuple(
            _of_species(name, sums[:, s], edges, strip, expected, s, spinning, flow and flow.velocity, window.memory)
            for s, name in enumerate(composition(log.discs).name)
        )
        caveats = (*_unknown_strips(species), *_limits(log, axis, float(edges[1] - edges[0]), species, expected))
        caveats += tuple(flow.caveats(window)) if flow else ()
        caveats += (SHEARED,) if log.scene.properties.shear else ()
        law = expected.law if expected else LAW if flow else None
        axes = "xy"[axis], None if along_flow is None else "xy"[along_flow]
        heat = heat_of_walls(log, window), heat_flow(log, axis, window)
        return Profile(window, *axes, edges, strip, len(sums), law, species, pressure, *heat, caveats=caveats)


def _tests(result: Profile) -> Iterator[tuple[str, StripTest]]:
    """Yield the name of each quantity of a species for which all strips were tested together, and the test."""
    for entry in result.species:
        for name, test in (("density", entry.density_test), ("temperature", entry.temperature_test)):
            if test is not None:
                yield f"{name} of {entry.species}", test


def _unknown_strips(species: Sequence[SpeciesProfile]) -> Iterator[str]:
    """Yield a caveat for each species that is too rare in some strips to have a temperature there."""
    for entry in species:
        if missing := sum(np.isnan(estimate.value) for estimate in entry.temperature):
            yield (
                f"{missing} of {len(entry.temperature)} strips hold a disc of {entry.species} in fewer than "
                f"{FEWEST_FRAMES} frames; they have no temperature."
            )


def _limits(
    log: Log, axis: int, width: float, species: Sequence[SpeciesProfile], expected: Expected | None
) -> Iterator[str]:
    """Yield a caveat if a theory of dilute gases, or of gases without layering at the walls, does not hold here."""
    if expected is None:
        return
    density = np.array([[estimate.value for estimate in entry.density] for entry in species])
    densest = max(composition(log.discs).packing_fraction(strip) for strip in density.T)
    if not expected.dilute:
        if expected.layers.max() > LAYERED:
            yield "Discs of a dense gas form layers at walls; the density is uniform only in strips away from walls."
    elif densest > DILUTE:
        yield f"The theory assumes a dilute gas; the packing fraction of a strip reaches {densest:.2g}."


def _of_species(
    name: str,
    sums: np.ndarray,
    edges: np.ndarray,
    strip: float,
    expected: Expected | None,
    s: int,
    spinning: bool,
    flow: Sequence[Theory] | None,
    memory: float,
) -> SpeciesProfile:
    """Return the profiles of species s from its sums (F, K, 5), see `collect`; strip: area of a strip, length²."""
    strips = range(sums.shape[1])

    def per_disc(k: int, column: int, by: int = 0, theory: Theory | None = None) -> Estimate:
        if np.count_nonzero(sums[:, k, 0]) < FEWEST_FRAMES:
            return Estimate(np.nan, np.nan, 0.0)
        if expected is not None:
            theory = expected.of_temperature(s, k) if column == 1 else expected.of_spin(s, k)
        return ratio(sums[:, k, column], sums[:, k, by], theory, memory)

    density_test = temperature_test = None
    if expected is not None and not expected.dilute:  # with a dilute-gas law, χ² would mainly test the error of the law
        number = strip * expected.density[s]
        density, warmth = ([of(s, k) for k in strips] for of in (expected.of_density, expected.of_temperature))
        excess = sums[..., 1] - [estimate.value for estimate in warmth] * sums[..., 0]
        errors = [np.array([estimate.error for estimate in estimates]) for estimates in (density, warmth)]
        density_test = strip_test(sums[..., 0], number, strip * errors[0], memory)
        temperature_test = strip_test(excess, number, number * errors[1], memory)
    return SpeciesProfile(
        name,
        tuple(mean(sums[:, k, 0] / strip, expected.of_density(s, k) if expected else None, memory) for k in strips),
        tuple(per_disc(k, 1) for k in strips),
        tuple(per_disc(k, 2) for k in strips) if spinning else None,
        tuple(per_disc(k, 3, 4, flow[k] if flow else None) for k in strips) if sums[..., 3].any() else None,
        gradient(sums[..., 0], sums[..., 1], (edges[1:] + edges[:-1]) / 2, expected, s, memory),
        density_test,
        temperature_test,
    )
