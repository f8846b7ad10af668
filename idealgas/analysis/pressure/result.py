"""Result of a pressure measurement: Z by every route or, without an equation of state, P on every wall."""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from itertools import cycle
from typing import TYPE_CHECKING, Annotated

from idealgas.analysis.check import CheckResult, agreement, check_theory
from idealgas.analysis.pressure.mechanical import Mechanical, WallPressure
from idealgas.analysis.pressure.routes import PAIRS, WALLS, PressureRoute
from idealgas.analysis.result import Result
from idealgas.errors import UserError, unknown
from idealgas.fields import INLINE, Key
from idealgas.presentation.tables import Table, estimates, format_estimate, pressure_table, with_error
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.collisions import CollisionRate, FreePath, collision_tables
from idealgas.tallies.equilibration import Window
from idealgas.theory.values import IDEAL

if TYPE_CHECKING:
    from matplotlib.figure import Figure

"""Name of the theory of the ideal gas, Z = 1."""

CLEAR = 5.0
"""Difference between two pressures, in combined standard errors, above which the headline quotes both."""

MOST_WALLS = 4
"""Largest number of pressures in the headline; if there are more, it quotes only the lowest and the highest."""

WALLS_AND_VIRIAL = (
    "Walls act on the centres of discs, which cannot reach the sides of the box: the force per length on a wall is "
    "larger than the pressure from the virial, and theory predicts a value for each."
)


@dataclass(frozen=True)
class Pressure(Result):
    """Pressure of one log by every route, with theory, collision rates and free paths from the same events.

    A gas without an equation of state has only the mechanical pressure on every wall: no routes, theories, rates or
    paths.

    Attributes:
        window: window of time that was averaged.
        number: number of discs.
        area: area of the box, length²; without an equation of state the mean area of the gas.
        temperature: temperature, energy (k_B = 1); without an equation of state the mean m v²/2 of discs over time.
        packing_fraction: packing fraction, no unit.
        routes: pressure and Z by each route.
        theories: Z according to each theory that applies, by the name of the theory.
        theory_errors: standard error of each value of `theories`, by the name of the theory.
        collision_rates: collision rate of each pair of species.
        free_paths: mean free path and mean free time of each species; empty without events or without interactions.
        tensor: components xx, yy and xy of the pressure tensor, energy/length².
        no_theory: why no theory applies to this gas in its box, as part of a sentence; None if one applies.
        mechanical: pressure on every wall of a gas without an equation of state; None for other gases.
    """

    window: Window
    number: int
    area: float
    temperature: float
    packing_fraction: float
    routes: tuple[PressureRoute, ...]
    theories: dict[str, float]
    theory_errors: dict[str, float]
    collision_rates: tuple[CollisionRate, ...]
    free_paths: tuple[FreePath, ...]
    tensor: Annotated[dict[str, Estimate], Key("pressure_tensor")]
    no_theory: str | None = None
    mechanical: Annotated[Mechanical | None, INLINE] = None

    def route(self, name: str) -> PressureRoute:
        """Return the pressure by one route.

        Raises:
            UserError: if there is no such route; if there are no routes at all, the message gives the reason.
        """
        if not self.routes:
            raise UserError(f"{self.origin.path}: {self.no_theory}" if self.origin else self.no_theory or "")
        names = [route.name for route in self.routes]
        if name not in names:
            raise unknown("route", name, names)
        return self.routes[names.index(name)]

    def check(self) -> CheckResult:
        """Check that Z from the virial of the walls and Z from the virial of the pairs agree with theory."""
        virials = (route for route in self.routes if route.name.startswith((WALLS, PAIRS)))
        return check_theory(((r.name, r.source, r.compressibility_factor) for r in virials), self.no_theory)

    def plain_tables(self) -> list[Table]:
        """Return the tables of routes, theories and collisions, or the tables of the pressure on every wall."""
        if self.mechanical:
            return self._wall_tables(self.mechanical)
        gas = (f"N = {self.number}, A = {self.area:g}, φ = {self.packing_fraction:.5g}, T = {self.temperature:.6g}",)
        exact = (1.0, self.routes[-1].compressibility_factor.theory)  # of the ideal gas, and of this N in this box
        theories = [
            (name if z in exact else f"{name}, N → ∞", *with_error(z, self.theory_errors[name]))
            for name, z in self.theories.items()
        ]
        missing = (f"Theory is not available: {self.no_theory}.",) if self.no_theory else ()
        return [
            estimates(
                "Z = PA/NT (no unit)",
                [(route.name, route.compressibility_factor) for route in self.routes],
                (str(self.window), *gas, WALLS_AND_VIRIAL),
            ),
            Table("Z by theory (no unit)", ("", "value", "± error"), theories, missing),
            estimates(
                "P (energy/length²)",
                [(route.name, route.pressure) for route in self.routes],
                (f"ideal gas: P = N T/A = {self.number * self.temperature / self.area:.6g}",),
            ),
            pressure_table(self.tensor),
            *collision_tables(self.collision_rates, self.free_paths),
        ]

    def _wall_tables(self, mechanical: Mechanical) -> list[Table]:
        """Return the tables of the mechanical pressure on every wall and of the forces on the walls."""
        ideal = self.number * self.temperature / self.area
        notes = [
            str(self.window),
            f"N = {self.number}, A = {self.area:.6g}, φ = {self.packing_fraction:.5g}, kinetic energy per disc "
            f"{self.temperature:.6g}, ideal gas N T/A = {ideal:.6g} in all of A (means over the window)",
            f"Theory is not available: {self.no_theory}.",
        ]
        if mechanical.unsteady:
            notes.append(f"Never stationary, as {mechanical.unsteady}: values are means; `evolution` shows P(t).")
        forces = [
            (f"{force.name}, {axis}", value) for force in mechanical.forces for axis, value in force.large.items()
        ]
        along = [(wall.name, wall.stress) for wall in mechanical.walls if wall.stress]
        return [
            estimates(
                "P on each wall (energy/length²)", [(wall.name, wall.pressure) for wall in mechanical.walls], notes
            ),
            estimates("Force of the discs on walls (energy/length)", forces),
            *([estimates("Stress along walls (energy/length²)", along)] if along else []),
        ]

    def summary(self) -> str:
        """Return the headline: Z compared with the ideal gas and hard discs, or the pressure on the walls.

        If the external pressure on some walls is known, only these walls are named.
        """
        ideal = self.number * self.temperature / self.area
        if self.mechanical:
            walls = self.mechanical.walls
            shown = [wall for wall in walls if wall.pressure.theory is not None] or _unlike(walls)
            beside = f"N T/A of an ideal gas is {ideal:.4g}; "
            verdict = agreement([(wall.name, wall.pressure) for wall in shown], "the external pressure", self.no_theory)
            pressures = _on_walls(walls, shown)
            return f"P = {pressures or 'unknown without walls'}; {beside}{verdict}."
        (z,) = (route.compressibility_factor for route in self.routes if route.name == PAIRS)
        more = z.value - 1
        beside = f"{abs(100 * more):.2g} % {'above' if more > 0 else 'below'} the ideal gas"
        if abs(more) <= z.standard_error:
            beside = "an ideal gas within the error"
        theory = f"hard discs at φ = {self.packing_fraction:.3g}" if len(self.theories) > 1 else "theory"
        return f"P A = {format_estimate(z)} N T: {beside}; {agreement([(PAIRS, z)], theory, self.no_theory)}."

    def figure(self) -> "Figure":
        """Draw Z by every route with the theory for this gas in its box, or the pressure on every wall."""
        from idealgas.presentation.style import BLACK, COLOURS, GREY, LINES, name_rows, panels

        if self.mechanical:
            return self._wall_figure(self.mechanical)
        figure, (ax,) = panels(1)
        routes = self.routes[::-1]
        values = [route.compressibility_factor.value for route in routes]
        errors = [route.compressibility_factor.standard_error for route in routes]
        known = [route.compressibility_factor.theory for route in routes]
        last = max((k for k, z in enumerate(known) if z), default=None)
        for k, route in enumerate(routes):
            label = "theory, ± its error" if k == last else None
            ax.theory_of_row(k, route.compressibility_factor, label)
        ax.errorbar(values, range(len(routes)), xerr=errors, fmt="o", color=COLOURS[0], capsize=3, label="measured")
        name_rows(ax, [route.name for route in routes])
        low, high = ax.get_xlim()
        for (name, z), style in zip(self.theories.items(), cycle(LINES), strict=False):
            shown = name == IDEAL or low < z < high
            if shown and z not in known:
                colour = BLACK if name == IDEAL else GREY
                ax.axvline(z, color=colour, linestyle=style, linewidth=1, label=f"{name}: {z:.5g}")
        ax.set(
            xlabel="Z = PA/NT (no unit)", ylabel=f"Z by every route, at packing fraction {self.packing_fraction:.4g}"
        )
        figure.legend(frameon=False, fontsize="small", loc="outside lower left", ncols=2)
        return figure

    def _wall_figure(self, pressures: Mechanical) -> "Figure":
        """Draw the mechanical pressure on every wall and the external pressure on pistons."""
        from idealgas.presentation.style import BLACK, COLOURS, name_rows, panels

        figure, (ax,) = panels(1)
        walls = pressures.walls[::-1]
        values, errors = [w.pressure.value for w in walls], [w.pressure.standard_error for w in walls]
        ax.errorbar(values, range(len(walls)), xerr=errors, fmt="o", color=COLOURS[0], capsize=3, label="measured")
        for k, wall in enumerate(walls):
            ax.theory_of_row(k, wall.pressure, "external pressure")
        ideal = self.number * self.temperature / self.area
        ax.axvline(ideal, color=BLACK, linewidth=1, label=f"{IDEAL}, N T/A: {ideal:.5g}")
        name_rows(ax, [wall.name for wall in walls])
        ax.set(xlabel="P (energy/length²)", ylabel="pressure on every wall")
        figure.legend(frameon=False, fontsize="small", loc="outside lower left", ncols=2)
        return figure


def _unlike(walls: Sequence[WallPressure]) -> list[WallPressure]:
    """Return the first wall that was hit, and each further wall whose pressure clearly differs from all before it."""
    unlike: list[WallPressure] = []
    for wall in (wall for wall in walls if not math.isnan(wall.pressure.standard_error)):
        p = wall.pressure
        before = [previous.pressure for previous in unlike]
        if all(abs(p.value - q.value) > CLEAR * math.hypot(p.standard_error, q.standard_error) for q in before):
            unlike.append(wall)
    return unlike


def _place(name: str) -> str:
    """Return the name of a side of the box, or of a face of another wall, as part of a sentence."""
    wall, _, direction = name.rpartition(", ")
    if direction in ("inside", "outside"):
        return f"the {direction} of {wall}"
    return f"the face of {wall} that looks {direction}" if wall else f"the {name}"


def _on_walls(walls: Sequence[WallPressure], shown: Sequence[WallPressure]) -> str:
    """Return the pressures on the shown walls as part of a sentence; if there are many, the lowest and the highest.

    If further faces inside the box have nearly the same pressures, their number is appended.
    """
    many = len(shown) > MOST_WALLS
    by_pressure = sorted(shown, key=lambda wall: wall.pressure.value)
    named = (by_pressure[0], by_pressure[-1]) if many else shown
    places = (f"{format_estimate(wall.pressure)} on {_place(wall.name)}" for wall in named)
    pressures = " to ".join(places) if many else ", ".join(places)
    others = sum(not math.isnan(wall.pressure.standard_error) for wall in walls) - len(shown)
    stand_for_others = all(", " in wall.name and wall.pressure.theory is None for wall in shown)
    if many or not others or not stand_for_others:
        return pressures
    return f"{pressures}, and within {CLEAR:g} standard errors of this on {others} other face{'s' * (others > 1)}"
