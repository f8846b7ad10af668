"""Dense states from compression: discs collide while their radii grow at a constant rate to their final values.

This is the event-driven algorithm of Lubachevsky & Stillinger, J. Stat. Phys. 60, 561 (1990), in a periodic box; only
the initial positions and velocities are random. The compression prepares the positions at time 0 of a run: all discs
have the same mass, velocities are rescaled repeatedly, and only the final positions are used.
"""

import math
from typing import NamedTuple

import numpy as np

from idealgas.jit import inline, njit
from idealgas.physics.periodic import nearest_image

LOOSE = 0.5
"""Packing fraction of the random positions from which the compression starts."""

RATE = 5e-3
"""Rate at which the mean radius grows, in units of the root-mean-square velocity component."""

GAP = 1e-9
"""Relative growth beyond the final radius, so that rounding does not cause overlaps at the start of the run."""

SLACK = 0.3
"""Gap up to which neighbours are listed, in diameters of the largest disc."""

RESCALE_INTERVAL, MAX_COLLISIONS = 4, 5_000
"""Numbers of collisions per disc after which velocities are rescaled, and after which discs are considered jammed."""


class Growing(NamedTuple):
    """N growing discs. Times count from the last synchronization, when all discs were at `origin`.

    Attributes:
        position: (N, 2) f8, position of each disc at its last collision, length.
        velocity: (N, 2) f8, length/time.
        time: (N,) f8, time of the last collision.
        origin: (N, 2) f8, position at the last synchronization, length.
        radius: (N,) f8, radius at the end of the compression, length.
        period: (2,) f8, width and height of the box, length.
        first: (N + 1,) i8, index in `neighbour` at which the neighbours of each disc begin.
        neighbour: i8, discs that a disc may meet before the next synchronization.
        next_time: (N,) f8, time of the next event of each disc.
        partner: (N,) i8, partner in this event; -1 if at this time the disc may instead meet a disc that is not listed.
        collisions: (N,) i8, number of collisions of each disc.
        known: (N,) i8, number of collisions of the partner when the event was predicted.
    """

    position: np.ndarray
    velocity: np.ndarray
    time: np.ndarray
    origin: np.ndarray
    radius: np.ndarray
    period: np.ndarray
    first: np.ndarray
    neighbour: np.ndarray
    next_time: np.ndarray
    partner: np.ndarray
    collisions: np.ndarray
    known: np.ndarray


def loose_scale(radius: np.ndarray, box: tuple[float, float]) -> float:
    """Return the fraction of the final radii with which the discs start; 1 if the packing fraction is low enough."""
    return min(math.sqrt(LOOSE * box[0] * box[1] / (math.pi * float(radius @ radius))), 1.0)


def compress(
    position: np.ndarray, radius: np.ndarray, box: tuple[float, float], scale: float, random: np.random.Generator
) -> float:
    """Let discs grow from scale * radius to radius; return the fraction of the radius reached, 1 unless they jam.

    position: (N, 2), changed in place, length. radius: (N,), length. random: source of the initial velocities.
    """
    n, period = len(radius), np.array(box)
    velocity, rate = random.standard_normal((n, 2)), RATE / float(radius.mean())
    done, end = 0, 1 + GAP
    while scale < end and done < MAX_COLLISIONS * n:
        velocity -= velocity.mean(axis=0)
        velocity /= math.sqrt(float((velocity**2).mean()))
        slack = min(SLACK * 2 * float(radius.max()), (min(box) / 2 - 2 * float(radius.max())) / 2)
        reach = 2 * float(radius.max()) * scale + 2 * slack  # discs approach by `slack` and grow by the same amount
        longest = min((end - scale) / rate, slack / (2 * float(radius.max()) * rate))
        discs = _synchronised(position, velocity, radius, period, reach)
        events, time = _grow(discs, scale, rate, slack / 2, longest, RESCALE_INTERVAL * n)
        moved = discs.position + velocity * (time - discs.time)[:, None]
        position[:] = np.minimum(moved % period, np.nextafter(period, 0.0))
        scale = end if time == (end - scale) / rate else scale + rate * time
        done += events + 1
    return min(scale, 1.0)


def _synchronised(
    position: np.ndarray, velocity: np.ndarray, radius: np.ndarray, period: np.ndarray, reach: float
) -> Growing:
    """Return the discs at local time 0, with a list of the neighbours of each that are closer than `reach` (length)."""
    from scipy.spatial import cKDTree

    n = len(radius)
    pairs = cKDTree(position, boxsize=period).query_pairs(reach, output_type="ndarray")
    both = np.concatenate((pairs, pairs[:, ::-1]))
    both = both[np.lexsort(both.T[::-1])]
    return Growing(
        position.copy(),
        velocity,
        np.zeros(n),
        position.copy(),
        radius,
        period,
        first=np.searchsorted(both[:, 0], np.arange(n + 1)),
        neighbour=both[:, 1].copy(),
        next_time=np.zeros(n),
        partner=np.zeros(n, np.int64),
        collisions=np.zeros(n, np.int64),
        known=np.zeros(n, np.int64),
    )


@inline
def _time_to_contact(discs, i, j, scale, rate):
    """Time at which discs i and j touch; infinite if they never touch. scale: fraction of the final radii at time 0."""
    now = max(discs.time[i], discs.time[j])
    since_i, since_j = now - discs.time[i], now - discs.time[j]
    vx = discs.velocity[i, 0] - discs.velocity[j, 0]
    vy = discs.velocity[i, 1] - discs.velocity[j, 1]
    dx = discs.position[i, 0] + discs.velocity[i, 0] * since_i
    dx -= discs.position[j, 0] + discs.velocity[j, 0] * since_j
    dy = discs.position[i, 1] + discs.velocity[i, 1] * since_i
    dy -= discs.position[j, 1] + discs.velocity[j, 1] * since_j
    dx = nearest_image(dx, discs.period[0], True)
    dy = nearest_image(dy, discs.period[1], True)
    sum_of_radii = discs.radius[i] + discs.radius[j]
    contact, growth = sum_of_radii * (scale + rate * now), sum_of_radii * rate
    a = vx * vx + vy * vy - growth * growth
    b = dx * vx + dy * vy - contact * growth
    c = dx * dx + dy * dy - contact * contact
    if b < 0 and c <= 0:
        return now
    root = b * b - a * c
    if b < 0:
        return now + c / (math.sqrt(root) - b) if root >= 0 else np.inf
    return now + (b + math.sqrt(max(root, 0.0))) / -a if a < 0 else np.inf  # they separate more slowly than they grow


@inline
def _predict(discs, i, scale, rate, range_):
    """Find the next event of disc i; range_: largest allowed distance from its origin, length."""
    x, y = discs.position[i, 0] - discs.origin[i, 0], discs.position[i, 1] - discs.origin[i, 1]
    speed = math.hypot(discs.velocity[i, 0], discs.velocity[i, 1])
    discs.next_time[i] = discs.time[i] + max(range_ - math.hypot(x, y), 0.0) / speed
    discs.partner[i] = -1
    for k in range(discs.first[i], discs.first[i + 1]):
        j = discs.neighbour[k]
        time = _time_to_contact(discs, i, j, scale, rate)
        if time < discs.next_time[i]:
            discs.next_time[i] = time
            discs.partner[i] = j
            discs.known[i] = discs.collisions[j]


@inline
def _collide(discs, i, j, time, rate):
    """Collide discs i and j elastically in the frame of their growing surfaces."""
    for k in (i, j):
        discs.position[k, 0] += discs.velocity[k, 0] * (time - discs.time[k])
        discs.position[k, 1] += discs.velocity[k, 1] * (time - discs.time[k])
        discs.time[k] = time
        discs.collisions[k] += 1
    dx = nearest_image(discs.position[j, 0] - discs.position[i, 0], discs.period[0], True)
    dy = nearest_image(discs.position[j, 1] - discs.position[i, 1], discs.period[1], True)
    distance = math.hypot(dx, dy)
    nx, ny = dx / distance, dy / distance
    apart = (discs.velocity[j, 0] - discs.velocity[i, 0]) * nx + (discs.velocity[j, 1] - discs.velocity[i, 1]) * ny
    impulse = rate * (discs.radius[i] + discs.radius[j]) - apart
    discs.velocity[i, 0] -= impulse * nx
    discs.velocity[i, 1] -= impulse * ny
    discs.velocity[j, 0] += impulse * nx
    discs.velocity[j, 1] += impulse * ny


@njit
def _grow(discs, scale, rate, range_, longest, most):
    """Collide discs until the time `longest`, `most` collisions, or the time at which a disc may leave its range.

    Returns the number of collisions and the time.
    """
    n = discs.time.shape[0]
    for i in range(n):
        _predict(discs, i, scale, rate, range_)
    for events in range(most):
        i = 0
        for k in range(1, n):
            if discs.next_time[k] < discs.next_time[i]:
                i = k
        time, j = discs.next_time[i], discs.partner[i]
        if time >= longest:
            return events, longest
        if j < 0:
            return events, time
        if discs.collisions[j] == discs.known[i]:
            _collide(discs, i, j, time, rate)
            _predict(discs, j, scale, rate, range_)
        _predict(discs, i, scale, rate, range_)
    return most, time
