"""The rule of pairs: a collision of two discs is two event rows at the same time, that of the smaller id first.

The kind of a row agrees with its partner: a disc, the heat bath or a wall.
"""

from collections.abc import Mapping

import numpy as np

from idealgas.columns import BATH, Column, Kind, columns_named
from idealgas.jit import njit

RULED = columns_named(("time", "disc", "partner", "kind"))
"""Event columns to which the rule applies."""

NO_PAIR, OTHER_KIND = 1, 2
DISC, THERMOSTAT = int(Kind.DISC), int(Kind.THERMOSTAT)


def check_pairs(columns: Mapping[str, np.ndarray], start: int) -> None:
    """Check the rule of pairs. A pair may be divided between two chunks.

    Args:
        columns: chunks of event columns, by name.
        start: number of their first row.

    Raises:
        ValueError: if a row has no pair, or a kind that disagrees with its partner.
    """
    if "disc" not in columns or "partner" not in columns:
        return
    fault, row = _first_fault(*(_of_one_type(columns, column) for column in RULED), start > 0)
    if fault == NO_PAIR:
        raise ValueError(f"events/partner: no pair in row {start + row}")
    if fault == OTHER_KIND:
        raise ValueError(f"events/kind: not that of its partner in row {start + row}")


def _of_one_type(columns: Mapping[str, np.ndarray], column: Column) -> np.ndarray:
    """A column, empty if it is missing, as a read-only view, so that one type is compiled."""
    found = columns.get(column.name, np.empty(0, column.dtype)).view()
    found.flags.writeable = False
    return found


@njit
def _first_fault(time, disc, partner, kind, is_second_allowed):
    """Code of the first fault, pairs before kinds, or 0, and its row. time and kind may be empty."""
    n = disc.shape[0]
    odd = -1  # first row of another kind
    allowed = is_second_allowed  # whether the row may be the second one of a pair
    for k in range(n):
        one, other = np.int64(disc[k]), np.int64(partner[k])
        if (
            kind.shape[0] > 0
            and odd < 0
            and ((kind[k] == DISC) != (other >= 0) or (kind[k] == THERMOSTAT) != (other == BATH))
        ):
            odd = k
        if other >= 0 and one >= other and not allowed:
            return NO_PAIR, k
        allowed = one < other
        if allowed and k + 1 < n:
            same_time = time.shape[0] == 0 or time[k] == time[k + 1]
            if disc[k + 1] != other or partner[k + 1] != one or not same_time:
                return NO_PAIR, k
    return (OTHER_KIND, odd) if odd >= 0 else (0, 0)
