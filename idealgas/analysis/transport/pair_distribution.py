"""Pair distribution g(r) of discs, averaged over several instants."""

import math
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from idealgas.log import Log
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.pairs import BINS_A_DIAMETER, REACH, inside
from idealgas.theory.ensemble import Composition

FRAMES = 64  # number of instants


@dataclass(frozen=True)
class Contact:
    """Contact value χ of the pair distribution of two species (no unit), from the collision rate of the two."""

    species: str
    other: str
    value: Estimate


@dataclass(frozen=True)
class PairDistribution:
    """Pair distribution g(r) of two species (no unit).

    Attributes:
        species: name of the first species.
        other: name of the second species.
        contact: sum of the mean radii of the two species, length.
        edges: (bins + 1,), edges of the bins of r, starting at the smallest possible distance, length.
        value: (bins,), g(r).
        error: (bins,), standard error of g(r).
    """

    species: str
    other: str
    contact: float
    edges: np.ndarray
    value: np.ndarray
    error: np.ndarray


def pair_distributions(log: Log, discs: Composition, start: float, end: float) -> tuple[PairDistribution, ...]:
    """Return the pair distribution of every pair of species between two times.

    A species with a single disc has no pair distribution with itself. If there are more than MOST_PAIRED species, all
    discs are treated together under the name "all". In a box with walls, the numbers of pairs are divided by those of
    discs at random positions in the same box.
    """
    if len(discs.partners) < len(discs.name):
        whole = len(log.discs)
        radius, mass = (np.array([discs.number @ values / whole]) for values in (discs.radius, discs.mass))
        discs = Composition(discs.partners, radius, mass, np.array([whole]), np.zeros(1, int))
    sigma, nearest = discs.radius[:, None] + discs.radius, _smallest(log)
    pairs = [(i, j) for i in range(len(discs.name)) for j in range(i, len(discs.name)) if i != j or discs.number[i] > 1]
    edges = {}
    for i, j in pairs:
        reach = min(REACH * sigma[i, j], min(log.box) / 2)
        first = nearest[i] + nearest[j]
        bins = max(int(BINS_A_DIAMETER * (reach - first) / sigma[i, j]), 1)
        edges[i, j] = np.linspace(first, max(reach, 1.01 * sigma[i, j]), bins + 1)
    counts: dict[tuple[int, int], list[np.ndarray]] = {pair: [] for pair in pairs}
    members = [np.flatnonzero(log.discs.partner == s) for s in range(len(discs.name))]
    period = np.where(log.periodic, log.box, 0.0)  # 0 means that there are no periodic images along this axis
    for state in log.frames(np.linspace(start, end, FRAMES)):
        places = inside(log, state.position)
        trees = [cKDTree(places[ids], boxsize=period) for ids in members]
        for i, j in pairs:
            numbers = trees[i].count_neighbors(trees[j], edges[i, j], cumulative=False)
            counts[i, j].append(numbers[1:])
    return tuple(_normalised(log, discs, i, j, edges[i, j], np.array(counts[i, j], float)) for i, j in pairs)


def _smallest(log: Log) -> np.ndarray:
    """Return the smallest radius of each species, or of all discs if they are treated together, length."""
    smallest = np.full(len(log.discs.partners), np.inf)
    np.minimum.at(smallest, log.discs.partner, log.discs.radius)
    return smallest


def _normalised(
    log: Log, discs: Composition, i: int, j: int, edges: np.ndarray, counts: np.ndarray
) -> PairDistribution:
    """Return the pair distribution from numbers of pairs (frames, bins); pairs within a species are counted twice."""
    reach = [
        (side, side) if periodic else (side - 2 * discs.radius[i], side - 2 * discs.radius[j])
        for side, periodic in zip(log.box, log.periodic, strict=True)
    ]
    expected = discs.number[i] * (discs.number[j] - (i == j)) * np.diff(chance_within(edges, reach, log.periodic))
    g = counts / expected
    contact, error = float(discs.radius[i] + discs.radius[j]), g.std(axis=0, ddof=1) / math.sqrt(len(g))
    return PairDistribution(discs.name[i], discs.name[j], contact, edges, g.mean(axis=0), error)


def chance_within(r: np.ndarray, reach: list[tuple[float, float]], periodic: tuple[bool, bool]) -> np.ndarray:
    """Return the probability that two random points, each in one of two concentric rectangles, are closer than r.

    Args:
        r: (n,), distances, length.
        reach: sides of the two rectangles along each axis, length.
        periodic: whether the box is periodic along each axis.
    """
    if all(periodic):
        return np.asarray(math.pi * r**2 / math.prod(a for a, _ in reach))
    angle = (np.arange(720) + 0.5) / 720 * math.pi / 2
    steps = np.linspace(0.0, 1.0, 65)
    rho = (r[:, None] * steps)[:, :, None]
    density = np.ones((len(r), len(steps), len(angle)))
    for (a, b), is_periodic, component in zip(reach, periodic, (np.cos(angle), np.sin(angle)), strict=True):
        if is_periodic:
            density /= a
        else:
            density *= np.clip((a + b) / 2 - rho * component, 0.0, min(a, b)) / (a * b)
    return np.trapezoid(2 * math.pi * rho[:, :, 0] * density.mean(axis=2), r[:, None] * steps, axis=1)
