"""Window of time that an analysis uses: given by the user, or from detected equilibrium on."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass

import numpy as np

from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.statistics import equilibration
from idealgas.analysis.core.stream import Tally, stream
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log

FEWEST_BLOCKS, MANY_BLOCKS, MOST_BLOCKS = 32, 512, 8192
DISC_BLOCKS = 2**17  # discs times blocks up to which a small gas gets more than MANY_BLOCKS blocks


@dataclass(frozen=True)
class Window:
    """Blocks of equal width in time that were read from a log, and the first block that an analysis uses.

    edges: (B + 1,), times between the blocks. first: index of the first block used. detected: whether `first` was found
    by the detection of equilibrium.
    """

    edges: np.ndarray
    first: int
    detected: bool

    @property
    def start(self) -> float:
        """Start of the window, time."""
        return float(self.edges[self.first])

    @property
    def end(self) -> float:
        """End of the window, time."""
        return float(self.edges[-1])

    @property
    def duration(self) -> float:
        """Length of the window, time."""
        return self.end - self.start

    @property
    def width(self) -> float:
        """Width of one block, in units of time."""
        return float(self.edges[1] - self.edges[0])

    def of(self, sums: np.ndarray) -> np.ndarray:
        """Sums (B, …) of a tally for the blocks of the window, divided by the width of a block: rates per time."""
        return sums[self.first :] / self.width

    def as_dict(self) -> dict[str, float | bool]:
        """Plain values by name, ready for JSON."""
        return {"start": self.start, "end": self.end, "equilibration_detected": self.detected}


def measure(
    log: Log,
    tallies: Sequence[Tally],
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    needs: Sequence[str] = (),
) -> Window:
    """Read the events of a log between two times into tallies, and return the window of time to use.

    Without `start` the window begins at detected equilibrium: where the kurtosis of the velocities, the energy of each
    species and the numbers of events per block are stationary.

    Args:
        log: the log to read.
        tallies: sums to collect over the events.
        start: start of the window, time; None for detected equilibrium.
        end: end of the window, time; None for the end of the log.
        progress: called with the number of rows read and the number of all rows.
        needs: properties of a scene (`idealgas.scene.properties`) that the analysis relies on.

    Raises:
        UserError: if the window is empty or not covered by the log, if the log has no events, or if an effect of the
            scene takes one of the needed properties away.
    """
    if strange := log.scene.lacking(*needs):
        raise NotApplicableError(f"{log.path}: this analysis has no answer for a gas with {', '.join(strange)}")
    edges = block_edges(log, start, end)
    if start is not None:
        stream(log, edges, tallies, progress)
        return Window(edges, 0, detected=False)
    present = [tally for tally in tallies if isinstance(tally, Moments)]
    moments = present[0] if present else Moments(log.gravity)
    stream(log, edges, tallies if present else [*tallies, moments], progress)
    return Window(edges, equilibration(*stationary_series(moments)), detected=True)


def block_edges(log: Log, start: float | None, end: float | None) -> np.ndarray:
    """Times (B + 1,) between blocks of equal width between `start` and `end`.

    A block is not shorter than the mean time between two events of a disc, unless there were too few blocks then.
    """
    if not log.has_events:
        raise UserError(f"{log.path}: has no events (made with log.events = false)")
    first = log.start_time if start is None else start
    last = log.end_time if end is None else end
    covered = f"the log covers t = {log.start_time:g} to {log.end_time:g}"
    if not log.start_time <= first < last <= log.end_time:
        raise UserError(f"{log.path}: no window from t = {first:g} to {last:g}: {covered}")
    rows = log.row_at(last, "right") - log.row_at(first, "right")
    if rows == 0:
        raise UserError(f"{log.path}: no event between t = {first:g} and {last:g}; {covered}")
    number = len(log.discs)
    most = min(max(DISC_BLOCKS // number, MANY_BLOCKS), MOST_BLOCKS)
    return np.linspace(first, last, min(max(rows // number, FEWEST_BLOCKS), most) + 1)


def stationary_series(moments: Moments) -> list[np.ndarray]:
    """Series of block averages that are stationary in equilibrium and change before it."""
    energy = moments.flights[:, :, 1] + moments.flights[:, :, 2]
    fourth = moments.flights[:, :, 3].sum(axis=1)
    shares = [
        share for share in energy.T if np.ptp(share) > 1e-9 * share.max()
    ]  # without series that change only by rounding
    return [fourth, *shares, *moments.events.T.astype(float)]


def span(log: Log, start: float | None, end: float | None) -> tuple[float, float]:
    """Start and end of a window in units of time, by default those of the log.

    Raises:
        UserError: if the log does not cover the window, or if the end is not after the start.
    """
    first = log.start_time if start is None else start
    last = log.end_time if end is None else end
    if not log.start_time <= first < last <= log.end_time:
        covered = f"the log covers t = {log.start_time:g} to {log.end_time:g}"
        raise UserError(f"{log.path}: no window from t = {first:g} to {last:g}: {covered}")
    return first, last
