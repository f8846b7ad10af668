import math
from itertools import product

import numpy as np
import pytest

from idealgas.engine.diagnostics import deepest_overlap
from idealgas.physics.periodic import Periodic
from idealgas.physics.shear import Shear
from idealgas.state import Gas

WIDTH, HEIGHT, AHEAD = 7.0, 5.0, 2.5


def all_overlaps(gas, periodic, ahead, here):
    """Overlaps of all pairs by the images next to the box, of which those above are ahead."""
    images = [(-1, 0, 1) if on else (0,) for on in periodic]
    for i, k in zip(*np.triu_indices(len(gas), 1), strict=True):
        if here[i] and here[k]:
            for x, y in product(*images):
                shift = np.array([x * WIDTH + y * ahead, y * HEIGHT])
                distance = math.hypot(*(gas.position[i] - gas.position[k] - shift))
                yield 1 - distance / (gas.radius[i] + gas.radius[k])


@pytest.mark.interpreted
@pytest.mark.parametrize(
    ("periodic", "ahead"),
    [(both, 0.0) for both in product((False, True), repeat=2)] + [((True, True), AHEAD), ((True, True), -AHEAD)],
)
@pytest.mark.parametrize("seed", range(6))
def test_the_deepest_overlap_is_that_of_all_pairs(periodic, ahead, seed):
    draw = np.random.default_rng(seed)
    position, radius = draw.uniform(0, (WIDTH, HEIGHT), (60, 2)), draw.choice([0.05, 0.2], 60)
    absorbing, here = None, np.ones(60, bool)
    if not any(periodic):
        position[:5], here[:5], absorbing = math.nan, False, np.ones(1, bool)
    gas = Gas((WIDTH, HEIGHT), position, np.zeros((60, 2)), radius, np.ones(60), np.zeros(60, np.uint16), ("gas",))
    shear = Shear(1.0, HEIGHT, WIDTH, HEIGHT, np.array([ahead, ahead])) if ahead else None
    counts = np.zeros((60, 2), np.int32)
    sides = Periodic(periodic[0], periodic[1] and not ahead, WIDTH, HEIGHT, counts, shear)
    expected = max(all_overlaps(gas, periodic, ahead, here))
    assert deepest_overlap(gas, sides if any(periodic) else None, absorbing) == pytest.approx(expected, abs=1e-14)
