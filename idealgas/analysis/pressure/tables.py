"""Tables of the pressure and of the equation of state."""

import math
from collections.abc import Sequence

from idealgas.analysis.check import agreement
from idealgas.analysis.pressure.equation_of_state import FITTED, FREE_TERMS, EquationOfState
from idealgas.analysis.pressure.measure import Pressure
from idealgas.analysis.pressure.mechanical import Mechanical, WallPressure
from idealgas.analysis.pressure.routes import PAIRS
from idealgas.presentation.tables import Cell, Number, Table, estimates, format_estimate, pressure_table, with_error
from idealgas.tallies.collisions import collision_tables

CLEAR = 5.0
"""Difference of two pressures, in units of their joint error, from which on the headline quotes both."""

MOST_WALLS = 4
"""Number of pressures above which the headline quotes only the lowest and the highest."""

WALLS_AND_VIRIAL = (
    "Walls act on the centres of discs, which reach less far than the box: the force per length of a wall is larger "
    "than the pressure by the virial, and each has its own theory."
)


def pressure_tables(result: Pressure | EquationOfState) -> list[Table]:
    """Return the tables of routes, theories and collisions of one log, or of states and virial coefficients."""
    return _of_states(result) if isinstance(result, EquationOfState) else _of_log(result)


def _of_walls(result: Pressure, mechanical: Mechanical) -> list[Table]:
    """Return the tables of the mechanical pressure on every wall, and of the forces on the walls."""
    ideal = result.number * result.temperature / result.area
    notes = [
        str(result.window),
        f"N = {result.number}, A = {result.area:.6g}, φ = {result.packing_fraction:.5g}, kinetic "
        f"energy per disc {result.temperature:.6g}, ideal gas N T/A = {ideal:.6g} in all of A (means over the window)",
        f"Theory is not available: {result.no_theory}.",
    ]
    if mechanical.unsteady:
        notes.append(f"Never stationary, as {mechanical.unsteady}: means over the window; `evolution` shows P(t).")
    forces = [(f"{force.name}, {axis}", value) for force in mechanical.forces for axis, value in force.large.items()]
    along = [(wall.name, wall.stress) for wall in mechanical.walls if wall.stress]
    return [
        estimates("P on each wall (energy/length²)", [(wall.name, wall.pressure) for wall in mechanical.walls], notes),
        estimates("Force of the discs on walls (energy/length)", forces),
        *([estimates("Stress along walls (energy/length²)", along)] if along else []),
    ]


def _of_log(result: Pressure) -> list[Table]:
    if result.mechanical:
        return _of_walls(result, result.mechanical)
    gas = (
        f"N = {result.number}, A = {result.area:g}, φ = {result.packing_fraction:.5g}, T = {result.temperature:.6g}",
    )
    exact = (
        1.0,
        result.routes[-1].compressibility_factor.theory,
    )  # of the ideal gas, and of this number of discs in this box
    theories = [
        (name if theory.value in exact else f"{name}, N → ∞", *with_error(theory.value, theory.error))
        for name, theory in result.known_theories.items()
    ]
    missing = (f"Theory is not available: {result.no_theory}.",) if result.no_theory else ()
    return [
        estimates(
            "Z = PA/NT (no unit)",
            [(route.name, route.compressibility_factor) for route in result.routes],
            (str(result.window), *gas, WALLS_AND_VIRIAL),
        ),
        Table("Z by theory (no unit)", ("", "value", "± error"), theories, missing),
        estimates(
            "P (energy/length²)",
            [(route.name, route.pressure) for route in result.routes],
            (f"ideal gas: P = N T/A = {result.number * result.temperature / result.area:.6g}",),
        ),
        pressure_table(result.tensor),
        *collision_tables(result.collision_rates, result.free_paths),
    ]


def _of_states(result: EquationOfState) -> list[Table]:
    several = len(result.kinds) > 1
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
        for state in result.states
    ]
    states = Table("Z = PA/NT: for N → ∞ up to φ = 0.62, of this N above; deviations are from theory", heads, rows)
    if result.b2 is None or result.b3 is None:
        notes = (f"No virial coefficients: a fit takes {FREE_TERMS + 1} packing fractions or more, up to {FITTED:g}.",)
        return [states, estimates("Virial coefficients, fitted", [], notes)]
    fitted = [("B2 in units of the disc's area", result.b2), ("B3/B2²", result.b3)]
    return [states, estimates("Virial coefficients, fitted", fitted)]


def _unlike(walls: Sequence[WallPressure]) -> list[WallPressure]:
    """Return the first wall that was hit, and each further wall whose pressure clearly differs from those before it."""
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

    Walls that stand for other faces inside the box are followed by the number of these faces.
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


def pressure_summary(result: Pressure | EquationOfState) -> str:
    """Return Z beside the ideal gas and hard discs, or the pressure on the walls of a gas without an equation of state.

    If the external pressure on a wall is known, only such walls are named.
    """
    if isinstance(result, EquationOfState):
        return _summary_of_states(result)
    ideal = result.number * result.temperature / result.area
    if result.mechanical:
        walls = result.mechanical.walls
        shown = [wall for wall in walls if wall.pressure.theory is not None] or _unlike(walls)
        beside = f"N T/A of an ideal gas is {ideal:.4g}; "
        verdict = agreement([(wall.name, wall.pressure) for wall in shown], "the external pressure", result.no_theory)
        pressures = _on_walls(walls, shown)
        return f"P = {pressures or 'unknown without walls'}; {beside}{verdict}."
    (z,) = (route.compressibility_factor for route in result.routes if route.name == PAIRS)
    more = z.value - 1
    beside = f"{abs(100 * more):.2g} % {'above' if more > 0 else 'below'} the ideal gas"
    if abs(more) <= z.standard_error:
        beside = "an ideal gas within the error"
    theory = f"hard discs at φ = {result.packing_fraction:.3g}"
    return f"P A = {format_estimate(z)} N T: {beside}; {agreement([(PAIRS, z)], theory, result.no_theory)}."


def _summary_of_states(result: EquationOfState) -> str:
    rows = [(f"φ = {state.packing_fraction:.5g}", state.infinite) for state in result.states]
    name, z = rows[-1]
    sentence = f"P A = {format_estimate(z)} N T at {name} (1 for the ideal gas); {agreement(rows, 'hard discs')}."
    if result.b2 is not None:
        sentence += f" B2 = {format_estimate(result.b2)} areas of a disc; {agreement([('B2', result.b2)])}."
    return sentence
