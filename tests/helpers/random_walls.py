"""Walls drawn at random, and how far from them a path goes."""

import math

import numpy as np
from hypothesis import strategies as st

WIDTH, HEIGHT = 6.0, 5.0
"""Of the box that the walls are drawn for; some reach beyond it."""

coordinate = st.one_of(st.floats(-1.0, 7.0), st.integers(-1, 7).map(float), st.sampled_from([0.5, 2.5, WIDTH, HEIGHT]))
point = st.tuples(coordinate, coordinate)


def regular(centre, radius, corners, turn):
    angles = [turn + 2 * math.pi * k / corners for k in range(corners)]
    x, y = centre
    ring = [(x + radius * math.cos(a), y + radius * math.sin(a)) for a in angles]
    return list(zip(ring, ring[1:] + ring[:1], strict=True))


short = st.builds(
    lambda p, angle, length: [(p, (p[0] + length * math.cos(angle), p[1] + length * math.sin(angle)))],
    point,
    st.floats(0, 6.3),
    st.sampled_from([1e-9, 1e-3, 0.1, 1.0]),
)
anywhere = st.tuples(point, point).map(lambda ends: [ends])
star = st.builds(lambda p, others: [(p, q) for q in others], point, st.lists(point, min_size=2, max_size=4))  # touching
polygon = st.builds(regular, point, st.floats(0.1, 2.5), st.integers(3, 8), st.floats(0, 1))
some_walls = st.lists(st.one_of(anywhere, short, star, polygon), min_size=1, max_size=4).map(
    lambda parts: [wall for part in parts for wall in part if math.dist(*wall) > 1e-12]
)


def distances(points: np.ndarray, walls: np.ndarray) -> np.ndarray:
    """(P, W) of points (P, 2) from walls (W, 2, 2)."""
    start, along = walls[:, 0], walls[:, 1] - walls[:, 0]
    share = ((points[:, None] - start) * along).sum(axis=2) / (along**2).sum(axis=1)
    return np.linalg.norm(points[:, None] - start - np.clip(share, 0, 1)[..., None] * along, axis=2)


def crossings(begin: np.ndarray, end: np.ndarray, walls: np.ndarray) -> np.ndarray:
    """(P, W) bool, whether the straight way from begin to end (P, 2) crosses a wall."""

    def side(a, b, p):
        return np.sign((b - a)[..., 0] * (p - a)[..., 1] - (b - a)[..., 1] * (p - a)[..., 0])

    a, b = begin[:, None], end[:, None]
    c, d = walls[None, :, 0], walls[None, :, 1]
    return (side(a, b, c) * side(a, b, d) < 0) & (side(c, d, a) * side(c, d, b) < 0)
