"""The event-driven method: neighbours are found with cells, and the next event with a tournament tree.

Every prediction is a pure function of the stored states of the discs involved, so the trajectory does not depend on the
cells, the scheduler or the size of the batches.
"""

import numpy as np

from idealgas.columns import EventBatch
from idealgas.effects.bundle import Effects
from idealgas.engine.event_driven.cells import (
    Cells,
    CoarseCells,
    discs_per_cell,
    make_cells,
    make_levels,
    order_by_cell,
)
from idealgas.engine.event_driven.kernel import advance_events, place
from idealgas.engine.event_driven.state import EventDrivenState, make_state
from idealgas.engine.event_driven.wall_cells import WallCells, make_wall_cells
from idealgas.engine.method import Limits, Method, Threads
from idealgas.engine.parallel.decomposition import DomainDecomposition
from idealgas.engine.parallel.slabs import DEFAULT_TUNING, Tuning, choose_threads
from idealgas.engine.parallel.workers import Workers
from idealgas.engine.records import make_discs
from idealgas.state import Gas

MAX_UNSORTED = 4096
"""Number of discs that fit into the processor's caches; up to this number, discs are sorted in memory once per run."""

SEGMENTS_PER_CELL = 2.0
"""Number of wall segments per cell, if discs do not interact."""


def expected_threads(gas: Gas, threads: int | None, piston: bool, shear: bool, interacting: bool = True) -> Threads:
    """Return how the work will be shared among threads.

    Args:
        gas: the gas at time 0.
        threads: requested number of threads, as in `EventDriven`.
        piston: whether the gas has a piston.
        shear: whether the box has sheared sides.
        interacting: whether discs collide with each other.
    """
    cells, coarse = make_levels(gas.radius, gas.box, discs_per_cell(gas.packing_fraction))
    return _share(cells, coarse, threads, len(gas), _far(piston, shear, interacting))


def _far(piston: bool, shear: bool, interacting: bool) -> str:
    """Return the reason why slabs of the box cannot be simulated separately; an empty string if they can."""
    if piston:
        return "any disc may meet the piston"
    if not interacting:
        return "discs that do not interact are in few, large cells"
    return "any disc may meet others through sheared sides" if shear else ""


def _share(
    cells: Cells, coarse: CoarseCells | None, threads: int | None, n: int, far: str, tuning: Tuning = DEFAULT_TUNING
) -> Threads:
    """Choose the number of threads for n discs (see `choose_threads`); one thread if large discs span many rows."""
    if coarse is not None and not far:
        return Threads(1, "the largest discs reach over many rows of cells")
    return choose_threads(threads, cells.rows - 2, n, far, tuning)


class EventDriven(Method):
    """The event-driven method, with the discs, effects and predictions of the current epoch."""

    _state: EventDrivenState
    _shared: Threads

    def __init__(self, filling: float | None = None, threads: int | None = 1, tuning: Tuning = DEFAULT_TUNING) -> None:
        """Set the parameters, which affect only the speed.

        Args:
            filling: mean number of discs per cell; None to derive it from the packing fraction.
            threads: number of threads; None for as many as are worthwhile.
            tuning: parameters of the threads.
        """
        self._filling = filling
        self._threads = threads
        self.workers = Workers(tuning)
        self._decomposition: DomainDecomposition | None = None
        self._walls: tuple[bytes, WallCells, WallCells | None] | None = None
        self._radius: np.ndarray | None = None  # radii of the discs for which memory is allocated

    def start(self, gas: Gas, effects: Effects) -> None:
        """Begin an epoch: put all discs into their cells. The discs and the set of effects do not change in a run."""
        is_new_run = self._radius is not gas.radius
        if is_new_run:
            self._allocate(gas, effects)
        if is_new_run or len(gas) > MAX_UNSORTED:
            self._sort(gas, effects)
        self._effects = effects
        walls, coarse_walls = self._wall_cells(effects)
        self._state = self._state._replace(walls=walls, coarse_walls=coarse_walls)
        position, velocity = (np.require(array, np.float64, ("C", "W")) for array in (gas.position, gas.velocity))
        state = self._state
        place(self.discs.record, self.discs.id, position, velocity, state, state.coarse, effects.absorbing)
        self._state.unpredicted[0] = True
        slabs = self._shared.number
        self._decomposition = (
            DomainDecomposition(self.workers, slabs, self.discs, self._state, effects) if slabs > 1 else None
        )

    def _allocate(self, gas: Gas, effects: Effects) -> None:
        """Allocate cells and memory for a run, during which only positions and velocities change."""
        self._radius = gas.radius
        interacting = effects.noninteracting is None
        filling = self._filling or discs_per_cell(gas.packing_fraction)
        if not interacting and self._filling is None:  # cells are only needed to find walls
            segments = 0 if effects.segments is None else len(effects.segments)
            filling = SEGMENTS_PER_CELL * len(gas) / max(segments, 1)
        cells, coarse = make_levels(gas.radius, gas.box, filling)
        if effects.shear is not None or not interacting:  # coarse cells only help in the search for partners
            cells, coarse = make_cells(len(gas), gas.box, float(gas.radius.max()), filling), None
        self._state = make_state(len(gas), cells, coarse, effects)
        far = _far(effects.piston is not None, effects.shear is not None, interacting)
        self._shared = _share(cells, coarse, self._threads, len(gas), far, self.workers.tuning)

    def _sort(self, gas: Gas, effects: Effects) -> None:
        """Sort the discs in memory by cell."""
        position = gas.position
        if effects.absorbing is not None:
            position = np.nan_to_num(position)  # the positions of discs that have left are nan
        self.discs = make_discs(gas, order_by_cell(position, self._state.cells))

    @property
    def threads(self) -> Threads:
        """How the work is shared among threads, and the numbers of shared and aborted slices in the run so far."""
        return self._shared._replace(slices=self.workers.counts["slices"], aborted=self.workers.aborted)

    @property
    def pending(self) -> bool:
        """Whether `advance` still has rows of past events to deliver."""
        return self._decomposition is not None and self._decomposition.pending

    def _wall_cells(self, effects: Effects) -> tuple[WallCells | None, WallCells | None]:
        """Return the wall segments of each cell and each coarse cell; they are reused until a gate opens or closes."""
        segments, coarse, radius = effects.segments, self._state.coarse, self._radius
        if segments is None or radius is None:
            return None, None
        active = segments.active.tobytes()
        if self._walls is None or self._walls[0] != active:
            small = radius if coarse is None else radius[radius <= coarse.limit]
            cells = [(self._state.cells, small)] + ([] if coarse is None else [(coarse.cells, radius)])
            made = [
                make_wall_cells(segments, effects.arcs, effects.periodic, level, float(r.max())) for level, r in cells
            ]
            self._walls = active, made[0], None if coarse is None else made[1]
        return self._walls[1:]

    def advance(
        self, limits: Limits, epoch_start: float, batch: EventBatch | None, counters: np.ndarray
    ) -> tuple[int, bool]:
        """Process events; see `advance_events`."""
        if self._decomposition is not None:
            return self._decomposition.advance(limits, epoch_start, batch, counters)
        return advance_events(self.discs, self._state, self._effects, limits, epoch_start, batch, counters, None)
