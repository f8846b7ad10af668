"""The rule of pairs: what is accepted and which row is wrong."""

import numpy as np
import pytest

from idealgas.columns import BATH, Kind
from idealgas.log.pairs import check_pairs

pytestmark = pytest.mark.interpreted

ROWS = [  # disc, partner, time, kind: a wall, a pair, the bath, a pair
    (3, -2, 1.0, Kind.WALL),
    (1, 4, 2.0, Kind.DISC),
    (4, 1, 2.0, Kind.DISC),
    (2, BATH, 3.0, Kind.THERMOSTAT),
    (0, 2, 3.0, Kind.DISC),
    (2, 0, 3.0, Kind.DISC),
]


def checked(rows, start=0, names=("disc", "partner", "time", "kind")):
    columns = dict(zip(("disc", "partner", "time", "kind"), map(np.array, zip(*rows, strict=True)), strict=True))
    check_pairs({name: columns[name] for name in names}, start)


def test_whole_pairs_are_accepted_also_between_two_chunks_but_not_at_the_start():
    checked(ROWS)
    checked(ROWS[2:], start=2)  # the second row of a pair begins the chunk
    checked(ROWS[:2])  # and the first one ends it
    checked(ROWS, names=("disc", "partner"))
    check_pairs({"disc": np.array([1, 1]), "time": np.array([2.0, 2.0])}, 0)
    for rows in (ROWS[2:], [(3, 3, 2.0, Kind.DISC)] * 2):  # half a pair; a disc and itself
        with pytest.raises(ValueError, match="no pair in row 0"):
            checked(rows)


@pytest.mark.parametrize(
    ("row", "column", "value", "wrong"),
    [
        (2, 1, 2, "events/partner: no pair in row 11"),
        (2, 0, 3, "events/partner: no pair in row 11"),
        (2, 2, 2.5, "events/partner: no pair in row 11"),
        (1, 1, -2, "events/partner: no pair in row 12"),
        (4, 1, 4, "events/partner: no pair in row 14"),
        (1, 3, Kind.WALL, "events/kind: disagrees with the partner in row 11"),
        (0, 3, Kind.DISC, "events/kind: disagrees with the partner in row 10"),
        (3, 3, Kind.WALL, "events/kind: disagrees with the partner in row 13"),
        (0, 3, Kind.THERMOSTAT, "events/kind: disagrees with the partner in row 10"),
    ],
)
def test_the_first_wrong_row_is_named(row, column, value, wrong):
    rows = [list(entry) for entry in ROWS]
    rows[row][column] = value
    with pytest.raises(ValueError, match=wrong):
        checked(rows, start=10)
