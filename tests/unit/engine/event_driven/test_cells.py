"""Cells: how many there are, which one a position belongs to, and the lists of their discs."""

import numpy as np
import pytest
from helpers.rounding import body

from idealgas.engine.event_driven.cells import (
    cell_index,
    cell_of,
    discs_per_cell,
    enter,
    find_cell,
    is_in_ring,
    leave,
    make_cells,
)

pytestmark = pytest.mark.interpreted


@pytest.mark.parametrize(
    ("n", "radius", "columns", "rows"),
    [
        (100, 0.5, 9, 4),  # ten cells of one diameter would leave no margin
        (100, 0.475, 10, 5),
        (4, 0.5, 3, 1),  # √(50 · 0.8/4) wide: as many as the filling asks for
        (1, 4.0, 1, 1),
    ],
)
def test_cells_are_a_diameter_wide_or_as_wide_as_their_filling(n, radius, columns, rows):
    """In a box of 10 by 5, with a ring around it."""
    cells = make_cells(n, (10.0, 5.0), radius, 0.8)
    assert (cells.columns - 2, cells.rows - 2) == (columns, rows)
    assert (cells.width, cells.height) == (10.0 / columns, 5.0 / rows)
    assert cells.head.tolist() == [-1] * ((columns + 2) * (rows + 2))


@pytest.mark.parametrize(("packing", "number"), [(0.7, 0.4), (0.1, 0.4), (0.01, 0.4 * 10**0.3), (0.0, 4.0)])
def test_dilute_gases_have_more_discs_in_a_cell(packing, number):
    assert discs_per_cell(packing) == pytest.approx(number, rel=1e-12)


@pytest.mark.parametrize(
    ("place", "column", "row"),
    [
        ((0.0, 0.0), 1, 1),
        ((1.99, 1.3), 1, 2),
        ((2.0, 1.2), 2, 1),
        ((9.99, 4.99), 5, 4),
        ((-0.01, 5.01), 1, 4),
        ((10.1, 2.6), 5, 3),
    ],
)
def test_the_cell_of_a_position(place, column, row):
    """Five columns of 2 and four rows of 1.25; beyond the box the nearest cell."""
    cells = make_cells(100, (10.0, 5.0), 0.62, 0.1)._replace(columns=7, rows=6, width=2.0, height=1.25)
    find_cell(cells, 3, body(x=place[0], y=place[1]))
    link = cells.link[3]
    assert (link.column, link.row, cell_index(cells, 3)) == (column, row, row * 7 + column)
    assert [found.tolist() for found in cell_of(np.array([place]), cells)] == [[column], [row]]
    assert not is_in_ring(cells, link)
    for ring in ((0, 1), (6, 1), (1, 0), (1, 5)):
        link.column, link.row = ring
        assert is_in_ring(cells, link)


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2), (1, 2, 0)])
def test_discs_enter_and_leave_a_cell(order):
    cells = make_cells(4, (10.0, 5.0), 0.5, 0.8)

    def discs(cell):
        """From the head on; the links back agree."""
        found, before, i = [], -1, cells.head[cell]
        while i >= 0:
            assert cells.link[i].previous == before
            found.append(int(i))
            before, i = i, cells.link[i].next
        return found

    enter(cells, 3, 5)
    for i in range(3):
        enter(cells, i, 6)
    assert (discs(5), discs(6)) == ([3], [2, 1, 0])
    left = [2, 1, 0]
    for i in order:
        leave(cells, i, 6)
        left.remove(i)
        assert (discs(5), discs(6)) == ([3], left)
