"""One log has one start of equilibrium, whatever analysis asks; some gases have none."""

import math

import pytest

from idealgas import analyse, open_log, parse_scene, simulate
from idealgas.analysis.heat_capacity.fluctuations import energy_series
from idealgas.errors import NotApplicableError

GAS = '[[species]]\nname = "gas"\ncount = 60\nradius = 0.02\ntemperature = 1\n'
RUN = "[run]\ncollisions_per_disc = 150\n"
BOX = "[box]\nsize = [1, 1]\n"
LIGHT_AND_HEAVY = (
    '[[species]]\nname = "light"\ncount = 240\nradius = 0.01\ntemperature = 2\n'
    '[[species]]\nname = "heavy"\ncount = 80\nradius = 0.015\nmass = 50\ntemperature = 0.1\n'
)
EXPANSION = (
    '[box]\nsize = [2, 1]\n[[wall]]\nname = "gate"\nfrom = [1, 0]\nto = [1, 1]\nopens_at = 3\n'
    + GAS
    + "region = [0, 0, 1, 1]\n[run]\nuntil = 60\n"
)
NEVER = {
    "cooling": BOX + GAS + "[restitution]\nnormal = 0.9\n" + RUN,
    "driven": '[box]\nsize = [2, 1]\n[[piston]]\nside = "right"\nvelocity = -0.05\n' + GAS + "[run]\nuntil = 10\n",
}


@pytest.fixture
def log_of(tmp_path):
    """Log of a scene, given as text."""
    logs = []

    def run(text):
        simulate(parse_scene(text), tmp_path / "run.h5", force=True)
        logs.append(open_log(tmp_path / "run.h5"))
        return logs[-1]

    yield run
    for log in logs:
        log.close()


def starts(log, *names):
    return {analyse(log, name).as_dict()["window"]["start"] for name in names}


def test_one_start_for_all_analyses(log_of):
    log = log_of(BOX + LIGHT_AND_HEAVY + RUN)
    (start,) = starts(log, "temperature", "pressure", "transport", "profile", "histogram")
    assert 0 < start < 0.5 * log.end_time  # the heavy discs take some 25 of 150 collisions for a factor e
    with open_log(log.path) as opened:
        assert starts(opened, "profile") == {start}  # which no other analysis has found before


SHORT_TRANSIENTS = {
    "equal speeds": ('[[species]]\nname = "gas"\ncount = 100\nradius = 0.01\nspeed = 1\n', 40),
    "two temperatures": (
        '[[species]]\nname = "light"\ncount = 400\nradius = 0.005\ntemperature = 2\n'
        '[[species]]\nname = "heavy"\ncount = 100\nradius = 0.01\nmass = 10\ntemperature = 0.5\n',
        60,
    ),
}


@pytest.mark.parametrize("name", SHORT_TRANSIENTS)
def test_transients_of_short_runs_are_left_out(name, log_of):
    discs, collisions = SHORT_TRANSIENTS[name]
    run = f"[run]\ncollisions_per_disc = {collisions}\n"
    found = [starts(log_of(f"scene.seed = {seed}\n{BOX}{discs}{run}"), "temperature").pop() for seed in range(12)]
    assert min(found) > 0


def test_start_is_after_a_gate_has_opened(log_of):
    log = log_of(EXPANSION)
    (start,) = starts(log, "profile", "temperature")
    assert 3 < start < 20


def test_samples_of_the_energy_count_from_when_a_gate_has_opened(log_of):
    assert energy_series(log_of(EXPANSION + "[log]\nevents = false\nsnapshot_every = 0.5\n")).start >= 3


def test_start_is_after_a_gas_has_filled_its_box(log_of):
    half = '[[species]]\nname = "a"\ncount = 200\nradius = 0.05\ntemperature = 1\nregion = [0, 0, 5, 10]\n'
    box = "[box]\nsize = [10, 10]\n"
    found = [
        starts(log_of(f"scene.seed = {seed}\n{box}{half}[run]\ncollisions_per_disc = 60\n"), "profile").pop()
        for seed in range(1, 8)
    ]
    assert min(found) > 0
    assert sorted(found)[3] > 2  # a disc of the mean speed crosses the empty half in 4
    assert max(found) < 20


def test_a_gate_that_opens_near_the_end_leaves_no_equilibrium(log_of):
    log = log_of(EXPANSION.replace("opens_at = 3", "opens_at = 59.9"))
    with pytest.raises(NotApplicableError, match=r"the scene changes at t = 59\.9, with too little"):
        analyse(log, "profile")


def test_steady_gas_is_kept(log_of):
    assert starts(log_of(BOX + GAS + RUN), "pressure", "profile") == {0.0}


def test_a_dense_mixture_in_equilibrium_is_kept(log_of):
    """Of 20 discs at φ = 0.45, whose places change slowly; at most one of 12 short runs loses more than a tenth."""
    radius = (2 * 0.45 / (20 * math.pi * (1 + 1.6**2))) ** 0.5
    each = '[[species]]\nname = "{}"\ncount = 10\nradius = {!r}\nmass = {}\ntemperature = 1\n'
    discs = each.format("light", radius, 1) + each.format("heavy", 1.6 * radius, 3)
    run, lost = "[run]\ncollisions_per_disc = 300\n", 0
    for seed in range(12):
        log = log_of(f"scene.seed = {seed}\n{BOX}{discs}{run}")
        lost += starts(log, "temperature").pop() > 0.1 * log.end_time
    assert lost <= 1


@pytest.mark.parametrize("name", NEVER)
def test_gas_that_is_never_in_equilibrium(name, log_of):
    log = log_of(NEVER[name])
    for analysis in ("temperature", "profile"):
        with pytest.raises(NotApplicableError, match=r"no equilibrium, as .*evolution.*--from") as refused:
            analyse(log, analysis)
        assert "\n" not in str(refused.value)
        assert analyse(log, analysis, start=1.0).as_dict()["window"]["start"] == 1.0


def test_gas_that_still_changes_at_the_end(log_of):
    """Discs go through a slit one by one, from the left into the void."""
    slit = (
        '[[wall]]\nfrom = [1, 0]\nto = [1, 0.47]\n[[wall]]\nfrom = [1, 0.53]\nto = [1, 1]\n[[species]]\nname = "gas"\n'
        "count = 400\nradius = 0.005\ntemperature = 1\nregion = [0, 0, 1, 1]\n"
    )
    log = log_of("[box]\nsize = [2, 1]\n" + slit + "[run]\nuntil = 15\n")
    with pytest.raises(NotApplicableError, match="still changes in the second half"):
        analyse(log, "temperature")


def test_temperature_between_walls_of_two_temperatures(log_of):
    log = log_of("[box]\nsize = [1, 1]\nleft = { thermal = 2 }\nright = { thermal = 1 }\n" + GAS + RUN)
    with pytest.raises(NotApplicableError, match=r"walls have 2 temperatures.*profile"):
        analyse(log, "temperature")
    assert analyse(log, "temperature", start=0.5).as_dict()["species"]
    assert analyse(log, "profile").as_dict()["window"]["equilibration_detected"]
