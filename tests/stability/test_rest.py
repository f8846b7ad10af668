"""Discs that come to rest where a force presses them on a wall: how often they hit it, and how high they bounce."""

import numpy as np
import pytest
from helpers.support import called

from idealgas import open_log, parse_scene, simulate
from idealgas.errors import UserError

FIVE = """
scene.seed = 1
box.size = [10, 10]
gravity.acceleration = [0, -1]
restitution.wall = 0.5
run.until = 120
species = [{ name = "gas", count = 5, radius = 0.5, temperature = 1, region = [0, 5, 10, 10] }]
"""
SLOPE = "wall=[{ from = [0, 4], to = [10, 1] }]"
FLOOR = -3


def run(path, *overrides):
    scene = parse_scene(FIVE, overrides=overrides)
    return scene, simulate(scene, path)


@pytest.mark.parametrize("overrides", [(), (SLOPE,), ("restitution={ normal = 0.7, wall = 0.7 }",)])
def test_five_discs_at_rest_make_few_events(overrides, tmp_path):
    """With the contact duration of before, a millionth of the time for a diameter, it was a million for every one."""
    scene, summary = run(tmp_path / "run.h5", *overrides)
    assert summary.completed
    assert scene.resting_disc.per_free_time == pytest.approx(20 / scene.restitution.wall)
    assert (
        summary.events < 4 * 5 * 120 * scene.resting_disc.hits[1]
    )  # on a slope they lean on each other, and hit more often


@pytest.mark.parametrize("wall", [0.9, 0.5, 0.1])
@pytest.mark.slow
def test_a_disc_at_rest_bounces_as_the_theory_says(wall, tmp_path):
    """In flights of e t to t, t the contact duration, to a height of g t²/8 at most; the energy is then constant."""
    actual = ["species.gas.count=1", f"restitution.wall={wall}", "run.until=200"]
    scene, summary = run(tmp_path / "run.h5", *actual, "box.left=periodic", "box.right=periodic")
    t, rest = scene.restitution.contact_duration, scene.resting_disc
    with open_log(tmp_path / "run.h5") as log:
        (rows,) = log.chunks()
        hits = rows.time[rows.partner == FLOOR]
        late = rows.velocity[rows.partner == FLOOR, 1][hits > 150]
        flights = np.diff(hits[hits > 150])
    assert len(flights) > 50 * rest.hits[0] * 0.99
    assert wall * t * (1 - 1e-6) < flights.min()
    assert flights.max() < t * (1 + 1e-6)
    assert np.ptp(late) < 1e-12
    assert (late**2 / 2).max() <= rest.height * (1 + 1e-9)  # of a unit mass under unit gravity
    assert (late**2 / 2).max() >= wall**2 * rest.height * (1 - 1e-9)
    assert rest.height < 0.01
    assert summary.events < 200 * rest.hits[1]


@pytest.mark.slow
def test_a_pressed_piston_comes_to_rest_on_discs(tmp_path):
    text = """
        box.size = [10, 3]
        restitution = { normal = 0.6, wall = 0.6 }
        piston = [{ side = "right", position = 9, mass = 5, pressure = 1 }]
        disc = [
            { position = [2, 1.5], velocity = [1, 0.1], radius = 0.5 },
            { position = [4, 1.4], velocity = [-1, 0.2], radius = 0.5 },
        ]
        run.until = 100
    """
    scene = parse_scene(text)
    summary = simulate(scene, tmp_path / "run.h5")
    assert summary.completed
    assert summary.events < 10 * 3 * 100 * scene.resting_disc.hits[1]


@pytest.mark.parametrize("wall", ["restitution.wall=0", "restitution={ normal = 0, wall = 0 }"])
def test_a_disc_that_sticks_ends_the_run_with_one_line(wall, tmp_path):
    (tmp_path / "scene.toml").write_text(FIVE)
    done = called("run", "scene.toml", "-o", "run.h5", "--set", wall, folder=tmp_path)
    assert done.returncode == 2
    assert "is stuck at" in done.stderr.splitlines()[-1]
    with open_log(tmp_path / "run.h5") as log:
        assert not log.complete


def test_an_arch_between_walls_ends_the_run_with_one_line(tmp_path):
    """30 discs in a box five diameters wide, some wedged: else millions of collisions per disc and time."""
    pile = ["box.size=[4, 40]", "species.gas.count=30", "species.gas.radius=0.4", "species.gas.region="]
    losses = ["scene.seed=0", "restitution={ normal = 0.7, wall = 0.7 }", "run.until=200", "log.compression='none'"]
    with pytest.raises(UserError, match=r"is stuck at t = .*: more than 1000 collisions within one contact duration"):
        run(tmp_path / "run.h5", *pile, *losses)
    with open_log(tmp_path / "run.h5") as log:
        assert not log.complete
        assert len(log) < 10_000_000
