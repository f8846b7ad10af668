"""Currents of momentum, energy and species in the whole gas, integrated over blocks of time, from the events of a log.

Between two events the currents are constant: Σ m v_a v_b for momentum, Σ (m v²/2) v_a for energy and, for two species,
the difference between their mean velocities. When two discs collide, momentum Δp and energy ΔE jump from the centre of
one disc to the centre of the other, over a vector r, and the time integrals of the currents grow by Δp_a r_b and
ΔE r_a. The integrals are the Helfand moments: Helfand, Phys. Rev. 119, 1 (1960).
"""

import numpy as np

from idealgas.log import Flights, Log
from idealgas.state import Gas
from idealgas.statistics.estimates import Estimate, mean, mean_of_flux
from idealgas.tallies.impacts import contacts
from idealgas.tallies.stream import add_to
from idealgas.theory.conserved import conserved_momentum
from idealgas.theory.ensemble import Ensemble
from idealgas.theory.values import BoxTheory

XX, XY, YY, HEAT_X, HEAT_Y, APART_X, APART_Y = range(7)
"""Components of the currents of momentum, of energy, and of one species relative to the other."""

CARRIED, PASSED_ON = range(2)
"""Kinetic part of a current, which discs carry in flight, and collisional part, which collisions transfer."""


class Currents:
    """Time integrals of the currents in each of B blocks; contributions of walls and of a heat bath are not included.

    Attributes:
        flow: (B, 2, 7), parts CARRIED and PASSED_ON of the components XX, XY, YY (energy·time), HEAT_X, HEAT_Y
            (energy·length), APART_X and APART_Y (length). The last two have a kinetic part only, and are 0 unless there
            are two species.
    """

    columns = ("disc", "block", "end", "kind", "partner", "velocity", "new_velocity", "end_position")
    cut = False

    def __init__(self, periodic: tuple[bool, ...] = (True, True)) -> None:
        """Set whether x and y are periodic."""
        self._periodic = periodic

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        self.edges = edges
        self._flow = np.zeros((2, 7, len(edges) - 1))
        self._box, self._mass, self._share = gas.box, gas.mass, shares(gas)
        self._total = carried(self._mass, self._share, gas.velocity).sum(axis=0)
        self._reached = float(edges[0])

    def add(self, flights: Flights) -> None:
        """Add a batch of flights."""
        mass, share = self._mass.take(flights.disc), self._share.take(flights.disc)
        change = carried(mass, share, flights.new_velocity) - carried(mass, share, flights.velocity)
        current = np.cumsum(
            np.concatenate((self._total[None], change)), axis=0
        )  # before each event and after the last one
        self._flow_until(flights.end, current[:-1])
        self._total = current[-1]
        second, apart = contacts(flights, self._box, self._periodic)
        before, after, block = flights.velocity[second], flights.new_velocity[second], flights.block[second]
        given = mass[second, None] * (after - before)
        energy = 0.5 * (given * (after + before)).sum(axis=1)
        (px, py), (x, y) = given.T, apart.T
        for k, passed in enumerate((px * x, px * y, py * y, energy * x, energy * y)):
            add_to(self._flow[PASSED_ON, k], block, passed)

    def finish(self) -> None:
        """Add the currents from the last event up to time edges[-1]."""
        self._flow_until(self.edges[-1:], self._total[None])
        self.flow = np.ascontiguousarray(np.moveaxis(self._flow, 2, 0))

    def _flow_until(self, times: np.ndarray, current: np.ndarray) -> None:
        """Integrate currents (n, 7) in time; each lasts from the previous time to its time in `times` (n,)."""
        inner = self.edges[(self.edges > self._reached) & (self.edges < times[-1])]
        at = times.searchsorted(inner)
        ends = np.insert(times, at, inner)
        flow = np.insert(current, at, current[at], axis=0) * np.diff(ends, prepend=self._reached)[:, None]
        block = self.edges[1:-1].searchsorted(ends)
        for k in range(7):
            add_to(self._flow[CARRIED, k], block, flow[:, k])
        self._reached = float(times[-1])


def shares(gas: Gas) -> np.ndarray:
    """Return the weights (N,) of the discs in the difference between the mean velocities of two species, else zeros."""
    number = np.bincount(gas.species, minlength=len(gas.species_names))
    if len(number) != 2:
        return np.zeros(len(gas))
    return np.array([1.0, -1.0])[gas.species] / number[gas.species]


def carried(mass: np.ndarray, share: np.ndarray, velocity: np.ndarray) -> np.ndarray:
    """Return the kinetic contribution of each disc to the currents, (n, 7)."""
    vx, vy = velocity.T
    px, py = mass * vx, mass * vy
    energy = 0.5 * mass * (vx * vx + vy * vy)
    return np.column_stack((px * vx, px * vy, py * vy, energy * vx, energy * vy, share * vx, share * vy))


def pressure_tensor(log: Log, equilibrium: Ensemble, theory: BoxTheory, current: np.ndarray) -> dict[str, Estimate]:
    """Return components xx, yy and xy of the pressure tensor of a uniform gas, energy/length², from momentum currents.

    According to equipartition the kinetic parts of xx and yy are NT. This value is used because the measured one
    fluctuates far more than the collisional part.

    Args:
        log: log of the gas.
        equilibrium: ensemble of the gas.
        theory: theory of the gas in its box.
        current: currents (B, 2, 3 or more) in blocks of time, energy.
    """
    gas, ideal = log.discs, len(log.discs) * equilibrium.temperature
    along = theory.along_axes(gas.radius, log.box, log.periodic)
    components = {
        name: mean(1 + current[:, PASSED_ON, k] / ideal, z).times(ideal / gas.area)
        for name, k, z in zip(("xx", "yy"), (XX, YY), along, strict=True)
    }
    shear = current[:, :, XY].sum(axis=1) / gas.area
    if conserved_momentum(log.scene).sum() == 1:  # walls exert no tangential force, so Σ m y vx stays bounded
        return components | {"xy": mean_of_flux(shear, np.zeros(len(shear)), 0.0)}
    return components | {"xy": mean(shear, 0.0)}
