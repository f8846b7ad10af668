"""A gas that is still far from equipartition is not taken to be in equilibrium, though it looks steady; others are."""

import pytest
from helpers.logs import gas, log_of, raised, species

from idealgas import analyse
from idealgas.errors import NotApplicableError

UNLIKE = gas(100, 0.05, (10, 10), "collisions_per_disc = 100", periodic="xy", name="light", temperature=2)
SUMS = "log = { events = false, pressure = true, snapshot_every = 2 }"


def bath(rate, then=""):
    return gas(100, 0.1, (10, 10), "until = 150", then=f"thermostat = {{ temperature = 4, rate = {rate} }}\n{then}")


def heavy(mass):
    return UNLIKE + species("heavy", 50, 0.05, temperature=0.2, mass=mass)


SLOW = {"heat bath": bath(0.002), "heavy discs": heavy(1000), "sums only": bath(0.002, SUMS)}
SHARED = {
    "heat bath": bath(0.2),
    "not so heavy discs": heavy(2),
    "sums only": bath(0.2, SUMS),
    "a single disc": gas(1, 0.1, (10, 10), "events = 500"),
}


@pytest.mark.parametrize("name", SLOW)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_slow_exchange_is_no_equilibrium(name, seed):
    log, why = (
        log_of(SLOW[name], f"scene.seed={seed}"),
        r"requires equilibrium, but (m v.² .* in equilibrium|the gas still changes)",
    )
    raised(why, analyse, log, "pressure", error=NotApplicableError)


@pytest.mark.parametrize("name", SHARED)
def test_gases_that_share_their_energy(name):
    """Of 40 gases in a heat bath one lost more: the median of three does not."""
    windows = [analyse(log_of(SHARED[name], f"scene.seed={seed}"), "pressure").window for seed in (1, 2, 3)]
    assert all(window.detected for window in windows)
    assert sorted(window.start / window.end for window in windows)[1] < 0.3
