"""Where a piston is between the hits of discs: as the engine has it at any time the run might have ended."""

import pytest
from helpers.logs import gas, log_of

from idealgas.movie.piston_track import piston_tracks
from idealgas.physics.vibration import motion_at

GAS = gas(50, 0.1, (20, 10), "until = 40")
PISTONS = {
    "with a mass": 'piston = [{side = "right", position = 12, mass = 10, pressure = 3}]\n',
    "of given velocity": 'piston = [{side = "left", position = 2, velocity = 0.1}]\n',
    "that falls": 'gravity.acceleration=[0, -0.5]\npiston = [{side = "top", position = 8, mass = 30, pressure = 1}]\n',
}


@pytest.mark.parametrize("name", PISTONS)
def test_it_is_where_the_engine_has_it(name):
    scene = PISTONS[name] + GAS
    log = log_of(scene)
    (track,), (part,) = piston_tracks(log, 0.0, 40.0), piston_tracks(log, 7.0, 12.0)
    assert len(track.time) > 20
    assert track.at(0.0) == pytest.approx(log.scene.piston[0].position, rel=1e-12)
    for time in (0.013, 7.7, 11.3):
        expected = log_of(scene, f"run.until={time}").observables["piston_position"][1][-1, 0]
        assert track.at(time) == pytest.approx(expected, rel=1e-12)
        if time > 7:
            assert part.at(time) == track.at(time)


@pytest.mark.parametrize("motion", ["parabolas", "sine"])
def test_vibrating_sides_are_where_the_engine_has_them(motion):
    """Within what straight lines between 32 positions a period leave out, A ω² dt²/8; not if they are too fast."""
    side = f'{{ vibrating = {{ amplitude = 0.5, frequency = 0.3, motion = "{motion}" }} }}'
    log = log_of(f"box.top = {side}\nbox.left = {side}\n" + GAS, "run.until=1")
    left, top = piston_tracks(log, 7.0, 120.0)
    record = log.scene.box.top.record
    assert (left.axis, top.axis) == (0, 1)
    for time in (7.0, 8.123, 77.7, 120.0):
        height = motion_at(record, time)[0]
        missing = record.acceleration * (2 * record.half / 32) ** 2 / 8
        assert (left.at(time), 10 - top.at(time)) == pytest.approx((height, height), abs=1.001 * missing)
    assert left.at(2 / 0.3) < 1e-12
    assert left.at(8.5 / 0.3) == pytest.approx(1.0, rel=1e-12)
    assert piston_tracks(log, 0.0, 1e4) == []


def test_no_piston_no_track():
    assert piston_tracks(log_of(GAS, "run.until=1"), 0.0, 1.0) == []
