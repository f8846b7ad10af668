"""Runs whose events do not come end, runs that have an end in time reach it, and neither fills a disk on the way."""

import math

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.small_gases import PERIODIC as ALL_PERIODIC
from helpers.support import gas_of

from idealgas.errors import UserError
from idealgas.log import open_log
from idealgas.physics.collision_rates import disc_collisions_per_length
from idealgas.run import stall
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

PERIODIC = f"{ALL_PERIODIC.replace('[8, 8]', '[10, 10]')}\n"


def row(*discs):
    """Tables of discs of the radius 0.2, from (x, y, vx, vy)."""
    tables = (f"{{ position = [{x}, {y}], velocity = [{vx}, {vy}], radius = 0.2 }}" for x, y, vx, vy in discs)
    return f"disc = [{', '.join(tables)}]\n"


MOVERS = row((1, 1, 1, 0.1), (3, 3, 1, -0.1), (5, 5, 1, 0.2), (7, 7, 1, -0.2))
LANES = "box.size = [10, 10]\n" + row((1, 2, 1, 0), (5, 4, -1, 0), (7, 8, 1, 0))
"""Discs that never meet, but hit walls for ever."""


def movers(*overrides):
    """Four discs that keep their places in a row: all are equally fast along it, so none meets another."""
    return parse_scene(MOVERS + PERIODIC, overrides=overrides)


@pytest.fixture
def few(monkeypatch):
    monkeypatch.setattr(stall, "EMPTY_EPOCHS", 100)
    monkeypatch.setattr(stall, "EXPECTED", 50)


def test_collisions_are_expected_of_the_discs_that_are_left():
    position, velocity = np.array([[1.0, 1], [3, 3], [np.nan] * 2]), np.array([[1.0, 0], [0, 1], [0, 0]])
    holes = np.ones(1, bool)
    gas = gas_of((10, 10), position[:2], velocity[:2], 0.2)
    expected = stall._expected_collisions(gas, 7.0)  # each disc has the speed √½, and one collision is of two discs
    per_length = disc_collisions_per_length(2, 0.4, gas.packing_fraction, (10, 10))
    assert expected == pytest.approx(per_length * math.sqrt(0.5) * 7.0, rel=1e-14)
    assert stall._expected_collisions(gas_of((10, 10), position, velocity, 0.2), 7.0, holes) == expected > 0
    assert stall._expected_collisions(gas_of((10, 10), position[2:], velocity[2:], 0.2), 7.0, holes) == 0


METHODS = ("run.method=event_driven", "run.method=brute_force", "run={ method='time_driven', dt=0.5, events=4000 }")


@pytest.mark.parametrize("method", METHODS)
@pytest.mark.usefixtures("few")
def test_a_run_without_events_ends_with_one_line_and_a_log_to_go_on_with(method, tmp_path):
    path = tmp_path / "run.h5"
    with pytest.raises(UserError, match=r"run\.h5: no event in 100 epochs, up to t = \d+") as caught:
        simulate(movers("run.events=4000", method), path)
    assert "\n" not in str(caught.value)
    with open_log(path) as log:
        assert (log.complete, log.unclosed, len(log)) == (False, False, 0)
        assert [checkpoint.epoch for checkpoint in log.checkpoints] == [0, 100]
        assert len(log.observables["energy"][0]) == stall.QUIET_SAMPLES + 1
        end = log.end_time
        assert log.state_at(end).position.shape == (4, 2)
    with pytest.raises(UserError, match="no event in 100 epochs"):  # as many again
        resume(path)
    with open_log(path) as log:
        assert log.end_time == pytest.approx(2 * end)
    summary = resume(path, ["run.events=", f"run.until={3.5 * end}"])
    assert (summary.completed, summary.end_time, summary.events) == (True, 3.5 * end, 0)


@pytest.mark.usefixtures("few")
def test_pairs_of_discs_with_one_velocity(tmp_path):
    text = """
        box.size = [10, 10]
        run = { method = "monte_carlo", events = 10 }
        species = [{ name = "gas", count = 3, radius = 0.2, velocities = [[1, 0], [1, 0], [1, 0]] }]
    """
    with pytest.raises(UserError, match="no event in 100 epochs"):
        simulate(parse_scene(text), tmp_path / "run.h5")
    summary = simulate(parse_scene(text, overrides=["run.events=", "run.trials=200000"]), tmp_path / "trials.h5")
    assert (summary.completed, summary.trials, summary.events) == (True, 200_000, 0)
    with open_log(tmp_path / "trials.h5") as log:
        assert len(log.checkpoints) == 1


@pytest.mark.usefixtures("few")
def test_a_run_with_an_end_in_time_comes_to_it(tmp_path):
    summary = simulate(movers("run.until=1e6"), tmp_path / "run.h5")
    assert (summary.completed, summary.end_time, summary.events) == (True, 1e6, 0)
    assert summary.epochs > 5 * stall.EMPTY_EPOCHS
    with open_log(tmp_path / "run.h5") as log:
        assert len(log.checkpoints) == 1
        assert len(log.observables["energy"][0]) == stall.QUIET_SAMPLES + 1
        assert log.state_at(1e6).position[:, 1] == pytest.approx([1, 3, 5, 7], abs=1e-6)


@pytest.mark.usefixtures("few")
def test_discs_that_never_meet(tmp_path):
    """Walls are hit for ever, but only a collision of two discs would end the run."""
    with pytest.raises(UserError, match="no collision between discs although about 50 were expected"):
        simulate(parse_scene(LANES, overrides=["run.collisions_per_disc=10"]), tmp_path / "run.h5")
    assert simulate(parse_scene(LANES, overrides=["run.events=5000"]), tmp_path / "events.h5").completed
    late = ["run.collisions_per_disc=10", "wall=[{ from=[0, 9], to=[10, 9], opens_at=1e5 }]"]
    assert simulate(parse_scene(LANES, overrides=[*late, "run.until=2e4"]), tmp_path / "until.h5").completed


@pytest.mark.usefixtures("few")
def test_before_a_gate_opens_nothing_is_in_vain(tmp_path):
    """The discs meet once the wall between them is gone."""
    text = """
        box.size = [10, 2]
        wall = [{ from = [5, 0], to = [5, 2], opens_at = 20000 }]
        run.collisions_per_disc = 3
    """
    summary = simulate(parse_scene(text + row((2, 1, 1, 0), (8, 1, -1, 0))), tmp_path / "run.h5")
    assert summary.completed
    assert summary.end_time > 20_000


DILUTE = """
scene.seed = 3
species = [{ name = "gas", count = 2, radius = 0.01, speed = 1 }]
"""
"""Two discs that meet in one epoch of fifty: the length of an epoch does not know that sides are periodic."""


@pytest.mark.usefixtures("few")
def test_a_dilute_gas_is_waited_for(tmp_path):
    scene = parse_scene(DILUTE + PERIODIC, overrides=["run.events=12"])
    summary = simulate(scene, tmp_path / "run.h5")
    assert summary.completed
    assert summary.epochs > 12  # some of them without an event
    with open_log(tmp_path / "run.h5") as log:
        assert len(log.checkpoints) <= 13


def test_a_break_in_an_empty_stretch_changes_nothing(tmp_path):
    whole, part = tmp_path / "whole.h5", tmp_path / "part.h5"
    scene = parse_scene(DILUTE + PERIODIC, overrides=["run.until=50000", "log.checkpoint_every=2"])
    summary = simulate(scene, whole)
    calls = iter(range(1_000_000))
    simulate(scene, part, interrupted=lambda: next(calls) > summary.epochs // 2)
    with open_log(whole) as log, open_log(part) as broken:
        assert 1 < len(log.checkpoints) < summary.epochs / 2
        assert not broken.complete
        assert len(broken.checkpoints) < len(log.checkpoints)
    resume(part)
    assert differences(part, whole) == []


# ── few discs that make most events ──

FALL = """
box.size = [10, 10]
gravity.acceleration = [0, -1]
restitution = { wall = 0.5, contact_duration = 1e-6 }
run.until = 3
disc = [{ position = [5, 0.6], radius = 0.5 }]
species = [{ name = "gas", count = 5, radius = 0.5, temperature = 1, region = [0, 5, 10, 10] }]
"""


def notices(text, path, *overrides):
    actual = []
    simulate(parse_scene(text, overrides=overrides), path, on_progress=lambda progress: actual.append(progress.notice))
    return [notice for notice in actual if notice]


def test_a_disc_that_keeps_the_run_busy_is_told_once_and_a_gas_never_is(tmp_path, monkeypatch):
    (line,) = notices(FALL, tmp_path / "run.h5")
    assert line.startswith("1 of 6 discs accounts for most of the events from t = 0 to t = 1.3")
    assert notices(FALL, tmp_path / "default.h5", "restitution={ wall=0.5 }", "run.until=50") == []
    # Not even where it has more events than its epochs are made for.
    monkeypatch.setattr(stall, "OVERDUE", 0.1)
    assert notices(FALL, tmp_path / "gas.h5", "restitution=", "run.until=100") == []


def test_a_stuck_disc_ends_the_run_with_one_line(tmp_path):
    """Between two walls, in a gap that it crosses ten thousand times per contact duration."""
    scene = parse_scene("""
        box.size = [1.000001, 20]
        gravity.acceleration = [0, -1]
        restitution = { normal = 0.7, wall = 0.7, contact_duration = 0.01 }
        run.until = 200
        disc = [{ position = [0.5000005, 1], velocity = [1, 0], radius = 0.5 }]
    """)
    with pytest.raises(
        UserError, match=r"run\.h5: disc 0 is stuck at t = 0\.\d+: more than 1000 collisions within one contact"
    ):
        simulate(scene, tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        assert sum(len(rows.time) for rows in log.chunks()) > 1000
