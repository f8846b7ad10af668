"""Overlaps of explicit discs: exactly those of all pairs and images, with few comparisons however discs lie."""

from itertools import combinations, product
from unittest.mock import patch

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from idealgas.scene.checks import overlaps as module
from idealgas.scene.checks.overlaps import MOST_OVERLAPS, overlapping, overlaps
from idealgas.scene.discs import discs_of_tables
from idealgas.scene.tables import Box, Disc

WIDTH, HEIGHT = 8.0, 4.0
FINEST = 64  # of a length: sums and squares of such numbers are exact, and many discs just touch

coordinates = st.tuples(*(st.integers(0, int(side * FINEST) - 1) for side in (WIDTH, HEIGHT)))
radii = st.sampled_from([1, 2, 3, 16, 17, 64, 128])
discs = st.lists(st.tuples(coordinates, radii), max_size=12)


def by_brute_force(placed, periodic):
    """Pairs of which any of the nine images overlap."""
    shifts = list(
        product(*((-side, 0, side) if on else (0,) for side, on in zip((WIDTH, HEIGHT), periodic, strict=True)))
    )
    return {
        (low, high)
        for (low, a), (high, b) in combinations(enumerate(placed), 2)
        for x, y in shifts
        if (a.position[0] - b.position[0] + x) ** 2 + (a.position[1] - b.position[1] + y) ** 2
        < (a.radius + b.radius) ** 2
    }


@given(discs, st.booleans(), st.booleans())
def test_they_are_those_of_all_pairs(drawn, along_x, along_y):
    placed = [Disc(position=(x / FINEST, y / FINEST), radius=r / FINEST) for (x, y), r in drawn]
    sides = ["left", "right"] * along_x + ["bottom", "top"] * along_y
    box = Box(size=(WIDTH, HEIGHT), **dict.fromkeys(sides, "periodic"))
    expected = sorted(by_brute_force(placed, (along_x, along_y)))
    compared = list(overlapping(discs_of_tables(placed), box))
    assert [(low, high) for low, high, _ in compared] == expected
    with patch.multiple(module, FEW=0, PART=2):  # compares groups and halves of groups
        assert list(overlapping(discs_of_tables(placed), box)) == compared


@pytest.mark.parametrize("step", [(0.0, 1.0), (1.0, 0.0), (1.0, 1.0)])
def test_discs_in_a_line_are_compared_with_few_others(step, monkeypatch):
    """A disc is compared with its two neighbours in the line, and two discs are near the small disc."""
    compared, pairs = [], module._near_pairs

    def counted(*arguments):
        for i, k in pairs(*arguments):
            compared.append(len(i))
            yield i, k

    monkeypatch.setattr(module, "_near_pairs", counted)
    centre = np.array([*(np.arange(10_000)[:, None] * step), (5.25 * step[0], 5.25 * step[1])])
    radius = np.append(np.full(10_000, 0.5), 1e-9)
    assert list(overlaps(centre, radius, 1e4)) == [(5, 10_000, pytest.approx(0.25 * sum(s * s for s in step) ** 0.5))]
    assert 9_999 * (sum(step) == 1) < sum(compared) < 10_000 + 4


@pytest.mark.parametrize("ratio", [1, 2])
def test_of_discs_in_one_place_a_number_is_reported(ratio):
    placed = discs_of_tables(
        [Disc(position=(1.0, 1.0), radius=0.5), Disc(position=(1.0, 1.0), radius=0.5 / ratio)] * 2_500
    )
    with patch.object(module, "PART", 64):
        assert len(list(overlapping(placed, None))) == MOST_OVERLAPS
