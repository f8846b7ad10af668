"""Cells: how many there are, which one a position belongs to, and the lists of their discs."""

from types import SimpleNamespace

import numpy as np
import pytest
from helpers.rounding import body

from idealgas.engine.event_driven.cells import (
    cell_of,
    discs_per_cell,
    enter,
    find_cell,
    leave,
    make_cells,
)
from idealgas.engine.event_driven.crossings import cross_cell
from idealgas.physics.periodic import Periodic

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
    assert (link.column, link.row) == (column, row)
    assert [result.tolist() for result in cell_of(np.array([place]), cells)] == [[column], [row]]


@pytest.mark.parametrize("order", [(0, 1, 2), (2, 1, 0), (1, 0, 2), (1, 2, 0)])
def test_discs_enter_and_leave_a_cell(order):
    cells = make_cells(4, (10.0, 5.0), 0.5, 0.8)

    def discs(cell):
        """From the head on; the links back agree."""
        result, before, i = [], -1, cells.head[cell]
        while i >= 0:
            assert cells.link[i].previous == before
            result.append(int(i))
            before, i = i, cells.link[i].next
        return result

    other, cell = 1 * cells.columns + 1, 1 * cells.columns + 2
    cells.link.row[:4] = 1
    cells.link.column[:4] = 2, 2, 2, 1
    for i in (3, 0, 1, 2):
        enter(cells, i)
    assert (discs(other), discs(cell)) == ([3], [2, 1, 0])
    left = [2, 1, 0]
    for i in order:
        leave(cells, i)
        left.remove(i)
        assert (discs(other), discs(cell)) == ([3], left)


@pytest.mark.parametrize(
    ("code", "start", "end", "crossed"),
    [
        (0, (3, 2), (2, 2), (0, 0)),
        (3, (3, 2), (3, 3), (0, 0)),
        (0, (1, 2), (5, 2), (-1, 0)),  # through the left side
        (1, (5, 2), (1, 2), (1, 0)),
        (2, (3, 1), (3, 4), (0, -1)),
        (3, (3, 4), (3, 1), (0, 1)),
    ],
)
def test_a_disc_crosses_into_the_next_cell(code, start, end, crossed):
    """Of five columns and four rows; through a periodic side into the cell at the opposite one."""
    cells = make_cells(4, (10.0, 5.0), 0.62, 0.1)._replace(columns=7, rows=6)
    sides = Periodic(True, True, 10.0, 5.0, np.zeros((4, 2), np.int32))
    state, record = SimpleNamespace(cells=cells, coarse=None), [body()] * 4
    link = cells.link[3]
    link.column, link.row = start
    enter(cells, 3)
    record[3].crossed_x = record[3].crossed_y = 0
    cross_cell(record, state, 3, code, sides, None)
    assert (link.column, link.row) == end
    assert (record[3].crossed_x, record[3].crossed_y) == crossed
    assert np.flatnonzero(cells.head >= 0).tolist() == [end[1] * 7 + end[0]]
