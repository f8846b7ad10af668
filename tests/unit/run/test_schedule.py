"""Values that change in time: exact, the same by every method, in a resumed run and in the energy account."""

import math

import numpy as np
import pytest
from helpers.log_compare import same_by_brute_force_and_resumed
from helpers.support import ROOT, logged

from idealgas import load_scene, open_log, parse_scene, simulate
from idealgas.columns import Kind
from idealgas.effects.schedule import description, steps_of, value_at
from idealgas.errors import NotApplicableError
from idealgas.log.flights import Flights

GOLDEN = ROOT / "tests" / "cases" / "golden" / "steps.toml"
FALLS = GOLDEN.with_name("gravity-in-steps.toml")
DRIVEN = "piston=[{ side = 'right', velocity = [[0, -0.25], [4, 0], [6, 0.5], [8, -0.125]] }]"
DISC = "[[disc]]\nposition = {}\nvelocity = {}\nradius = 0.5\n"


@pytest.mark.slow
@pytest.mark.parametrize(
    ("scene", "overrides", "changes"),
    [
        pytest.param(GOLDEN, (), {3, 4, 5, 6, 8}, id="pressed"),
        pytest.param(GOLDEN, (DRIVEN,), {3, 4, 5, 6, 8}, id="driven"),
        pytest.param(FALLS, (), {1.5, 4, 7}, id="falls"),
    ],
)
def test_the_same_by_brute_force_and_resumed(tmp_path, scene, overrides, changes):
    same_by_brute_force_and_resumed(tmp_path, scene, overrides, "run.until=1", "run.until=4", "run.until=7.5")
    with open_log(tmp_path / "whole.h5") as log:
        assert len(log) > 300
        assert changes <= set(log.observables["energy"][0].tolist())


ROUND = "[[wall]]\nfrom = [1, 5]\nto = [1, 5]\nvia = [9, 5]\n"
BUMPER = "[[disc]]\nposition = [8, 5]\nradius = 0.5\nfixed = true\n"


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(("obstacle", "place", "time"), [(ROUND, [5, 5], 3.5), (BUMPER, [2, 5], 5.0)])
def test_before_gravity_begins_round_walls_and_fixed_discs_are_there(tmp_path, obstacle, place, time):
    gravity = "gravity.acceleration = [[0, [0, 0]], [20, [0, -1]]]\n"
    text = f"box.size = [10, 10]\n{gravity}run.until = 8\n{obstacle}{DISC.format(place, [1, 0])}"
    with logged(parse_scene(text), tmp_path / "run.h5") as log:
        assert next(log.chunks()).time[0] == time


def rows_of(log, *columns):
    return [np.concatenate([getattr(block, name) for block in log.chunks()]) for name in columns]


def test_the_velocities_have_the_temperature_of_the_time(tmp_path):
    """Mean energies T within 4 standard errors, T/√n each: m v²/2 from a heat bath, m vx²/2 from a thermal side."""
    scene = """
        scene.seed = 5
        box = { size = [10, 10], left = { thermal = [[0, 4], [40, 0.25], [80, "reflecting"]] } }
        species = [{ name = "gas", count = 100, radius = 0.02, temperature = 1 }]
        thermostat = { temperature = [[0, 1], [60, 9]], rate = 0.2 }
        run.until = 120
    """
    with logged(parse_scene(scene), tmp_path / "run.h5") as log:
        time, kind, partner, velocity = rows_of(log, "time", "kind", "partner", "velocity")
    squared = velocity**2 / 2
    left, bath = (kind == Kind.WALL) & (partner == -1), kind == Kind.THERMOSTAT
    sources = [(left, squared[:, 0], 0, 40, 4.0), (left, squared[:, 0], 40, 80, 0.25)]
    sources += [(bath, squared.sum(axis=1), 0, 60, 1.0), (bath, squared.sum(axis=1), 60, 120, 9.0)]
    for which, energy, start, end, temperature in sources:
        selected = energy[which & (time >= start) & (time < end)]
        assert len(selected) > 100
        assert abs(selected.mean() / temperature - 1) < 4 / math.sqrt(len(selected))


@pytest.mark.usefixtures("uncompiled")
def test_a_side_reflects_where_its_step_says_so(tmp_path):
    """To and fro over 9: it meets the left side at 4, 22 and 40, and is emitted only by the second."""
    side = 'box = { size = [10, 2], left = { thermal = [[0, "reflecting"], [20, 1e-8], [23, "reflecting"]] }}\n'
    with logged(parse_scene(side + DISC.format([4.5, 1], [-1, 0]) + "[run]\nuntil = 23\n"), tmp_path / "run.h5") as log:
        time, velocity = rows_of(log, "time", "velocity")
    assert time.tolist() == [4, 13, 22]
    assert velocity[:2, 0].tolist() == [1, -1]
    assert 0 < velocity[2, 0] < 1e-2


@pytest.mark.usefixtures("uncompiled")
def test_a_piston_falls_on_the_parabolas_of_its_pressures(tmp_path):
    """X = 9 - t²/4 up to 2, then 8 - s - s²/2 up to 3, then 6.5 - 2 s - s²/8: a = -P L/m is -1/2, -1, -1/4."""
    piston = "[[piston]]\nside = 'top'\nposition = 9\nmass = 4\npressure = [[0, 1], [2, 2], [3, 0.5]]\n"
    scene = "[box]\nsize = [2, 10]\n" + piston + DISC.format([1, 1], [0, 0]) + "[run]\nuntil = 4\n"
    summary = simulate(parse_scene(scene), tmp_path / "run.h5")
    with open_log(tmp_path / "run.h5") as log:
        place, given = log.observables["piston_position"], log.observables["step_energy"][1]
    assert dict(zip(*(values.tolist() for values in place), strict=True)) == {0: [9], 2: [8], 3: [6.5], 4: [4.375]}
    assert given[-1] == (2 * 8) + (-3 * 6.5)  # ΔP L X
    assert summary.energy_drift == 0


@pytest.mark.usefixtures("uncompiled")
def test_a_disc_falls_on_the_parabolas_of_its_gravities(tmp_path):
    """Up at 1 from y = 2: 4 at t = 2, then y = 4 + s - s²/2 to 4 at t = 4, where v = -1 and g = (1/2, 0) takes over."""
    gravity = "gravity = { acceleration = [[0, [0, 0]], [2, [0, -1]], [4, [0.5, 0]]] }\nbox.size = [20, 8]\n"
    text = gravity + "run.until = 6\n" + DISC.format([2, 2], [0, 1])
    summary = simulate(parse_scene(text), tmp_path / "run.h5")
    y = {0: 2, 1: 3, 2: 4, 3: 4.5, 4: 4, 5: 3, 6: 2}
    with open_log(tmp_path / "run.h5") as log:
        states = list(log.frames(list(y)))
        assert [state.position[0].tolist() for state in states] == [
            [2 + max(t - 4, 0) ** 2 / 4, height] for t, height in y.items()
        ]
        assert [state.velocity[0].tolist() for state in states] == [
            [0, 1], [0, 1], [0, 1], [0, 0], [0, -1], [0.5, -1], [1, -1]
        ]  # fmt: skip
        flights = Flights.joined(log.flights([0, 1, 3, 5, 6]))
        assert flights.end.tolist() == [1, 2, 3, 4, 5, 6]
        assert flights.end_position[:, 1].tolist() == [3, 4, 4.5, 4, 3, 2]
        assert flights.displacement.tolist() == [[0, 1], [0, 1], [0, 0.5], [0, -0.5], [0.25, -1], [0.75, -1]]
        assert flights.end_velocity.tolist() == [[0, 1], [0, 1], [0, 0], [0, -1], [0.5, -1], [1, -1]]
        assert log.observables["step_energy"][1][-1] == 4 - 5  # -m Δg·r
        with pytest.raises(NotApplicableError, match="constant gravity is required, but gravity changes in time"):
            assert log.gravity
    assert summary.energy_drift == 0


@pytest.mark.usefixtures("uncompiled")
def test_a_gate_opens_and_closes_twice(tmp_path):
    gate = "[[wall]]\nfrom = [5, 0]\nto = [5, 2]\nopens_at = [2, 20]\ncloses_at = [6, 30]\n"
    scene = "[box]\nsize = [10, 2]\n" + gate + DISC.format([2, 1], [1, 0]) + "[run]\nuntil = 35\n"
    with logged(parse_scene(scene), tmp_path / "run.h5") as log:
        time, partner = rows_of(log, "time", "partner")
        assert log.scene.wall[0].action == "reflecting, open from 2 to 6, from 20 to 30"
    assert time.tolist() == [7.5, 11.5, 15.5, 19.5, 23.5, 32.5]
    assert partner.tolist() == [-2, -5, -2, -5, -2, -1]


def test_later_scenes_have_the_rest_of_the_steps():
    scene = load_scene(GOLDEN)
    gate = scene.wall[0].later(5.0)
    assert (gate.opens_at, gate.closes_at, gate.temperature) == (2, 5, 1.5)
    assert gate.later(2.5).absences == ((0, 2.5),)
    assert scene.wall[0].later(1.0).absences == ((0, 3.5), (6, 9))
    assert scene.box.left.after(4.0).thermal == ((0, 0.25), (2, "reflecting"), (5, 1))
    assert scene.box.left.after(7.0).thermal == ((0, "reflecting"), (2, 1))
    assert scene.piston[0].after(8.0).pressure == 1
    assert description(scene.box.left.thermal) == "2, 0.25 from t = 3, reflecting from t = 6, 1 from t = 9"
    assert (value_at(3.0, 7), steps_of(3.0)) == (3, ((0, 3),))
    assert value_at(((0.0, 1.0), (2.0, 3.0)), np.array([0, 1.9, 2, 5])).tolist() == [1, 1, 3, 3]
