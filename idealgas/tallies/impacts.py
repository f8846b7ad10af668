"""Sums over collisions and wall hits: virials, momentum given to walls, and numbers of events.

Each event contributes the change in the momentum of a disc during the event; changes due to gravity during flights are
not included.
"""

import numpy as np

from idealgas.columns import SIDES, WALL_HITS, Kind
from idealgas.log import Flights
from idealgas.state import Gas
from idealgas.tallies.stream import add_to


class Impacts:
    """Sums over collisions and wall hits in each of B blocks of time, for S species and W walls.

    Attributes:
        pair_virial: (B,), Σ r_ij·Δp_ij over pair collisions, where r_ij is the minimum image, energy·time.
        wall_virial: (B,), -Σ r·Δp over wall hits, summed over axes that are not periodic, where r is measured from the
            centre of the box, energy·time.
        inner_virial: (B,), Σ r·Δp over all other events along the same axes, energy·time.
        passed_on: (B, 4), momentum that events other than hits of a side transfer towards this side, see `add`,
            mass·length/time.
        collisions: (B, S, G), numbers of collisions of the discs of a species with the discs of a group
            (`Gas.partners`); a pair collision counts for both of its discs.
        impulse: (B, W, 2), momentum given to each wall, mass·length/time.
        hits: (B, W), numbers of hits of each wall.
    """

    columns = ("disc", "block", "kind", "partner", "end_velocity", "new_velocity", "end_position")
    cut = False

    def __init__(self, walls: int = len(SIDES), periodic: tuple[bool, ...] = (False, False)) -> None:
        """Set the number of walls, of which the sides of the box come first, and whether x and y are periodic."""
        self.walls, self.periodic = walls, periodic

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the discs at time edges[0]; edges: (B + 1,), boundaries of the blocks of time."""
        blocks = len(edges) - 1
        self.pair_virial = np.zeros(blocks)
        self.wall_virial = np.zeros(blocks)
        self.inner_virial = np.zeros(blocks)
        self._passed_on = np.zeros((len(SIDES), blocks))
        self.collisions = np.zeros((blocks, len(gas.species_names), len(gas.partners)), np.int64)
        self._impulse = np.zeros((2, blocks, self.walls))
        self.hits = np.zeros((blocks, self.walls), np.int64)
        self._box, self._mass, self._radius = gas.box, gas.mass, gas.radius
        self._species, self._partner = gas.species.astype(np.intp), gas.partner.astype(np.intp)

    def add(self, flights: Flights) -> None:
        """Add the events at the ends of a batch of flights.

        The momentum of a disc counts for a side of the box with a weight that depends on the position of the disc: it
        grows linearly from 0 at the opposite side to 1 at the side itself. An event that transfers momentum from one
        disc to another therefore moves part of this momentum towards a side.
        """
        assert flights.end_position is not None
        block, partner, place = flights.block, flights.partner, flights.end_position
        mass, change = self._mass.take(flights.disc), flights.new_velocity - flights.end_velocity
        given = mass * change[:, 0], mass * change[:, 1]
        radius, virial = self._radius.take(flights.disc), np.zeros(len(block))
        for axis in (axis for axis in range(2) if not self.periodic[axis]):
            along, width = given[axis], self._box[axis]
            virial += (place[:, axis] - width / 2) * along
            near = (place[:, axis] - radius) / (width - 2.0 * radius)
            low, high = 2 * axis, 2 * axis + 1
            add_to(self._passed_on[low], block, np.where(partner == -1 - low, 0.0, (near - 1.0) * along))
            add_to(self._passed_on[high], block, np.where(partner == -1 - high, 0.0, near * along))
        hit = is_wall_hit(flights.kind)
        add_to(self.inner_virial, block, np.where(hit, 0.0, virial))
        add_to(self.wall_virial, block, np.where(hit, -virial, 0.0))
        self._add_pairs(flights, given)
        wall_hits = np.flatnonzero(hit)
        walls = block[wall_hits] * self.walls + (-1 - partner[wall_hits])
        add_to(self.hits, walls)
        for axis in range(2):
            add_to(self._impulse[axis], walls, -given[axis][wall_hits])

    def finish(self) -> None:
        """Set the attributes from the sums."""
        self.passed_on, self.impulse = self._passed_on.T, np.moveaxis(self._impulse, 0, 2)

    def _add_pairs(self, flights: Flights, given: tuple[np.ndarray, np.ndarray]) -> None:
        """Add collisions of two discs; given: x and y components, (n,) each, of the momentum given to each disc."""
        second, apart = contacts(flights, self._box, self.periodic)
        block = flights.block[second]
        add_to(self.pair_virial, block, apart[:, 0] * given[0][second] + apart[:, 1] * given[1][second])
        _, species, groups = self.collisions.shape
        pair = flights.disc[second], flights.partner[second]
        for disc, partner in (pair, pair[::-1]):
            place = (block * species + self._species.take(disc)) * groups + self._partner.take(partner)
            add_to(self.collisions, place)


def contacts(
    flights: Flights, box: tuple[float, float], periodic: tuple[bool, ...], shear: float = 0.0
) -> tuple[np.ndarray, np.ndarray]:
    """Return the rows of flights that end in collisions, once per collision, and the relative positions of the discs.

    Args:
        flights: whole flights; the times of their ends are needed only if the sides are sheared.
        box: width and height, length.
        periodic: whether x and y are periodic.
        shear: shear rate, 1/time. The periodic image above the box is displaced along x by the product of this rate,
            the height and the time.

    Returns:
        The rows (c,) of the second of the two discs, and the positions (c, 2) of these discs relative to the nearest
            images of their partners, length.
    """
    assert flights.end_position is not None
    second = np.flatnonzero((flights.kind == Kind.DISC) & (flights.disc > flights.partner))
    apart = flights.end_position.take(second, axis=0) - flights.end_position.take(second - 1, axis=0)
    if shear:
        rows = np.rint(apart[:, 1] / box[1])
        apart[:, 0] -= rows * np.remainder(shear * box[1] * flights.end[second], box[0])
    for axis in range(2):
        if periodic[axis]:
            apart[:, axis] -= box[axis] * np.rint(apart[:, axis] / box[axis])
    return second, apart


def is_wall_hit(kind: np.ndarray) -> np.ndarray:
    """Return whether events of these kinds are hits of walls, fixed discs or the piston."""
    return np.isin(kind, WALL_HITS)
