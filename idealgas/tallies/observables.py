"""Observables of a gas that are steady in equilibrium, and the time in which the structure of the gas relaxes."""

import math
from collections.abc import Callable, Iterable, Iterator
from typing import Any, NamedTuple

import numpy as np

from idealgas.log import Log
from idealgas.statistics.autoregression import inefficiency
from idealgas.tallies.equilibrium import ROUNDING, known_ensemble, nonstationary_reason
from idealgas.tallies.exchange import Exchange
from idealgas.tallies.flights import DensityBins, Moments
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.stream import Tally
from idealgas.theory.conserved import are_fixed
from idealgas.theory.ensemble import composition

BINS = 4
"""Number of bins along each axis in which discs are counted to determine the centre of a species."""

MIXING = 0.15
"""Smallest packing fraction at which collision rates depend on the positions of the species.

They were found to depend on them at 0.2, but not at 0.06.
"""

DENSE, FREE_TIMES = 0.5, 50.0
"""Smallest packing fraction at which the structure of any gas relaxes slowly, and the time of this in mean free times.

At φ = 0.6, standard errors are 1.2 to 1.3 times too small in windows of 300 mean free times, and correct in 2000.
"""

HEAT = 6.0
"""Time that heat takes to cross a gas, in units of the statistical inefficiency of the kinetic energy.

Most fluctuations of the kinetic energy are faster. For 40 discs between thermal walls and under gravity, standard
errors are 1.14 to 1.21 times too small in windows of 30 to 45 inefficiencies, 1.09 to 1.17 times too small in windows
of 85, and correct in windows of 140.
"""


class Observable(NamedTuple):
    """Means over blocks of a quantity that is steady in equilibrium, and theoretical bounds on its variance.

    Attributes:
        values: (n,), means over the blocks.
        least: variance of fluctuations that may be slower than the series is long. The series is ignored unless its
            beginning differs from the remainder by more than these fluctuations explain.
        most: variance at one instant, an upper bound on the variance of any mean.
    """

    values: np.ndarray
    least: float = 0.0
    most: float = math.inf


class TimeSeries:
    """Observables of a gas, in blocks of time, that are steady in equilibrium, and the tallies that measure them."""

    def __init__(self, log: Log, edges: np.ndarray, present: Iterable[Tally] = ()) -> None:
        """Set up the tallies for a log and blocks with boundaries (B + 1,), reusing suitable tallies in `present`."""
        self.discs, self.ensemble, self.width = composition(log.discs), known_ensemble(log), edges[1] - edges[0]
        self.fraction, properties = log.discs.packing_fraction, log.scene.properties
        through_walls = not properties.isolated and properties.bath is None
        self.conducts = (through_walls or not properties.straight_flight) and not nonstationary_reason(log)
        self.tallies = list(present)
        self.moments = self._get(Moments, lambda: Moments(log.gravity))
        self.impacts: Impacts | None = None
        self.bins: DensityBins | None = None
        if log.has_positions:
            self.impacts = self._get(Impacts, lambda: Impacts(len(log.walls), log.periodic))
            self.bins = self._get(DensityBins, lambda: DensityBins(BINS))

    def _get(self, kind: type[Any], make: Callable[[], Any]) -> Any:
        if not any(isinstance(tally, kind) for tally in self.tallies):
            self.tallies.append(make())
        return next(tally for tally in self.tallies if isinstance(tally, kind))

    @property
    def rates(self) -> np.ndarray:
        """Time averages of Σ |v|, Σ m vx² and Σ m vy² over the discs of each species in each block, (B, S, 3)."""
        return self.moments.flights / self.width

    def observables(self) -> Iterator[Observable]:
        """Yield speed and energy of each species, the difference of the energies along x and y, event counts, virial.

        The speed detects equal initial speeds better than v⁴ would: at fixed energy, the mean speed is then 0.84 √N
        standard deviations from its equilibrium value, and the mean of v⁴ 0.50 √N.
        """
        speeds, energies = self.rates[:, :, 0], self.rates[:, :, 1:]
        moments = np.array([speeds.T, energies.sum(axis=2).T])
        known = (
            np.full(moments.shape[:2], math.inf)
            if self.ensemble is None
            else self.ensemble.variances(self.discs.number)
        )
        mobile = ~are_fixed(self.discs.mass)
        for values, most in zip(moments[:, mobile], known[:, mobile], strict=True):
            yield from map(
                Observable, values, np.zeros(len(most)), most
            )  # the integrals of fixed discs would grow forever
        yield Observable(energies.sum(axis=1) @ (1.0, -1.0))
        yield from (Observable(numbers.astype(float)) for numbers in self.moments.events.T)
        if self.impacts is not None:
            yield Observable(self.impacts.pair_virial)

    def centres(self) -> Iterator[Observable]:
        """Yield sums of the positions of each species along x and y, in bins, with the variance for independent discs.

        In a dense gas and in a sound wave these sums fluctuate more slowly than a short log can show.
        """
        if self.bins is not None:
            place = np.arange(self.bins.bins) - (self.bins.bins - 1) / 2
            for discs in np.moveaxis(self.bins.discs, 0, 2).reshape(-1, *self.bins.discs.shape[::3]):
                yield Observable(discs @ place, least=float(discs[0].sum() * (place**2).mean()))

    def slowest_exchange(self, first: int) -> Exchange:
        """Return the slowest exchange that the log shows after a given block.

        Its time is 0 if nothing is known to be slow. In a mixture it is twice the longest correlation time of the
        centre of a species relative to the centre of all discs. Collision rates depend on this motion, but so weakly
        that the motion is not visible in their own series. In a dense gas the time is at least FREE_TIMES mean free
        times. If heat has to cross the gas, the time is at least HEAT times the inefficiency of the kinetic energy;
        this does not apply to spins and thermostats, which exchange energy everywhere.
        """
        kinetic, slow, free_time = self.rates[first:, :, 1:].sum(axis=(1, 2)), [], 0.0
        exchange = inefficiency(kinetic) if self.conducts and np.ptp(kinetic) > ROUNDING * kinetic.max() else 0.0
        if self.bins is not None and self.fraction >= MIXING:
            centre, number = self.bins.discs[first:] @ np.arange(self.bins.bins), self.discs.number[:, None]
            apart = centre / number - centre.sum(axis=1, keepdims=True) / number.sum()
            slow = [*apart.reshape(len(centre), -1).T] if len(number) > 1 else []
            if self.fraction >= DENSE and (collisions := self.moments.events[first:, 0].sum()):
                free_time = number.sum() * len(centre) / (2 * collisions)
        mixing = (inefficiency(centres) for centres in slow if np.ptp(centres) > ROUNDING)
        times = (
            (HEAT * exchange, "heat crosses the gas"),
            (FREE_TIMES * free_time, "the discs of a dense gas change places"),
            (max(mixing, default=0.0), "species move past each other"),
        )
        return max(Exchange(time * self.width, process) for time, process in times)
