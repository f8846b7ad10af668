"""Epochs: how long local clocks run before all discs are brought to one time and the clocks start again."""

import math

from idealgas.gas import Gas

EVENTS_PER_DISC = 64
FEWEST_EVENTS = 1024  # of an epoch of few discs


def epoch_length(gas: Gas, extra_speed: float = 0.0) -> float:
    """A power of two of time in which about 64 events a disc happen; infinite if nothing moves.

    extra_speed: length/time, what gravity or a piston may add to the mean speed of the discs.

    A pure function of the gas: sums are exactly rounded, so neither the order of memory nor the processor has a say.
    The rate is a kinetic-theory estimate of collisions with discs and with the sides.
    """
    n = len(gas)
    mean_speed = math.fsum(math.hypot(vx, vy) for vx, vy in gas.velocity.tolist()) / n + extra_speed
    if mean_speed == 0.0:
        return math.inf
    largest_radius = float(gas.radius.max())
    mean_diameter = 2.0 * math.fsum(gas.radius.tolist()) / n
    phi = min(math.pi * math.fsum((gas.radius**2).tolist()) / gas.area, 0.7)
    contact_value = (1.0 - 7.0 * phi / 16.0) / (1.0 - phi) ** 2
    pairs = math.sqrt(2.0) * mean_diameter * (n - 1) / gas.area * contact_value
    sides = sum(2.0 / (math.pi * (length - 2.0 * largest_radius)) for length in gas.box)
    rate = n * mean_speed * (pairs + sides)
    return 2.0 ** math.floor(math.log2(max(EVENTS_PER_DISC * n, FEWEST_EVENTS) / rate))
