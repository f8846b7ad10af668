"""A log gone on with is the log of a run without a break, bit for bit; or it is refused."""

import re
import shutil
from functools import partial
from itertools import count

import numpy as np
import pytest
from helpers.crafted import craft, put
from helpers.log_compare import differences, scene_of

import idealgas.run.resume as going_on
from idealgas.analysis.status import status
from idealgas.engine.simulation import TRAJECTORY
from idealgas.log import DamageError, LogError, LogWriter, open_log
from idealgas.log.digest import digest
from idealgas.log.hdf5.superblock import lookup3
from idealgas.run.resume import resume
from idealgas.run.simulate import open_run, simulate
from idealgas.scene import SceneError, parse_scene

SNAPSHOTS = "log.snapshot_every=0.37"
EVENTS = 12_000
SCENES = (
    "quickstart", "periodic", "piston", "cooling", "rough", "heat-bath", "atmosphere", "thermostat", "novak-bortz"
)  # fmt: skip


def interrupted(slices):
    """What ends a run after some slices."""
    calls = count(1)
    return lambda: next(calls) >= slices


@pytest.fixture(scope="module", params=SCENES)
def whole(request, tmp_path_factory):
    """A scene's name and its log."""
    path = tmp_path_factory.mktemp("whole") / "run.h5"
    simulate(scene_of(request.param, SNAPSHOTS, f"run.events={EVENTS}"), path)
    return request.param, path


@pytest.mark.slow
def test_extended(whole, tmp_path):
    name, expected = whole
    path = tmp_path / "run.h5"
    simulate(scene_of(name, SNAPSHOTS, f"run.events={EVENTS * 2 // 3}"), path)
    resume(path, [f"run.events={EVENTS}"])
    assert differences(path, expected) == []


@pytest.mark.parametrize("slices", [1, 3])
@pytest.mark.slow
def test_interrupted(whole, tmp_path, slices):
    name, expected = whole
    path = tmp_path / "run.h5"
    simulate(scene_of(name, SNAPSHOTS, f"run.events={EVENTS}"), path, interrupted=interrupted(slices))
    with open_log(path) as log:
        assert not log.complete
        assert (np.diff(log.observables["kinetic_energy"][0]) >= 0).all()
    summary = resume(path)
    assert summary.completed
    assert differences(path, expected) == []


def test_from_a_time_to_a_later_one(tmp_path):
    simulate(scene_of("quickstart", "run.until=0.61"), tmp_path / "run.h5")
    resume(tmp_path / "run.h5", ["run.until=1.7"])
    simulate(scene_of("quickstart", "run.until=1.7"), tmp_path / "whole.h5")
    assert differences(tmp_path / "run.h5", tmp_path / "whole.h5") == []


@pytest.mark.slow
def test_sparse_checkpoints_and_no_events(tmp_path):
    for number, override in enumerate(("log.checkpoint_every=3", "log.events=false")):
        scene = partial(scene_of, "quickstart", override, SNAPSHOTS)
        part, whole = tmp_path / f"{number}.h5", tmp_path / f"{number}-whole.h5"
        simulate(scene("run.events=300000"), part)
        resume(part, ["run.events=400000"])
        simulate(scene("run.events=400000"), whole)
        assert differences(part, whole) == []


def test_a_log_that_has_only_its_start(tmp_path):
    scene = scene_of("rough", "run.events=3000")
    for name in ("run.h5", "whole.h5"):
        simulate(scene, tmp_path / name)
    LogWriter.resume(tmp_path / "run.h5", None).close()
    with open_log(tmp_path / "run.h5") as log:
        assert (len(log), len(log.checkpoints)) == (0, 0)
    resume(tmp_path / "run.h5")
    assert differences(tmp_path / "run.h5", tmp_path / "whole.h5") == []


def test_snapshots_change_no_event(tmp_path):
    for name, override in (("with", SNAPSHOTS), ("without", "log.snapshot_every=")):
        simulate(scene_of("periodic", override, "run.events=20000"), tmp_path / name)
    with open_log(tmp_path / "with") as with_snapshots, open_log(tmp_path / "without") as without:
        assert len(with_snapshots.snapshot_times) > 5
        for a, b in zip(with_snapshots.chunks(), without.chunks(), strict=True):
            for name in with_snapshots.columns:
                assert np.array_equal(getattr(a, name), getattr(b, name))


# ── refusals ──


@pytest.fixture(scope="module")
def finished(tmp_path_factory):
    path = tmp_path_factory.mktemp("finished") / "run.h5"
    simulate(scene_of("quickstart", "run.events=5000"), path, command="first")
    return path


def test_a_log_at_its_end_stays_as_it_is(finished):
    before = finished.read_bytes()
    summary = resume(finished)
    assert (summary.events, summary.completed) == (5000, True)
    assert finished.read_bytes() == before


def test_a_complete_log_that_was_not_closed_is_closed(finished, tmp_path):
    """As after a disk that failed at the last write of a run, which clears the flags of an open file."""
    path, block = tmp_path / "run.h5", bytearray(finished.read_bytes())
    block[11] = 5  # open for writing, and for reading meanwhile
    block[44:48] = lookup3(bytes(block[:44])).to_bytes(4, "little")
    path.write_bytes(block)
    with open_log(path) as log:
        assert (log.complete, log.unclosed) == (True, True)
    assert resume(path).events == 5000
    with open_log(path) as log, open_log(finished) as whole:
        assert (log.unclosed, digest(log)) == (False, digest(whole))


def test_logs_that_were_damaged_by_hand_are_one_line(finished, tmp_path):
    path = tmp_path / "run.h5"
    shutil.copy(finished, path)
    with open_log(path) as log:
        place = list(log.summary).index("events")
    craft(path, put("summary/name", place, b"unknown"))
    with pytest.raises(LogError, match="summary: has no events"):
        resume(path)
    path = tmp_path / "run.h5"
    shutil.copy(finished, path)
    craft(path, put("runs/scene", 0, b"box.size = [1, 1]\nspecies = [{count = -1}, {count = -2}]\n"))
    with pytest.raises(DamageError, match=f"{re.escape(str(path))}: damaged: runs/scene: ") as caught:
        resume(path, ["run.events=9000"])
    assert "\n" not in str(caught.value)


@pytest.mark.parametrize(
    ("overrides", "message"),
    [
        (["run.events=4e3"], "already at 5,000 events; 4,000 is earlier"),
        (["run.until=0.001"], r"already at [\d.]+ units of time; 0.001 is earlier"),
        (["run.collisions_per_disc=0.1", "run.events="], r"already at [\d.]+ collisions per disc; 0.1 is earlier"),
        (["gravity.acceleration=[0, -1]"], r"with another \[gravity\]: only until, events, .* may change"),
        (["species.gas.radius=0.01", "run.events=9000"], r"with another \[species\]"),
        (["run.method=brute_force"], r"with another \[run\]"),
        (["scene.seed=5"], r"with another \[scene\]"),
    ],
)
def test_what_would_not_follow(finished, overrides, message):
    before = finished.read_bytes()
    with pytest.raises(LogError, match=message) as caught:
        resume(finished, overrides)
    assert caught.value.exit_code == 2
    assert finished.read_bytes() == before


def test_a_wrong_end_and_other_laws(finished, monkeypatch):
    """By their version, and by what they do."""
    with pytest.raises(SceneError, match=r"run\.until: out of range"):
        resume(finished, ["run.until=-1"])
    with monkeypatch.context() as patch:
        patch.setattr(going_on, "TRAJECTORY", 99)
        with pytest.raises(LogError, match=f"made with version {TRAJECTORY} of the laws of motion; this program has "):
            resume(finished, ["run.events=9000"])
    restore = going_on.restore

    def displaced(*arguments):
        gas = restore(*arguments)
        gas.velocity[:] *= 1 + 1e-15
        return gas

    monkeypatch.setattr(going_on, "restore", displaced)
    before = finished.read_bytes()
    with pytest.raises(LogError, match=r"this program on this machine computes a different \w+ in event row \d+"):
        resume(finished, ["run.events=9000"])
    assert finished.read_bytes() == before


def test_the_log_tells_of_its_runs(finished, tmp_path):
    path = tmp_path / "run.h5"
    path.write_bytes(finished.read_bytes())
    resume(path, ["run.events=6000"], command="second")
    with open_log(path) as log:
        assert [command for _, command in log.runs] == ["first", "second"]
        assert (log.command, log.scene.run.events) == ("second", 6000)
        assert len(log.checkpoints) >= 1


GAS = """
scene.seed = 5
box.size = [4, 4]
species = [{ name = "gas", count = 12, radius = 0.2, temperature = 1 }]
"""


def test_an_interrupted_run_ends_at_one_time_and_one_number_of_events(uncompiled, tmp_path):
    """For the run, for who reads its log, and for who wants to end it earlier."""
    path = tmp_path / "run.h5"
    with open_run(parse_scene(f"{GAS}run.events = 100_000"), path) as run:
        run.advance(events=1500)
        ended = run._summarise()
    with open_log(path) as log:
        last = log.checkpoints[-1]
        assert 0 < last.time < log.end_time == ended.end_time
        assert log.counts == {name: getattr(ended, name) for name in ("events", "disc_collisions", "trials")}
        assert status(log).events == ended.events == 1500 > last.values["events"] > 0
    for end, message in (
        (f"run.until={(last.time + ended.end_time) / 2!r}", f"already at {ended.end_time:,.12g} units of time; "),
        (f"run.events={ended.events - 1}", f"already at {ended.events:,} events; {ended.events - 1:,} is earlier"),
        (f"run.events={ended.events}", f"already at {ended.events:,} events; {ended.events:,} is not a later end"),
    ):
        with pytest.raises(LogError, match=re.escape(message)):
            resume(path, [end])


@pytest.mark.parametrize("discs", [2, 12])
def test_a_reversal_is_whole(uncompiled, tmp_path, discs):
    """A run whose number of events is reached within it ends after it, also if it is cut there and resumed."""
    gas = f"{GAS}steering.reversed_at = 1.0\n".replace("count = 12", f"count = {discs}")
    before = simulate(parse_scene(f"{gas}run.until = 0.999999"), tmp_path / "before.h5").events
    expected, path = tmp_path / "expected.h5", tmp_path / "cut.h5"
    whole = simulate(parse_scene(f"{gas}run.events = {before + discs // 2}"), expected)
    assert (whole.events, whole.steered, whole.end_time) == (before + discs, discs, 1.0)
    shutil.copy(expected, path)
    LogWriter.resume(path).close()
    with open_log(path) as log:
        assert (log.complete, len(log), log.end_time) == (False, whole.rows, 1.0)
    resume(path)
    assert differences(path, expected) == []
