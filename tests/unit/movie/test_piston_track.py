"""Where a piston is between the hits of discs: as the engine has it at any time the run might have ended."""

import pytest

from idealgas.log import open_log
from idealgas.movie.piston_track import piston_tracks
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

SCENE = """
box.size = [20, 10]
species = [{{name = "gas", count = 50, radius = 0.1, temperature = 1}}]
run.until = {until}
"""

PISTONS = {
    "with a mass": 'piston = [{side = "right", position = 12, mass = 10, pressure = 3}]\n',
    "of given velocity": 'piston = [{side = "left", position = 2, velocity = 0.1}]\n',
    "that falls": 'piston = [{side = "top", position = 8, mass = 30, pressure = 1}]\ngravity.acceleration=[0, -0.5]\n',
}


def run(path, piston, until):
    simulate(parse_scene(piston + SCENE.format(until=until)), path)
    return open_log(path)


@pytest.mark.parametrize("name", PISTONS)
def test_it_is_where_the_engine_has_it(name, tmp_path):
    with run(tmp_path / "long.h5", PISTONS[name], 40) as log:
        (track,) = piston_tracks(log, 0.0, 40.0)
        (part,) = piston_tracks(log, 7.0, 12.0)
    assert len(track.time) > 20
    for time in (0.0, 0.013, 7.7, 11.3):
        if time:
            with run(tmp_path / f"{time}.h5", PISTONS[name], time) as short:
                expected = short.observables["piston_position"][1][-1, 0]
        else:
            expected = parse_scene(PISTONS[name] + SCENE.format(until=1)).piston[0].position
        assert track.at(time) == pytest.approx(expected, rel=1e-12)
        if time > 7:
            assert part.at(time) == track.at(time)


def test_no_piston_no_track(tmp_path):
    with run(tmp_path / "run.h5", "", 1) as log:
        assert piston_tracks(log, 0.0, 1.0) == []
