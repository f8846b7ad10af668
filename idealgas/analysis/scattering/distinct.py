"""Distinct part of the van Hove function: the other discs around the earlier position of a disc."""

import math
from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
from scipy.spatial import cKDTree

from idealgas.analysis.scattering.displacements import Curve, curve_of
from idealgas.analysis.scattering.sums import SEGMENTS
from idealgas.log import Log
from idealgas.tallies.equilibration import Window
from idealgas.tallies.pairs import BINS_A_DIAMETER, REACH, inside
from idealgas.theory.conserved import centre_of_mass_velocity

STARTS = 4
"""Number of initial instants in each segment."""


@dataclass(frozen=True)
class Distinct:
    """Distinct part of the van Hove function at one time: density of other discs around the earlier position of a disc.

    Attributes:
        time: time.
        distance: (B,), middles of bins, length.
        density: (B,), G_d(r, t), averaged over each bin, 1/length²; n g(r) at t = 0, and (N - 1)/A at long times.
    """

    time: float
    distance: np.ndarray
    density: Curve


def distinct_parts(log: Log, window: Window, times: Sequence[float]) -> tuple[Distinct, ...]:
    """Return the distinct part after each of several times, at distances up to half the box; empty for a single disc.

    Positions are relative to the centre of mass. The log is read once, and the positions at an instant are kept in
    memory until they are no longer needed. Standard errors follow from the scatter of SEGMENTS parts of the window.
    """
    number, diameter = len(log.discs), 2 * float(log.discs.radius[0])
    if number < 2:
        return ()
    bins = int(BINS_A_DIAMETER * min(REACH, min(log.box) / 2 / diameter))
    edges = np.arange(bins + 1) * diameter / BINS_A_DIAMETER
    starts = np.linspace(window.start, window.end - max(times), STARTS * SEGMENTS)
    later = np.array([np.minimum(starts + time, window.end) for time in times])
    at = np.unique(np.append(starts, later))
    first, second = at.searchsorted(starts), at.searchsorted(later)
    counts = np.empty((len(times), len(starts), bins))
    places: dict[int, np.ndarray] = {}
    box, drift = np.array(log.box), centre_of_mass_velocity(log.scene, log.discs)
    for now, state in enumerate(log.frames(at)):
        places[now] = inside(log, np.remainder(state.position - drift * at[now], box))
        for k, start in np.argwhere(second == now):
            counts[k, start] = _pairs(places[first[start]], places[now], box, edges)
        waiting = first[second.max(axis=0) > now]
        places = {n: positions for n, positions in places.items() if n in waiting}
    densities = counts.reshape(len(times), SEGMENTS, STARTS, bins).mean(axis=2) / (number * math.pi * np.diff(edges**2))
    middles = (edges[1:] + edges[:-1]) / 2
    return tuple(Distinct(time, middles, curve_of(parts)) for time, parts in zip(times, densities, strict=True))


def _pairs(before: np.ndarray, after: np.ndarray, box: np.ndarray, edges: np.ndarray) -> np.ndarray:
    """Count pairs of discs by the distance from the earlier position of one to the later position of the other."""
    counts = cKDTree(before, boxsize=box).count_neighbors(cKDTree(after, boxsize=box), edges[1:], cumulative=False)
    moved = after - before
    moved -= box * np.rint(moved / box)
    self_distances = np.hypot(*moved.T)
    return counts - np.histogram(self_distances, edges)[0]
