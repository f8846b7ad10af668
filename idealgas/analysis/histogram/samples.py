"""Independent samples of a velocity quantity of the discs of one gas."""

import math

import numpy as np

from idealgas.statistics.autoregression import inefficiency
from idealgas.tallies.equilibrium import ROUNDING

GROUPS = 16
"""Number of groups of discs that are sampled in turn.

The discs share energy and momentum, but a sixteenth of them hardly correlates with itself for this reason. A disc
hardly correlates with itself sixteen statistical inefficiencies later, even if it is confined between walls.
"""


def independent_samples(values: np.ndarray) -> tuple[np.ndarray, int]:
    """Return independent samples (n,) of values (B, M) of M discs at B instants, and the spacing of the samples.

    The spacing, in instants, is the largest statistical inefficiency of single discs and of their mean, which
    fluctuates slowly if walls or a thermostat exchange energy with the gas. The squares of the values are also
    considered, as a light disc among heavy ones keeps its speed for longer than its direction.
    """
    memory = 1.0
    for x in (values, values**2):
        mean = x.mean(axis=1)
        conserved = np.ptp(mean) <= ROUNDING * np.abs(x).max()
        memory = max(memory, inefficiency(x), 1.0 if conserved else inefficiency(mean))
    spacing, groups = math.ceil(memory), min(GROUPS, values.shape[1])
    samples = [row[k % groups :: groups] for k, row in enumerate(values[::spacing])]
    return np.concatenate(samples), spacing
