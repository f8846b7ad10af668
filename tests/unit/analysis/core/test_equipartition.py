"""A gas that is still far from equipartition is not taken to be in equilibrium, though it looks steady; others are."""

import pytest

from idealgas import analyse, open_log, parse_scene, simulate
from idealgas.errors import NotApplicableError

BOX = "[box]\nsize = [10, 10]\n"
PERIODIC = "".join(f'{side} = "periodic"\n' for side in ("left", "right", "bottom", "top"))
GAS = '[[species]]\nname = "a"\ncount = 100\nradius = 0.1\ntemperature = 1\n'
BATH = "[thermostat]\ntemperature = 4\nrate = {}\n[run]\nuntil = 150\n"
LIGHT_AND_HEAVY = (
    '[[species]]\nname = "light"\ncount = 100\nradius = 0.05\ntemperature = 2\n'
    '[[species]]\nname = "heavy"\ncount = 50\nradius = 0.05\ntemperature = 0.2\nmass = {}\n'
    "[run]\ncollisions_per_disc = 100\n"
)
SUMS = "[log]\nevents = false\npressure = true\nsnapshot_every = 2\n"
SLOW = {
    "heat bath": BOX + GAS + BATH.format(0.002),
    "heavy discs": BOX + PERIODIC + LIGHT_AND_HEAVY.format(1000),
    "sums only": BOX + GAS + BATH.format(0.002) + SUMS,
}
SHARED = {
    "heat bath": BOX + GAS + BATH.format(0.2),
    "not so heavy discs": BOX + PERIODIC + LIGHT_AND_HEAVY.format(2),
    "sums only": BOX + GAS + BATH.format(0.2) + SUMS,
    "a single disc": BOX + GAS.replace("100", "1") + "[run]\nevents = 500\n",
}


def pressure_of(text, seed, folder):
    simulate(parse_scene(text, overrides=[f"scene.seed={seed}"]), folder / "run.h5", force=True)
    with open_log(folder / "run.h5") as log:
        return analyse(log, "pressure")


@pytest.mark.parametrize("name", SLOW)
@pytest.mark.parametrize("seed", [1, 2, 3])
def test_slow_exchange_is_no_equilibrium(name, seed, tmp_path):
    with pytest.raises(NotApplicableError, match=r"no equilibrium, as (m v.² .* in equilibrium|it still changes)"):
        pressure_of(SLOW[name], seed, tmp_path)


@pytest.mark.parametrize("name", SHARED)
def test_gases_that_share_their_energy(name, tmp_path):
    """Of 40 gases in a heat bath one lost more: the median of three does not."""
    windows = [pressure_of(SHARED[name], seed, tmp_path).window for seed in (1, 2, 3)]
    assert all(window.detected for window in windows)
    assert sorted(window.start / window.end for window in windows)[1] < 0.3
