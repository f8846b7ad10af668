"""The rule of pairs: a collision of two discs is two event rows at the same time, that of the smaller id first.

The kind of a row agrees with its partner: a disc, the heat bath, the outside or a wall.
"""

from collections.abc import Mapping

import numpy as np

from idealgas.columns import BATH, OUTSIDE, Kind

PARTNERS = {Kind.THERMOSTAT: BATH, Kind.STEERED: OUTSIDE}
"""Partner in all events of a kind, and in no others."""


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
    disc, partner = columns["disc"].astype(np.int64), columns["partner"]
    first = disc < partner  # of the two rows of a collision
    second = (partner >= 0) & ~first
    lonely = np.zeros(len(disc), bool)
    lonely[1:] = second[1:] & ~first[:-1]
    lonely[:1] = second[:1] & (start == 0)
    ones = np.flatnonzero(first[:-1])
    wrong = (disc[ones + 1] != partner[ones]) | (partner[ones + 1] != disc[ones])
    if "time" in columns:
        wrong |= columns["time"][ones + 1] != columns["time"][ones]
    lonely[ones[wrong]] = True
    if lonely.any():
        raise ValueError(f"events/partner: no pair in row {start + int(lonely.argmax())}")
    if "kind" in columns:
        kind = columns["kind"]
        other = (kind == Kind.DISC) != (partner >= 0)
        for own, only in PARTNERS.items():
            other |= (kind == own) != (partner == only)
        if other.any():
            raise ValueError(f"events/kind: not that of its partner in row {start + int(other.argmax())}")
