"""Discs that do not interact: they pass through each other, and each moves as if it were alone in the box.

The mean path of such a disc between two hits is π A/P, where A is the area that its centre can reach and P the
perimeter of this area, if the disc visits all of it evenly (Santaló; Chernov, J. Stat. Phys. 88, 1 (1997)).
"""

import math
from collections.abc import Iterable


def wall_hits_per_length(segments: Iterable[tuple[float, float]], area: float) -> float:
    """Estimate how often a disc hits wall segments and fixed discs per unit length of its path, P/(π A), 1/length.

    Only one face of each segment counts, and arcs count as their chords.

    Args:
        segments: length of each wall segment, and radius of its ends, length.
        area: area A of the box that is not covered by solid walls, length².
    """
    return math.fsum(length + 2.0 * math.pi * radius for length, radius in segments) / (math.pi * area)
