"""Sums of a run: the same bits with events and without, with breaks and without; and what the events add up to."""

import numpy as np
import pytest
from helpers.log_compare import differences, scene_of
from helpers.support import logged, refused

from idealgas.analysis.pressure.measure import pressure
from idealgas.analysis.status import status
from idealgas.errors import UserError
from idealgas.log import open_log
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene
from idealgas.tallies.impacts import Impacts
from idealgas.tallies.samples import SampledImpacts
from idealgas.tallies.stream import stream

pytestmark = pytest.mark.slow

SUMS = ("kinetic_flow", "collision_flow", "wall_virial", "face_normal_impulse", "face_tangential_impulse")

GAS = """
scene.seed = 3
box.size = [16, 12]
species = [{name = "gas", count = 60, radius = 0.4, temperature = 1.0}]
run.events = 30_000
log = {pressure = true, snapshot_every = 2.0}
"""
MIXTURE = """species = [
    {name = "a", count = 40, radius = 0.4, temperature = 1},
    {name = "b", count = 20, radius = 0.3, mass = 3, temperature = 2},
]
"""
CASES = {
    "walls": GAS,
    "mixture": GAS.replace(GAS.splitlines()[3] + "\n", MIXTURE),
    "periodic": GAS + 'box.left = "periodic"\nbox.right = "periodic"\n',
    "everything": GAS
    + "rotation = {roughness = 0.4, wall_roughness = 0.2}\nrestitution = {normal = 0.97, wall = 0.9}\n"
    + "gravity.acceleration = [0.1, -0.3]\nbox.bottom = { thermal = 1.5 }\n"
    + 'wall = [{name = "shelf", from = [3, 4], to = [7, 6]}, {from = [10, 1], to = [10, 5], opens_at = 9}]\n'
    + 'piston = [{side = "right", velocity = -0.01}]\nrun.until = 300\n',
}


def run(case, path, *overrides):
    simulate(parse_scene(CASES[case], overrides=overrides), path)
    return path


@pytest.fixture(
    scope="module",
    params=[pytest.param(case, marks=pytest.mark.long if case == "everything" else ()) for case in CASES],
)
def whole(request, tmp_path_factory):
    """A case and its log, with events."""
    return request.param, run(request.param, tmp_path_factory.mktemp(request.param) / "run.h5")


def test_the_same_without_events(whole, tmp_path):
    case, path = whole
    other = run(case, tmp_path / "run.h5", "log.events=false")
    with open_log(path) as a, open_log(other) as b:
        assert a.observables.keys() == b.observables.keys() >= {*SUMS, "face_hits"}
        for name, (_, values) in a.observables.items():
            assert np.array_equal(values, b.observables[name][1]), name
        for each, same in zip(a.checkpoints, b.checkpoints, strict=True):
            assert all(np.array_equal(entry, same.arrays[name]) for name, entry in each.arrays.items())


def test_brute_force_has_the_same_sums(whole, tmp_path):
    case, _ = whole
    short = "run.events=4000"
    paths = [
        run(case, tmp_path / f"{method}.h5", short, f"run.method={method}")
        for method in ("event_driven", "brute_force")
    ]
    assert [name for name in differences(*paths) if name != "scene"] == []


def test_resumed(whole, tmp_path):
    case, path = whole
    part = run(case, tmp_path / "run.h5", "run.events=20000")
    resume(part, ["run.events=30000"])
    assert differences(part, path) == []


def test_snapshots_change_no_sum(whole, tmp_path):
    case, path = whole
    with open_log(path) as a, open_log(run(case, tmp_path / "run.h5", "log.snapshot_every=")) as b:
        assert len(a.observables["energy"][0]) > 2 * len(b.observables["energy"][0])
        for name in (f"{name}_sum" for name in SUMS):
            assert np.array_equal(a.checkpoints[-1].arrays[name], b.checkpoints[-1].arrays[name])
            assert np.any(a.checkpoints[-1].arrays[name])


def test_the_sums_are_those_of_the_events(whole):
    """Blocks of time between samples, whose events are added up one by one."""
    case, path = whole
    with open_log(path) as log:
        time = log.observables["energy"][0]
        edges = time[[2, 9, 10, 23, -1]]
        events, samples = Impacts(len(log.walls), log.periodic), SampledImpacts(log, edges)
        stream(log, edges, [events])
        assert np.array_equal(samples.hits, events.hits)
        assert np.array_equal(samples.collisions, events.collisions)
        assert events.hits.sum() > 500
        falls = any(log.gravity)  # then the velocity changes between events too, which these tallies take for impulse
        if not falls:
            for name in ("pair_virial", "wall_virial", "impulse"):
                result, expected = getattr(samples, name), getattr(events, name)
                scale = np.abs(expected).max()
                assert np.abs(result - expected).max() < 1e-12 * scale, name
    # Momentum at the samples, less what gravity gave, changes by what the faces received, normal and along.
    with open_log(path) as log:
        time, momentum = log.observables["momentum"]
        received = SampledImpacts(log, time).impulse.sum(axis=1)
        gained = np.diff(momentum, axis=0) - np.outer(np.diff(time), log.discs.mass.sum() * np.array(log.gravity))
        assert np.abs(gained + received).max() < 1e-9 * log.observables["face_normal_impulse"][1].max()
    # Its trace is the integral of twice the kinetic energy; where nothing changes that, the energy times time.
    if case != "everything":
        with open_log(path) as log:
            time, flow = log.observables["kinetic_flow"]
            energy = log.observables["kinetic_energy"][1]
            assert np.abs(flow[:, 0] + flow[:, 2] - 2 * energy * time).max() < 1e-11 * flow.max()


def compared(tmp_path, *overrides):
    """Z and rates from events and from samples of two runs, in one window."""
    scene = GAS.replace("snapshot_every = 2.0", "snapshot_every = 50.0")
    paths = tmp_path / "events.h5", tmp_path / "samples.h5"
    for path, events in zip(paths, ("true", "false"), strict=True):
        simulate(parse_scene(scene, overrides=[*overrides, f"log.events={events}"]), path)
    with open_log(paths[0]) as a, open_log(paths[1]) as b:
        for name in (*SUMS, "face_hits"):
            assert np.array_equal(a.observables[name][1], b.observables[name][1])
        time = b.observables["energy"][0]
        start, end = time[len(time) // 10], time[-3]
        each, other = (pressure(log, start, end) for log in (a, b))
    assert other.window.start == start
    assert [route.name for route in other.routes] == [route.name for route in each.routes]
    for result, expected in zip(other.routes, each.routes, strict=True):
        assert result.compressibility_factor.value == pytest.approx(expected.compressibility_factor.value, rel=1e-12)
        assert result.compressibility_factor.theory == expected.compressibility_factor.theory
        error = result.compressibility_factor.standard_error / expected.compressibility_factor.standard_error
        assert 0.5 < error < 2
    for result, expected in zip(other.collision_rates, each.collision_rates, strict=True):
        assert result.rate.value == pytest.approx(expected.rate.value, rel=1e-12)
    assert other.free_paths == ()
    return other


def test_the_same_pressure_without_events(tmp_path):
    compared(tmp_path, "run.events=100_000")


@pytest.mark.long
def test_the_same_pressure_without_events_in_a_long_run(tmp_path):
    """Ten million collisions."""
    result = compared(tmp_path, "run.events=", "run.collisions_per_disc=333_334")
    assert result.check().agrees


PARTED = (
    GAS
    + "rotation = {roughness = 0.4, wall_roughness = 0.2}\ngravity.acceleration = [0.1, -0.3]\n"
    + 'box.bottom = { thermal = 1.5 }\nwall = [{name = "middle", from = [8, 0], to = [8, 12]}]\n'
)
"""A rough gas under gravity on both sides of a wall without ends that discs could touch."""


@pytest.mark.long
def test_the_same_mechanical_pressure_without_events(tmp_path):
    paths = tmp_path / "events.h5", tmp_path / "samples.h5"
    for path, events in zip(paths, ("true", "false"), strict=True):
        simulate(parse_scene(PARTED, overrides=[f"log.events={events}"]), path)
    with open_log(paths[0]) as a, open_log(paths[1]) as b:
        time = b.observables["energy"][0]
        each, other = (pressure(log, time[10], time[-3]) for log in (a, b))
    assert each.mechanical
    assert other.mechanical
    assert other.temperature == pytest.approx(each.temperature, rel=0.02)  # with the energy at events, not in between
    walls = list(zip(other.mechanical.walls, each.mechanical.walls, strict=True))
    assert [result.name for result, _ in walls] == [expected.name for _, expected in walls]
    assert len(walls) == 6
    for result, expected in walls:
        assert result.pressure.value == pytest.approx(expected.pressure.value, rel=1e-11)
        assert result.stress
        assert expected.stress
        assert result.stress.value == pytest.approx(expected.stress.value, rel=1e-9)
    for push, awaited in zip(other.mechanical.forces, each.mechanical.forces, strict=True):
        assert (push.name, push.x.theory, push.y.theory) == (awaited.name, awaited.x.theory, awaited.y.theory)
        assert push.y.value == pytest.approx(awaited.y.value, rel=1e-9)


def test_samples_do_not_follow_a_piston(tmp_path):
    piston = GAS + 'piston = [{side = "right", velocity = -0.01}]\n'
    simulate(
        parse_scene(piston, overrides=["log.events=false", "run.events=3000", "run.until=300"]), tmp_path / "run.h5"
    )
    with open_log(tmp_path / "run.h5") as log, pytest.raises(UserError, match="do not follow a piston"):
        pressure(log)


def test_sums_that_were_not_asked_for(tmp_path):
    path = tmp_path / "run.h5"
    with logged(scene_of("quickstart", "run.events=3000", "log.events=false"), path) as log:
        assert not {*SUMS, "face_hits"} & log.observables.keys()
        assert not [name for name in log.checkpoints[0].arrays if "flow" in name or "face" in name]
        with pytest.raises(UserError, match=r"has neither events .* nor sums \(these require log.pressure = true\)"):
            pressure(log)
        assert status(log).compressibility_factor is None


def test_pressure_of_few_and_of_enough_samples(tmp_path):
    """Too few are refused; a run that goes on shows the pressure of the last ones, its analysis that of all."""
    path = tmp_path / "run.h5"
    overrides = ("log.events=false", "log.snapshot_every=", "run.events=400_000")
    with logged(parse_scene(GAS, overrides=overrides), path) as log:
        result = pressure(log)
        assert result.window.detected
        assert result.check().agrees
        z = status(log).compressibility_factor
        assert abs(z.value - result.routes[-1].compressibility_factor.value) < 5 * z.standard_error
        time = log.observables["energy"][0]
        few = rf"only 16 samples between t = 0 and {time[15]:g}, one for each epoch or snapshot \(allowed >= 17\)"
        with pytest.raises(UserError, match=few):
            pressure(log, 0.0, time[15])
        assert len(pressure(log, 0.0, time[16]).window.edges) == 17


@pytest.mark.parametrize(
    ("keys", "got"),
    [
        ('method = "time_driven"\ndt = 0.01', 'method = "time_driven"'),
        ('method = "monte_carlo"', 'method = "monte_carlo"'),
        ('method = "brute_force"\nprecision = "float32"', 'precision = "float32"'),
    ],
)
def test_methods_without_these_sums(keys, got):
    allowed = 'event_driven, brute_force with "float64"'
    lines = refused(GAS + "".join(f"run.{key}\n" for key in keys.splitlines()))
    assert f"log.pressure: not recorded by this method (got {got}; allowed {allowed})" in "\n".join(lines)


@pytest.mark.parametrize("roughness", [1.0, 0.5])
def test_spins_of_far_more_energy_than_the_motion(roughness, tmp_path):
    """Heavy discs at rest with fast spins, in the course of a cold bath and of a gas that they set in motion."""
    scene = """
    box.size = [8, 6]
    disc = [
        {position = [2, 2], velocity = [0, 0], radius = 0.6, mass = 1e8, angular_velocity = 2},
        {position = [5, 3], velocity = [1e-16, 0], radius = 0.6, mass = 1e8, angular_velocity = -2},
    ]
    rotation = {inertia = 0.5, wall_roughness = 1}
    thermostat = {temperature = 1e-12, rate = 0.1}
    log.pressure = true
    run.events = 200
    """
    path = tmp_path / "run.h5"
    with logged(parse_scene(scene, overrides=[f"rotation.roughness={roughness}"]), path) as log:
        energy, heat = log.observables["energy"][1], log.observables["bath_energy"][1]
        lost = log.observables["dissipated_energy"][1].sum(axis=1) if roughness < 1 else 0.0
        assert energy[0] > 1e7
        assert energy[-1] < 1e-4
        assert np.abs(energy + lost - energy[0] - heat).max() <= 1e-12 * energy[0]
