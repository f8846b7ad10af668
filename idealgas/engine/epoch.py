"""Epochs: how long local clocks run before all discs are brought to one time and the clocks start again."""

import math
from collections.abc import Sequence

import numpy as np

from idealgas.gas.state import Gas
from idealgas.physics.contact_value import contact_value
from idealgas.physics.effects import Effects

EVENTS_PER_DISC = 64  # at most; half of it at least
FEWEST_EVENTS = 1024  # of an epoch of few discs
LONGEST_WAY = 6144  # of the fastest disc, in diameters: contacts are missed by 2**-54 of it for each of the two at most
FEWEST_PER_DISC = 4  # events, however long the way: an epoch costs about as much as one event a disc


def encounters_per_length(gas: Gas, periodic: Sequence[bool] = (False, False)) -> float:
    """Encounters of all discs with discs and sides per length that each moves: a kinetic-theory estimate, 1/length.

    periodic: along which axes sides are. Sides that leave a disc less than its diameter: see `narrow_encounters`.
    """
    n = len(gas)
    largest_radius = float(gas.radius.max())
    mean_diameter = 2.0 * math.fsum(gas.radius.tolist()) / n
    phi = min(math.pi * math.fsum((gas.radius**2).tolist()) / gas.area, 0.9)
    pairs = math.sqrt(2.0) * mean_diameter * (n - 1) / gas.area * contact_value(phi)
    room = [length - 2.0 * largest_radius for length in gas.box]
    far = [
        way if way > 2.0 * largest_radius else length * on
        for way, length, on in zip(room, gas.box, periodic, strict=True)
    ]
    sides = sum(2.0 / (math.pi * way) for way in far if way > 0.0)
    return n * (pairs + sides)


def narrow_encounters(gas: Gas, periodic: Sequence[bool]) -> float:
    """Hits of sides that leave the largest disc less than its diameter, 1/time: the direction of motion decides."""
    rate = 0.0
    for axis, (length, on) in enumerate(zip(gas.box, periodic, strict=True)):
        room = length - 2.0 * gas.radius
        if not on and 0.0 < room.min() <= 2.0 * gas.radius.max():
            rate += math.fsum((np.abs(gas.velocity[:, axis]) / room).tolist())
    return rate


def epoch_length(
    gas: Gas, encounters: float, extra_speed: float = 0.0, periodic: Sequence[bool] = (False, False)
) -> float:
    """A power of two of time in which 32 to 64 events a disc happen, fewer in a thin gas; infinite if nothing moves.

    encounters: see `encounters_per_length`. extra_speed: length/time, what gravity or a piston may add to a speed.
    The sum of the speeds is exactly rounded, so neither the order of memory nor the processor has a say in it.
    """
    n = len(gas)
    speeds = np.sqrt(gas.velocity[:, 0] ** 2 + gas.velocity[:, 1] ** 2)
    rate = (math.fsum(speeds.tolist()) / n + extra_speed) * encounters + narrow_encounters(gas, periodic)
    if rate == 0.0:
        return math.inf
    way = 2.0 * LONGEST_WAY * float(gas.radius.min()) / (float(speeds.max()) + extra_speed)
    shortest = FEWEST_PER_DISC * n / rate
    longest = max(EVENTS_PER_DISC * n, FEWEST_EVENTS) / rate
    return 2.0 ** math.floor(math.log2(min(max(way, shortest), longest)))


def speed_beyond(gas: Gas, effects: Effects) -> float:
    """What the effects may add to the mean speed of the discs, length/time; a rough figure for epoch lengths."""
    speed = 0.0
    if effects.gravity is not None:
        speed += math.sqrt(math.hypot(*effects.gravity) * sum(gas.box))
    if effects.piston is not None:
        speed += abs(float(effects.piston[0].v))
    return speed
