"""Where a piston is between the hits of discs: as the engine has it at any time the run might have ended."""

import pytest
from helpers.logs import gas, log_of

from idealgas.movie.piston_track import piston_tracks

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


def test_no_piston_no_track():
    assert piston_tracks(log_of(GAS, "run.until=1"), 0.0, 1.0) == []
