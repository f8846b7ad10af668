"""Order of simultaneous events: the smaller pair (smaller id, other id) comes first, where a wall precedes any disc.

A thermostat collision comes after the walls and before any disc, as the bath's number is beyond those of the walls.

Where a disc meets the same disc or wall in two images at once, that image comes first that is fewer box lengths away
from the disc with the smaller id, counted along x and then along y. The rule uses ids only, never indices in memory, so
every method and every renumbering gives the same order.
"""

from idealgas.jit import inline

FIRST_WALL = -(1 << 31)


@inline
def wall_rank(wall):
    """Rank of a wall among a disc's partners: before all discs, in order of wall number."""
    return FIRST_WALL + wall


@inline
def precedes(a, b, c, d):
    """Whether the event of ids (a, b) comes before the simultaneous one of (c, d); b and d may be wall ranks."""
    a_low, a_high = (b, a) if 0 <= b < a else (a, b)
    c_low, c_high = (d, c) if 0 <= d < c else (c, d)
    return a_low < c_low or (a_low == c_low and a_high < c_high)


@inline
def image_precedes(own, other, images, others):
    """Whether a disc meets a partner in the image `images` before it meets it, at the same time, in the image `others`.

    images, others: numbers of box lengths (x, y). own: id of the disc. other: id or wall rank of the partner.
    """
    ahead = images[0] < others[0] or (images[0] == others[0] and images[1] < others[1])
    return ahead if other < 0 or own < other else images != others and not ahead
