"""Values in steps: which holds when, and what is left of them in a scene whose clock starts later."""

import numpy as np
import pytest

from idealgas.effects.bundle import Effects, changed, next_change
from idealgas.effects.gravity import GravityTable
from idealgas.effects.schedule import Change, changes_of, value_at, without_past
from idealgas.effects.wall import WallTable
from idealgas.physics.gravity import Gravity as Acceleration

pytestmark = pytest.mark.interpreted

STEPS = ((0.0, 1.0), (2.0, 5.0), (4.0, 3.0))


@pytest.mark.parametrize(("time", "value"), [(0.0, 1.0), (1.9, 1.0), (2.0, 5.0), (3.9, 5.0), (4.0, 3.0), (9.0, 3.0)])
def test_a_step_holds_from_its_time_on(time, value):
    assert value_at(STEPS, time) == value_at(STEPS, np.array([time]))[0] == value
    assert value_at(7.0, time) == 7.0


def test_changes_are_those_after_time_0():
    assert list(changes_of(STEPS, 6)) == [Change(2.0, 6, 5.0), Change(4.0, 6, 3.0)]
    assert list(changes_of(7.0, 6)) == []


@pytest.mark.parametrize(
    ("time", "left"),
    [
        (1.0, [(0.0, (0.0, -1.0)), (1.0, (0.0, -5.0))]),
        (2.0, (0.0, -5.0)),  # a step that is due is no change any more
        (3.0, (0.0, -5.0)),
    ],
)
def test_a_later_clock_has_the_steps_after_it(time, left):
    gravity = GravityTable(acceleration=[[0.0, [0.0, -1.0]], [2.0, [0.0, -5.0]]])
    assert gravity.after(time).acceleration == (tuple(left) if isinstance(left, list) else left)
    assert without_past((1.0, 2.0, 4.0), 2.0) == 2.0
    assert without_past((1.0, 2.0), 2.0) is None


@pytest.mark.parametrize(("time", "there"), [(0.0, True), (1.9, True), (2.0, False), (2.9, False), (3.0, True)])
def test_a_gate_is_open_from_one_time_until_another(time, there):
    gate = WallTable.model_validate({"from": [1.0, 1.0], "to": [1.0, 2.0], "opens_at": 2.0, "closes_at": 3.0})
    assert gate.is_present(time) == there
    assert gate.absences == ((2.0, 3.0),)
    assert gate.later(2.5).absences == ((0.0, 0.5),)
    assert gate.later(1.0).absences == ((1.0, 2.0),)
    assert gate.later(3.0).absences == ()


def test_an_epoch_takes_the_changes_after_its_start_up_to_its_end():
    effects = Effects(gravity=Acceleration(0.0, -1.0), schedule=((2.0, 0, 1, -5.0), (2.0, 0, 0, 0.5), (4.0, 0, 1, 0.0)))
    assert [next_change(effects, time) for time in (0.0, 2.0, 3.0, 4.0)] == [2.0, 4.0, 4.0, np.inf]
    assert changed(effects, 0.0, 2.0).gravity == (0.5, -5.0)
    assert changed(effects, 0.0, 1.9).gravity == (0.0, -1.0)
    assert changed(effects, 2.0, 4.0).gravity == (0.0, 0.0)
