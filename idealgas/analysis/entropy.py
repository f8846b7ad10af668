"""Follow Boltzmann's H and the entropy of the positions in time, without the bias of finite numbers.

H = ∫ f ln f d²v of each species, from distances between velocities; the entropy of positions, from discs in cells.
"""

import math
from collections.abc import Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING, NamedTuple

import numpy as np

from idealgas.analysis.core.analysis import Analysis, Progress, Section
from idealgas.analysis.core.check import agreement
from idealgas.analysis.core.ensemble import becomes_uniform, known_ensemble, nonstationary_reason
from idealgas.analysis.core.equilibration import detect_equilibration
from idealgas.analysis.core.observables import Observable
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.core.stream import frames, span
from idealgas.analysis.core.tables import Table, estimates, format_estimate, time_series
from idealgas.analysis.theory import hard_discs
from idealgas.analysis.theory.ensemble import Ensemble, composition
from idealgas.analysis.theory.values import Theory
from idealgas.errors import NotApplicableError
from idealgas.log import Log

if TYPE_CHECKING:
    from matplotlib.figure import Figure

INSTANTS = 129
MOST_DISCS = 2**13
"""Largest number of discs of a species whose velocities are compared; of more, evenly chosen ones."""

NEIGHBOUR = 4
"""Which nearest velocity the distance is to: a smaller one scatters more, a larger one blurs more."""

FEWEST_DISCS = 2 * NEIGHBOUR
"""Least number of discs of a species."""

DISCS_PER_CELL = 16
"""Mean number of discs of a species in a cell; the next term of the bias is then below 1 % of the one removed."""

NODES = 64
"""Nodes of the quadratures of the bias, along each of two dimensions."""


@dataclass(frozen=True)
class SpeciesEntropy:
    """Entropy of the discs of one species, per disc (no unit, k_B = 1).

    species: name. h: (F,), Boltzmann's H, ⟨ln f⟩ of its velocities. positions: (F,), entropy of its positions in cells
    of equal area, 0 for an even density and -ln 2 for one half of the box; None without positions. cells: numbers along
    x and y. mean_h, mean_positions: means from the time on at which both are steady; None if they never are.
    """

    species: str
    h: np.ndarray
    positions: np.ndarray | None
    cells: tuple[int, int]
    mean_h: Estimate | None
    mean_positions: Estimate | None


@dataclass(frozen=True)
class Entropy(Result):
    """Entropy of a gas in time.

    time: (F,), instants. species: entropy of each species of at least FEWEST_DISCS discs.
    """

    time: np.ndarray
    species: tuple[SpeciesEntropy, ...]


class EntropyAnalysis(Analysis):
    """Entropy of velocities and positions."""

    position = 25
    headline = "species.*.mean_h"
    results = (Entropy,)
    sections = (Section("Entropy", "Boltzmann's H and the entropy of the positions against time, equilibrium dashed"),)
    takes_unlike_discs = False
    start = "the log's start"
    reads = "frames"

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: Progress | None = None
    ) -> Entropy:
        """Follow Boltzmann's H of the velocities and the entropy of the positions, per disc; needs no equilibrium.

        Raises:
            UserError: if the log does not cover the times, has no events, or no species of at least 8 discs.
        """
        equilibrium = known_ensemble(log)
        species = [one for one in _species(log, equilibrium) if len(one.members) >= FEWEST_DISCS]
        if not species or not log.has_events:
            needs = f"events and a species of at least {FEWEST_DISCS} discs"
            raise NotApplicableError(f"{log.path}: entropy requires {needs}")
        time = np.linspace(*span(log, start, end), INSTANTS)
        h, positions = np.empty((2, len(species), len(time)))
        for k, state in enumerate(frames(log, time, progress)):
            for s, one in enumerate(species):
                h[s, k] = one.bias - neighbour_entropy(state.velocity[one.compared])
                positions[s, k] = one.spread(state.position) if log.has_positions else 0.0
        first = detect_equilibration(map(Observable, (*h, *positions))) if np.isfinite(h).all() else None
        steady = first is not None and nonstationary_reason(log) == ""
        found = tuple(
            SpeciesEntropy(
                one.name,
                h[s],
                positions[s] if log.has_positions else None,
                one.grid,
                mean(h[s][first:], one.expected_h) if steady else None,
                mean(positions[s][first:], one.expected_spread) if steady and log.has_positions else None,
            )
            for s, one in enumerate(species)
        )
        return Entropy(time, found)

    @staticmethod
    def tables(result: Entropy) -> list[Table]:
        """Tables of the means in equilibrium and of the series."""
        rows = [
            (f"{one.species}: {name}", found)
            for one in result.species
            for name, found in (("H", one.mean_h), ("positions", one.mean_positions))
            if found is not None
        ]
        notes = [
            f"{one.species}: {one.cells[0]} × {one.cells[1]} cells"
            for one in result.species
            if one.positions is not None
        ]
        columns: dict[str, np.ndarray | None] = {"t": result.time}
        for one in result.species:
            columns |= {f"H of {one.species}": one.h, f"positions of {one.species}": one.positions}
        return [
            estimates("Per disc, once steady (no unit, k_B = 1)", rows, notes if rows else [*notes, "never steady"]),
            time_series("Boltzmann's H and entropy of positions per disc", columns),
        ]

    @staticmethod
    def summary(result: Entropy) -> str:
        """Boltzmann's H at the start and in the end, and whether it is that of the Maxwell–Boltzmann distribution."""
        first, rows = result.species[0], [(s.species, s.mean_h) for s in result.species if s.mean_h is not None]
        change = f"H per disc of {first.species} goes from {first.h[0]:.4g} to {first.h[-1]:.4g}"
        if not rows:
            return f"{change} and is not steady."
        said = agreement(rows, "the Maxwell–Boltzmann distribution")
        return f"{change}; steady at {format_estimate(rows[0][1])}; {said}."

    @staticmethod
    def figure(result: Entropy) -> "Figure":
        """Picture of H and of the entropy of the positions against time, with their values in equilibrium dashed."""
        from idealgas.analysis.core.style import curve_style, panels

        has_positions = any(one.positions is not None for one in result.species)
        figure, axes = panels(1 + has_positions)
        for k, one in enumerate(result.species):
            colour, line, _ = curve_style(k)
            for ax, values, found in zip(axes, (one.h, one.positions), (one.mean_h, one.mean_positions), strict=False):
                if values is None:
                    continue
                ax.plot(result.time, values, line, color=colour, label=one.species)
                if found is not None and found.theory is not None:
                    ax.theory(None, found.theory, found.theory_error, "equilibrium, theory", colour)
        axes[0].set_ylabel("Boltzmann's H per disc, ⟨ln f⟩ (no unit)")
        if has_positions:
            axes[1].set_ylabel("entropy of positions per disc (no unit)")
        for ax in axes:
            ax.time_axis()
            ax.legend()
        return figure


def neighbour_entropy(points: np.ndarray) -> float:
    """Entropy -∫ f ln f of points (n, 2), from distances to a neighbour; nan if points coincide.

    Kozachenko & Leonenko, Probl. Inf. Transm. 23, 95 (1987); Kraskov et al., Phys. Rev. E 69, 066138 (2004).
    """
    from scipy import spatial, special

    n = len(points)
    distance = spatial.cKDTree(points).query(points, NEIGHBOUR + 1)[0][:, -1]
    if not distance.min() > 0:
        return math.nan
    return float(special.psi(n) - special.psi(NEIGHBOUR) + math.log(math.pi) + 2 * np.log(distance).mean())


def _bias(number: int) -> float:
    """Bias of `neighbour_entropy` of so many independent points of a normal distribution, exactly.

    The probability p within the distance of neighbour k has the distribution Beta(k, n - k), and the entropy would have
    no bias if the density were the same up to there. At a distance r from the middle p is the noncentral χ².
    """
    from scipy import special

    middle, weight = np.polynomial.laguerre.laggauss(NODES)  # r²/2, exponential
    chance = (np.arange(NODES) + 0.5) / NODES
    within = special.betaincinv(NEIGHBOUR, number - NEIGHBOUR, chance)
    used = weight > 1e-12
    squared = special.chndtrix(within, 2.0, 2 * middle[used, None])  # distance²
    return float(weight[used] @ (np.log(squared / 2) - np.log(within)).mean(axis=1)) - 1.0


def _bias_of_energy(equilibrium: Ensemble | None) -> float:
    """Mean of ln(T/T') over canonical velocities whose energy gives T' with D degrees of freedom; 0 in a heat bath.

    Velocities of a fixed energy are canonical ones times √(T/T'), which changes the entropy of each sample by as much.
    """
    from scipy import special

    if equilibrium is None or math.isinf(equilibrium.dof):
        return 0.0
    return math.log(equilibrium.dof / 2) - float(special.psi(equilibrium.dof / 2))


class _Species(NamedTuple):
    """What the entropy of a species takes.

    name: of the species. members: ids of its discs. compared: of those whose velocities are compared. low, size: (2,),
    corner and size of what the centres of its discs reach, length. grid: numbers of cells. bias: of H. variance: of
    the number of discs in a cell, over its mean. expected_h, expected_spread: theory for
    equilibrium; None without one.
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
        """-Σ p ln(p K) over K cells with the shares p of the discs; position: (N, 2), of all discs.

        Without the bias of Miller (1955) for independent discs, times the variance of a number in the gas.
        """
        share = (position[self.members] - self.low) / self.size
        x, y = (np.clip((share[:, a] * self.grid[a]).astype(int), 0, self.grid[a] - 1) for a in range(2))
        found = np.bincount(x * self.grid[1] + y) / len(self.members)
        found = found[found > 0]
        bias = self.variance * (len(found) - 1) / (2 * len(self.members))
        return bias - float(found @ np.log(found * math.prod(self.grid)))


def _species(log: Log, equilibrium: Ensemble | None) -> Iterator[_Species]:
    """All species of a log."""
    kinds, periodic, phi = composition(log.discs), np.array(log.periodic), log.discs.packing_fraction
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
    """H of the Maxwell–Boltzmann distribution with the variance T/m of a velocity component, (length/time)²."""
    return -1 - math.log(2 * math.pi * thermal)


def _grid(size: np.ndarray, number: int) -> tuple[int, int]:
    """Numbers of nearly square cells along x and y for so many discs: 1, or even, so that halves are whole cells."""
    cells = max(number / DISCS_PER_CELL, 1.0)
    along_x = max(2 * round(math.sqrt(cells * size[0] / size[1]) / 2), 1)
    return along_x, max(2 * int(cells / along_x / 2), 1)
