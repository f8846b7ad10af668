"""SplitMix64: random numbers as a pure function of a counter and a key.

Source: Steele, Lea & Flood, OOPSLA 2014.
"""

import numpy as np

from idealgas.jit import inline

GOLDEN = np.uint64(0x9E3779B97F4A7C15)
"""Constant by which SplitMix64 multiplies the counter."""

_MIX_1 = np.uint64(0xBF58476D1CE4E5B9)
_MIX_2 = np.uint64(0x94D049BB133111EB)
_S27, _S30, _S31, _S11 = (np.uint64(s) for s in (27, 30, 31, 11))


@inline
def mix(z):
    """Output function of SplitMix64: 64 random bits from 64 bits."""
    z = (z ^ (z >> _S30)) * _MIX_1
    z = (z ^ (z >> _S27)) * _MIX_2
    return z ^ (z >> _S31)


@inline
def unit_interval(bits):
    """Random number in (0, 1] from 64 random bits."""
    return (np.float64(bits >> _S11) + 1.0) * 2.0**-53


@inline
def disc_uniform(seed, disc_id, number, draw):
    """Random number in (0, 1], a pure function of the four arguments.

    seed: u8. disc_id: id of a disc. number: u8, index of the random event of this disc, from 0. draw: index of the
    random number among the eight for this event; thermal walls use 0 to 2, and the heat bath uses 3 to 7.
    """
    key = mix(seed + GOLDEN * (np.uint64(disc_id) + np.uint64(1)))
    count = number * np.uint64(8) + np.uint64(draw)
    return unit_interval(mix(mix(key + GOLDEN * (count + np.uint64(1))) + key))
