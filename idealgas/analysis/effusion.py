"""Measure the flow through an opened gate, and compare it with n⟨v⟩/π and Graham's law.

DIR is the folder of a sweep with the analysis "effusion". Runs that differ only in their seeds are averaged.
"""

import math
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.caveats import must_be_one_gas
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result, RunResult
from idealgas.errors import UserError
from idealgas.fields import INLINE, OMITTED, OPTIONAL
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate, mean_of_replicates
from idealgas.tallies.equilibrium import ensemble
from idealgas.tallies.reach import Slit, slit_of
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
class Flow:
    """Flow of the discs of one species between two chambers through an opened gate.

    Attributes:
        density: number density that the chamber with more discs at the start would have if it contained all discs,
            1/length².
        time: (INSTANTS,), times.
        beyond: (INSTANTS,), number of discs in the other chamber.
        expected: (INSTANTS,), theoretical number of discs in the other chamber; None if `speed` has no theory.
        speed: flux over density: net number of discs per time and open length, divided by the difference between the
            densities, length/time. Each density is multiplied by the mean speed in its chamber, relative to the
            equilibrium mean speed ⟨v⟩ of the gas. The theoretical value is ⟨v⟩/π; it is None if the slit is wider than
            a mean free path or the chamber is denser than DENSEST. The standard error assumes that the numbers of
            passages in both directions follow Poisson distributions; without theory, of one passage at least.
    """

    density: float
    time: np.ndarray
    beyond: np.ndarray
    expected: np.ndarray | None
    speed: Estimate


@dataclass(frozen=True)
class Effusion(Flow, RunResult):
    """Flow of the discs of a gas or, in a mixture, of its first species.

    Attributes:
        temperature: temperature of the gas, energy.
        species: flow of each species of a mixture, by name; None for a single species.
    """

    temperature: float
    species: Annotated[dict[str, Flow] | None, OPTIONAL] = None


@dataclass(frozen=True)
class Effusions(Result):
    """Flow through a slit, averaged over groups of runs that differ only in their seeds.

    Attributes:
        groups: flows in the runs of each group, by name of the group; each species of a mixture is a group.
        together: mean flux over density of each group, length/time.
        ratios: ratio of `together` of each species of a mixture to that of its first species, no unit; None if there
            are no mixtures, as for `flows`.
        flows: mean flow of each species of mixtures.
    """

    groups: Annotated[dict[str, tuple[Flow, ...]], OMITTED]
    together: Annotated[dict[str, Estimate], INLINE]
    ratios: Annotated[dict[str, Estimate] | None, OPTIONAL] = None
    flows: Annotated[dict[str, Flow] | None, OPTIONAL] = None

    def plain_tables(self) -> list[Table]:
        """Return the tables of the flux over density of each group, length/time, and of the ratios in mixtures."""
        tables = [estimates("Flux over density (length/time), theory ⟨v⟩/π", self.together.items())]
        return [*tables, estimates("Graham's law (no unit)", self.ratios.items())] if self.ratios else tables

    def summary(self) -> str:
        """Return the flux over density of the first group, and whether all fluxes agree with kinetic theory."""
        first, *_ = self.together.values()
        verdict = agreement(self.together.items(), "⟨v⟩/π of kinetic theory")
        return f"The flux over density is {format_estimate(first)}; {verdict}.{ratio_sentence(self.ratios)}"

    def figure(self) -> "Figure":
        """Draw the number of discs beyond the slit against time, and the flux of each group against n⟨v⟩/π."""
        from idealgas.presentation.style import GREY, curve_style, panels

        flows = {name: _mean(runs) for name, runs in self.groups.items()}
        figure, (course, flux) = panels(2)
        for k, (name, flow) in enumerate(flows.items()):
            colour, line, marker = curve_style(k)
            n, speed, label = flow.density, flow.speed, name or "measured"
            course.plot(flow.time, flow.beyond, line, color=colour, label=label)
            if flow.expected is not None:
                course.plot(flow.time, flow.expected, "--", color=GREY, linewidth=0.8, label="kinetic theory")
            if speed.theory is None:
                flux.axhline(n * speed.value, color=colour, linestyle=line, label=f"{name}: no theory")
            else:
                expected, value, error = n * speed.theory, n * speed.value, n * speed.standard_error
                flux.errorbar(expected, value, error, fmt=marker, color=colour, capsize=3, label=label)
        ends = np.array([0.0, 1.1 * max(flow.density * (flow.speed.theory or 0) for flow in flows.values())])
        doubt = max((f.speed.theory_error / f.speed.theory for f in flows.values() if f.speed.theory), default=0.0)
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
        Theory is not available if the slit is wider than a mean free path or if the chamber is dense. Each species of a
        mixture has its own density, mean speed and open length.

        Raises:
            UserError: if the log has no events, if the scene does not have exactly one gate that forms a slit in a wall
                along an axis, if a species does not fit through it, or if no net flow of a species is expected.
        """
        discs, equilibrium, interacting = composition(log.discs), ensemble(log), log.scene.properties.interacting
        gate = slit_of(log)
        across, place, radius, number = gate.across, gate.place, discs.radius, discs.number
        slit, time = gate.width - 2 * radius, _instants(log, gate, start, end)
        beyond, flux = _passages(log, gate, time, progress)
        if beyond[:, 0].sum() > number.sum() / 2:
            beyond, flux, place = number[:, None] - beyond, flux[::-1], log.box[across] - place
        height = log.box[1 - across] - 2 * radius
        area = np.array([(place - 2 * radius) * height, (log.box[across] - place - 2 * radius) * height])
        mean_speed = hard_discs.mean_speed(equilibrium.temperature, discs.mass, equilibrium.dof)
        there, back = flux / mean_speed[:, None] / area[:, :, None]
        home = (beyond[:, 0] > number / 2).astype(int)  # chamber from which the species flows
        drive, both = np.trapezoid(there - back, time) * (1 - 2 * home), np.trapezoid(there + back, time)
        for name, width, net in zip(discs.name, slit, drive, strict=True):
            if not (width > 0 and net > 0):
                of = f" of species '{name}'" if len(slit) > 1 else ""
                need = f"unequal densities{of} in the two chambers" if width > 0 else f"a slit wider than a disc{of}"
                raise UserError(f"{log.path}: effusion requires {need}")
        expected, densities = mean_speed / math.pi, np.array([number - beyond[:, 0], beyond[:, 0]]) / area
        phi = np.array([discs.packing_fraction(density) for density in densities])[home] * interacting
        free = np.empty(len(radius))
        for k in np.unique(home):  # an empty chamber has no free path
            free[home == k] = hard_discs.mixture_free_paths(radius, discs.mass, densities[k])[home == k]
        speed = (beyond[:, -1] - beyond[:, 0]) * (1 - 2 * home) / (slit * drive)
        paths, law = interacting * slit / free, None
        no_law = _no_law(float(paths.max()), float(phi.max()))
        passages = np.maximum(np.abs(speed) * slit * both, 1) if no_law else expected * slit * both
        error = np.sqrt(passages) / (slit * drive)
        theory_error = expected * (LAW_OFF + LAW_OFF_PER_PATH * paths + CROWDING * phi)
        if not no_law:
            leave, come = expected * slit / area
            law = number[:, None] * share_beyond(time, beyond[:, 0] / number, leave, come, number / number.sum())
        flows = {}
        for s, (name, k) in enumerate(zip(discs.name, home, strict=True)):
            known = () if no_law else (float(expected[s]), float(theory_error[s]))
            estimate = Estimate(float(speed[s]), float(error[s]), math.inf, *known)
            density = float(number[s] / area[k, s])
            flows[name] = Flow(density, time, beyond[s], None if law is None else law[s], estimate)
        if gate.others:
            no_law += (f"Theory assumes chambers without other walls; these contain {', '.join(gate.others)}.",)
        first, species = flows[discs.name[0]], flows if len(flows) > 1 else None
        return Effusion(**vars(first), temperature=equilibrium.temperature, species=species, caveats=no_law)

    @staticmethod
    def combine(results: Sequence[Effusion]) -> Effusions:
        """Group runs with the same label and average the flux in each group.

        Raises:
            UserError: if runs with the same label belong to different gases.
        """
        groups = dict[str, tuple[Effusion, ...]]()
        for run in results:
            label = run.origin.label if run.origin else ""
            groups[label] = (*groups.get(label, ()), run)
        flows, ratios = dict[str, tuple[Flow, ...]](), dict[str, Estimate]()
        for label, runs in groups.items():
            must_be_one_gas(runs, f"{label}: different gases under one name")
            each, several = [run.species or {label: run} for run in runs], len(groups) > 1
            names = {s: f"{label}: {s}" if runs[0].species and several else s for s in each[0]}
            flows |= {name: tuple(of[species] for of in each) for species, name in names.items()}
            first, *others = (_mean(flows[name]).speed for name in names.values())
            for name, speed in zip(list(names.values())[1:], others if first.value else (), strict=False):
                ratios[f"{name} / {next(iter(names))}"] = speed.over(first)
        means = {name: _mean(runs) for name, runs in flows.items()}
        together = {name: flow.speed for name, flow in means.items()}
        return Effusions(flows, together, ratios or None, means if any(run.species for run in results) else None)


def ratio_sentence(ratios: Mapping[str, Estimate] | None) -> str:
    """Return a sentence that states the first ratio and whether all agree with Graham's law; empty if there is none."""
    if not ratios:
        return ""
    name, ratio = next(iter(ratios.items()))
    return f" Ratio of the rates {name}: {format_estimate(ratio)}; {agreement(ratios.items())}."


def _mean(runs: Sequence[Flow]) -> Flow:
    """Return the mean flow of several runs."""
    laws = [run.expected for run in runs if run.expected is not None]
    beyond, law = np.mean([run.beyond for run in runs], axis=0), np.mean(laws, axis=0) if laws else None
    return Flow(runs[0].density, runs[0].time, beyond, law, mean_of_replicates([run.speed for run in runs]))


def _passages(log: Log, gate: Slit, time: np.ndarray, progress: ReadProgress | None) -> tuple[np.ndarray, np.ndarray]:
    """Return the numbers of discs above the gate, (S, INSTANTS), and sums of speeds on both sides, (2, S, INSTANTS)."""
    members = [log.discs.species == s for s in range(len(log.discs.species_names))]
    beyond, flux = np.empty((len(members), INSTANTS)), np.empty((2, len(members), INSTANTS))
    for k, state in enumerate(frames(log, time, progress)):
        side, pace = state.position[:, gate.across] > gate.place, np.hypot(*state.velocity.T)
        for s, member in enumerate(members):
            beyond[s, k] = (side & member).sum()
            flux[:, s, k] = pace[~side & member].sum(), pace[side & member].sum()
    return beyond, flux


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


def share_beyond(
    time: np.ndarray, at_first: np.ndarray, leave: np.ndarray, come: np.ndarray, part: np.ndarray
) -> np.ndarray:
    """Return the theoretical fraction of the discs of each species that are beyond the slit, (S, INSTANTS).

    The discs that pass carry a mean energy of 3T/2 instead of T, so that one chamber cools and the other heats up. All
    species in a chamber have the same temperature.

    Args:
        time: (INSTANTS,), times.
        at_first: (S,), fraction of the discs beyond the slit at the first time.
        leave: (S,), rate at which a disc passes from the first chamber to the other at equal temperatures, 1/time.
        come: (S,), rate at which a disc passes back, 1/time.
        part: (S,), fraction of all discs that belongs to the species.
    """
    from scipy.integrate import solve_ivp  # its import takes longer than most measurements

    def change(_: float, shares: np.ndarray) -> np.ndarray:
        """Return the rates of change of the fractions of discs and, in the last row, energy beyond the slit, 1/time."""
        here, there = np.maximum(1 - shares, TINY), np.maximum(shares, TINY)
        # temperatures e/n of both sides; discs pass at rates proportional to n √(e/n), and carry 3/2 e/n
        warm, cool = here[-1] / (part @ here[:-1]), there[-1] / (part @ there[:-1])
        out, back = leave * here[:-1] * math.sqrt(warm), come * there[:-1] * math.sqrt(cool)
        return np.append(out - back, 1.5 * part @ (out * warm - back * cool))

    return solve_ivp(change, (time[0], time[-1]), np.append(at_first, part @ at_first), t_eval=time, rtol=1e-8).y[:-1]


def _instants(log: Log, gate: Slit, start: float | None, end: float | None) -> np.ndarray:
    """Return the times (INSTANTS,) at which the open gate is sampled; raise UserError if there are none."""
    if gate.opens >= log.end_time:
        raise UserError(f"{log.path}: the gate opens at t = {gate.opens:g}, but the log ends at {log.end_time:g}")
    first, last = span(log, start, end)
    if not max(gate.opens, first) < min(gate.closes, last):
        raise UserError(f"{log.path}: the gate is open only from t = {gate.opens:g} to {gate.closes:g}")
    return np.linspace(max(gate.opens, first), min(gate.closes, last), INSTANTS)
