"""Stress tensor, heat flux and wall impulses of a gas, accumulated as exact sums.

The pressure tensor P, multiplied by the area A and the time τ, is P_ab A τ = ∫ Σ m v_a v_b dt + Σ Δp_a r_b. The
integral is the kinetic contribution. The sum over collisions of two discs is the collisional contribution, where Δp is
the impulse on one of the discs and r the position of that disc relative to the other. Exchanging the two discs does not
change any bit of a term. Both contributions are energies times time.

The heat flux is accumulated in the same way as ∫ Σ (m v²/2) v_a dt + Σ ΔE r_a, an energy times length, where ΔE is the
energy gained by one disc and velocities are relative to the centre of mass. The heat flux is recorded only if
velocities change exclusively in collisions of smooth elastic discs.

A face is one side of a wall. Faces 0 to 3 are the sides of the box. They are followed by two faces for each wall
segment: the face on the left as seen from the start of the segment, and the face on the right.
"""

from typing import Any, NamedTuple

import numpy as np

from idealgas.jit import aligned, inline, njit
from idealgas.physics.absorbing import mass_in_gas
from idealgas.physics.exact_sum import BATCH, add, add_all
from idealgas.physics.periodic import shift_by_images

U = np.uintp
KINETIC, COLLISIONAL = slice(0, 3), slice(3, None)
"""Components of the tensor: kinetic xx, xy, yy, then collisional xx, xy, yy and, for rough discs, yx."""

TERMS = np.dtype([("column", "f8", (BATCH,))])
"""Terms of a sum, one for each buffered collision."""

PARTS = 7
"""Largest number of sums for the tensor, which rough discs require."""

HEAT = 4
"""Number of sums for the heat flux."""


class Buffer(NamedTuple):
    """Buffered terms of collisions; adding them together with `flush` is faster than adding them one by one.

    Attributes:
        number: (1,) i8, number of buffered collisions.
        terms: (PARTS + HEAT,) TERMS, terms of the tensor, followed by those of the heat flux.
    """

    number: np.ndarray
    terms: np.recarray


class StressAccumulator(NamedTuple):
    """Sums over a run for the stress tensor, the heat flux and the walls, and numbers of collisions.

    Attributes:
        tensor: (6,) SUM, kinetic xx, xy, yy, then collisional xx, xy, yy, energy times time; for rough discs (7,), with
            collisional yx appended, which equals xy for smooth discs.
        buffer: terms that have not yet been added to these sums.
        walls: (1,) SUM, -Σ r·Δp over all wall hits, where r is the position relative to the centre of the box and Δp
            is the impulse on the disc, energy times time.
        normal_impulse: (F,) SUM, impulse on each face along its normal, into the wall, mass length/time.
        tangential_impulse: (F,) SUM, impulse on each face along its tangent, mass length/time. The tangent of a side
            points towards larger coordinates, and the tangent of a segment from its start to its end.
        hits: (F,) i8, number of hits on each face.
        pairs: (S, S) i8, numbers of collisions of species i and j, in the upper triangle; None for a single species.
        species: (N,) u2, species of each disc by id; None for a single species.
        x: x coordinate of the centre of the box, length.
        y: y coordinate of the centre of the box, length.
        heat: (4,) SUM, kinetic heat flux along x and y, then collisional along x and y, energy times length; None if
            not recorded.
        vx: centre-of-mass velocity along x, length/time; 0 without heat flux.
        vy: centre-of-mass velocity along y, length/time; 0 without heat flux.
    """

    tensor: np.recarray
    buffer: Buffer
    walls: np.recarray
    normal_impulse: np.recarray
    tangential_impulse: np.recarray
    hits: np.ndarray
    pairs: np.ndarray | None
    species: np.ndarray | None
    x: float
    y: float
    heat: np.recarray | None = None
    vx: float = 0.0
    vy: float = 0.0


def empty_buffer() -> Buffer:
    """Return a buffer without terms."""
    return Buffer(np.zeros(1, np.int64), aligned(PARTS + HEAT, TERMS))


@inline
def kinetic_flow(mass, vx, vy, delay, gravity):
    """Kinetic contribution (xx, xy, yy) of a disc in free flight to the stress, energy times time.

    vx, vy: velocity at the start, length/time. delay: duration of the flight, time.
    """
    carried = mass * delay
    if gravity is not None:  # v_a v_b at the middle of the flight, plus the variance of the velocity
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
def kinetic_heat_flow(mass, vx, vy, delay):
    """Kinetic contribution (x, y) of a disc in free flight to the heat flux, energy times length.

    vx, vy: velocity relative to the centre of mass, length/time. delay: duration of the flight, time.
    """
    energy = 0.5 * mass * (vx * vx + vy * vy) * delay
    return energy * vx, energy * vy


@inline
def energy_gained(mass, vx, vy, vx_after, vy_after, frame_x, frame_y):
    """Energy gained by a disc whose velocity changed, in a frame that moves at velocity (frame_x, frame_y).

    Velocities are in length/time, the energy in mass length²/time².
    """
    along_x = (vx_after - vx) * (vx_after + vx - 2.0 * frame_x)
    along_y = (vy_after - vy) * (vy_after + vy - 2.0 * frame_y)
    return 0.5 * mass * (along_x + along_y)


@inline
def record_flight(flow, disc, time, gravity):
    """Record the flight of a disc from its own local time to a later local time, if stress is recorded."""
    if flow is not None:
        xx, xy, yy = kinetic_flow(disc.m, disc.vx, disc.vy, time - disc.t, gravity)
        add(flow.tensor[U(0)], xx)
        add(flow.tensor[U(1)], xy)
        add(flow.tensor[U(2)], yy)


@inline
def record_collision_stress(flow, a, b, a_id, b_id, flights, images, effects):
    """Record the collision of two discs, whose stored states must be at the time of contact, if stress is recorded.

    flights: durations (a_delay, b_delay) of the flights that ended with the contact, time; velocities (a_vx, a_vy,
    b_vx, b_vy) at the start of these flights, length/time; and the same velocities just before the collision.
    """
    if flow is not None:
        number, terms = flow.buffer.number, flow.buffer.terms
        k = U(number[0])
        x, y = shift_by_images(a.x - b.x, a.y - b.y, effects.periodic, images)
        (a_delay, b_delay), (a_vx, a_vy, b_vx, b_vy), before = flights
        a_xx, a_xy, a_yy = kinetic_flow(a.m, a_vx, a_vy, a_delay, effects.gravity)
        b_xx, b_xy, b_yy = kinetic_flow(b.m, b_vx, b_vy, b_delay, effects.gravity)
        px = 0.5 * (a.m * (a.vx - before[0]) - b.m * (b.vx - before[2]))
        py = 0.5 * (a.m * (a.vy - before[1]) - b.m * (b.vy - before[3]))
        terms[U(0)].column[k] = a_xx + b_xx
        terms[U(1)].column[k] = a_xy + b_xy
        terms[U(2)].column[k] = a_yy + b_yy
        terms[U(3)].column[k] = px * x
        terms[U(4)].column[k] = px * y
        terms[U(5)].column[k] = py * y
        terms[U(6)].column[k] = py * x  # added for rough discs only
        buffer_heat(flow.heat, flow, k, a, b, flights, x, y)
        number[0] += 1
        if number[0] == BATCH:
            flush(flow)
        count_pair(flow.pairs, flow.species, a_id, b_id)


@inline
def buffer_heat(heat, flow, k, a, b, flights, x, y):
    """Write the heat-flux terms of a collision to row k of the buffer, if the heat flux is recorded.

    x, y: position of a relative to b, length. The other arguments are as in `record_collision_stress`.
    """
    if heat is not None:
        terms, vx, vy = flow.buffer.terms, flow.vx, flow.vy
        (a_delay, b_delay), (a_vx, a_vy, b_vx, b_vy), _ = flights
        a_x, a_y = kinetic_heat_flow(a.m, a_vx - vx, a_vy - vy, a_delay)
        b_x, b_y = kinetic_heat_flow(b.m, b_vx - vx, b_vy - vy, b_delay)
        a_gain = energy_gained(a.m, a_vx, a_vy, a.vx, a.vy, vx, vy)
        b_gain = energy_gained(b.m, b_vx, b_vy, b.vx, b.vy, vx, vy)
        gain = 0.5 * (a_gain - b_gain)
        terms[U(PARTS)].column[k] = a_x + b_x
        terms[U(PARTS + 1)].column[k] = a_y + b_y
        terms[U(PARTS + 2)].column[k] = gain * x
        terms[U(PARTS + 3)].column[k] = gain * y


@njit
def flush(flow):
    """Add all buffered terms to their sums."""
    number, terms = flow.buffer.number[0], flow.buffer.terms
    add_terms(flow.tensor, terms, 0, flow.tensor.shape[0], number)
    add_terms(flow.heat, terms, PARTS, HEAT, number)
    flow.buffer.number[0] = 0


@inline
def add_terms(sums, terms, first, parts, number):
    """Add `number` terms to each of the first `parts` sums; `sums` may be None.

    first: index in `terms` of the terms of the first sum.
    """
    if sums is not None:
        for k in range(parts):
            add_all(sums[U(k)], terms[U(first + k)].column[:number])


@inline
def count_pair(pairs, species, a_id, b_id):
    """Count a collision under the species of its two discs, if there are several species."""
    if species is not None:
        i = species[U(a_id)]
        j = species[U(b_id)]
        pairs[U(min(i, j)), U(max(i, j))] += 1


@inline
def record_hit(flow, disc, face, normal, tangent, impulse):
    """Record a hit on a face, if stress is recorded; the disc must be at the contact, inside the box.

    normal: unit normal of the face towards the disc. tangent: unit tangent of the face. impulse: impulse on the disc,
    mass length/time.
    """
    if flow is not None:
        k = U(face)
        px, py = impulse
        add(flow.normal_impulse[k], normal[0] * px + normal[1] * py)
        add(flow.tangential_impulse[k], -(tangent[0] * px + tangent[1] * py))
        add(flow.walls[0], -((disc.x - flow.x) * px + (disc.y - flow.y) * py))
        flow.hits[k] += 1


@njit
def complete_flights(record, time, gravity, flow, absorbing):
    """Add the buffered collisions, then the flights of all discs from their own local times to a common local time."""
    flush(flow)
    terms = flow.buffer.terms
    for first in range(0, record.shape[0], BATCH):
        number = min(BATCH, record.shape[0] - first)
        for k in range(number):
            disc = record[U(first + k)]
            mass = mass_in_gas(disc, absorbing)
            xx, xy, yy = kinetic_flow(mass, disc.vx, disc.vy, time - disc.t, gravity)
            terms[U(0)].column[U(k)] = xx
            terms[U(1)].column[U(k)] = xy
            terms[U(2)].column[U(k)] = yy
        add_terms(flow.tensor, terms, 0, 3, number)
        complete_heat(flow.heat, terms, record, first, number, time, flow.vx, flow.vy)


@inline
def complete_heat(heat, terms, record, first, number, time, vx, vy):
    """Add the kinetic heat flux of `number` discs, from `first` on, up to a local time, if the heat flux is recorded.

    The heat flux is not recorded for a box with walls inside, so no disc can have left the gas.
    """
    if heat is not None:
        for k in range(number):
            disc = record[U(first + k)]
            x, y = kinetic_heat_flow(disc.m, disc.vx - vx, disc.vy - vy, time - disc.t)
            terms[U(0)].column[U(k)] = x
            terms[U(1)].column[U(k)] = y
        add_terms(heat, terms, 0, 2, number)


def sums_of(flow: StressAccumulator) -> list[np.ndarray]:
    """Return all arrays of type SUM."""
    return [
        flow.tensor,
        flow.walls,
        flow.normal_impulse,
        flow.tangential_impulse,
        *([] if flow.heat is None else [flow.heat]),
    ]


def counts_of(flow: StressAccumulator) -> list[np.ndarray]:
    """Return all arrays of collision counts."""
    return [flow.hits] if flow.pairs is None else [flow.hits, flow.pairs]


def copy_of(flow: StressAccumulator | None) -> StressAccumulator | None:
    """Return an independent copy of the sums and the buffer; None if stress is not recorded."""
    if flow is None:
        return None
    copies: Any = {name: part.copy() for name, part in flow._asdict().items() if isinstance(part, np.ndarray)}
    buffer = empty_buffer()
    buffer.number[:], buffer.terms[:] = flow.buffer
    return flow._replace(buffer=buffer, **copies)
