"""Collision rates of discs that rarely meet."""

import numpy as np
import pytest
from helpers.logs import gas, species

from idealgas import pressure

GAS = gas(50, 0.1, (10, 10), "until = 200", seed=1).replace(
    "[[species]]", f"{species('grain', 2, 0.5, mass=20)}\n[[species]]"
)


def test_few_collisions_are_few_samples(log):
    """An error from n events is known no better than from n samples."""
    result = pressure(log)
    duration = result.window.duration
    inside = np.concatenate([b.time > result.window.start for b in log.chunks()])
    disc, partner = (np.concatenate([getattr(b, name) for b in log.chunks()])[inside] for name in ("disc", "partner"))
    (rate,) = [r.rate for r in result.collision_rates if r.species == r.other == "grain"]
    events = ((disc < 2) & (partner >= 0) & (partner < 2)).sum() / 2
    assert 1 < events < 20
    assert rate.independent_samples <= events
    assert rate.value == pytest.approx(events / duration)
