"""Temperature of every degree of freedom of each species, compared with equipartition."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Annotated

import numpy as np

from idealgas.analysis.core.composition import composition
from idealgas.analysis.core.ensemble import known_ensemble, nonequilibrium_reason, nonstationary_reason
from idealgas.analysis.core.equilibration import Window, measure
from idealgas.analysis.core.fields import OMITTED, reported
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.result import Result
from idealgas.analysis.core.statistics import Estimate, mean
from idealgas.analysis.theory.conserved import is_ergodic
from idealgas.errors import NotApplicableError
from idealgas.log import Log


@dataclass(frozen=True)
class SpeciesTemperature:
    """Temperatures of the discs of one species (energy, k_B = 1), compared with equipartition.

    species: name. number: of its discs. x, y, both: mean of m vx², m vy² and m v²/2. directions: (B, 2), mean m vx² and
    m vy² in every block that was read, including those before the window.
    """

    species: str
    number: int
    x: Estimate
    y: Estimate
    both: Estimate
    directions: Annotated[np.ndarray, OMITTED]

    @property
    @reported
    def history(self) -> np.ndarray:
        """Mean m v²/2 (B,) in every block that was read, energy."""
        return self.directions.mean(axis=1)


@dataclass(frozen=True)
class Temperature(Result):
    """Temperatures of each species, and last of all discs.

    window: the time that was used. expected: E/N in equilibrium, energy; None if it is not known beforehand. species:
    temperatures of each species and of all discs.
    """

    window: Window
    expected: float | None
    species: tuple[SpeciesTemperature, ...]

    @property
    @reported
    def block_edges(self) -> np.ndarray:
        """Times (B + 1,) between the blocks that were read."""
        return self.window.edges

    @property
    def apart(self) -> tuple[SpeciesTemperature, ...]:
        """Temperatures that are not the same: with one species only those of all discs."""
        return self.species[:1] if len(self.species) == 2 else self.species


def temperature(
    log: Log,
    start: float | None = None,
    end: float | None = None,
    progress: Callable[[int, int], None] | None = None,
) -> Temperature:
    """Measure the temperature of every direction of motion, species by species, between two times of a log.

    By equipartition all are the same in equilibrium: m⟨vx²⟩ = m⟨vy²⟩ = m⟨v²⟩/2 = T, with k_B = 1, less what a conserved
    momentum takes away in a finite gas.

    start, end: times; by default from detected equilibrium to the end of the log. progress(done, in all) is called as
    events are read. Raises UserError if there are no events in the window, and NotApplicableError if no start is given
    and the gas has no equilibrium.
    """
    if start is None and len(log.scene.properties.temperatures) > 1 and not nonstationary_reason(log):
        raise NotApplicableError(
            f"{log.path}: no equilibrium, as {nonequilibrium_reason(log)}: "
            "`idealgas profile` shows T in strips; --from T sets a start by hand"
        )
    moments = Moments(log.gravity)
    window = measure(log, [moments], start, end, progress)
    discs = composition(log.discs)
    equilibrium = known_ensemble(log)
    shares: list[float] | list[None] = [None] * len(discs.name)
    expected = None
    if equilibrium is not None:
        shares = equilibrium.of_species.tolist()
        expected = float(discs.number @ equilibrium.of_species / discs.number.sum())
    sums, shared = moments.flights[:, :, 1:3] / window.width, is_ergodic(log.scene, log.discs)

    def entry(name: str, number: int, expected: float | None, directions: np.ndarray) -> SpeciesTemperature:
        """Temperatures of one species from sums (B, 2) of m vx² and m vy² over its discs."""
        means = directions / number
        x, y = means[window.first :].T
        along = expected if shared else None
        return SpeciesTemperature(name, number, mean(x, along), mean(y, along), mean((x + y) / 2, expected), means)

    entries = [
        entry(name, int(number), shares[s], sums[:, s])
        for s, (name, number) in enumerate(zip(discs.name, discs.number, strict=True))
    ]
    return Temperature(window, expected, (*entries, entry("all discs", len(log.discs), expected, sums.sum(axis=1))))
