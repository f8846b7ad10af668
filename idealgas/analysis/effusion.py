"""Measure the flow through an opened gate, and compare it with n⟨v⟩/π.

DIR is the folder of a sweep with the analysis "effusion". Runs that differ only in their seeds are averaged.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, NamedTuple

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.caveats import must_be_one_gas
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result, RunResult
from idealgas.errors import UserError
from idealgas.fields import INLINE, OMITTED
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate
from idealgas.scene.walls import NumberedWall, walls_inside
from idealgas.statistics.estimates import Estimate, mean_of_replicates
from idealgas.tallies.equilibrium import ensemble
from idealgas.tallies.stream import ReadProgress, frames, span
from idealgas.theory import hard_discs
from idealgas.theory.ensemble import composition

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTANTS = 256

LAW_OFF, LAW_OFF_PER_PATH = 0.0125, 0.245
"""Coefficients of the relative error of n⟨v⟩/π for a slit of width w: LAW_OFF + LAW_OFF_PER_PATH w/λ.

λ is the mean free path. The line was fitted to measured fluxes, which exceeded n⟨v⟩/π by 2.0, 3.9 and 6.6 % at w/λ =
0.03, 0.11 and 0.22.
"""

CROWDING = 3.2
"""Relative error of n⟨v⟩/π, divided by the packing fraction φ of the chamber, due to the higher density in the slit.

To lowest order in φ, the density in a narrow slit is n exp(3.2 φ), because the walls cover part of the area from which
a disc excludes other discs. In twelve runs each, the flux was larger by 14 % at φ = 0.1 and by 120 % at φ = 0.3.
"""

DENSEST = 0.03
"""Largest packing fraction of the chamber for which theory is available."""

TINY = 1e-12


@dataclass(frozen=True)
class Effusion(RunResult):
    """Flow of discs between two chambers through an opened gate.

    Attributes:
        density: number density that the chamber with more discs at the start would have if it contained all discs,
            1/length².
        temperature: temperature of the gas, energy.
        time: (INSTANTS,), times.
        beyond: (INSTANTS,), number of discs in the other chamber.
        expected: (INSTANTS,), theoretical number of discs in the other chamber; None if `speed` has no theory.
        speed: flux over density: net number of discs per time and open length, divided by the difference between the
            densities, length/time. Each density is multiplied by the mean speed in its chamber, relative to the
            equilibrium mean speed ⟨v⟩ of the gas. The theoretical value is ⟨v⟩/π; it is None if the slit is wider than
            a mean free path or the chamber is denser than DENSEST. The standard error assumes that the numbers of
            passages in both directions follow Poisson distributions.
    """

    density: float
    temperature: float
    time: np.ndarray
    beyond: np.ndarray
    expected: np.ndarray | None
    speed: Estimate


@dataclass(frozen=True)
class Effusions(Result):
    """Flow through a slit, averaged over groups of runs that differ only in their seeds.

    Attributes:
        groups: runs of each group, by name of the group.
        together: mean flux over density of each group, length/time.
    """

    groups: Annotated[dict[str, tuple[Effusion, ...]], OMITTED]
    together: Annotated[dict[str, Estimate], INLINE]

    def plain_tables(self) -> list[Table]:
        """Return the table of the flux over density of each group, length/time."""
        return [estimates("Flux over density (length/time), theory ⟨v⟩/π", self.together.items())]

    def summary(self) -> str:
        """Return the flux over density of the first group, and whether all fluxes agree with kinetic theory."""
        first, *_ = self.together.values()
        verdict = agreement(self.together.items(), "⟨v⟩/π of kinetic theory")
        return f"The flux over density is {format_estimate(first)}; {verdict}."

    def figure(self) -> "Figure":
        """Draw the number of discs beyond the slit against time, and the flux of each group against n⟨v⟩/π."""
        from idealgas.presentation.style import GREY, curve_style, panels

        groups, together = self.groups, self.together
        figure, (course, flux) = panels(2)
        for k, (name, runs) in enumerate(groups.items()):
            colour, line, marker = curve_style(k)
            beyond, label = np.mean([run.beyond for run in runs], axis=0), name or "measured"
            course.plot(runs[0].time, beyond, line, color=colour, label=label)
            if laws := [run.expected for run in runs if run.expected is not None]:
                law = np.mean(laws, axis=0)
                course.plot(runs[0].time, law, "--", color=GREY, linewidth=0.8, label="kinetic theory")
            n, speed = runs[0].density, together[name]
            if speed.theory is None:
                flux.axhline(n * speed.value, color=colour, linestyle=line, label=f"{name}: no theory")
            else:
                expected, value, error = n * speed.theory, n * speed.value, n * speed.standard_error
                flux.errorbar(expected, value, error, fmt=marker, color=colour, capsize=3, label=label)
        highest = max(runs[0].density * (together[name].theory or 0) for name, runs in groups.items())
        ends = np.array([0.0, 1.1 * highest])
        doubt = max(
            (estimate.theory_error / estimate.theory for estimate in together.values() if estimate.theory), default=0.0
        )
        flux.theory(ends, ends, doubt * ends, "n⟨v⟩/π", GREY)
        course.set(xlabel="t (time)", ylabel="discs beyond the slit (no unit)")
        flux.set(xlabel="n⟨v⟩/π (1/(length time))", ylabel="flux (1/(length time))")
        for ax in (course, flux):
            ax.legend()
        return figure


class EffusionAnalysis(Analysis):
    """Effusion through a slit."""

    position = 110
    headline = "speed"
    supports_polydispersity = False
    results = (Effusion, Effusions)
    sections = (Section("Effusion", "Discs beyond the slit against time, and the measured flux against n⟨v⟩/π"),)
    averages = True
    start = "the opening of the gate"
    reads = "frames"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Effusion:
        """Measure the flux of discs through a slit that opens between two chambers, and compare it with n⟨v⟩/π.

        Kinetic theory predicts that n⟨v⟩/π discs leave a gas of number density n and mean speed ⟨v⟩ per time and open
        length of the slit, if the slit is much narrower than the mean free path. More discs pass through a wider slit.
        Theory is not available if the slit is wider than a mean free path or if the chamber is dense.

        Raises:
            UserError: if the log has no events, if the scene has several species, if it does not have exactly one gate
                that forms a slit in a wall along an axis, or if no net flow is expected.
        """
        discs, equilibrium = composition(log.discs), ensemble(log)
        gate = _slit(log)
        across, place = gate.across, gate.place
        radius, number, slit = discs.radius[0], len(log.discs), gate.width - 2 * discs.radius[0]
        time = _instants(log, gate, start, end)
        beyond, flux = np.empty(INSTANTS), np.empty((2, INSTANTS))  # flux: sums of the speeds below and above the gate
        for k, state in enumerate(frames(log, time, progress)):
            side, pace = state.position[:, across] > place, np.hypot(*state.velocity.T)
            beyond[k], flux[:, k] = side.sum(), (pace[~side].sum(), pace[side].sum())
        if beyond[0] > number / 2:
            beyond, flux, place = number - beyond, flux[::-1], log.box[across] - place
        height = log.box[1 - across] - 2 * radius
        inner, outer = (place - 2 * radius) * height, (log.box[across] - place - 2 * radius) * height
        mean_speed = hard_discs.mean_speed(equilibrium.temperature, discs.mass[0], equilibrium.dof)
        there, back = flux / mean_speed / [[inner], [outer]]
        drive, both = np.trapezoid(there - back, time), np.trapezoid(there + back, time)
        if not slit > 0 or not drive > 0:
            raise UserError(
                f"{log.path}: effusion requires a slit wider than a disc between chambers of unequal density"
            )
        expected = mean_speed / math.pi
        density = (number - beyond[0]) / inner
        phi = density * math.pi * radius**2 * log.scene.properties.interacting
        paths = log.scene.properties.interacting * slit / hard_discs.mean_free_path(2 * radius, density, phi)
        speed = float(beyond[-1] - beyond[0]) / (slit * drive)
        no_law = _no_law(paths, phi)
        error = math.sqrt((speed if no_law else expected) * slit * both) / (slit * drive)
        theory_error = expected * (LAW_OFF + LAW_OFF_PER_PATH * paths + CROWDING * phi)
        flux_over_density = Estimate(speed, error, math.inf, expected, theory_error)
        law = None
        if no_law:
            flux_over_density = replace(flux_over_density, theory=None, theory_error=0.0)
        else:
            rate = expected * slit
            law = number * _share_beyond(time, beyond[0] / number, rate / inner, rate / outer)
        if gate.others:
            no_law += (f"Theory assumes chambers without other walls; these contain {', '.join(gate.others)}.",)
        density = number / inner
        return Effusion(density, equilibrium.temperature, time, beyond, law, flux_over_density, caveats=no_law)

    @staticmethod
    def combine(results: Sequence[Effusion]) -> Effusions:
        """Group runs with the same label and average the flux in each group.

        Raises:
            UserError: if runs with the same label belong to different gases.
        """
        groups: dict[str, tuple[Effusion, ...]] = {}
        for run in results:
            label = run.origin.label if run.origin else ""
            groups[label] = (*groups.get(label, ()), run)
        for name, runs in groups.items():
            must_be_one_gas(runs, f"{name}: different gases under one name")
        return Effusions(groups, {name: mean_of_replicates([r.speed for r in runs]) for name, runs in groups.items()})


def _no_law(paths: float, phi: float) -> tuple[str, ...]:
    """Return a caveat that ⟨v⟩/π does not apply; empty if it does.

    Args:
        paths: width of the slit in mean free paths.
        phi: packing fraction of the chamber.
    """
    if paths > 1:
        return (
            f"The slit is {paths:.2g} mean free paths wide: discs stream out together, not one by one, and ⟨v⟩/π does "
            "not apply.",
        )
    if phi > DENSEST:
        return (f"The chamber has a packing fraction of {phi:.2g}: discs crowd in the slit, and ⟨v⟩/π does not apply.",)
    return ()


def _share_beyond(time: np.ndarray, at_first: float, leave: float, come: float) -> np.ndarray:
    """Return the theoretical fraction of all discs that are beyond the slit, (INSTANTS,).

    The discs that pass carry a mean energy of 3T/2 instead of T, so that one chamber cools and the other heats up.

    Args:
        time: (INSTANTS,), times.
        at_first: fraction of the discs beyond the slit at the first time.
        leave: rate at which a disc passes from the first chamber to the other at equal temperatures, 1/time.
        come: rate at which a disc passes back, 1/time.
    """
    from scipy.integrate import solve_ivp  # its import takes longer than most measurements

    def change(_: float, shares: np.ndarray) -> np.ndarray:
        """Return the rates of change of the fractions of discs and energy beyond the slit, 1/time.

        A side with fractions n of the discs and e of the energy loses discs at a rate proportional to √(ne), and energy
        at a rate proportional to 3/2 √(e³/n).
        """
        (n, e), (m, f) = np.maximum(1 - shares, TINY), np.maximum(shares, TINY)
        discs = leave * math.sqrt(n * e) - come * math.sqrt(m * f)
        return np.array([discs, 1.5 * (leave * e * math.sqrt(e / n) - come * f * math.sqrt(f / m))])

    return solve_ivp(change, (time[0], time[-1]), [at_first, at_first], t_eval=time, rtol=1e-8).y[0]


# ── slit ──


class Slit(NamedTuple):
    """Slit between two chambers: a gate in a wall that divides the box.

    Attributes:
        opens: time at which the gate opens.
        closes: time at which the gate closes.
        across: axis normal to the wall (0 or 1).
        place: coordinate of the wall on this axis, length.
        width: width of the slit, length.
        others: names of the other walls in the chambers.
    """

    opens: float
    closes: float
    across: int
    place: float
    width: float
    others: tuple[str, ...]


def _slit(log: Log) -> Slit:
    """Return the slit of a log; raise UserError unless it has events, one species and one gate that forms a slit."""
    inside = walls_inside(log.scene)
    gates = [wall for wall in inside if wall.absences and wall.absences[0][0] > 0]
    if len(gates) != 1 or len(log.discs.species_names) != 1 or not log.has_events:
        raise UserError(f"{log.path}: effusion requires one gate, one species and events")
    (gate,) = gates
    across = int(gate.start[0] != gate.end[0])
    in_line = _in_line(log, gate, across)
    if why := _obstacle(log, gate, in_line, across):
        raise UserError(f"{log.path}: effusion requires a slit in a wall, but {why}")
    low, high = _reach(gate, across)
    obstacles = tuple(wall.name for wall in inside if wall not in (gate, *in_line))
    opens, closes = gate.absences[0]
    return Slit(max(opens, log.start_time), closes, across, gate.start[across], high - low, obstacles)


def _obstacle(log: Log, gate: NumberedWall, in_line: Sequence[NumberedWall], across: int) -> str:
    """Return why a gate is not a slit in a wall, as part of a sentence; empty if it is a slit."""
    if gate.start[across] != gate.end[across] or not gate.is_straight:
        return "the gate is not along an axis"
    (low, high), radius, size = _reach(gate, across), float(log.discs.radius[0]), log.box[1 - across]
    if high - low + 2 * radius >= size:  # what remains of the wall is shorter than a disc
        return "the gate opens the box from side to side, so that the gas expands freely; use `idealgas evolution`"
    if log.periodic[across]:
        return "discs also pass through the periodic sides"
    beside = [_reach(wall, across) for wall in in_line]
    if any(min(end, high) - max(start, low) > radius for start, end in beside):
        return "a wall stands in the gate"
    reached, gap = 0.0, 0.0
    for start, end in [*sorted([*beside, (low, high)]), (size, math.inf)]:
        gap, reached = max(gap, start - reached), max(reached, end)
    return (
        f"the wall of the gate does not divide the box: there is a gap of {gap:.4g} beside the gate"
        if gap >= 2 * radius
        else ""
    )


def _in_line(log: Log, gate: NumberedWall, across: int) -> list[NumberedWall]:
    """Return the walls that are in line with an open gate, displaced by so little that no disc passes between them."""
    opens, closes = gate.absences[0][0], min(gate.absences[0][1], log.end_time)
    place, near = gate.start[across], log.discs.radius[0] / 2
    return [
        wall
        for wall in walls_inside(log.scene)
        if wall != gate
        and wall.arc is None
        and all(start >= closes or end <= opens for start, end in wall.absences)
        and max(abs(wall.start[across] - place), abs(wall.end[across] - place)) <= near
    ]


def _reach(wall: NumberedWall, across: int) -> tuple[float, float]:
    """Return the lowest and highest coordinate of a wall along the axis other than `across`, length."""
    ends = float(wall.start[1 - across]), float(wall.end[1 - across])
    return min(ends), max(ends)


def _instants(log: Log, gate: Slit, start: float | None, end: float | None) -> np.ndarray:
    """Return the times (INSTANTS,) at which the open gate is sampled; raise UserError if there are none."""
    if gate.opens >= log.end_time:
        raise UserError(f"{log.path}: the gate opens at t = {gate.opens:g}, but the log ends at {log.end_time:g}")
    first, last = span(log, start, end)
    if not max(gate.opens, first) < min(gate.closes, last):
        raise UserError(f"{log.path}: the gate is open only from t = {gate.opens:g} to {gate.closes:g}")
    return np.linspace(max(gate.opens, first), min(gate.closes, last), INSTANTS)
