"""Uniformity of a cooling gas, from the numbers and momenta of discs in small cells."""

import math
from collections.abc import Iterator

import numpy as np

from idealgas.log import Log, LogState
from idealgas.theory.conserved import centre_of_mass_velocity

DISCS_PER_CELL = 8
"""Approximate mean number of discs in a cell."""

SIGNIFICANT = 4.0
"""Deviation at which a gas counts as nonuniform, in standard errors of a single state."""


def cells_of(log: Log) -> np.ndarray:
    """Return the numbers (2,) of equal cells along x and y in which discs are counted."""
    side = math.sqrt(DISCS_PER_CELL * math.prod(log.box) / len(log.discs))
    shape = np.maximum(np.round(np.array(log.box) / side).astype(int), 1)
    return shape if (shape > 1).any() else np.array([2, 2])


def scatter_of(log: Log, state: LogState, shape: np.ndarray) -> tuple[float, float]:
    """Return the variance-to-mean ratio of the number of discs per cell, and the relative mean square momentum.

    The mean square momentum of a cell is relative to that of discs that move independently. As all discs have the same
    mass, it is computed from sums of velocities.

    Args:
        log: log of the gas.
        state: state of the gas.
        shape: (2,), numbers of cells along x and y.
    """
    velocity, cells = state.velocity - centre_of_mass_velocity(log.scene, log.discs), int(shape.prod())
    at = np.minimum((state.position / np.array(log.box) * shape).astype(int), shape - 1)
    cell = at[:, 0] * shape[1] + at[:, 1]
    counts = np.bincount(cell, minlength=cells)
    sums = sum(np.bincount(cell, v, cells) ** 2 for v in velocity.T)
    return float(counts.var(ddof=1) / counts.mean()), float(np.sum(sums) / (velocity**2).sum())


def nonuniform(early: float, late: float, flow: float, cells: int) -> Iterator[str]:
    """Yield caveats if the gas is less uniform at the end than the fluctuations of single states can explain.

    For a single state and M cells, the relative standard error of the scatter is √(2/(M - 1)), and that of the flow
    1/√M.

    Args:
        early: mean scatter of the numbers of discs in cells in the first tenth of the collisions.
        late: mean scatter in the last tenth of the collisions.
        flow: mean square momentum of cells in the last tenth, relative to that of independent discs.
        cells: number of cells M.
    """
    end = "theory assumes a uniform gas."
    if late > early * (1 + SIGNIFICANT * math.sqrt(4 / (cells - 1))):
        yield f"Clusters form: numbers of discs in cells scatter {late / early:.3g} times as much as before; {end}"
    if flow > 1 + SIGNIFICANT / math.sqrt(cells):
        yield f"Discs move together: the squared momentum of cells is {flow:.3g} times that of independent discs; {end}"
