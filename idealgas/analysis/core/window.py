"""Window of time that an analysis uses: given by the user, or from detected equilibrium on."""

from collections.abc import Callable, Iterable, Sequence
from dataclasses import dataclass
from typing import Annotated, Any
from weakref import WeakKeyDictionary

import numpy as np

from idealgas.analysis.core.equilibrium import known_ensemble
from idealgas.analysis.core.equipartition import why_not_shared
from idealgas.analysis.core.fields import OMITTED, Key, as_dict, reported
from idealgas.analysis.core.settling import why_never_stationary
from idealgas.analysis.core.steadiness import FEWEST, Course, forgetting, steady_from
from idealgas.analysis.core.stream import Tally, stream
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import Log
from idealgas.scene.walls import walls_inside

FEWEST_BLOCKS, MANY_BLOCKS, MOST_BLOCKS = 32, 512, 8192
DISC_BLOCKS = 2**17  # discs times blocks up to which a small gas gets more than MANY_BLOCKS blocks

_KNOWN: WeakKeyDictionary[Log, dict[tuple[int, float], int]] = WeakKeyDictionary()
"""Block from which on the gas of a log is steady, by the number of event rows and the end of the window."""


@dataclass(frozen=True)
class Window:
    """Blocks of equal width in time that were read from a log, and the first block that an analysis uses.

    edges: (B + 1,), times between the blocks. first: index of the first block used. detected: whether `first` was found
    by the detection of equilibrium.
    """

    edges: Annotated[np.ndarray, OMITTED]
    first: Annotated[int, OMITTED]
    detected: Annotated[bool, Key("equilibration_detected")]

    @property
    @reported
    def start(self) -> float:
        """Start of the window, time."""
        return float(self.edges[self.first])

    @property
    @reported
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

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return as_dict(self)


def measure(
    log: Log,
    tallies: Sequence[Tally],
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
    needs: Sequence[str] = (),
) -> Window:
    """Read the events of a log between two times into tallies, and return the window of time to use.

    Without `start` the window begins where the gas is steady (`steadiness`), at one time for all analyses of a log.

    Args:
        log: the log to read.
        tallies: sums to collect over the events.
        start: start of the window, time; None for detected equilibrium.
        end: end of the window, time; None for the end of the log.
        progress: called with the number of rows read and the number of all rows.
        needs: properties of a scene (`idealgas.scene.properties`) that the analysis relies on.

    Raises:
        UserError: if the window is empty or not covered by the log, if the log has no events, if an effect of the scene
            takes one of the needed properties away, or if the gas does not become steady.
    """
    must_apply(log, start, needs)
    edges = block_edges(log, start, end)
    if start is not None:
        if tallies:
            stream(log, edges, tallies, progress)
        return Window(edges, 0, detected=False)
    known = _KNOWN.setdefault(log, {})
    key = (len(log), edges[-1])
    if key not in known:
        course = Course(log, tallies)
        stream(log, edges, course.tallies, progress)
        begin = after_gates(log, edges)
        counts = ((numbers[begin:], drawn) for numbers, drawn in course.counts())
        first = begin + first_steady(log, (values[begin:] for values in course.series()), counts)
        must_be_shared(log, course.moments.flights[first:, :, 1:3] / (edges[1] - edges[0]))
        known[key] = first
    elif tallies:
        stream(log, edges, tallies, progress)
    return Window(edges, known[key], detected=True)


def must_apply(log: Log, start: float | None, needs: Sequence[str]) -> None:
    """Refuse a log whose scene lacks a needed property, or, without a given start, whose gas can never be steady.

    Raises:
        NotApplicableError: in both cases.
    """
    if strange := log.scene.lacking(*needs):
        raise NotApplicableError(f"{log.path}: this analysis has no answer for a gas with {', '.join(strange)}")
    if start is None and (why := why_never_stationary(log)):
        raise not_steady(log, why)


def after_gates(log: Log, edges: np.ndarray) -> int:
    """Index of the first block after the last gate has opened or closed; 0 without any. edges: (B + 1,), of the blocks.

    Raises:
        UserError: if so few blocks are left that nothing can be said of them.
    """
    changes = [time for wall in walls_inside(log.scene) for time in wall.absence if edges[0] < time < edges[-1]]
    if not changes:
        return 0
    begin = int(np.searchsorted(edges, max(changes)))
    if begin > len(edges) - 1 - FEWEST:
        raise not_steady(log, f"a gate opens or closes at t = {max(changes):g}, with too little of the log after it")
    return begin


def first_steady(log: Log, series: Iterable[np.ndarray], counts: Iterable[tuple[np.ndarray, float]] = ()) -> int:
    """Index from which on all series (n,) of a log are steady; counts: see `steady_from`.

    Where no law says what the gas is like in equilibrium, it has some time more to forget how it was placed.

    Raises:
        UserError: if they are not steady by the end.
    """
    series = list(series)
    first = steady_from(series, counts)
    if first is None:
        raise not_steady(log, "it still changes at the end of the log")
    if known_ensemble(log) is None:
        return max(first, min(forgetting(series, first), len(series[0]) // 2))
    return first


def must_be_shared(log: Log, energies: np.ndarray) -> None:
    """Refuse a log whose gas is steady, as far as can be seen, but has not the temperatures of equilibrium.

    energies: see `why_not_shared`.
    """
    if why := why_not_shared(log, energies):
        raise not_steady(log, why)


def not_steady(log: Log, why: str) -> NotApplicableError:
    """Error for a gas that does not come to equilibrium, with what applies to it instead; why: part of a sentence."""
    return NotApplicableError(
        f"{log.path}: no equilibrium, as {why}: `idealgas evolution` follows it in time; --from T sets a start by hand"
    )


def block_edges(log: Log, start: float | None, end: float | None) -> np.ndarray:
    """Times (B + 1,) between blocks of equal width between `start` and `end`.

    A block is not shorter than the mean time between two events of a disc, unless there were too few blocks then.
    """
    if not log.has_events:
        raise UserError(f"{log.path}: has no events (made with log.events = false)")
    first, last = span(log, start, end)
    rows = log.row_at(last, "right") - log.row_at(first, "right")
    if rows == 0:
        raise UserError(f"{log.path}: no event between t = {exact(first)} and {exact(last)}; {_covered(log)}")
    number = len(log.discs)
    most = min(max(DISC_BLOCKS // number, MANY_BLOCKS), MOST_BLOCKS)
    return np.linspace(first, last, min(max(rows // number, FEWEST_BLOCKS), most) + 1)


def span(log: Log, start: float | None, end: float | None) -> tuple[float, float]:
    """Start and end of a window in units of time, by default those of the log.

    Raises:
        UserError: if the log does not cover the window, or if the end is not after the start.
    """
    first = log.start_time if start is None else start
    last = log.end_time if end is None else end
    if not log.start_time <= first < last <= log.end_time:
        raise UserError(f"{log.path}: no window from t = {exact(first)} to {exact(last)}: {_covered(log)}")
    return first, last


def exact(number: float) -> str:
    """A number with all the digits that tell it from any other."""
    return repr(float(number)).removesuffix(".0")


def _covered(log: Log) -> str:
    return f"the log covers t = {exact(log.start_time)} to {exact(log.end_time)}"
