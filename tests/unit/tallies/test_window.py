"""One log has one start of equilibrium, whatever analysis asks; some gases have none."""

import math

import pytest
from helpers.logs import gas, log_of, raised, species

from idealgas import analyse, open_log
from idealgas.analysis.heat_capacity.fluctuations import energy_series
from idealgas.errors import NotApplicableError

COLLISIONS = "collisions_per_disc = 150"
GAS = gas(60, 0.02, (1, 1), COLLISIONS)
UNLIKE = gas(240, 0.01, (1, 1), COLLISIONS, name="light", temperature=2) + species(
    "heavy", 80, 0.015, mass=50, temperature=0.1
)
GATE = 'wall = [{ name = "gate", from = [1, 0], to = [1, 1], opens_at = 3 }]'
EXPANSION = gas(60, 0.02, (2, 1), "until = 60", region=[0, 0, 1, 1], then=GATE)


def starts(log, *names):
    return {analyse(log, name).as_dict()["window"]["start"] for name in names}


def test_one_start_for_all_analyses():
    log = log_of(UNLIKE)
    (start,) = starts(log, "temperature", "pressure", "transport", "profile", "histogram")
    assert 0 < start < 0.5 * log.end_time  # the heavy discs take some 25 of 150 collisions for a factor e
    with open_log(log.path) as opened:
        assert starts(opened, "profile") == {start}  # which no other analysis has found before


@pytest.mark.parametrize(
    "scene",
    [
        gas(100, 0.01, (1, 1), "collisions_per_disc = 40", speed=1),
        gas(400, 0.005, (1, 1), "collisions_per_disc = 60", name="light", temperature=2)
        + species("heavy", 100, 0.01, mass=10, temperature=0.5),
    ],
    ids=["equal speeds", "two temperatures"],
)
def test_transients_of_short_runs_are_left_out(scene):
    assert min(starts(log_of(scene, f"scene.seed={seed}"), "temperature").pop() for seed in range(12)) > 0


def test_start_is_after_a_gate_has_opened():
    (start,) = starts(log_of(EXPANSION), "profile", "temperature")
    assert 3 < start < 20
    assert energy_series(log_of(EXPANSION, "log.events=false", "log.snapshot_every=0.5")).start >= 3
    late = log_of(EXPANSION, "wall.gate.opens_at=59.9")
    why = r"the scene changes at t = 59\.9, with too little"
    raised(why, analyse, late, "profile", error=NotApplicableError)


def test_start_is_after_a_gas_has_filled_its_box():
    half = gas(200, 0.05, (10, 10), "collisions_per_disc = 60", region=[0, 0, 5, 10])
    actual = [starts(log_of(half, f"scene.seed={seed}"), "profile").pop() for seed in range(1, 8)]
    assert min(actual) > 0
    assert sorted(actual)[3] > 2  # a disc of the mean speed crosses the empty half in 4
    assert max(actual) < 20


def test_steady_gas_is_kept():
    assert starts(log_of(GAS), "pressure", "profile") == {0.0}


def test_a_dense_mixture_in_equilibrium_is_kept():
    """Of 20 discs at φ = 0.45, whose places change slowly; at most one of 12 short runs loses more than a tenth."""
    radius, lost = (2 * 0.45 / (20 * math.pi * (1 + 1.6**2))) ** 0.5, 0
    mixture = gas(10, radius, (1, 1), "collisions_per_disc = 300") + species("heavy", 10, 1.6 * radius, mass=3)
    for seed in range(12):
        log = log_of(mixture, f"scene.seed={seed}")
        lost += starts(log, "temperature").pop() > 0.1 * log.end_time
    assert lost <= 1


@pytest.mark.parametrize(
    "overrides",
    [("restitution.normal=0.9",), ("box.size=[2, 1]", "piston=[{velocity=-0.05}]", "run={until=10}")],
    ids=["cooling", "driven"],
)
def test_gas_that_is_never_in_equilibrium(overrides):
    log = log_of(GAS, *overrides)
    for analysis in ("temperature", "profile"):
        raised(r"requires equilibrium, but .*evolution.*--from", analyse, log, analysis, error=NotApplicableError)
        assert analyse(log, analysis, start=1.0).as_dict()["window"]["start"] == 1.0


def test_gas_that_still_changes_at_the_end():
    """Discs go through a slit one by one, from the left into the void."""
    slit = "wall = [{ from = [1, 0], to = [1, 0.47] }, { from = [1, 0.53], to = [1, 1] }]"
    log = log_of(gas(400, 0.005, (2, 1), "until = 15", region=[0, 0, 1, 1], then=slit))
    raised("still changes in the second half", analyse, log, "temperature", error=NotApplicableError)


def test_temperature_between_walls_of_two_temperatures():
    log = log_of(GAS, "box.left={ thermal = 2 }", "box.right={ thermal = 1 }")
    why = r"walls have 2 temperatures.*profile"
    raised(why, analyse, log, "temperature", error=NotApplicableError)
    assert analyse(log, "temperature", start=0.5).as_dict()["species"]
    assert analyse(log, "profile").as_dict()["window"]["equilibration_detected"]
