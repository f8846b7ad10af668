"""How the averages of a gas that moves in time steps go wrong with the step."""

import math

import numpy as np
from helpers.support import gas_of

from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation
from idealgas.engine.time_driven import TimeDriven

BLOCKS = 40
NUMBER, RADIUS = 400, 0.5
SIDE = math.sqrt(NUMBER * math.pi * RADIUS**2 / 0.4)


def gas():
    """At φ = 0.4 and temperature 1, from a lattice."""
    random = np.random.default_rng(5)
    k = math.isqrt(NUMBER)
    place = (np.stack(np.meshgrid(np.arange(k), np.arange(k)), axis=-1).reshape(-1, 2) + 0.5) * SIDE / k
    velocity = random.standard_normal((NUMBER, 2))
    velocity -= velocity.mean(axis=0)
    velocity *= math.sqrt(2 * NUMBER / (velocity**2).sum())
    return gas_of((SIDE, SIDE), place, velocity, RADIUS)


def rate(method, width=12.0):
    """Collisions per time, from blocks after the first two, with its standard error."""
    simulation = Simulation(gas(), method)
    counts = []
    for k in range(1, BLOCKS + 3):
        simulation.run(pause=k * width)
        counts.append(simulation.counters.disc_collisions)
    rates = np.diff(counts[1:]) / width
    return rates.mean(), rates.std(ddof=1) / math.sqrt(len(rates))


def test_the_collision_rate_is_too_low_in_proportion_to_the_step():
    """A contact is found dt/2 late and lasts as long again, so pairs spend Γdt of their time overlapping.

    They take less of each other's room by that, and meet more rarely: a bias of first order in dt (what is missed is of
    second order). Then twice the bias at dt is that at 2dt, but for the second order: the exponent between both is 1.
    k = 4 standard errors; the bias at the larger step is 40 of them.
    """
    exact, error = rate(EventDriven())
    dt = 0.02 * 2 * RADIUS
    bias, spread = np.array([np.array(rate(TimeDriven(step))) / exact - (1, 0) for step in (dt, 2 * dt, 4 * dt)]).T
    spread = np.hypot(spread, error / exact)
    assert (bias < 0).all()
    assert -bias[2] > 40 * spread[2]
    order = np.diff(np.log2(-bias))
    uncertainty = np.hypot(spread[1:] / bias[1:], spread[:-1] / bias[:-1]) / math.log(2)
    assert (np.abs(order - 1) < 4 * uncertainty).all()
    assert uncertainty.max() < 0.2
