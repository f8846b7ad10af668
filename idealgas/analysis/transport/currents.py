"""Currents of momentum, energy and species in the whole gas, integrated over blocks of time, from the events of a log.

Between two events a current is constant: Σ m v_a v_b for momentum, Σ (m v²/2) v_a for energy, and for two species the
mean velocity of the discs of one less that of the other. In a collision of two
discs, momentum Δp and energy ΔE jump from the centre of one to that of the other: their integrals over time grow by
Δp_a r_b and ΔE r_a. These sums are the Helfand moments: Helfand, Phys. Rev. 119, 1 (1960).
"""

from typing import Any

import numpy as np

from idealgas.jit import inline, njit
from idealgas.physics.periodic import nearest_image
from idealgas.state import Gas

XX, XY, YY, HEAT_X, HEAT_Y, APART_X, APART_Y = range(7)
"""Components of the current: of momentum, of energy, and of one species relative to the other."""

CARRIED, PASSED_ON = range(2)
"""Part of a current that discs carry as they fly, and part that they pass on in collisions."""

X, Y, VX, VY = range(4)  # columns of a track: position and velocity of a disc after its last event


class Currents:
    """Time integrals of the currents in each of B blocks, in a box without walls.

    flow: (B, 2, 7), parts CARRIED and PASSED_ON of the components XX, XY, YY (energy·time), HEAT_X, HEAT_Y
    (energy·length), APART_X and APART_Y (length), which are carried only, and 0 unless there are two species.
    """

    columns = ("time", "disc", "partner", "position", "velocity")

    def begin(self, gas: Gas, edges: np.ndarray) -> None:
        """Start with the state of the discs at time edges[0]; edges: (B + 1,), times between the blocks."""
        self.edges = edges
        self.flow = np.zeros((len(edges) - 1, 2, 7))
        self._box, self._mass, self._share = gas.box, gas.mass, shares(gas)
        self._tracks = np.column_stack((gas.position, gas.velocity))
        self._total = np.zeros(7)
        for mass, share, track in zip(self._mass, self._share, self._tracks, strict=True):
            _carry(self._total, mass, share, track[VX], track[VY], 1.0)
        self._reached = 0, float(edges[0])

    def add(self, rows: Any) -> None:
        """Add the next event rows of the log."""
        self._reached = _add_currents(
            rows.time, rows.disc, rows.partner, rows.position, rows.velocity, self._box, self._mass, self._share,
            self._tracks, self._total, self.edges, *self._reached, self.flow,
        )  # fmt: skip

    def finish(self) -> None:
        """Add the currents from the last event up to time edges[-1]."""
        _flow_until(self.edges[-1], self._total, self.edges, *self._reached, self.flow)


def shares(gas: Gas) -> np.ndarray:
    """Weights (N,) of the discs' velocities in the mean velocity of the first of two species less the other's."""
    number = np.bincount(gas.species, minlength=len(gas.species_names))
    if len(number) != 2:
        return np.zeros(len(gas))
    return np.array([1.0, -1.0])[gas.species] / number[gas.species]


@inline
def _carry(total, mass, share, vx, vy, sign):
    """Add sign times what a disc carries to the current (7,) of all discs."""
    px = sign * mass * vx
    py = sign * mass * vy
    energy = sign * 0.5 * mass * (vx * vx + vy * vy)
    total[XX] += px * vx
    total[XY] += px * vy
    total[YY] += py * vy
    total[HEAT_X] += energy * vx
    total[HEAT_Y] += energy * vy
    total[APART_X] += sign * share * vx
    total[APART_Y] += sign * share * vy


@njit
def _flow_until(now, total, edges, block, since, flow):
    """Add the current since a time until now, over as many blocks as that takes; returns the last block."""
    while block + 2 < edges.shape[0] and now > edges[block + 1]:
        for k in range(7):
            flow[block, CARRIED, k] += total[k] * (edges[block + 1] - since)
        since = edges[block + 1]
        block += 1
    for k in range(7):
        flow[block, CARRIED, k] += total[k] * (now - since)
    return block


@njit
def _add_currents(time, disc, partner, position, velocity, box, mass, share, tracks, total, edges, block, since, flow):
    for row in range(time.shape[0]):
        i = np.uintp(disc[row])
        track = tracks[i]
        if time[row] > since:
            block = _flow_until(time[row], total, edges, block, since, flow)
            since = time[row]
        vx, vy = velocity[row, 0], velocity[row, 1]
        _carry(total, mass[i], share[i], track[VX], track[VY], -1.0)
        _carry(total, mass[i], share[i], vx, vy, 1.0)
        if disc[row] > partner[row] >= 0:  # second row of a collision: now both tracks are at the contact
            j = np.uintp(partner[row])
            x = nearest_image(position[row, 0] - tracks[j][X], box[0], True)
            y = nearest_image(position[row, 1] - tracks[j][Y], box[1], True)
            px, py = mass[i] * (vx - track[VX]), mass[i] * (vy - track[VY])
            energy = 0.5 * (px * (vx + track[VX]) + py * (vy + track[VY]))
            passed = flow[block, PASSED_ON]
            passed[XX] += px * x
            passed[XY] += px * y
            passed[YY] += py * y
            passed[HEAT_X] += energy * x
            passed[HEAT_Y] += energy * y
        track[X] = position[row, 0]
        track[Y] = position[row, 1]
        track[VX] = vx
        track[VY] = vy
    return block, since
