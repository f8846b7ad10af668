"""Structure factor S(k) = |Σ exp(ik·r)|²/N of discs in a periodic box, on the reciprocal lattice of the box."""

import math
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from idealgas.analysis.core.fields import OMITTED, Key
from idealgas.analysis.core.statistics import Estimate, mean

REACH = 15.0
"""Largest wave number in units of √n: three rings of peaks of a triangular lattice, at 6.75, 11.7 and 13.5."""

RINGS = 60
"""Number of rings of wave vectors over whose directions S(k) is averaged."""


@dataclass(frozen=True)
class Structure:
    """Structure factor of the discs of a periodic box (no unit).

    kx, ky: (X,) and (Y,), components of the wave vectors, 1/length; kx ≥ 0, as S(-k) = S(k). on_lattice: (X, Y), mean
    of S over time at each wave vector; nan at 0 and beyond the reach. k, value, error: (K,), mean wave number of a
    ring, mean of S over time and the directions in the ring, and its standard error. peak: (2,), wave vector of the
    highest S in every other frame. positional: S/N at that wave vector in the remaining frames, so that chance does
    not choose what is measured: the square of the positional order, 1 in a lattice at rest.
    """

    kx: Annotated[np.ndarray, OMITTED]
    ky: Annotated[np.ndarray, OMITTED]
    on_lattice: Annotated[np.ndarray, OMITTED]
    k: np.ndarray
    value: np.ndarray
    error: np.ndarray
    peak: np.ndarray
    positional: Annotated[Estimate, Key("positional_order_squared")]


class WaveVectors:
    """Wave vectors 2π(a/Lx, b/Ly) of a periodic box up to a reach, of which one in each pair ±k."""

    def __init__(self, box: tuple[float, float], number: int) -> None:
        """Take the width and height of the box, length, and the number of discs in it."""
        reach = REACH * math.sqrt(number / (box[0] * box[1]))
        most = [max(int(reach * size / (2 * math.pi)), 1) for size in box]
        self.kx = 2 * math.pi / box[0] * np.arange(most[0] + 1)
        self.ky = 2 * math.pi / box[1] * np.arange(-most[1], most[1] + 1)
        size = np.hypot(self.kx[:, None], self.ky)
        twice = (self.kx[:, None] == 0) & (self.ky <= 0)  # the other one of a pair, or no wave at all
        self.used = ~twice & (size <= max(reach, size[0, most[1] + 1], size[1, most[1]]))
        self.size = size[self.used]

    def structure_factor(self, position: np.ndarray) -> np.ndarray:
        """S (K,) of positions (N, 2) at the wave vectors that are used."""
        along, across = (np.exp(1j * np.outer(k, x)) for k, x in zip((self.kx, self.ky), position.T, strict=True))
        return np.asarray(np.abs((along @ across.T)[self.used]) ** 2 / len(position))

    def structure(self, frames: np.ndarray, number: int) -> Structure:
        """Structure of a gas of `number` discs from S (F, K) in F frames, F ≥ 2."""
        edges = np.linspace(0.0, self.size.max() * (1 + 1e-9), RINGS + 1)
        ring = np.digitize(self.size, edges) - 1
        filled = np.unique(ring)
        found = [mean(frames[:, ring == r].mean(axis=1)) for r in filled]
        on_lattice = np.full(self.used.shape, np.nan)
        on_lattice[self.used] = frames.mean(axis=0)
        best = int(frames[::2].mean(axis=0).argmax())
        column, row = (index[best] for index in np.nonzero(self.used))
        return Structure(
            self.kx,
            self.ky,
            on_lattice,
            k=np.array([self.size[ring == r].mean() for r in filled]),
            value=np.array([one.value for one in found]),
            error=np.array([one.standard_error for one in found]),
            peak=np.array((self.kx[column], self.ky[row])),
            positional=mean(frames[1::2, best] / number),
        )
