"""Momentum and heat that a gas carries and passes on, and momentum for walls: exact sums of which its pressure follows.

Pressure tensor times area and time: P_ab A τ = ∫ Σ m v_a v_b dt + Σ Δp_a r_b. The integral is the kinetic flow. The
second sum, over collisions of two discs, is the collision flow: Δp is what one disc receives, r its position relative
to the other. Every term is the same to the last bit if the two discs are exchanged. Both are energies times time.

Heat flows likewise: ∫ Σ (m v²/2) v_a dt + Σ ΔE r_a, with the energy ΔE that one disc receives, and all velocities
relative to the gas as a whole; energies times length. It is recorded where nothing but collisions of smooth elastic
discs changes velocities.

A face is what a disc can hit: sides 0 to 3, then both sides of each wall segment, that to the left of the way from its
start to its end first.
"""

from typing import Any, NamedTuple

import numpy as np

from idealgas._jit import inline, njit
from idealgas.physics.exact_sum import TOGETHER, add, add_all
from idealgas.physics.periodic import shift_by_images

U = np.uintp
KINETIC, COLLISION = slice(0, 3), slice(3, None)
"""Which of the sums of the tensor are the two flows: their components xx, xy, yy, and of the collision flow yx."""

TERMS = np.dtype([("column", "f8", (TOGETHER,))])
"""Terms of one of the sums, by collision; a record, so that their place in memory is a constant."""


class MomentumFlow(NamedTuple):
    """Sums over a run, SUM by SUM, and numbers of collisions.

    Attributes:
        tensor: (6,) SUM: the kinetic flow xx, xy and yy, and the collision flow xx, xy and yy, energy times time; where
            discs are rough (7,), also the collision flow yx, which smooth discs make equal to xy.
        terms: TERMS by collision of each SUM of the tensor, to which `settle` is to add them.
        waiting: (1,) i8, number of these collisions.
        walls: (1,) SUM, -Σ r·Δp over all wall hits, r from the middle of the box and Δp what the disc receives,
            energy times time.
        push: (F,) SUM, momentum given to each face along its normal, into the wall, mass length/time.
        drag: (F,) SUM, momentum given to each face along itself: towards larger coordinates for a side, from start to
            end for a segment, mass length/time.
        hits: (F,) i8, number of hits of each face.
        pairs: (S, S) i8, numbers of collisions of species i and j, in the upper triangle; None for one species.
        species: (N,) u2, of each disc by id; None for one species.
        x: coordinate of the middle of the box, length.
        y: coordinate of the middle of the box, length.
        heat: (4,) SUM: heat carried along x and y, then passed on along x and y, energy times length; None where it is
            not recorded.
        heat_terms: TERMS by collision of each of these; None where it is not recorded.
        vx: velocity of the whole gas, length/time; 0 where no heat is recorded.
        vy: the same along y.
    """

    tensor: np.recarray
    terms: np.recarray
    waiting: np.ndarray
    walls: np.recarray
    push: np.recarray
    drag: np.recarray
    hits: np.ndarray
    pairs: np.ndarray | None
    species: np.ndarray | None
    x: float
    y: float
    heat: np.recarray | None = None
    heat_terms: np.recarray | None = None
    vx: float = 0.0
    vy: float = 0.0


@inline
def carried(disc, time, gravity):
    """Momentum flow (xx, xy, yy), energy times time, of a disc in free flight from its record to a local time."""
    delay = time - disc.t
    vx = disc.vx
    vy = disc.vy
    mass = disc.m * delay
    if gravity is not None:  # v_a v_b of the middle of the flight, and what the change of the velocity adds
        vx += 0.5 * gravity.x * delay
        vy += 0.5 * gravity.y * delay
        third = mass * delay * delay / 12.0
        return (
            mass * vx * vx + third * gravity.x * gravity.x,
            mass * vx * vy + third * gravity.x * gravity.y,
            mass * vy * vy + third * gravity.y * gravity.y,
        )
    return mass * vx * vx, mass * vx * vy, mass * vy * vy


@inline
def record_flight(flow, disc, time, gravity):
    """Add the flight of a disc, from its record to a local time, where momentum flow is recorded."""
    if flow is not None:
        xx, xy, yy = carried(disc, time, gravity)
        add(flow.tensor[U(0)], xx)
        add(flow.tensor[U(1)], xy)
        add(flow.tensor[U(2)], yy)


@inline
def record_flights(flow, a, b, time, gravity):
    """Note the flights of two discs that meet at a local time, where momentum flow is recorded."""
    if flow is not None:
        a_xx, a_xy, a_yy = carried(a, time, gravity)
        b_xx, b_xy, b_yy = carried(b, time, gravity)
        k = U(flow.waiting[0])
        flow.terms[U(0)].column[k] = a_xx + b_xx
        flow.terms[U(1)].column[k] = a_xy + b_xy
        flow.terms[U(2)].column[k] = a_yy + b_yy
        record_heat_carried(flow.heat_terms, k, a, b, time, flow.vx, flow.vy)


@inline
def heat_carried(disc, time, vx, vy):
    """Flow of heat (x, y), energy times length, of a disc in free flight from its record to a local time."""
    x = disc.vx - vx
    y = disc.vy - vy
    energy = 0.5 * disc.m * (x * x + y * y) * (time - disc.t)
    return energy * x, energy * y


@inline
def record_heat_carried(terms, k, a, b, time, vx, vy):
    """Note the heat that two discs carried to the collision that waits as number k, where it is recorded."""
    if terms is not None:
        a_x, a_y = heat_carried(a, time, vx, vy)
        b_x, b_y = heat_carried(b, time, vx, vy)
        terms[U(0)].column[k] = a_x + b_x
        terms[U(1)].column[k] = a_y + b_y


@inline
def record_heat_passed_on(terms, k, a, b, before, x, y, vx, vy):
    """Note the heat that a disc received in the collision that waits as number k, where it is recorded.

    before: velocities (a_vx, a_vy, b_vx, b_vy) before it, length/time. x, y: position relative to the other disc.
    """
    if terms is not None:
        a_vx, a_vy, b_vx, b_vy = before
        a_gain = a.m * ((a.vx - a_vx) * (a.vx + a_vx - 2.0 * vx) + (a.vy - a_vy) * (a.vy + a_vy - 2.0 * vy))
        b_gain = b.m * ((b.vx - b_vx) * (b.vx + b_vx - 2.0 * vx) + (b.vy - b_vy) * (b.vy + b_vy - 2.0 * vy))
        gain = 0.25 * (a_gain - b_gain)
        terms[U(2)].column[k] = gain * x
        terms[U(3)].column[k] = gain * y


@inline
def record_collision_flow(flow, a, b, a_id, b_id, before, periodic, images, rotation):
    """Note what two discs passed on, whose flights are noted, at their contact, where momentum flow is recorded.

    before: velocities (a_vx, a_vy, b_vx, b_vy) before the collision, length/time. images: numbers of box lengths (x, y)
    between the records, where sides are periodic.
    """
    if flow is not None:
        a_vx, a_vy, b_vx, b_vy = before
        x, y = shift_by_images(a.x - b.x, a.y - b.y, periodic, images)
        px = 0.5 * (a.m * (a.vx - a_vx) - b.m * (b.vx - b_vx))
        py = 0.5 * (a.m * (a.vy - a_vy) - b.m * (b.vy - b_vy))
        k = U(flow.waiting[0])
        flow.terms[U(3)].column[k] = px * x
        flow.terms[U(4)].column[k] = px * y
        flow.terms[U(5)].column[k] = py * y
        if rotation is not None:
            flow.terms[U(6)].column[k] = py * x
        record_heat_passed_on(flow.heat_terms, k, a, b, before, x, y, flow.vx, flow.vy)
        flow.waiting[0] += 1
        if flow.waiting[0] == TOGETHER:
            settle(flow)
        count_pair(flow.pairs, flow.species, a_id, b_id)


@njit
def settle(flow):
    """Add the terms of the collisions that were noted."""
    for k in range(flow.tensor.shape[0]):
        add_all(flow.tensor[U(k)], flow.terms[U(k)].column[: flow.waiting[0]])
    add_heat(flow.heat, flow.heat_terms, 4, flow.waiting[0])
    flow.waiting[0] = 0


@inline
def add_heat(heat, terms, parts, number):
    """Add a number of terms of each of the first sums of the heat, where it is recorded."""
    if heat is not None:
        for k in range(parts):
            add_all(heat[U(k)], terms[U(k)].column[:number])


@inline
def count_pair(pairs, species, a_id, b_id):
    """Count a collision by the species of its discs, where there are several."""
    if species is not None:
        i = species[U(a_id)]
        j = species[U(b_id)]
        pairs[U(min(i, j)), U(max(i, j))] += 1


@inline
def record_hit(flow, disc, face, nx, ny, tx, ty, px, py):
    """Add a hit of a face, where momentum flow is recorded; the disc's record is at the contact, inside the box.

    nx, ny: unit normal of the face towards the disc. tx, ty: unit vector along it. px, py: momentum that the disc
    received, mass length/time.
    """
    if flow is not None:
        k = U(face)
        add(flow.push[k], nx * px + ny * py)
        add(flow.drag[k], -(tx * px + ty * py))
        add(flow.walls[0], -((disc.x - flow.x) * px + (disc.y - flow.y) * py))
        flow.hits[k] += 1


@njit
def complete_flights(record, time, gravity, flow):
    """Add the flights of all discs from their records to a local time; no collisions may wait to be added."""
    for first in range(0, record.shape[0], TOGETHER):
        number = min(TOGETHER, record.shape[0] - first)
        for k in range(number):
            xx, xy, yy = carried(record[U(first + k)], time, gravity)
            flow.terms[U(0)].column[U(k)] = xx
            flow.terms[U(1)].column[U(k)] = xy
            flow.terms[U(2)].column[U(k)] = yy
        for k in range(3):
            add_all(flow.tensor[U(k)], flow.terms[U(k)].column[:number])
        note_heat_carried(flow.heat_terms, record, first, number, time, flow.vx, flow.vy)
        add_heat(flow.heat, flow.heat_terms, 2, number)


@inline
def note_heat_carried(terms, record, first, number, time, vx, vy):
    """Note the heat that a number of discs carried from their records to a local time, where it is recorded."""
    if terms is not None:
        for k in range(number):
            x, y = heat_carried(record[U(first + k)], time, vx, vy)
            terms[U(0)].column[U(k)] = x
            terms[U(1)].column[U(k)] = y


def sums_of(flow: MomentumFlow) -> list[np.ndarray]:
    """All arrays of SUM."""
    return [flow.tensor, flow.walls, flow.push, flow.drag, *([] if flow.heat is None else [flow.heat])]


def counts_of(flow: MomentumFlow) -> list[np.ndarray]:
    """All arrays of numbers of collisions."""
    return [flow.hits] if flow.pairs is None else [flow.hits, flow.pairs]


def copy_of(flow: MomentumFlow | None) -> MomentumFlow | None:
    """Independent copy; None for none."""
    if flow is None:
        return None
    copies: Any = {name: part.copy() for name, part in flow._asdict().items() if isinstance(part, np.ndarray)}
    return flow._replace(**copies)
