"""Equation of state Z(φ) from the pressures of many runs, compared with theory, with fitted virial coefficients."""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

import numpy as np

from idealgas.analysis.caveats import by_state, name_of_state, seeds_of
from idealgas.analysis.check import CheckResult, agreement, check_theory
from idealgas.analysis.pressure.result import Pressure
from idealgas.analysis.pressure.routes import PAIRS
from idealgas.analysis.result import Result
from idealgas.errors import UserError
from idealgas.fields import Key
from idealgas.presentation.tables import Cell, Number, Table, estimates, format_estimate, with_error
from idealgas.statistics.estimates import Estimate, mean_of_replicates
from idealgas.theory import hard_discs
from idealgas.theory.values import FREEZING, MELTING, PUBLISHED, SOLID, crystal

if TYPE_CHECKING:
    from matplotlib.axes import Axes
    from matplotlib.figure import Figure

FITTED = 0.25
"""Largest packing fraction in the fit of virial coefficients."""

RESUMMED = "virial series, resummed"
"""Name of the theory for a fluid."""

FREE_TERMS = 3
"""Number of virial coefficients that are fitted, starting with B2; higher coefficients have their known values.

The fit requires at least one more packing fraction than it has coefficients.
"""


@dataclass(frozen=True)
class PressureState:
    """Compressibility factor Z (no unit) at one packing fraction and one number of discs.

    Attributes:
        name: φ, N, seeds and kind of gas, in words.
        packing_fraction: packing fraction φ.
        number: number of discs.
        kind: kind of gas in words; empty if unknown.
        runs: number of runs.
        seeds: seeds of the runs.
        compressibility_factor: mean of Z over the runs, with the theory for this number of discs in this box.
        infinite: up to φ = 0.62, Z of an infinite gas: the measured Z times the ratio of the theories for N → ∞ and for
            this N, compared with the resummed virial series. At higher φ, or if the ratio is not known, Z as measured,
            compared with published simulations or, for a crystal, with free-volume theory, if available.
        source: name of the theory of `infinite`; None if there is no theory.
        virial: virial series to B10; None above φ = 0.62.
        henderson: equation of state of Henderson (1975); None above φ = 0.62.
    """

    name: str
    packing_fraction: float
    number: int
    kind: Annotated[str, Key("gas")]
    runs: int
    seeds: tuple[int, ...]
    compressibility_factor: Annotated[Estimate, Key("Z_of_this_N")]
    infinite: Annotated[Estimate, Key("Z")]
    source: Annotated[str | None, Key("theory")]
    virial: Annotated[float | None, Key("virial_series_to_B10")]
    henderson: float | None


@dataclass(frozen=True)
class EquationOfState(Result):
    """Equation of state: states in order of φ, and the fitted virial coefficients (no unit).

    Attributes:
        states: compressibility factors in order of φ.
        b2: B2 in units of the area of a disc; its exact value is 2. None if there are too few states for the fit.
        b3: B3/B2²; None if there are too few states for the fit.
    """

    states: tuple[PressureState, ...]
    b2: Annotated[Estimate | None, Key("B2")]
    b3: Annotated[Estimate | None, Key("B3")]

    def check(self) -> CheckResult:
        """Check that Z agrees with theory in every state for which theory is available."""
        several = len(self.kinds) > 1
        names = (f"φ = {s.packing_fraction:.5g}, N = {s.number}" + f", {s.kind}" * several for s in self.states)
        reason = f"no equation of state is known for a packing fraction of {self.states[0].packing_fraction:.5g}"
        return check_theory(((n, s.source, s.infinite) for n, s in zip(names, self.states, strict=True)), reason)

    @property
    def kinds(self) -> tuple[str, ...]:
        """Kinds of gas of the states, in words."""
        return tuple(dict.fromkeys(state.kind for state in self.states))

    def plain_tables(self) -> list[Table]:
        """Return the tables of the states and of the virial coefficients."""
        several = len(self.kinds) > 1
        heads = (
            *["gas"] * several,
            "φ",
            "N",
            "runs",
            "Z",
            "± s.e.",
            "deviation (σ)",
            "theory",
            "to B10",
            "Henderson",
            "which theory",
        )
        rows: list[tuple[Cell, ...]] = [
            (
                *((state.kind,) if several else ()),
                Number(state.packing_fraction, ".5g"),
                Number(state.number, "d"),
                Number(state.runs, "d"),
                *with_error(state.infinite.value, state.infinite.standard_error),
                Number(state.infinite.deviation, "+.2f"),
                *(Number(value, ".5f") for value in (state.infinite.theory, state.virial, state.henderson)),
                state.source or "",
            )
            for state in self.states
        ]
        states = Table("Z = PA/NT: for N → ∞ up to φ = 0.62, for this N above; deviations are from theory", heads, rows)
        if self.b2 is None or self.b3 is None:
            notes = (
                f"No virial coefficients: a fit requires {FREE_TERMS + 1} packing fractions or more, up to {FITTED:g}.",
            )
            return [states, estimates("Virial coefficients, fitted", [], notes)]
        fitted = [("B2 in units of the disc's area", self.b2), ("B3/B2²", self.b3)]
        return [states, estimates("Virial coefficients, fitted", fitted)]

    def summary(self) -> str:
        """Return the headline: Z of the densest state and B2, and whether they agree with theory."""
        rows = [(f"φ = {state.packing_fraction:.5g}", state.infinite) for state in self.states]
        name, z = rows[-1]
        sentence = f"P A = {format_estimate(z)} N T at {name} (1 for the ideal gas); {agreement(rows, 'hard discs')}."
        if self.b2 is not None:
            sentence += f" B2 = {format_estimate(self.b2)} disc areas; {agreement([('B2', self.b2)])}."
        return sentence

    def figure(self) -> "Figure":
        """Draw Z against φ with the theories and, in a second panel, the deviation of each state from theory."""
        from idealgas.presentation.style import BAND, COLOURS, GREY, panels

        figure, (above, below) = panels(2)
        phi = np.array([state.packing_fraction for state in self.states])
        z = np.array([state.infinite.value for state in self.states])
        error = np.array([state.infinite.standard_error for state in self.states])
        best = np.array([state.infinite.theory or np.nan for state in self.states])
        band = 1e3 * np.array([state.infinite.theory_error for state in self.states]) / best
        x = np.linspace(1e-9, min(1.05 * phi.max(), hard_discs.HIGHEST), 400)
        curves = (
            ("virial series, resummed", hard_discs.compressibility_factor, "-", COLOURS[1]),
            ("virial series to B10", hard_discs.virial_series, "--", COLOURS[2]),
            ("Henderson 1975", hard_discs.henderson_compressibility_factor, ":", COLOURS[3]),
        )
        above.axhline(1.0, color=GREY, label="ideal gas")
        for name, function, style, colour in curves:
            above.plot(x, function(x), style, color=colour, label=name)
            below.plot(x, 1e3 * (function(x) / hard_discs.compressibility_factor(x) - 1), style, color=colour)
        if phi.max() > hard_discs.HIGHEST:
            _draw_dense(above, float(phi.max()))
        above.errorbar(phi, z, error, fmt="o", ms=4, color=COLOURS[0], label="measured")
        below.fill_between(phi, -band, band, color=COLOURS[1], alpha=BAND, linewidth=0)
        below.errorbar(phi, 1e3 * (z / best - 1), 1e3 * error / best, fmt="o", ms=4, color=COLOURS[0], capsize=3)
        if np.isfinite(best).any():
            low, high = (1e3 * (z / best - 1 + sign * 3 * error / best) for sign in (-1, 1))
            below.set_ylim(min(np.nanmin(low), 0.0), max(np.nanmax(high), 0.0))
        above.set_ylabel("Z = PA/NT (no unit)")
        below.set(ylabel="deviation from theory (‰ of Z)", xlabel="packing fraction φ (no unit)")
        below.set_xlim(above.get_xlim())
        above.legend(frameon=False, fontsize="small")
        return figure


def equation_of_state(results: Sequence[Pressure]) -> EquationOfState:
    """Return the equation of state from many runs, averaged over runs with the same kind of gas, number of discs and φ.

    Raises:
        UserError: if the gas of a run is a mixture or has no equation of state.
    """
    if mixed := next((r.origin for r in results if r.origin and r.origin.mixture), None):
        raise UserError(
            f"{mixed.path}: an equation of state requires equal discs, as Z of a {mixed.kind} does not follow from φ "
            "alone; use `idealgas pressure` on the single log to compare it with theory"
        )
    states = tuple(_state(kind, runs) for kind, runs in by_state(results))
    b2, b3 = _virial_coefficients(states)
    result = EquationOfState(states, b2, b3)
    if len(result.kinds) == 1:
        return result
    sentence = f"The states belong to different gases, each in a separate row: {'; '.join(result.kinds)}."
    return replace(result, caveats=(sentence,))


def _state(kind: str, runs: Sequence[Pressure]) -> PressureState:
    phi = float(np.mean([run.packing_fraction for run in runs]))
    measured = mean_of_replicates([run.route(PAIRS).compressibility_factor for run in runs])
    fluid = phi <= hard_discs.HIGHEST
    infinite, source = measured, "published simulations" if measured.theory is not None else None
    if fluid and measured.theory is not None:
        infinite, source = measured.times(float(hard_discs.compressibility_factor(phi)) / measured.theory), RESUMMED
    elif SOLID <= phi < hard_discs.CLOSE_PACKING and measured.theory is None:
        solid = crystal(phi)
        infinite, source = replace(measured, theory=solid.value, theory_error=solid.error), solid.source
    seeds = seeds_of(runs)
    return PressureState(
        name_of_state(phi, runs[0].number, kind, seeds),
        phi,
        runs[0].number,
        kind,
        len(runs),
        seeds,
        measured,
        infinite,
        source,
        virial=float(hard_discs.virial_series(phi)) if fluid else None,
        henderson=float(hard_discs.henderson_compressibility_factor(phi)) if fluid else None,
    )


def _virial_coefficients(states: Sequence[PressureState]) -> tuple[Estimate | None, Estimate | None]:
    """Fit the virial coefficients B2 and B3 to (Z - 1)/2φ = Σ b_k (2φ)^(k - 2) by weighted least squares."""
    used = [s for s in states if 0 < s.packing_fraction <= FITTED and s.source and s.infinite.standard_error > 0]
    if len({round(s.packing_fraction, 6) for s in used}) <= FREE_TERMS:
        return None, None
    density = np.array([2 * s.packing_fraction for s in used])
    known = np.array(hard_discs.VIRIAL[1 + FREE_TERMS :])
    powers = np.vander(density, len(hard_discs.VIRIAL) - 1, increasing=True)
    y = np.array([s.infinite.value - 1 for s in used]) / density - powers[:, FREE_TERMS:] @ known
    error = np.array([s.infinite.standard_error for s in used]) / density
    design = powers[:, :FREE_TERMS] / error[:, None]
    covariance = np.linalg.inv(design.T @ design)
    b = covariance @ design.T @ (y / error)
    samples = float(sum(s.infinite.independent_samples for s in used))
    b2 = Estimate(float(2 * b[0]), float(2 * np.sqrt(covariance[0, 0])), samples, theory=2.0)
    ratio = b[1] / b[0] ** 2
    slope = np.array([-2 * b[1] / b[0] ** 3, 1 / b[0] ** 2])
    b3_error = float(np.sqrt(slope @ covariance[:2, :2] @ slope))
    return b2, Estimate(float(ratio), b3_error, samples, theory=hard_discs.VIRIAL[2])


def _draw_dense(ax: "Axes", most: float) -> None:
    """Draw what is known at densities beyond the virial series: published points, coexistence, and the crystal."""
    from idealgas.presentation.style import COLOURS, GREY

    published, pressure = np.array(list(PUBLISHED)), np.array([value for value, _ in PUBLISHED.values()])
    points = pressure * np.pi / (4 * published)
    ax.plot(published, points, "D", ms=7, mfc="none", color=COLOURS[4], label="870 discs, Li et al. 2022")
    ax.axvspan(FREEZING, MELTING, color=GREY, alpha=0.2, label="two phases in a large gas")
    if most > SOLID:
        x = np.linspace(SOLID, min(1.01 * most, 0.99 * hard_discs.CLOSE_PACKING), 200)
        ax.plot(
            x,
            hard_discs.free_volume_compressibility_factor(x),
            "-.",
            color=COLOURS[5],
            label="free-volume theory of a crystal",
        )
        ax.set_yscale("log")
