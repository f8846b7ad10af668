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

from idealgas.jit import aligned, inline, njit
from idealgas.physics.exact_sum import TOGETHER, add, add_all
from idealgas.physics.periodic import shift_by_images

U = np.uintp
KINETIC, COLLISION = slice(0, 3), slice(3, None)
"""Which of the sums of the tensor are the two flows: their components xx, xy, yy, and of the collision flow yx."""

TERMS = np.dtype([("column", "f8", (TOGETHER,))])
"""Terms of one of the sums, by collision."""

PARTS = 7
"""Most sums of the tensor: those of rough discs."""

HEAT = 4
"""Sums of the heat."""


class Waiting(NamedTuple):
    """Terms of collisions that wait until `settle` adds many at once, which takes less time than one by one.

    Attributes:
        number: (1,) i8, of these collisions.
        terms: (PARTS + HEAT,) TERMS, those of the tensor, then those of the heat.
    """

    number: np.ndarray
    terms: np.recarray


class MomentumFlow(NamedTuple):
    """Sums over a run, SUM by SUM, and numbers of collisions.

    Attributes:
        tensor: (6,) SUM: the kinetic flow xx, xy and yy, and the collision flow xx, xy and yy, energy times time; where
            discs are rough (7,), also the collision flow yx, which smooth discs make equal to xy.
        waiting: terms that are not in these sums yet.
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
        vx: velocity of the whole gas, length/time; 0 where no heat is recorded.
        vy: the same along y.
    """

    tensor: np.recarray
    waiting: Waiting
    walls: np.recarray
    push: np.recarray
    drag: np.recarray
    hits: np.ndarray
    pairs: np.ndarray | None
    species: np.ndarray | None
    x: float
    y: float
    heat: np.recarray | None = None
    vx: float = 0.0
    vy: float = 0.0


def none_waiting() -> Waiting:
    """Room for terms, with those of no collision."""
    return Waiting(np.zeros(1, np.int64), aligned(PARTS + HEAT, TERMS))


@inline
def flow_carried(mass, vx, vy, delay, gravity):
    """Momentum flow (xx, xy, yy), energy times time, of a disc in free flight, from its velocity at the start.

    delay: duration of the flight, time.
    """
    carried = mass * delay
    if gravity is not None:  # v_a v_b of the middle of the flight, and what the change of the velocity adds
        vx += 0.5 * gravity.x * delay
        vy += 0.5 * gravity.y * delay
        third = carried * delay * delay / 12.0
        return (
            carried * vx * vx + third * gravity.x * gravity.x,
            carried * vx * vy + third * gravity.x * gravity.y,
            carried * vy * vy + third * gravity.y * gravity.y,
        )
    return carried * vx * vx, carried * vx * vy, carried * vy * vy


@inline
def heat_carried(mass, vx, vy, delay):
    """Flow of heat (x, y), energy times length, of a disc in free flight; velocity relative to the gas as a whole."""
    energy = 0.5 * mass * (vx * vx + vy * vy) * delay
    return energy * vx, energy * vy


@inline
def energy_gained(mass, vx, vy, vx_after, vy_after, frame_x, frame_y):
    """Energy (mass length²/time²) that a disc gained as its velocity changed, seen from a frame that moves."""
    along_x = (vx_after - vx) * (vx_after + vx - 2.0 * frame_x)
    along_y = (vy_after - vy) * (vy_after + vy - 2.0 * frame_y)
    return 0.5 * mass * (along_x + along_y)


@inline
def record_flight(flow, disc, time, gravity):
    """Add the flight of a disc, from its record to a local time, where momentum flow is recorded."""
    if flow is not None:
        xx, xy, yy = flow_carried(disc.m, disc.vx, disc.vy, time - disc.t, gravity)
        add(flow.tensor[U(0)], xx)
        add(flow.tensor[U(1)], xy)
        add(flow.tensor[U(2)], yy)


@inline
def flights_to(flow, a, b, time):
    """Flights of two discs that meet at a local time; zeros where momentum flow is not recorded.

    Returns their durations (a, b), time, and the velocities (a_vx, a_vy, b_vx, b_vy) at their start, length/time.
    """
    if flow is not None:
        return (time - a.t, time - b.t), (a.vx, a.vy, b.vx, b.vy)
    return (0.0, 0.0), (0.0, 0.0, 0.0, 0.0)


@inline
def record_collision_flow(flow, a, b, a_id, b_id, flights, before, periodic, images, gravity):
    """Record the collision of two discs at their contact, where momentum flow is recorded.

    flights: as `flights_to` gave them. before: velocities (a_vx, a_vy, b_vx, b_vy) before the collision, length/time.
    images: numbers of box lengths (x, y) between the records, where sides are periodic.
    """
    if flow is not None:
        number, terms = flow.waiting.number, flow.waiting.terms
        k = U(number[0])
        x, y = shift_by_images(a.x - b.x, a.y - b.y, periodic, images)
        (a_delay, b_delay), (a_vx, a_vy, b_vx, b_vy) = flights
        a_xx, a_xy, a_yy = flow_carried(a.m, a_vx, a_vy, a_delay, gravity)
        b_xx, b_xy, b_yy = flow_carried(b.m, b_vx, b_vy, b_delay, gravity)
        px = 0.5 * (a.m * (a.vx - before[0]) - b.m * (b.vx - before[2]))
        py = 0.5 * (a.m * (a.vy - before[1]) - b.m * (b.vy - before[3]))
        terms[U(0)].column[k] = a_xx + b_xx
        terms[U(1)].column[k] = a_xy + b_xy
        terms[U(2)].column[k] = a_yy + b_yy
        terms[U(3)].column[k] = px * x
        terms[U(4)].column[k] = px * y
        terms[U(5)].column[k] = py * y
        terms[U(6)].column[k] = py * x  # added for rough discs only
        keep_heat(flow.heat, terms, k, a, b, flights, x, y, flow.vx, flow.vy)
        number[0] += 1
        if number[0] == TOGETHER:
            settle(flow)
        count_pair(flow.pairs, flow.species, a_id, b_id)


@inline
def keep_heat(heat, terms, k, a, b, flights, x, y, vx, vy):
    """Keep what a collision adds to the flow of heat as terms number k, where it is recorded.

    x, y: position of a relative to b, length. vx, vy: velocity of the gas as a whole, length/time.
    """
    if heat is not None:
        (a_delay, b_delay), (a_vx, a_vy, b_vx, b_vy) = flights
        a_x, a_y = heat_carried(a.m, a_vx - vx, a_vy - vy, a_delay)
        b_x, b_y = heat_carried(b.m, b_vx - vx, b_vy - vy, b_delay)
        a_gain = energy_gained(a.m, a_vx, a_vy, a.vx, a.vy, vx, vy)
        b_gain = energy_gained(b.m, b_vx, b_vy, b.vx, b.vy, vx, vy)
        gain = 0.5 * (a_gain - b_gain)
        terms[U(PARTS)].column[k] = a_x + b_x
        terms[U(PARTS + 1)].column[k] = a_y + b_y
        terms[U(PARTS + 2)].column[k] = gain * x
        terms[U(PARTS + 3)].column[k] = gain * y


@njit
def settle(flow):
    """Add the terms that wait."""
    number, terms = flow.waiting.number[0], flow.waiting.terms
    add_terms(flow.tensor, terms, 0, flow.tensor.shape[0], number)
    add_terms(flow.heat, terms, PARTS, HEAT, number)
    flow.waiting.number[0] = 0


@inline
def add_terms(sums, terms, first, parts, number):
    """Add a number of terms to each of the first sums, if any, from columns of which the first has number `first`."""
    if sums is not None:
        for k in range(parts):
            add_all(sums[U(k)], terms[U(first + k)].column[:number])


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
    """Add the flights of all discs from their records to a local time, after the collisions that wait to be added."""
    settle(flow)
    terms = flow.waiting.terms
    for first in range(0, record.shape[0], TOGETHER):
        number = min(TOGETHER, record.shape[0] - first)
        for k in range(number):
            disc = record[U(first + k)]
            xx, xy, yy = flow_carried(disc.m, disc.vx, disc.vy, time - disc.t, gravity)
            terms[U(0)].column[U(k)] = xx
            terms[U(1)].column[U(k)] = xy
            terms[U(2)].column[U(k)] = yy
        add_terms(flow.tensor, terms, 0, 3, number)
        complete_heat(flow.heat, terms, record, first, number, time, flow.vx, flow.vy)


@inline
def complete_heat(heat, terms, record, first, number, time, vx, vy):
    """Add the heat that a number of discs carried from their records to a local time, where it is recorded."""
    if heat is not None:
        for k in range(number):
            disc = record[U(first + k)]
            x, y = heat_carried(disc.m, disc.vx - vx, disc.vy - vy, time - disc.t)
            terms[U(0)].column[U(k)] = x
            terms[U(1)].column[U(k)] = y
        add_terms(heat, terms, 0, 2, number)


def sums_of(flow: MomentumFlow) -> list[np.ndarray]:
    """All arrays of SUM."""
    return [flow.tensor, flow.walls, flow.push, flow.drag, *([] if flow.heat is None else [flow.heat])]


def counts_of(flow: MomentumFlow) -> list[np.ndarray]:
    """All arrays of numbers of collisions."""
    return [flow.hits] if flow.pairs is None else [flow.hits, flow.pairs]


def copy_of(flow: MomentumFlow | None) -> MomentumFlow | None:
    """Independent copy of sums and of the collisions that wait to be added; None for none."""
    if flow is None:
        return None
    copies: Any = {name: part.copy() for name, part in flow._asdict().items() if isinstance(part, np.ndarray)}
    waiting = none_waiting()
    waiting.number[:], waiting.terms[:] = flow.waiting
    return flow._replace(waiting=waiting, **copies)
