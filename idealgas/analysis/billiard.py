"""Measure the mean path length of discs between successive wall hits.

If the paths pass through every point in every direction with equal probability, the mean path length is exactly π times
the area that the centres of the discs can reach, divided by the perimeter of this area, whatever the shape of the box
(Chernov, J. Stat. Phys. 88, 1 (1997), after Santaló).
"""

import math
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from idealgas.analysis.analysis import Analysis, Section
from idealgas.analysis.check import CheckResult, agreement, check_theory
from idealgas.analysis.result import Result
from idealgas.errors import UserError
from idealgas.log import Log
from idealgas.presentation.tables import Number, Table, estimates, format_estimate
from idealgas.statistics.estimates import Estimate, ratio
from idealgas.tallies.equilibration import Window, measure
from idealgas.tallies.flights import Moments
from idealgas.tallies.reach import Reach, reach_of
from idealgas.tallies.stream import ReadProgress
from idealgas.theory.values import NoTheoryError, Theory

if TYPE_CHECKING:
    from matplotlib.figure import Figure

UNMIXED = (
    "Discs hardly ever collide. Theory then requires walls that mix all paths, such as those of Sinai's billiard or of "
    "a stadium; in a circle or a rectangle, the mean depends on the path."
)
"""Caveat for discs that are deflected almost only by walls."""

SPARSE = 1e-6
"""Packing fraction up to which other discs do not change any printed digit of the density at the walls."""

ROW = "mean path between wall hits (length)"


@dataclass(frozen=True)
class Billiard(Result):
    """Paths of discs between wall hits.

    Attributes:
        window: time window that was analysed.
        hits: number of wall hits in the window.
        path: mean path length of a disc between successive wall hits.
        reach: area that the centres of the discs can reach, and its perimeter; None without theory.
        reason: why theory is not available, as part of a sentence; None if theory is available.
        time: (B,), middles of the blocks of time.
        series: (B,), mean path length up to the end of each block.
    """

    window: Window
    hits: int
    path: Estimate
    reach: Reach | None
    reason: str | None
    time: np.ndarray
    series: np.ndarray

    def check(self) -> CheckResult:
        """Compare the mean path with theory."""
        return check_theory([("path", None, self.path)], self.reason)

    def plain_tables(self) -> list[Table]:
        """Return the table of the mean path and that of the area and perimeter from which it is predicted."""
        notes = [str(self.window), f"{self.hits:,} wall hits"]
        if self.reason:
            notes.append(f"Theory is not available: {self.reason}.")
        tables = [estimates("Paths between walls", [(ROW, self.path)], notes)]
        if self.reach:
            rows = [
                ("area (length²)", Number(self.reach.area)),
                ("perimeter (length)", Number(self.reach.perimeter)),
            ]
            tables.append(Table("Reach of the centres of the discs", ("", "value"), rows))
        return tables

    def summary(self) -> str:
        """Return the mean path between wall hits, and whether it agrees with π A/P."""
        verdict = agreement([("path", self.path)], "π A/P", self.reason)
        return f"The mean path length between successive wall hits is {format_estimate(self.path)}; {verdict}."

    def figure(self) -> "Figure":
        """Draw the running mean of the path length, with the theoretical value."""
        from idealgas.presentation.style import COLOURS, panels

        figure, (ax,) = panels(1)
        ax.plot(self.time, self.series, color=COLOURS[0], label="mean up to this time")
        if self.path.theory is not None:
            ax.theory(None, self.path.theory, self.path.theory_error, "π A/P")
        ax.set_ylabel("path between wall hits (length)")
        ax.time_axis()
        ax.legend()
        return figure


class BilliardAnalysis(Analysis):
    """Mean path between wall hits."""

    position = 108
    headline = "path"
    results = (Billiard,)
    sections = (
        Section("Paths between walls", "Mean path length between successive wall hits, averaged up to each time"),
    )

    @staticmethod
    def measure(
        log: Log, start: float | None = None, end: float | None = None, progress: ReadProgress | None = None
    ) -> Billiard:
        """Measure the mean path length of discs between successive wall hits, and compare it with π A/P.

        A is the area that the centres of the discs can reach, and P is its perimeter. Collisions with other discs do
        not end a path. Theory is available for discs of equal radius that fly straight between walls at rest. In a gas
        of several discs, the theoretical value has a relative error of 2φ, which allows for the density at the walls.

        Raises:
            UserError: if no disc hits a wall in the window.
        """
        log.require_events()
        moments = Moments(log.gravity)
        window = measure(log, [moments], start, end, progress)
        path, hits = moments.flights[window.first :, :, 0].sum(axis=1), moments.events[window.first :, 1]
        if not hits.any():
            raise UserError(f"{log.path}: no disc hits a wall between t = {window.start:g} and {window.end:g}")
        theory, reach, reason = None, None, None
        try:
            theory, reach = _theory(log)
        except NoTheoryError as error:
            reason = str(error)
        unmixed = reach is not None and moments.events[window.first :, 0].sum() < hits.sum()
        return Billiard(
            window,
            int(hits.sum()),
            ratio(path, hits, theory=theory),
            reach,
            reason,
            (window.edges[window.first : -1] + window.edges[window.first + 1 :]) / 2,
            path.cumsum() / np.maximum(hits.cumsum(), 1),
            caveats=(UNMIXED,) if unmixed else (),
        )


def _theory(log: Log) -> tuple[Theory, Reach]:
    """Return the theoretical mean path length π A/P between wall hits, with the area A and the perimeter P.

    Raises:
        NoTheoryError: if theory does not apply.
    """
    properties, gas = log.scene.properties, log.discs
    if np.ptp(gas.radius) > 0:
        raise NoTheoryError("the discs differ in radius")
    if not (properties.straight_flight and properties.fixed_walls):
        raise NoTheoryError("gravity acts on the discs, or walls move")
    if properties.dissipative or properties.spins or properties.varies or len(properties.temperatures) > 1:
        raise NoTheoryError("the gas is not in equilibrium")
    if log.escapes or any(wall.absences or wall.is_permeable for wall in log.scene.walls):
        raise NoTheoryError("a wall opens, or lets discs pass")
    reach = reach_of(log, float(gas.radius[0]))
    if not (reach.area > 0 and reach.perimeter > 0):
        raise NoTheoryError("there is no free area between the walls")
    path = math.pi * reach.area / reach.perimeter
    crowding = (
        2 * gas.packing_fraction if properties.interacting and len(gas) > 1 and gas.packing_fraction > SPARSE else 0.0
    )
    return Theory(path, path * crowding, "π A/P"), reach
