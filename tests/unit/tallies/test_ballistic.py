"""Histograms of velocities and free paths of discs that fall, against sampling at many times."""

import numpy as np
import pytest
from helpers.logs import gas, streamed
from scipy.integrate import quad

from idealgas.tallies.flights import VELOCITY_QUANTITIES, VelocityHistogram
from idealgas.tallies.intervals import FreeFlights

GAS = gas(9, 0.3, (6, 5), "events = 200", mass=2.0, seed=3, then="gravity.acceleration = [0.3, -0.7]")

VALUES = {
    "speed": lambda v: np.hypot(*v.T),
    "vx": lambda v: v[:, 0],
    "vy": lambda v: v[:, 1],
    "energy": lambda v: (v**2).sum(axis=1),
}


@pytest.mark.slow
@pytest.mark.parametrize("quantity", VELOCITY_QUANTITIES)
@pytest.mark.parametrize("gravity", ["[0.3, -0.7]", "[0, -0.7]", "[0.4, 0]"])
def test_time_in_each_bin_of_falling_discs(quantity, gravity, make):
    log = make(f"gravity.acceleration={gravity}")
    edges = np.linspace(0.2, 0.8, 4) * log.end_time
    low, high = (-3.0, 3.0) if quantity in ("vx", "vy") else (0.0, 3.0)
    tally = streamed(
        log, edges, VelocityHistogram(quantity, np.array([low]), np.array([high]), 10, np.array([2, 5]), log.gravity)
    )
    steps = 4000
    for block in range(3):
        width = edges[block + 1] - edges[block]
        times = edges[block] + width * (np.arange(steps) + 0.5) / steps
        values = np.concatenate([VALUES[quantity](state.velocity) for state in log.frames(times)])
        bins = np.array([-np.inf, *np.linspace(low, high, 11), np.inf])
        counted = np.histogram(values, bins)[0] * width / steps
        assert tally.counts[block, 0] == pytest.approx(counted, abs=20 * width / steps)
        assert tally.counts[block].sum() == pytest.approx(9 * width, rel=1e-12)
        assert tally.sums[block, 0] == pytest.approx(values.sum() * width / steps, abs=20 * width / steps)
    for k in range(2):
        state = log.state_at(edges[k + 1])
        assert tally.snapshots[k] == pytest.approx(VALUES[quantity](state.velocity[[2, 5]]), rel=1e-12)


def test_free_paths_of_falling_discs_are_arcs(make):
    log = make()
    edges = np.array([0.0, log.end_time])
    tally = streamed(log, edges, FreeFlights(True, np.array([10.0]), 5, 1, 10_000))
    g, arcs = np.array(log.gravity), []
    start = log.state_at(0.0)
    last = {disc: (0.0, start.velocity[disc], 0.0, False) for disc in range(9)}
    for batch in log.chunks():
        for time, disc, partner, velocity in zip(batch.time, batch.disc, batch.partner, batch.velocity, strict=True):
            began, v, path, counts = last[disc]
            path += quad(lambda t: np.hypot(*(v + g * t)), 0, time - began, epsabs=1e-12)[0]  # noqa: B023
            if partner >= 0:
                arcs += [path] if counts else []
                path, counts = 0.0, True
            last[disc] = time, velocity, path, counts
    assert len(arcs) > 50
    assert tally.sums.sum() == pytest.approx(sum(arcs), rel=1e-9)
    assert sorted(tally.sample) == pytest.approx(sorted(arcs), rel=1e-8)
