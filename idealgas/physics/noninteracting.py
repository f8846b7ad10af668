"""Discs that do not interact: they pass through each other, and each moves as if it were alone in the box."""

import math
from collections.abc import Iterable


def wall_hits_per_length(segments: Iterable[tuple[float, float]], area: float) -> float:
    """Estimate how often a disc hits wall segments and fixed discs per unit length of its path, P/(π A), 1/length.

    Source: Chernov, J. Stat. Phys. 88, 1 (1997). Only one face of each segment counts, and arcs count as their chords.

    Args:
        segments: length of each wall segment, and radius of its ends, length.
        area: area A of the box that is not covered by solid walls, length².
    """
    return math.fsum(length + 2.0 * math.pi * radius for length, radius in segments) / (math.pi * area)
