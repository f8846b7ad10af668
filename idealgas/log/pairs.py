"""The pair rule: a collision of two discs consists of two event rows with the same time, the smaller id first.

The kind of a row must agree with its partner, which is a disc, a wall, the heat bath or the outside.
"""

from collections.abc import Mapping

import numpy as np

from idealgas.columns import BATH, OUTSIDE, Kind

PARTNERS = {Kind.THERMOSTAT: BATH, Kind.STEERED: OUTSIDE}
"""Kinds of events that always have the same special partner, which occurs in no other kind of event."""


def check_pairs(columns: Mapping[str, np.ndarray], start: int) -> None:
    """Check the pair rule in a chunk; the two rows of a pair may be in different chunks.

    Args:
        columns: event columns of the chunk, by name.
        start: number of the first row of the chunk.

    Raises:
        ValueError: if one of the two rows of a pair is missing, or the kind of a row disagrees with its partner.
    """
    if "disc" not in columns or "partner" not in columns:
        return
    disc, partner = columns["disc"].astype(np.int64), columns["partner"]
    first = disc < partner  # first row of a collision
    second = (partner >= 0) & ~first
    unpaired = np.zeros(len(disc), bool)
    unpaired[1:] = second[1:] & ~first[:-1]
    unpaired[:1] = second[:1] & (start == 0)
    rows = np.flatnonzero(first[:-1])
    wrong = (disc[rows + 1] != partner[rows]) | (partner[rows + 1] != disc[rows])
    if "time" in columns:
        wrong |= columns["time"][rows + 1] != columns["time"][rows]
    unpaired[rows[wrong]] = True
    if unpaired.any():
        raise ValueError(f"events/partner: no pair in row {start + int(unpaired.argmax())}")
    if "kind" in columns:
        kind = columns["kind"]
        wrong = (kind == Kind.DISC) != (partner >= 0)
        for special_kind, special_partner in PARTNERS.items():
            wrong |= (kind == special_kind) != (partner == special_partner)
        if wrong.any():
            raise ValueError(f"events/kind: disagrees with the partner in row {start + int(wrong.argmax())}")
