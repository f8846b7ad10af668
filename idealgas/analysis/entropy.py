"""Follow Boltzmann's H and the entropy of the positions over time, corrected for the bias of finite numbers.

H = ∫ f ln f d²v of each species is estimated from distances between velocities, and the entropy of the positions from
the numbers of discs in cells.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.check import agreement
from idealgas.analysis.result import Result
from idealgas.errors import NotApplicableError
from idealgas.log import Log
from idealgas.presentation.tables import Table, estimates, format_estimate, time_series
from idealgas.statistics.estimates import Estimate, mean
from idealgas.tallies.equilibration import detect_equilibration
from idealgas.tallies.equilibrium import becomes_uniform, known_ensemble, nonstationary_reason
from idealgas.tallies.observables import Observable
from idealgas.tallies.stream import ReadProgress, frames, span
from idealgas.theory import hard_discs
from idealgas.theory.ensemble import Ensemble, composition
from idealgas.theory.values import Theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTANTS = 129
MOST_DISCS = 2**13
"""Largest number of discs per species from which H is estimated; larger species are thinned evenly."""

NEIGHBOUR = 4
"""Rank of the neighbour to which distances are measured; a low rank gives more scatter, a high rank more bias."""

FEWEST_DISCS = 2 * NEIGHBOUR
"""Smallest number of discs in a species for which the entropy is estimated."""

DISCS_PER_CELL = 16
"""Mean number of discs of a species per cell; the next term of the bias is then below 1 % of the term removed."""

NODES = 64
"""Number of quadrature nodes in each of the two dimensions over which the bias is integrated."""


@dataclass(frozen=True)
class SpeciesEntropy:
    """Entropy of the discs of one species, per disc (no unit, k_B = 1).

    Attributes:
        species: name of the species.
        h: (F,), Boltzmann's H = ⟨ln f⟩, where f is the density of the velocities.
        positions: (F,), entropy of the positions in cells of equal area: 0 for a uniform density, and -ln 2 if the
            discs are spread uniformly over one half of the box; None without positions.
        cells: numbers of cells along x and y.
        mean_h: mean of H once all series are steady; None if they never become steady.
        mean_positions: mean entropy of the positions over the same times; None without positions, or if the series
            never become steady.
    """

    species: str
    h: np.ndarray
    positions: np.ndarray | None
    cells: tuple[int, int]
    mean_h: Estimate | None
    mean_positions: Estimate | None


@dataclass(frozen=True)
class Entropy(Result):
    """Entropy of a gas over time.

    Attributes:
        time: (F,), times.
        species: entropy of each species with at least FEWEST_DISCS discs.
    """

    time: np.ndarray
    species: tuple[SpeciesEntropy, ...]

    def plain_tables(self) -> list[Table]:
        """Return the table of means in equilibrium and that of the time series."""
        rows = [
            (f"{entropy.species}: {name}", average)
            for entropy in self.species
            for name, average in (("H", entropy.mean_h), ("positions", entropy.mean_positions))
            if average is not None
        ]
        notes = [
            f"{entropy.species}: {entropy.cells[0]} × {entropy.cells[1]} cells"
            for entropy in self.species
            if entropy.positions is not None
        ]
        columns: dict[str, np.ndarray | None] = {"t": self.time}
        for entropy in self.species:
            columns |= {f"H of {entropy.species}": entropy.h, f"positions of {entropy.species}": entropy.positions}
        return [
            estimates("Per disc, once steady (no unit, k_B = 1)", rows, notes if rows else [*notes, "never steady"]),
            time_series("Boltzmann's H and entropy of positions per disc", columns),
        ]

    def summary(self) -> str:
        """Return H at the start and at the end, and whether its mean agrees with the Maxwell–Boltzmann distribution."""
        first, rows = self.species[0], [(s.species, s.mean_h) for s in self.species if s.mean_h is not None]
        change = f"H per disc of {first.species} goes from {first.h[0]:.4g} to {first.h[-1]:.4g}"
        if not rows:
            return f"{change} and does not become steady."
        verdict = agreement(rows, "the Maxwell–Boltzmann distribution")
        return f"{change}; its mean once steady is {format_estimate(rows[0][1])}; {verdict}."

    def figure(self) -> "Figure":
        """Draw H and the entropy of the positions against time, with their equilibrium values dashed."""
        from idealgas.presentation.style import curve_style, panels

        has_positions = any(entropy.positions is not None for entropy in self.species)
        figure, axes = panels(1 + has_positions)
        for k, entropy in enumerate(self.species):
            colour, line, _ = curve_style(k)
            for ax, values, average in zip(
                axes, (entropy.h, entropy.positions), (entropy.mean_h, entropy.mean_positions), strict=False
            ):
                if values is None:
                    continue
                ax.plot(self.time, values, line, color=colour, label=entropy.species)
                if average is not None and average.theory is not None:
                    ax.theory(None, average.theory, average.theory_error, "equilibrium, theory", colour)
        axes[0].set_ylabel("Boltzmann's H per disc, ⟨ln f⟩ (no unit)")
        if has_positions:
            axes[1].set_ylabel("entropy of positions per disc (no unit)")
        for ax in axes:
            ax.time_axis()
            ax.legend()
        return figure


class EntropyAnalysis(Analysis):
    """Entropy of velocities and positions."""

    position = 25
    headline = "species.*.mean_h"
    results = (Entropy,)
    sections = (Section("Entropy", "Boltzmann's H and the entropy of the positions against time, equilibrium dashed"),)
    supports_polydispersity = False
    start = "the log's start"
    reads = "frames"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Entropy:
        """Follow Boltzmann's H of the velocities and the entropy of the positions over time, both per disc.

        The gas need not be in equilibrium.

        Raises:
            UserError: if the log does not cover the times, has no events, or has no species with at least 8 discs.
        """
        equilibrium = known_ensemble(log) if log.scene.properties.shares_energy else None
        species = [kind for kind in _species(log, equilibrium) if len(kind.members) >= FEWEST_DISCS]
        if not species or not log.has_events:
            needs = f"events and a species of at least {FEWEST_DISCS} discs"
            raise NotApplicableError(f"{log.path}: entropy requires {needs}")
        time = np.linspace(*span(log, start, end), INSTANTS)
        h, positions = np.empty((2, len(species), len(time)))
        for k, state in enumerate(frames(log, time, progress)):
            for s, kind in enumerate(species):
                h[s, k] = kind.bias - neighbour_entropy(state.velocity[kind.compared])
                positions[s, k] = kind.spread(state.position) if log.has_positions else 0.0
        first = detect_equilibration(map(Observable, (*h, *positions))) if np.isfinite(h).all() else None
        steady = first is not None and nonstationary_reason(log) == ""
        entropies = tuple(
            SpeciesEntropy(
                kind.name,
                h[s],
                positions[s] if log.has_positions else None,
                kind.grid,
                mean(h[s][first:], kind.expected_h) if steady else None,
                mean(positions[s][first:], kind.expected_spread) if steady and log.has_positions else None,
            )
            for s, kind in enumerate(species)
        )
        return Entropy(time, entropies)


def neighbour_entropy(points: np.ndarray) -> float:
    """Return the entropy -∫ f ln f of points (n, 2) from distances between neighbours; nan if too many points coincide.

    Kozachenko & Leonenko, Probl. Inf. Transm. 23, 95 (1987); Kraskov et al., Phys. Rev. E 69, 066138 (2004).
    """
    from scipy import spatial, special

    n = len(points)
    distance = spatial.cKDTree(points).query(points, NEIGHBOUR + 1)[0][:, -1]
    if not distance.min() > 0:
        return math.nan
    return float(special.psi(n) - special.psi(NEIGHBOUR) + math.log(math.pi) + 2 * np.log(distance).mean())


def _bias(number: int) -> float:
    """Return the exact bias of `neighbour_entropy` for a number of independent, normally distributed points.

    Let p be the probability within the circle around a point that reaches to its neighbour of rank k. For n points, p
    has the distribution Beta(k, n - k). The estimator would be unbiased if the density were uniform within the circle.
    Around a point at distance r from the centre, p is a noncentral χ² distribution function of the squared distance.
    """
    from scipy import special

    middle, weight = np.polynomial.laguerre.laggauss(NODES)  # r²/2 is distributed exponentially
    chance = (np.arange(NODES) + 0.5) / NODES
    within = special.betaincinv(NEIGHBOUR, number - NEIGHBOUR, chance)
    used = weight > 1e-12
    squared = special.chndtrix(within, 2.0, 2 * middle[used, None])  # distance²
    return float(weight[used] @ (np.log(squared / 2) - np.log(within)).mean(axis=1)) - 1.0


def _bias_of_energy(equilibrium: Ensemble | None) -> float:
    """Return the bias of the entropy of velocities that is due to a fixed total energy; 0 in a heat bath.

    Let T' be the temperature that follows from the energy of a canonical sample with D degrees of freedom.
    Multiplying its velocities by √(T/T') gives a sample at fixed energy and changes its entropy by ln(T/T'). The bias
    is the mean of ln(T/T') over canonical samples.
    """
    from scipy import special

    if equilibrium is None or math.isinf(equilibrium.dof):
        return 0.0
    return math.log(equilibrium.dof / 2) - float(special.psi(equilibrium.dof / 2))


class _Species(NamedTuple):
    """Quantities that determine the entropy of a species.

    Attributes:
        name: name of the species.
        members: ids of the discs of the species.
        compared: ids of the discs from whose velocities H is estimated.
        low: (2,), lower left corner of the rectangle that the centres of the discs can reach, length.
        size: (2,), width and height of this rectangle, length.
        grid: numbers of cells along x and y.
        bias: bias of the estimated entropy of the velocities (no unit).
        variance: variance over mean of the number of discs in a cell.
        expected_h: theoretical H in equilibrium; None without theory.
        expected_spread: theoretical entropy of the positions in equilibrium; None without theory.
    """

    name: str
    members: np.ndarray
    compared: np.ndarray
    low: np.ndarray
    size: np.ndarray
    grid: tuple[int, int]
    bias: float
    variance: float
    expected_h: Theory | None
    expected_spread: Theory | None

    def spread(self, position: np.ndarray) -> float:
        """Return the entropy of the positions of the species, -Σ p ln(p K), from the positions (N, 2) of all discs.

        The sum is over K cells, and p is the fraction of the discs in a cell. The bias is removed: it is the bias for
        independent discs (Miller 1955) times the variance over mean of the number of discs in a cell.
        """
        share = (position[self.members] - self.low) / self.size
        x, y = (np.clip((share[:, a] * self.grid[a]).astype(int), 0, self.grid[a] - 1) for a in range(2))
        shares = np.bincount(x * self.grid[1] + y) / len(self.members)
        shares = shares[shares > 0]
        bias = self.variance * (len(shares) - 1) / (2 * len(self.members))
        return bias - float(shares @ np.log(shares * math.prod(self.grid)))


def _species(log: Log, equilibrium: Ensemble | None) -> Iterator[_Species]:
    """Yield the quantities that determine the entropy for each species in a log."""
    kinds, periodic = composition(log.discs), np.array(log.periodic)
    phi = log.discs.packing_fraction * log.scene.properties.interacting
    compressibility = 1 / float(hard_discs.inverse_compressibility(phi)) if phi <= hard_discs.HIGHEST else 0.0
    even = log.has_positions and becomes_uniform(log, None) and log.scene.properties.fixed_walls
    for s, (name, number, radius, mass) in enumerate(
        zip(kinds.name, kinds.number, kinds.radius, kinds.mass, strict=True)
    ):
        members = np.flatnonzero(log.discs.species == s)
        low = np.where(periodic, 0.0, float(radius))
        size = np.array(log.box) - 2 * low
        grid, variance = _grid(size, int(number)), 1 - number / len(log.discs) * (1 - compressibility)
        miller = (math.prod(grid) - 1) / (2 * float(number))
        energy = (
            None if equilibrium is None else Theory(_maxwell(equilibrium.temperature / mass), 0.0, "Maxwell–Boltzmann")
        )
        doubt = miller * ((1 - variance) / 2 + 1 / (6 * DISCS_PER_CELL))
        yield _Species(
            name,
            members,
            compared := members[:: -(-len(members) // MOST_DISCS)],
            low,
            size,
            grid,
            _bias(len(compared)) + _bias_of_energy(equilibrium) if len(compared) >= FEWEST_DISCS else 0.0,
            float(variance),
            energy,
            Theory(0.0, doubt, "even density") if even else None,
        )


def _maxwell(thermal: float) -> float:
    """Return H of the Maxwell–Boltzmann distribution from the variance T/m of a velocity component, (length/time)²."""
    return -1 - math.log(2 * math.pi * thermal)


def _grid(size: np.ndarray, number: int) -> tuple[int, int]:
    """Return the numbers of nearly square cells along x and y for a given number of discs.

    Each number is 1 or even, so that each half of the box consists of whole cells.
    """
    cells = max(number / DISCS_PER_CELL, 1.0)
    along_x = max(2 * round(math.sqrt(cells * size[0] / size[1]) / 2), 1)
    return along_x, max(2 * int(cells / along_x / 2), 1)
