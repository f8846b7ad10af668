"""Tables of the transport in a gas."""

from dataclasses import replace

from idealgas.analysis.check import agreement
from idealgas.analysis.transport.coefficients import SYMBOLS, Coefficient, Collective
from idealgas.analysis.transport.combine import States
from idealgas.analysis.transport.measure import Transport
from idealgas.presentation.tables import (
    THEORY_ERROR,
    Cell,
    Number,
    Table,
    estimates,
    format_estimate,
    pressure_table,
    with_error,
)
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.collisions import collision_tables

WALLS = (
    "No viscosities and thermal conductivity: they need periodic sides and nothing else in the box, as walls change "
    "the currents of the gas."
)


def transport_tables(result: Transport | States) -> list[Table]:
    """Return the tables of one log, or of the coefficients of several logs."""
    return _of_states(result) if isinstance(result, States) else _of_log(result)


def _of_states(result: States) -> list[Table]:
    rows: list[tuple[Cell, ...]] = [
        (
            f"{symbol} at φ = {state.packing_fraction:.5g}",
            Number(state.number, "d"),
            Number(state.runs, "d"),
            *with_error(estimate.value, estimate.standard_error),
            Number(estimate.theory_error, ".2g"),
            Number(estimate.deviation, "+.2f"),
        )
        for state in result.states
        for symbol, estimate in state.coefficients.items()
    ]
    heads = ("", "N", "runs", "value", "± s.e.", THEORY_ERROR, "deviation (σ)")
    return [Table("Transport coefficients over Enskog's", heads, rows)]


def _of_log(result: Transport) -> list[Table]:
    """Return the tables of collisions, pair distribution at contact, diffusion of each species, and coefficients."""
    rates, paths = collision_tables(result.collision_rates, result.free_paths)
    contacts = [(f"{contact.species} and {contact.other}", contact.value) for contact in result.contacts]
    diffusion, lags = [], []
    for entry in result.diffusion:
        if entry.plateau and entry.coefficient and entry.velocity_correlation_time:
            diffusion += [
                (f"{entry.species}: D by displacement, length²/time", entry.coefficient),
                (f"{entry.species}: velocity correlation time, time", entry.velocity_correlation_time),
            ]
            lags.append(f"{entry.species}: lags t = {entry.plateau[0]:.4g} to {entry.plateau[1]:.4g}")
    tables = [replace(rates, notes=(str(result.window),)), paths, estimates("g(r) at contact (no unit)", contacts)]
    tables.append(estimates("Diffusion, theory Enskog's", diffusion, (*lags, *([] if result.collective else [WALLS]))))
    if result.collective:
        tables += _of_currents(result.collective, result.free_times)
    tables.append(pressure_table(result.pressure))
    return [table for table in tables if table.rows or table.notes]


def _of_currents(collective: Collective, free_times: float) -> list[Table]:
    first, last = collective.plateau
    plateau = (
        f"plateau: t = {first:.4g} to {last:.4g} ({free_times * first / last:.3g} to {free_times:.3g} mean free times)"
    )
    rows = {name: _rows(SYMBOLS[name], coefficient) for name, coefficient in collective.coefficients.items()}
    mutual = rows.pop("mutual_diffusion", [])
    currents = [row for each in rows.values() for row in each]
    return [
        estimates("Viscosity η, thermal conductivity λ and bulk viscosity ζ, theory Enskog's", currents, (plateau,)),
        estimates("Diffusion of two species in each other (Maxwell and Stefan), theory Enskog's", mutual),
    ]


def _rows(name: str, coefficient: Coefficient) -> list[tuple[str, Estimate]]:
    """Return the rows of a coefficient and, if there are several routes, of each route and of their difference."""
    rows = [(f"{name}, {coefficient.unit}", coefficient.value)]
    if coefficient.difference is not None:
        first_route, second_route = coefficient.routes
        rows += [(f"   by {route}", value) for route, value in coefficient.routes.items()]
        rows.append((f"   {first_route} minus {second_route}", coefficient.difference))
    return rows


def transport_summary(result: Transport | States) -> str:
    """Return diffusion coefficients, or else mean free paths, and whether all coefficients agree with theory."""
    if isinstance(result, States):
        rows = [
            (f"{symbol} at φ = {state.packing_fraction:.5g}", estimate)
            for state in result.states
            for symbol, estimate in state.coefficients.items()
        ]
        last = result.states[-1]
        values = ", ".join(f"{symbol} = {format_estimate(value)}" for symbol, value in last.coefficients.items())
        values = values or "no coefficient has a theory"
        densest = f"At φ = {last.packing_fraction:.5g}, in units of Enskog's values, {values}"
        return f"{densest}; {agreement(rows, 'Enskog')}."
    rows = [(f"D of {entry.species}", entry.coefficient) for entry in result.diffusion if entry.coefficient]
    if result.collective:
        rows += [(SYMBOLS[name], estimate.value) for name, estimate in result.collective.coefficients.items()]
    theory = "Enskog's theory"
    if not rows:
        theory, rows = (
            "kinetic theory",
            [(f"Mean free path of {estimate.species}", estimate.path) for estimate in result.free_paths],
        )
    sentence = ", ".join(f"{name} = {format_estimate(estimate)}" for name, estimate in rows)
    return f"{sentence}; {agreement(rows, theory)}."
