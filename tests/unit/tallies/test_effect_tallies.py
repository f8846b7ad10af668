"""Tallies of gases that fall or go round, against slow and obvious computations."""

from itertools import pairwise

import numpy as np
import pytest
from helpers.logs import gas, log_of, streamed
from scipy.integrate import quad

from idealgas.tallies.flights import Moments
from idealgas.tallies.impacts import Impacts

GAS = gas(9, 0.3, (6, 5), "events = 300", mass=2.0, seed=3)


def test_moments_of_falling_discs():
    """Every flight integrated numerically, cut at the blocks' edges."""
    log = log_of(GAS, "gravity.acceleration=[0.3, -0.7]")
    edges, g = np.linspace(0.2, 0.8, 4) * log.end_time, np.array(log.gravity)
    tally = streamed(log, edges, Moments(log.gravity))
    for block, (start, end) in enumerate(pairwise(edges)):
        state = log.state_at(start)
        flights = [(d, start, state.velocity[d]) for d in range(len(log.discs))]
        (rows,) = log.chunks(None, log.row_at(start, "right"), log.row_at(end, "right"))
        since, sums = {d: (t, v) for d, t, v in flights}, np.zeros(3)
        ends = [
            *zip(rows.disc.tolist(), rows.time.tolist(), rows.velocity, strict=True),
            *((d, end, None) for d in since),
        ]
        for disc, time, after in ends:
            began, v = since[disc]
            powers = (lambda v: np.hypot(*v), lambda v: 2 * v[0] ** 2, lambda v: 2 * v[1] ** 2)
            for k, power in enumerate(powers):
                sums[k] += quad(lambda t: power(v + g * (t - began)), began, time, epsabs=1e-12)[0]  # noqa: B023
            since[disc] = (time, after)
        assert tally.flights[block, 0] == pytest.approx(sums, rel=1e-9)


@pytest.mark.parametrize("sides", [("periodic", "periodic"), ("periodic", "reflecting")], ids=str)
def test_virial_of_pairs_across_joined_sides(sides):
    """Every collision by itself, between the nearest of all images."""
    x, y = sides
    log = log_of(GAS, f'box={{size = [3, 4], left = "{x}", right = "{x}", bottom = "{y}", top = "{y}"}}')
    edges = np.array([0.1, 0.9]) * log.end_time
    tally = streamed(log, edges, Impacts(len(log.walls), log.periodic))
    (rows,) = log.chunks(None, log.row_at(edges[0], "right"), log.row_at(edges[1], "right"))
    shifts = [np.array(k) * log.box for k in np.ndindex(3, 3)]
    velocity, virial, pairs, wrapped = log.state_at(edges[0]).velocity, 0.0, 0, 0
    for row, (i, j) in enumerate(zip(rows.disc.tolist(), rows.partner.tolist(), strict=True)):
        if j > i:  # the first of a pair's two rows
            apart = rows.position[row] - rows.position[row + 1]
            images = [apart + shift - log.box for shift in shifts]
            nearest = min(images, key=lambda r: r @ r)
            assert np.hypot(*nearest) == pytest.approx(0.6, rel=1e-12)
            virial += nearest @ (2.0 * (rows.velocity[row] - velocity[i]))
            pairs, wrapped = pairs + 1, wrapped + (nearest != apart).any()
        velocity[i] = rows.velocity[row]
    assert tally.pair_virial.sum() == pytest.approx(virial, rel=1e-12)
    assert (tally.collisions.sum(), wrapped > 0) == (2 * pairs, True)
