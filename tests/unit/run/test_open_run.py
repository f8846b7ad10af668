"""Runs that a program advances and steers: the log of one run, and changes that replay, resume and account know."""

import shutil
import time
from contextlib import suppress

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.support import ROOT

from idealgas import SceneError, UserError, load_scene, open_log, open_run, parse_scene, resume, simulate
from idealgas.columns import Kind
from idealgas.errors import OutputError
from idealgas.log import writer as log_writer
from idealgas.log.writer import LogWriter

GOLDEN = ROOT / "tests" / "cases" / "golden" / "steering.toml"
BOX = """
scene.seed = 5
box.size = [10, 10]
species = [{ name = "gas", count = 40, radius = 0.2, temperature = 1 }]
steering = {}
run.until = 12
"""


def test_in_pieces_or_left_early_the_log_is_that_of_one_run(tmp_path):
    scene = load_scene(GOLDEN)
    whole = simulate(scene, tmp_path / "whole.h5")
    with open_run(scene, tmp_path / "pieces.h5") as run:
        while run.advance(events=37) and run.time < 3:
            assert run.state().time == run.time
        while run.advance(until=run.time + 0.3):
            pass
        assert not run.advance(until=100)
        assert (run.time, run.events) == (8, whole.events)
    assert differences(tmp_path / "whole.h5", tmp_path / "pieces.h5") == []
    with open_log(tmp_path / "pieces.h5") as log:
        assert log.complete
    with open_run(scene, tmp_path / "left.h5") as run:
        assert run.advance(until=4.4)
    with open_log(tmp_path / "left.h5") as log:
        assert not log.complete
    resume(tmp_path / "left.h5")
    assert differences(tmp_path / "whole.h5", tmp_path / "left.h5") == []
    # The epoch ends at the same times, so that the events are the same bits.
    with open_run(load_scene(GOLDEN, ["steering={}"]), tmp_path / "program.h5") as run:
        for time in (2, 5):
            run.advance(until=time)
            run.reverse()
    resume(tmp_path / "program.h5")
    assert differences(tmp_path / "whole.h5", tmp_path / "program.h5") == ["scene"]


def steer(scene, path):
    """New velocities for some discs at some times and after some events; the states after each."""
    states = []
    with open_run(scene, path) as run:
        for k in range(9):
            run.advance(**({"until": run.time + 0.7} if k % 3 else {"events": 50}))
            discs = np.arange(k, 40, 7)
            velocity = run.state().velocity[discs]
            run.set_velocities(velocity[:, ::-1] * (1.1 if k % 2 else 0.9), discs)
            states.append(run.state())
        assert run.advance(events=0)
    return states


@pytest.mark.parametrize("method", ["event_driven", "brute_force"])
def test_new_velocities_are_in_the_log_and_on_the_account(tmp_path, method):
    scene = parse_scene(BOX, overrides=[f"run.method={method}"])
    states = steer(scene, tmp_path / "run.h5")
    summary = resume(tmp_path / "run.h5")
    assert abs(summary.energy_drift) < 1e-12
    assert abs(summary.energy_change) > 0.1
    with open_log(tmp_path / "run.h5") as log:
        rows = list(log.chunks(("time", "kind", "disc")))
        kind, time, disc = (np.concatenate([getattr(b, name) for b in rows]) for name in ("kind", "time", "disc"))
        steered = kind == Kind.STEERED
        assert steered.sum() == summary.steered == sum(len(range(k, 40, 7)) for k in range(9))
        assert disc[steered].tolist() == [i for k in range(9) for i in range(k, 40, 7)]
        assert sorted(set(time[steered])) == [state.time for state in states]
        for state in states:
            assert np.array_equal(log.state_at(state.time).velocity, state.velocity)
            assert np.abs(log.state_at(state.time).position - state.position).max() < 1e-14


def test_steered_by_brute_force_the_log_is_the_same(tmp_path):
    for method in ("event_driven", "brute_force"):
        steer(parse_scene(BOX, overrides=[f"run.method={method}"]), tmp_path / f"{method}.h5")
        resume(tmp_path / f"{method}.h5")
    assert set(differences(tmp_path / "event_driven.h5", tmp_path / "brute_force.h5")) <= {"scene"}


def test_a_lost_program_leaves_a_log_that_goes_on_after_the_last_change(tmp_path):
    def program():
        with open_run(parse_scene(BOX), tmp_path / "run.h5") as run:
            run.advance(until=3)
            run.set_velocities([[2, 0]], [0])
            run.advance(until=3.5)
            raise ZeroDivisionError

    with pytest.raises(ZeroDivisionError):
        program()
    resume(tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        assert log.state_at(3).velocity[0].tolist() == [2, 0]
        assert log.end_time == 12


@pytest.mark.usefixtures("uncompiled")
def test_rows_of_a_change_are_committed_with_their_checkpoint(tmp_path, monkeypatch):
    """If the log is committed after every item and the program dies just before the checkpoint of a change."""
    killed, checkpoint = tmp_path / "killed.h5", LogWriter.checkpoint

    def copy_then_store(writer, *given):
        while not writer._queue.empty():
            time.sleep(0.01)
        time.sleep(0.1)  # the thread stores the last item
        shutil.copy(writer.path, killed)
        checkpoint(writer, *given)

    monkeypatch.setattr(log_writer, "FLUSH_SECONDS", 0.0)
    with open_run(parse_scene(BOX), tmp_path / "run.h5") as run:
        run.advance(until=2)
        monkeypatch.setattr(LogWriter, "checkpoint", copy_then_store)
        run.set_velocities(-run.state().velocity)
        monkeypatch.setattr(LogWriter, "checkpoint", checkpoint)
        run.advance(until=3)
    with open_log(killed) as log:
        assert 1.5 < log.end_time <= 2
        assert not any((rows.kind == Kind.STEERED).any() for rows in log.chunks(("kind",)))
    resume(killed)
    unchanged = simulate(parse_scene(BOX), tmp_path / "unchanged.h5")
    assert unchanged.completed
    assert differences(killed, tmp_path / "unchanged.h5") == []


def test_a_closed_log_takes_nothing_more_and_what_cannot_be_steered_is_one_line(tmp_path):
    with open_run(parse_scene(BOX, overrides=["steering="]), tmp_path / "plain.h5") as run:
        run.advance(until=1)
        with pytest.raises(UserError, match=r"^only a scene with a \[steering\] table can be changed during its run$"):
            run.reverse()
    with open_run(parse_scene(BOX), tmp_path / "run.h5") as run:
        for velocity, discs, wrong in (
            ([[1, 2]], None, r"^velocity: not \(40, 2\) numbers"),
            ([[1, np.nan]], [3], r"^velocity: not \(1, 2\) numbers"),
            ([[1, 2]], [40], r"^discs: not ids \(allowed 0 to 39\)$"),
            (np.ones((40, 2)), np.ones(40, bool), "^discs: not ids"),
            ([[1, 2]], [1.5], "^discs: not ids"),
        ):
            with pytest.raises(UserError, match=wrong):
                run.set_velocities(velocity, discs)
        run.set_velocities(np.empty((0, 2)), [])
        run.advance(until=1)
        with pytest.raises(UserError, match=r"^setting: too long \(got 315 bytes; allowed <= 256\)$"):
            run.change(f"wall.{'x' * 300}.open=true")
        run.advance()
        with pytest.raises(UserError, match=r"^the run has reached the end of its scene$"):
            run.reverse()
    with open_run(parse_scene(BOX), tmp_path / "closed.h5") as run:
        run.advance(until=1)
    with pytest.raises(OutputError, match=r"this log is closed$"):
        run.advance(until=2)
    with pytest.raises(OutputError, match=r"this log is closed$"):
        run.reverse()


def test_rows_of_a_reader_that_fails_are_in_the_log(tmp_path):
    def fail(batch):
        raise ZeroDivisionError

    simulate(parse_scene(BOX), tmp_path / "whole.h5")
    with open_run(parse_scene(BOX), tmp_path / "run.h5", on_events=fail) as run:
        while not run.ended:
            with suppress(ZeroDivisionError):
                run.advance(until=run.time + 1)
    assert differences(tmp_path / "run.h5", tmp_path / "whole.h5") == []


STEPS = ROOT / "tests" / "cases" / "golden" / "steps.toml"
CHANGES = [
    (2, "wall.gate.temperature=1.5"),
    (3, "box.left.thermal=0.25"),
    (4, "piston.pressure=0.25"),
    (4.5, "wall.gate.open=false"),
    (5, "thermostat.temperature=3"),
    (6, "box.left.thermal='reflecting'"),
    (7, "wall.gate.open=true"),
    (8, "piston.pressure=1"),
    (9, "box.left.thermal=1"),
    (10, "wall.gate.open=false"),
]
"""Those of the golden scene after its first, the opening of the gate at 1."""
UNCHANGED = (
    "steering={}",
    "box.left={ thermal = 2 }",
    "piston.pressure=0.5",
    "thermostat.temperature=0.5",
    "wall.0.temperature=[[0, 'reflecting']]",
    "wall.0.opens_at=1",
    "wall.0.closes_at=",
)


@pytest.mark.usefixtures("uncompiled")
def test_values_changed_by_the_program_as_by_the_scene(tmp_path):
    simulate(load_scene(STEPS, ["steering={}"]), tmp_path / "scene.h5")
    with open_run(load_scene(STEPS, UNCHANGED), tmp_path / "program.h5") as run:
        for time, setting in CHANGES:
            run.advance(until=time)
            run.change(setting)
    resume(tmp_path / "program.h5")
    unequal = differences(tmp_path / "scene.h5", tmp_path / "program.h5")
    assert set(unequal) == {"scene", "changes/time", "changes/setting"}
    with open_log(tmp_path / "scene.h5") as log, open_log(tmp_path / "program.h5") as other:
        assert other.scene == log.scene
        assert other.changes == CHANGES
        assert abs(other.summary["energy_drift"]) < 1e-12


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(
    ("setting", "wrong"),
    [
        ("thermostat.rate=3", "not a value that can change"),
        ("gravity.acceleration=[0, 1]", "no gravity in the scene"),
        ("wall.gate.open=true", "wall.gate.closes_at: openings and closings do not alternate"),
        ("wall.door.open=true", "no such key or table"),
        ("thermostat.temperature=-1", "thermostat.temperature"),
        ("thermostat", "not an assignment"),
        ("thermostat.temperature=", "no value"),
        ("open=true", "not a value that can change"),
    ],
)
def test_a_change_that_does_not_fit_is_one_line_and_changes_nothing(tmp_path, setting, wrong):
    with open_run(load_scene(STEPS, UNCHANGED), tmp_path / "run.h5") as run:
        run.advance(until=1.5)
        with pytest.raises(SceneError, match=wrong) as error:
            run.change(setting)
        assert "\n" not in str(error.value)
        assert run.advance(until=2)
    with open_log(tmp_path / "run.h5") as log:
        assert log.changes == []
