"""How often discs of each species meet, how far they fly in between, and what kinetic theory says."""

from dataclasses import dataclass
from typing import Any, NamedTuple

import numpy as np

from idealgas.analysis.core.composition import Composition
from idealgas.analysis.core.equilibrium import Ensemble, drift
from idealgas.analysis.core.flights import Moments
from idealgas.analysis.core.impacts import Impacts
from idealgas.analysis.core.statistics import Estimate, estimate, mean, ratio
from idealgas.analysis.core.window import Window
from idealgas.analysis.theory import hard_discs
from idealgas.analysis.theory.values import BoxTheory, Theory, box_theory
from idealgas.log import Log


@dataclass(frozen=True)
class CollisionRate:
    """Collisions per time of one disc of `species` with discs of the species `other`."""

    species: str
    other: str
    rate: Estimate

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        return {"species": self.species, "other": self.other, "rate": self.rate.as_dict()}


@dataclass(frozen=True)
class FreePath:
    """Mean path and mean time of a disc between collisions with discs, and its mean speed."""

    species: str
    path: Estimate
    time: Estimate
    speed: Estimate

    def as_dict(self) -> dict[str, Any]:
        """For JSON."""
        values = {"path": self.path.as_dict(), "time": self.time.as_dict(), "speed": self.speed.as_dict()}
        return {"species": self.species, **values}


class ExpectedRates(NamedTuple):
    """Γ_ij by theory, (S, S), not a number where it has no value; relative_error: (S, S), one standard deviation."""

    rate: np.ndarray
    relative_error: np.ndarray

    def between(self, i: int, j: int) -> Theory | None:
        """Γ_ij, None without a value."""
        return self._theory(self.rate[i, j], self.relative_error[i, j] * self.rate[i, j])

    def of(self, i: int) -> Theory | None:
        """Collisions of a disc of species i with all discs."""
        return self._theory(self.rate[i].sum(), (self.relative_error[i] * self.rate[i]).sum())

    @staticmethod
    def _theory(rate: float, error: float) -> Theory | None:
        return Theory(float(rate), float(error), "kinetic theory") if np.isfinite(rate) else None


def theory_of(log: Log, discs: Composition) -> BoxTheory:
    """Pressure and contacts of the gas of a log, which is uniform, where theory knows them."""
    return box_theory(discs.radius, discs.number, log.box, log.periodic, ergodic=_is_ergodic(log))


def _is_ergodic(log: Log) -> bool:
    """Whether two discs come everywhere that their energy allows.

    Equal discs between walls that set out with opposite velocities do not: after every reflection each component of
    one is that of the other but for its sign, which keeps the centre of the pair, reflected as they are, in its place.
    """
    gas = log.discs
    if len(gas) != 2 or all(log.periodic) or not log.scene.properties.isolated or np.ptp(gas.mass) > 0:
        return True
    speeds = np.abs(gas.velocity - drift(log))[:, ~np.array(log.periodic)]
    return bool(np.abs(speeds[0] - speeds[1]).max() > 1e-9 * speeds.max())


def expected_rates(
    discs: Composition, box: tuple[float, float], equilibrium: Ensemble, theory: BoxTheory | None
) -> ExpectedRates:
    """Γ_ij by theory for all discs of a box; theory: as `theory_of` gives it, None for a gas without positions.

    The contacts that the pressure comes from, met at relative speeds that a fixed total energy makes a little larger
    than Maxwell and Boltzmann's.
    """
    speed = hard_discs.mean_relative_speeds(equilibrium.temperature, discs.mass, equilibrium.dof)
    if theory is None:
        return ExpectedRates(hard_discs.contacts_without_positions(discs.radius, discs.number, box) * speed, 0 * speed)
    return ExpectedRates(theory.contacts * speed, theory.rate_error)


def collision_rates(
    discs: Composition, expected: ExpectedRates, window: Window, impacts: Impacts
) -> tuple[CollisionRate, ...]:
    """Rates of all pairs of species. expected: as `expected_rates` gives them."""
    counts = window.of(impacts.collisions)

    def rate(i: int, j: int) -> Estimate:
        discs_per_event = 2 if i == j else 1
        series = discs_per_event * counts[:, min(i, j), max(i, j)] / discs.number[i]
        return mean(series, theory=expected.between(i, j))

    species = range(len(discs.name))
    return tuple(CollisionRate(discs.name[i], discs.name[j], rate(i, j)) for i in species for j in species)


def free_paths(
    discs: Composition,
    expected: ExpectedRates,
    equilibrium: Ensemble,
    window: Window,
    moments: Moments,
    impacts: Impacts,
) -> tuple[FreePath, ...]:
    """Mean free path λ = ⟨v⟩/Γ and time 1/Γ of each species. expected: as `expected_rates` gives them."""
    counts = window.of(impacts.collisions)
    paths = []
    for i, (name, mass, number) in enumerate(zip(discs.name, discs.mass, discs.number, strict=True)):
        own = (counts[:, i, :] + counts[:, :, i]).sum(axis=1) / number  # a collision of two like discs counts for both
        speeds = window.of(moments.flights)[:, i, 0] / number
        speed = hard_discs.mean_speed(equilibrium.of_species[i], mass, equilibrium.dof)
        free_time = _inverse(expected.of(i))
        paths.append(
            FreePath(
                name,
                path=ratio(speeds, own, theory=free_time and free_time.times(speed)),
                time=estimate(lambda rate: 1 / rate, own, theory=free_time),
                speed=mean(speeds, theory=speed),
            )
        )
    return tuple(paths)


def _inverse(rate: Theory | None) -> Theory | None:
    if rate is None or rate.value == 0:
        return None
    return Theory(1 / rate.value, rate.error / rate.value**2, rate.source)
