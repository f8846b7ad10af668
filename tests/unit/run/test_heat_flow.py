"""The sums of the flow of heat: the same bits by every method and with breaks, and those that the events add up to."""

import numpy as np
import pytest
from helpers.log_compare import contents, differences
from helpers.support import refused

from idealgas.log import open_log
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene
from idealgas.tallies.currents import CARRIED, HEAT_X, HEAT_Y, PASSED_ON, Currents
from idealgas.tallies.stream import stream

GAS = """
scene.seed = 3
box = {size = [16, 12], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic"}
species = [{name = "gas", count = 60, radius = 0.4, temperature = 1.0}]
disc = [{position = [8, 6], velocity = [9, -7], radius = 0.4}]
run.events = 12_000
log = {pressure = true, heat_flow = true, snapshot_every = 2.0}
"""
SUMS = {"kinetic_heat_flow": CARRIED, "collision_heat_flow": PASSED_ON}


def run(path, *overrides):
    simulate(parse_scene(GAS, overrides=overrides), path)
    return path


@pytest.fixture(scope="module")
def whole(tmp_path_factory):
    return run(tmp_path_factory.mktemp("heat") / "run.h5")


@pytest.mark.slow
def test_the_sums_are_those_of_the_events(whole):
    """In blocks of time between samples, in a gas that moves as a whole."""
    with open_log(whole) as log:
        assert np.abs(log.observables["momentum"][1][0]).min() > 1
        time = log.observables["energy"][0]
        currents = Currents()
        stream(log, time, [currents])
        for name, part in SUMS.items():
            result, expected = np.diff(log.observables[name][1], axis=0), currents.flow[:, part, HEAT_X : HEAT_Y + 1]
            assert np.abs(result - expected).max() < 1e-11 * np.abs(expected).max()


@pytest.mark.slow
@pytest.mark.parametrize("override", ["run.threads=2", "run.method=brute_force"])
def test_the_same_bits_in_other_ways(tmp_path, override):
    ways = run(tmp_path / "one.h5", "run.events=3000"), run(tmp_path / "other.h5", "run.events=3000", override)
    assert [name for name in differences(*ways) if name != "scene"] == []


def same_but(whole, other, left_out):
    """Whether two logs are the same bit for bit but for some of what they hold, by parts of its names."""
    first, second = (
        {name: value for name, value in contents(path).items() if not any(part in name for part in left_out)}
        for path in (whole, other)
    )
    assert first.keys() == second.keys()
    return all(np.array_equal(first[name], second[name]) for name in first if name != "scene")


@pytest.mark.slow
def test_the_same_bits_without_events_resumed_and_without_the_flow_of_heat(whole, tmp_path):
    assert same_but(whole, run(tmp_path / "eventless.h5", "log.events=false"), ("events/", "row", "summary"))
    part = run(tmp_path / "part.h5", "run.events=8000")
    resume(part, ["run.events=12000"])
    assert differences(part, whole) == []
    # All but the scene and these sums.
    other = run(tmp_path / "plain.h5", "log.heat_flow=false")
    assert same_but(whole, other, ("heat_flow",))
    assert not any("heat_flow" in name for name in contents(other))


@pytest.mark.parametrize(
    ("overrides", "said"),
    [
        (
            ("log.pressure=false",),
            "only recorded together with the momentum flow (got pressure = false; allowed pressure",
        ),
        (
            ("box.left=", "box.right="),
            "walls exchange heat and momentum with the gas (got sides that reflect; allowed four periodic",
        ),
        (("restitution.normal=0.9",), "changes velocities between collisions (got restitution; allowed heat_flow ="),
        (("rotation.roughness=0.5",), "changes velocities between collisions (got rotation; allowed heat_flow ="),
    ],
)
def test_gases_without_it(overrides, said):
    assert said in "\n".join(refused(GAS, *overrides))
