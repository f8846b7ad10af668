"""Draw Poincaré sections: hits of walls or crossings of a line, each as a position and the sine of an angle.

The position is a length along the walls or the line. The share that trajectories visit is measured by box counting.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.result import Result
from idealgas.analysis.section.points import POINT, chosen_walls, crossings, hits, line_ends
from idealgas.errors import UserError
from idealgas.fields import OMITTED
from idealgas.log import Log
from idealgas.presentation.tables import Number, Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate
from idealgas.tallies.stream import ReadProgress, span

if TYPE_CHECKING:
    from matplotlib.figure import Figure

DRAWN, FEWEST, MOST, SAMPLED = 20_000, 512, 100_000, 64
"""Most points in a figure, fewest and most points for a share, and most trajectories whose shares are measured."""

PER_BOX, PIXELS = 8, 16
"""Points per smallest box on average, so that 1 box in 3 000 is missed, and number of pixels along its sides."""

UNEQUAL = "Shares refer to area in the plane of position and sine, which this motion does not preserve."
COLLIDING = "Discs collide with each other, so a point of the section does not determine the next one."


@dataclass(frozen=True)
class PoincareSection(Result):
    """Poincaré section of the discs in one or more logs; each disc of each log is a trajectory.

    Attributes:
        kind: "hit these walls", "cross the line", or "hit walls", where walls without points are left out.
        lengths: lengths of the walls or of the line, by name.
        number: number of points on each of them.
        starts: positions at which they start, and the end of the last one, length.
        discs: number of discs in each log.
        share: share of the section that all trajectories visit; None if there are too few points.
        shares: shares that single trajectories visit, at most SAMPLED, in increasing order.
        never: share of the trajectories without points; None for all walls.
        points: (n,) POINT, in order of time for each log.
        places: ends, arcs and radii of the walls, or the ends of the line.
    """

    kind: str
    lengths: dict[str, float]
    number: dict[str, int]
    starts: np.ndarray
    discs: tuple[int, ...]
    share: Estimate | None
    shares: tuple[Estimate, ...]
    never: Estimate | None
    points: Annotated[np.ndarray | None, OMITTED] = None
    places: Annotated[Any, OMITTED] = None

    @property
    def stored(self) -> np.ndarray:
        """The points; raise UserError for the results of a sweep, which do not contain points."""
        if self.points is None:
            raise UserError("section: results of a sweep contain no points; use keep_logs = true and pass the logs")
        return self.points

    def rows(self) -> dict[str, np.ndarray]:
        """Return the points as columns by name, with names of walls and positions along all walls."""
        columns = {name: self.stored[name].copy() for name in POINT.names or ()}
        columns["position"] += self.starts[columns["wall"]]
        return columns | {"wall": np.array([*self.lengths])[columns["wall"]]}

    def plain_tables(self) -> list[Table]:
        """Return the tables of shares and of walls."""
        rows = {"section visited by all trajectories": self.share, f"trajectories that never {self.kind}": self.never}
        for name, k in (("largest", -1), ("median", len(self.shares) // 2)) if len(self.shares) > 1 else ():
            rows[f"{name} of {len(self.shares)} trajectories"] = self.shares[k]
        walls = [
            (name, Number(start), Number(length), Number(self.number[name], ","))
            for (name, length), start in zip(self.lengths.items(), self.starts.tolist(), strict=False)
            if self.number[name] or self.never
        ]
        unsure = "Errors assume independent points and do not account for parts of the section not reached yet."
        notes = [unsure if self.share else f"Shares of the section require {FEWEST} points."]
        shares = estimates("Shares (no unit)", [(name, share) for name, share in rows.items() if share], notes)
        return [shares, Table("Section", ("", "start (length)", "length", "points"), walls)]

    def summary(self) -> str:
        """Return the number of points and the shares, for which theory is not available."""
        visit = f"; share of the section visited: {format_estimate(self.share)}" if self.share else ""
        never = f"; share of trajectories that never {self.kind}: {format_estimate(self.never)}" if self.never else ""
        whose = f"{sum(self.discs):,} {'trajectory' if sum(self.discs) == 1 else 'trajectories'}"
        return f"{sum(self.number.values()):,} points from {whose}{visit}{never}. Theory is not available."

    def figure(self) -> "Figure":
        """Draw the sine against the position for some trajectories, coloured by disc or, for several logs, by log."""
        from idealgas.presentation.style import COLOURS, GREY, panels

        figure, (ax,) = panels(1)
        rows = self.rows()
        visible = np.unique(rows["trajectory"])
        chosen = visible[sample(len(visible), max(DRAWN * len(visible) // (len(rows["time"]) or 1), 1))]
        drawn = np.flatnonzero(np.isin(rows["trajectory"], chosen))
        drawn = drawn[sample(len(drawn), DRAWN)]
        x, y, group = (rows[name][drawn] for name in ("position", "sine", "log" if len(self.discs) > 1 else "disc"))
        for k, colour in enumerate(COLOURS):
            here, size = group % len(COLOURS) == k, 1.5 if len(x) > DRAWN / 10 else 3.0
            ax.plot(x[here], y[here], ".", color=colour, ms=size, mew=0, rasterized=True)
        for start in np.unique(self.starts)[1:-1]:
            ax.axvline(start, color=GREY, linewidth=0.6)
        ax.set(xlim=(0, self.starts[-1] or 1.0), ylim=(-1, 1), xlabel="position (length)", ylabel="sine (no unit)")
        return figure


class SectionAnalysis(Analysis):
    """Poincaré sections."""

    position = 109
    headline = "share"
    averages = True
    on_request = True
    supports_escapes = True
    results = (PoincareSection,)
    sections = (Section("Poincaré section", "Sine of the angle of reflection against the position along the walls"),)
    options = (
        Option("walls", str, "Names of walls, separated by commas; all walls by default.", metavar="NAME,..."),
        Option("line", str, "Ends of a line; its crossings replace wall hits as points.", metavar="X0,Y0,X1,Y1"),
    )
    start = "the log's start"

    @staticmethod
    def measure(
        log: Log, walls: str | None = None, line: str | None = None,
        start: float | None = None, end: float | None = None, progress: ReadProgress | None = None,
    ) -> PoincareSection:  # fmt: skip
        """Find the points at which discs hit walls or cross a line, and the share of the section that they visit."""
        log.require_events()
        if walls is not None and line is not None:
            raise UserError("section: walls and line cannot be combined")
        first, last = span(log, start, end)
        if line is None:
            kind, chosen = "hit walls" if walls is None else "hit these walls", chosen_walls(log, walls)
            lengths, batches = {wall.name: wall.length for wall in chosen.values()}, hits(log, chosen, first, last)
            places: Any = [(wall.start, wall.end, wall.arc, wall.radius) for wall in chosen.values()]
        else:
            kind, ends = "cross the line", line_ends(line)
            lengths, batches = {"line": math.dist(*ends)}, crossings(log, ends, first, last)
            places = ends.tolist()
        parts, done, rows = [np.empty(0, POINT)], 0, log.row_at(last, "right") - log.row_at(first, "right")
        for batch, read in batches:
            parts.append(batch)
            done += read
            if progress is not None:
                progress(min(done, rows), rows)
        points = np.concatenate(parts)
        points["trajectory"] = points["disc"]
        points = points if line is None else points[np.argsort(points["time"], kind="stable")]
        collisions = np.ptp(np.interp((first, last), *log.observables["disc_collisions"]))
        gas = log.scene.properties
        conserves = gas.straight_flight and gas.elastic and gas.fixed_walls and gas.isolated and not gas.spins
        caveats = {UNEQUAL: not conserves, COLLIDING: collisions > len(points) / 100}
        return _section(kind, lengths, (len(log.discs),), points, places, *filter(caveats.get, caveats))

    @staticmethod
    def combine(results: Sequence[PoincareSection]) -> PoincareSection:
        """Combine the points of several logs; raise UserError if their walls differ."""
        first, discs = results[0], tuple[int, ...]()
        if len(results) == 1:
            return first
        parts = [result.stored.copy() for result in results]
        if any((each.kind, each.lengths, each.places) != (first.kind, first.lengths, first.places) for each in results):
            raise UserError("section: the logs have different walls; analyse them separately")
        for part, result in zip(parts, results, strict=True):
            part["log"] += len(discs)
            part["trajectory"] += sum(discs)
            discs += result.discs
        return _section(first.kind, first.lengths, discs, np.concatenate(parts), first.places)


def _section(
    kind: str, lengths: dict, discs: tuple[int, ...], points: np.ndarray, places: Any, *caveats: str
) -> PoincareSection:
    """Return the section that consists of points, with its shares; the other arguments are as in `PoincareSection`."""
    number = np.bincount(points["wall"], minlength=len(lengths))
    starts = np.cumsum([0.0, *np.where((number > 0) | (kind != "hit walls"), [*lengths.values()], 0.0)])
    x, y = (starts[points["wall"]] + points["position"]) / (starts[-1] or 1.0), (1 + points["sine"]) / 2
    total, order = sum(discs), np.argsort(points["trajectory"], kind="stable")
    counts = np.bincount(points["trajectory"], minlength=total)
    members, enough = np.split(order, np.cumsum(counts)[:-1]), np.flatnonzero(counts >= FEWEST)
    enough = enough[sample(len(enough), SAMPLED)] if 2 * len(enough) > total else enough[:0]  # few are not typical
    shares = filter(None, (share_visited(x[members[k]], y[members[k]]) for k in enough))
    without = int((counts == 0).sum())
    error = math.sqrt((without + 1) * (total - without + 1) / (total + 3)) / (total + 2)  # never 0
    never = Estimate(without / total, error, math.inf) if kind != "hit walls" else None
    ordered, share = tuple(sorted(shares, key=lambda share: share.value)), share_visited(x, y)
    by_name = dict(zip(lengths, number.tolist(), strict=True))
    return PoincareSection(
        kind, lengths, by_name, starts, discs, share, ordered, never, points, places, caveats=caveats
    )


def share_visited(x: np.ndarray, y: np.ndarray) -> Estimate | None:
    """Return the share of the unit square that points (n,) fill; None for fewer than FEWEST points.

    The share v(h) of boxes of side h with points exceeds the area of a region by its boundary times h, which 2 v(h) -
    v(2h) removes. For 2h and 4h, a fourth and a sixteenth of the points are used, so that boxes contain equally many.
    The error combines a third of the change if h is doubled with the boxes missed by chance: a box at the boundary in
    which λ independent points are expected is missed with a variance of e^-λ (1 - e^-λ); averaged over λ, this is half
    the mean of λ e^-λ, the number of boxes with a single point.
    """
    if len(x) < FEWEST:
        return None
    kept = sample(len(x), MOST)
    n, side = len(kept), int(math.sqrt(len(kept) / PER_BOX)) // 4 * 4 * PIXELS
    i, j = (np.clip((values[kept] * side).astype(np.int64), 0, side - 1) for values in (x, y))
    shares, alone = np.zeros(3), np.zeros(n)
    for k, weight in enumerate((2.0, -1.0, 0.0)):
        for first in range(subsets := min(4**k, 4)):
            part = slice(first, None, 4**k)
            share, gain = _boxes(i[part], j[part], side, PIXELS * 2**k)
            shares[k] += share / subsets
            alone[part] += weight * gain / subsets
    area, coarser = np.maximum(2 * shares[:2] - shares[1:], 1 / n)
    error = math.sqrt(alone @ alone / 2 + (area - coarser) ** 2 / 9 + 1 / n**2)
    value = area / -math.expm1(-PER_BOX / area)  # includes boxes inside the region that are missed
    return Estimate(min(float(value), 1.0), error, math.inf)


def sample(number: int, most: int) -> np.ndarray:
    """Return at most `most` of the integers from 0 to `number` - 1, chosen at random, in increasing order."""
    return np.sort(np.random.default_rng(0).choice(number, min(number, most), replace=False))


def _boxes(i: np.ndarray, j: np.ndarray, side: int, width: int) -> tuple[float, np.ndarray]:
    """Return the area of the boxes that contain points, and for each point (n,) the area of the boxes with no other.

    Boxes are `width` pixels wide and end at the sides of the unit square, which has `side` pixels along each axis. The
    areas are averages over all positions of the grid of boxes on the pixels, to which the points (i, j) belong.
    """
    pixels = np.bincount(i * side + j, minlength=side * side).reshape(side, side)
    sums = np.pad(pixels, ((width, width - 1),) * 2).cumsum(0).cumsum(1)
    counts = sums[width:, width:] - sums[:-width, width:] - sums[width:, :-width] + sums[:-width, :-width]
    low = np.arange(1 - width, side)
    inside = (np.minimum(low + width, side) - np.maximum(low, 0)) / (side * width)
    sums = np.pad(np.where(counts == 1, np.outer(inside, inside), 0.0), ((1, 0), (1, 0))).cumsum(0).cumsum(1)
    alone = sums[i + width, j + width] - sums[i, j + width] - sums[i + width, j] + sums[i, j]
    return float(inside @ (counts > 0) @ inside), alone
