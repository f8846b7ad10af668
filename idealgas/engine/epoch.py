"""Length of epochs. At the end of an epoch all discs are moved to the same time, and local times restart from 0."""

import math
from collections.abc import Sequence

import numpy as np

from idealgas.effects.bundle import Effects, present
from idealgas.physics.collision_rates import collisions_per_length
from idealgas.physics.motion import MAX_DISPLACEMENT
from idealgas.physics.noninteracting import wall_hits_per_length
from idealgas.physics.periodic import periodic_axes
from idealgas.state import Gas

EVENTS_PER_DISC = 64  # largest number of events per disc in an epoch; the smallest is half as large
EVENTS_OF_FEW = 1024  # largest number of events in an epoch of a few discs; the smallest is a quarter of it
MOST_CROSSINGS = 8192  # crossings of periodic sides by the fastest disc: predictions store their number in 16 bits
FEWEST_PER_DISC = 4  # events per disc, however long the free paths; an epoch's start takes as long as 1 event per disc
FEWEST_EVENTS = 512  # events in all, however few discs; an epoch's start takes as long as several hundred events
UNDECIDED = 1e-6  # if the exponent is this close to an integer, speeds are summed exactly; NumPy's error is far smaller


def encounters_per_length(gas: Gas, periodic: Sequence[bool] = (False, False)) -> float:
    """Return the number of encounters of all discs per distance that each disc travels, 1/length, from kinetic theory.

    Encounters with discs and with sides are counted; `narrow_side_hit_rate` is for sides that leave a disc less room
    than its diameter. periodic: whether the sides along x and along y are periodic.
    """
    n = len(gas)
    mean_diameter = 2.0 * math.fsum(gas.radius.tolist()) / n
    phi = math.pi * math.fsum((gas.radius**2).tolist()) / gas.area
    return collisions_per_length(n, mean_diameter, float(gas.radius.max()), phi, gas.box, periodic)


def encounters_of_effects(gas: Gas, effects: Effects) -> float:
    """Return `encounters_per_length`; for discs that do not interact, walls inside the box replace the other discs."""
    periodic = periodic_axes(effects.periodic)
    if effects.noninteracting is None:
        return encounters_per_length(gas, periodic)
    largest = float(gas.radius.max())
    sides = collisions_per_length(1, 2.0 * largest, largest, 0.0, gas.box, periodic)
    segments = () if effects.segments is None else effects.segments[["length", "radius"]].tolist()
    return len(gas) * (sides + wall_hits_per_length(segments, gas.area))


def narrow_side_hit_rate(gas: Gas, periodic: Sequence[bool]) -> float:
    """Estimate the rate of hits, 1/time, on sides that leave the largest disc less room than its diameter.

    The rate is computed from the velocities along the narrow axis, because the direction of motion matters there.
    """
    rate, diameter = 0.0, 2.0 * float(gas.radius.max())
    for axis, (length, on) in enumerate(zip(gas.box, periodic, strict=True)):
        if not on and 0.0 < length - diameter <= diameter:
            room = length - 2.0 * gas.radius
            rate += math.fsum((np.abs(gas.velocity[:, axis]) / room).tolist())
    return rate


def epoch_length(
    gas: Gas,
    encounters: float,
    extra_speed: float = 0.0,
    periodic: Sequence[bool] = (False, False),
    thermostat_collisions: float = 0.0,
    fall: float = 0.0,
    interacting: bool = True,
) -> float:
    """Return the length of an epoch, time: a power of two such that 32 to 64 events per disc are expected.

    In a dilute gas there are fewer events per disc, but at least 256 to 512 events in all; otherwise starting an epoch
    would take longer than its events. If the last digits of the sum of the speeds determine the power of two, the sum
    is correctly rounded, so that the length depends on neither the order of the discs nor the processor.

    For discs that do not interact, the result does not depend on their number, on discs at rest or outside, or on the
    last digits of the speeds. Among equal discs with equal speeds, each disc therefore moves exactly as if alone.

    Args:
        gas: the gas at the start of the epoch.
        encounters: number of encounters per length, see `encounters_per_length`, 1/length.
        extra_speed: expected increase in the speeds due to gravity, a piston or a heat bath, length/time.
        periodic: whether the sides along x and along y are periodic.
        thermostat_collisions: rate of the collisions with the heat bath, 1/time.
        fall: acceleration along periodic axes, length/time². The epoch is so short that no disc gains more than the
            largest speed from this acceleration.
        interacting: whether discs collide with each other.

    Returns:
        The length of the epoch; infinite if there are no events.
    """
    n = len(gas)
    speeds = np.sqrt(gas.velocity[:, 0] ** 2 + gas.velocity[:, 1] ** 2)
    in_motion = n if interacting else int(np.count_nonzero(speeds)) or 1
    fastest = float(speeds.max()) + extra_speed
    other_events = narrow_side_hit_rate(gas, periodic) + thermostat_collisions
    displacement = 2.0 * MAX_DISPLACEMENT * float(gas.radius.min())
    round_the_box = MOST_CROSSINGS * min(
        (length for length, on in zip(gas.box, periodic, strict=True) if on), default=math.inf
    )

    def exponent(sum_of_speeds: float) -> float:
        """Base-2 logarithm of the longest duration of an epoch; infinite if there are no events."""
        rate = (sum_of_speeds / in_motion + extra_speed) * encounters + other_events
        longest = fastest / fall if fall else math.inf
        if rate == 0.0:
            return math.log2(longest)
        if not interacting:
            return math.log2(min(EVENTS_PER_DISC * n / rate, round_the_box / fastest, longest)) + UNDECIDED
        shortest = min(max(FEWEST_PER_DISC * n, FEWEST_EVENTS) / rate, round_the_box / fastest)
        longest = min(longest, max(EVENTS_PER_DISC * n, EVENTS_OF_FEW) / rate)
        return math.log2(min(max(displacement / fastest, shortest), longest))

    power = exponent(float(speeds.sum()))
    if math.isinf(power):
        return math.inf
    if abs(power - round(power)) < UNDECIDED:
        power = exponent(math.fsum(speeds.tolist()))
    return 2.0 ** math.floor(power)


def fall_along_sides(effects: Effects) -> float:
    """Return the largest acceleration along a periodic axis, length/time²; 0 if there is none."""
    if effects.gravity is None:
        return 0.0
    both = zip(effects.gravity, periodic_axes(effects.periodic), strict=True)
    return max((abs(component) for component, on in both if on), default=0.0)


def driving_speed(gas: Gas, effects: Effects) -> float:
    """Estimate the increase in the mean speed of the discs due to gravity, moving walls or a heat bath, length/time."""
    return sum(effect.driving_speed(state, gas) for effect, state in present(effects))
