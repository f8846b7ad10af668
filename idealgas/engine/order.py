"""Which of two simultaneous events comes first: the smaller (smaller id, other id), where a wall precedes any disc.

Where two discs, or a disc and a wall, meet in two images at once, the one comes first that is fewer box lengths away
from the smaller id, counted along x and then along y.

The rule uses ids only, never places in memory, so every method and every renumbering gives the same order.
"""

from idealgas._jit import inline

FIRST_WALL = -(1 << 31)


@inline
def wall_rank(wall):
    """A wall's place among a disc's partners: before all discs, in order of wall number."""
    return FIRST_WALL + wall


@inline
def precedes(a, b, c, d):
    """Whether the event of ids (a, b) comes before that of (c, d) at one time; b and d may be wall ranks."""
    a_low, a_high = (b, a) if 0 <= b < a else (a, b)
    c_low, c_high = (d, c) if 0 <= d < c else (c, d)
    return a_low < c_low or (a_low == c_low and a_high < c_high)


@inline
def image_precedes(own, other, images, others):
    """Whether a disc meets the same partner first in `images` box lengths and then in `others`; other may be a rank."""
    ahead = images[0] < others[0] or (images[0] == others[0] and images[1] < others[1])
    return ahead if other < 0 or own < other else images != others and not ahead
