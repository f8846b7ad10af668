"""Result of a measurement of transport in the gas of one log."""

from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated

from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result
from idealgas.analysis.transport.coefficients import SYMBOLS, Coefficient, Collective
from idealgas.analysis.transport.diffusion import Diffusion
from idealgas.analysis.transport.pair_distribution import Contact, PairDistribution
from idealgas.fields import Key
from idealgas.presentation.tables import Table, estimates, format_estimate, pressure_table
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.collisions import CollisionRate, FreePath, collision_tables
from idealgas.tallies.equilibration import Window

if TYPE_CHECKING:
    from matplotlib.figure import Figure

WALLS = (
    "No viscosities or thermal conductivity: they require periodic sides and nothing else in the box, as walls change "
    "the currents of the gas."
)


@dataclass(frozen=True)
class Transport(Result):
    """Transport in the gas of one log.

    Attributes:
        window: window of time that was used.
        packing_fraction: packing fraction φ.
        number: number of discs.
        free_times: longest lag up to which discs and currents are followed, in mean free times of the species that
            collides least often.
        walled: whether walls reflect diffusing discs.
        collision_rates: collision rate of each pair of species.
        free_paths: mean free path and mean free time of each species.
        contacts: contact value of each pair of species.
        diffusion: diffusion of each species.
        collective: viscosities and thermal conductivity; None if there are walls, which change the currents.
        pressure: components xx, yy and xy of the pressure tensor, energy/length².
        pair_distributions: pair distribution of each pair of species.
    """

    window: Window
    packing_fraction: float
    number: int
    free_times: float
    walled: bool
    collision_rates: tuple[CollisionRate, ...]
    free_paths: tuple[FreePath, ...]
    contacts: tuple[Contact, ...]
    diffusion: tuple[Diffusion, ...]
    collective: Collective | None
    pressure: Annotated[dict[str, Estimate], Key("pressure_tensor")]
    pair_distributions: tuple[PairDistribution, ...]

    def plain_tables(self) -> list[Table]:
        """Return the tables of collisions, contact values, diffusion, coefficients and pressure tensor."""
        rates, paths = collision_tables(self.collision_rates, self.free_paths)
        contacts = [(f"{contact.species} and {contact.other}", contact.value) for contact in self.contacts]
        diffusion, lags = [], []
        for entry in self.diffusion:
            if entry.plateau and entry.coefficient and entry.velocity_correlation_time:
                diffusion += [
                    (f"{entry.species}: D by displacement, length²/time", entry.coefficient),
                    (f"{entry.species}: velocity correlation time, time", entry.velocity_correlation_time),
                ]
                lags.append(f"{entry.species}: lags t = {entry.plateau[0]:.4g} to {entry.plateau[1]:.4g}")
        tables = [replace(rates, notes=(str(self.window),)), paths, estimates("g(r) at contact (no unit)", contacts)]
        tables.append(
            estimates("Diffusion, theory Enskog's", diffusion, (*lags, *([] if self.collective else [WALLS])))
        )
        if self.collective:
            tables += _of_currents(self.collective, self.free_times)
        tables.append(pressure_table(self.pressure))
        return [table for table in tables if table.rows or table.notes]

    def summary(self) -> str:
        """Return the headline: all coefficients, or else the mean free paths, and whether they agree with theory."""
        rows = [(f"D of {entry.species}", entry.coefficient) for entry in self.diffusion if entry.coefficient]
        if self.collective:
            rows += [(SYMBOLS[name], estimate.value) for name, estimate in self.collective.coefficients.items()]
        theory = "Enskog's theory"
        if not rows:
            theory, rows = (
                "kinetic theory",
                [(f"Mean free path of {estimate.species}", estimate.path) for estimate in self.free_paths],
            )
        sentence = ", ".join(f"{name} = {format_estimate(estimate)}" for name, estimate in rows)
        return f"{sentence}; {agreement(rows, theory)}."

    def figure(self) -> "Figure":
        """Draw the velocity correlation, mean square displacement, pair distribution and coefficients.

        If the log has no events, only the coefficients are drawn; among fixed discs there is no pair distribution.
        """
        from idealgas.analysis.transport.figure import draw_coefficients, draw_diffusion, draw_pairs
        from idealgas.presentation.style import panels

        if not self.diffusion:
            figure, (coefficients,) = panels(1)
        else:
            has_pairs = bool(self.pair_distributions)
            figure, (correlation, displacement, *pairs, coefficients) = panels(2, 2) if has_pairs else panels(3)
            draw_diffusion(correlation, displacement, self.diffusion, self.free_paths[0].time.value)
            if has_pairs:
                draw_pairs(pairs[0], self.pair_distributions, self.contacts, self.packing_fraction)
        draw_coefficients(coefficients, self.diffusion, self.collective)
        for ax in figure.axes:
            ax.legend()
        return figure


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
    """Return the rows for a coefficient and, if there are several routes, for each route and their difference."""
    rows = [(f"{name}, {coefficient.unit}", coefficient.value)]
    if coefficient.difference is not None:
        first_route, second_route = coefficient.routes
        rows += [(f"   by {route}", value) for route, value in coefficient.routes.items()]
        rows.append((f"   {first_route} minus {second_route}", coefficient.difference))
    return rows
