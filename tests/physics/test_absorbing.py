"""Holes: resumed and continued; what leaves is accounted for, and counts no more."""

import math

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, log_of, raised
from helpers.support import output_of

from idealgas import evolution, open_log, open_run, parse_scene, resume, simulate
from idealgas.columns import Kind
from idealgas.initial.files import read_state
from idealgas.log.dataframes import flat_discs
from idealgas.movie.film import paint_frame
from idealgas.report.player import player

TWO = """
box.size = [10, 10]
run.until = 10
wall = [{ from = [5, 4], to = [5, 6], absorbing = true, name = "hole" }]
disc = [
    { position = [2, 5], velocity = [1, 0], radius = 0.5, mass = 2 },
    { position = [2, 8], velocity = [1, 0], radius = 0.5 },
]
"""


@pytest.fixture
def two(uncompiled):
    """A disc that leaves at t = 2.5, where its edge touches the hole, and one that flies by."""
    return log_of(TWO)


def test_the_last_event_of_a_disc(two):
    (rows,) = two.chunks()
    own = rows.disc == 0
    assert (rows.time[own].tolist(), rows.kind[own].tolist(), rows.partner[own].tolist()) == ([2.5], [6], [-5])
    assert (rows.position[own].tolist(), rows.velocity[own].tolist()) == ([[4.5, 5.0]], [[1.0, 0.0]])
    assert two.summary["escaped"] == 1
    flights = next(two.flights(discs=[0]))
    assert (flights.start.tolist(), flights.end.tolist()) == ([0.0], [2.5])


def test_it_is_nowhere_after_that(two):
    before, after = two.frames([2.4, 2.6])
    assert before.inside.all()
    assert after.inside.tolist() == [False, True]
    assert np.isnan(after.position[0]).all()
    assert after.position[1].tolist() == pytest.approx([4.6, 8.0])


@pytest.mark.usefixtures("uncompiled")
def test_it_flies_through_no_more_images():
    """It crosses the right side at t = 8, and the hole takes it at t = 11.5."""
    start = ("disc.0.position=[6, 5]", "disc.0.velocity=[0.5, 0]")
    log = log_of(TWO, *PERIODIC[:2], *start, "run.until=99")
    assert [state.image[0].tolist() for state in log.frames([7.0, 9.0, 30.0, 90.0])] == [[0, 0], *[[1, 0]] * 3]


def test_its_energy_is_on_the_account(two):
    assert two.observables["wall_energy"][1][-1].tolist() == [0, 0, 0, 0, -1.0]
    assert two.observables["energy"][1][[0, -1]].tolist() == [1.5, 0.5]
    assert two.observables["escaped"][1][[0, -1]].tolist() == [0, 1]
    assert two.summary["energy_drift"] == 0


@pytest.mark.usefixtures("uncompiled")
def test_with_height_and_spin():
    """It takes m g h + I ω²/2: from y = 5 at rest down to y = 1.5 with g = 2, m = 1, I ω² = 0.5 · 0.25 · 16."""
    discs = "{ position = [5, 5], radius = 0.5, angular_velocity = 4 }, { position = [9, 5], radius = 0.5 }"
    floor = "wall=[{ from = [2, 1], to = [8, 1], absorbing = true }]"
    log = log_of(TWO, "run.until=3", "gravity.acceleration=[0, -2]", "rotation.roughness=1", floor, f"disc=[{discs}]")
    assert log.observables["wall_energy"][1][-1][4] == pytest.approx(-(5 * 2 + 1.0), rel=1e-14)
    assert next(log.chunks()).time[0] == pytest.approx(math.sqrt(3.5), rel=1e-14)
    assert abs(log.summary["energy_drift"]) < 1e-15


def test_analyses_count_those_that_are_left(two):
    assert evolution(two).temperature[[0, -1]].tolist() == [0.75, 0.5]


def test_pictures_leave_it_out(two, tmp_path):
    paint_frame(two, tmp_path / "frame.png", 9.0)
    result = player(two, start=3.0)
    assert result.head["speed"] == pytest.approx(10 / 5)


@pytest.mark.usefixtures("uncompiled")
def test_a_start_from_a_state_has_those_that_are_left(tmp_path):
    """Ids are new, in the old order: from a checkpoint the events of the run that goes on, bit for bit."""
    hole = "wall = [{ from = [4, 2], to = [4, 2.5], absorbing = true }]"
    log = log_of(gas(40, 0.2, (8, 6), "events = 1000", seed=3, then=hole))
    k = len(log.checkpoints) // 2
    at, row = log.checkpoints.times[k].item(), log.checkpoints.rows[k].item()
    here, (expected,) = np.flatnonzero(log.state_at(at).inside), log.chunks(None, row)
    assert 10 < len(here) < 40
    output_of("scene", log.path, "--at", repr(at), "-o", tmp_path / "next.toml")
    (result,) = log_of(tmp_path / "next.toml", "run.events=50").chunks()
    rows = slice(0, len(result.disc))
    assert np.array_equal(here[result.disc], expected.disc[rows])
    assert np.array_equal(result.position, expected.position[rows])


@pytest.mark.usefixtures("uncompiled")
def test_a_start_after_a_species_has_left(tmp_path):
    """It has no table any more, and a wall that only its discs would pass is closed to all."""
    doors = """
        { from = [9, 1], to = [9, 3], permeable_to = ["heavy"], permeable_from = "left" },
        { from = [9, 4], to = [9, 6], permeable_to = ["heavy", "light"] },
    ]
    species = [
        { name = "heavy", count = 1, radius = 0.5, mass = 2, speed = 1 },
        { name = "light", count = 1, radius = 0.5, speed = 1 },
    ]"""
    text = TWO.replace(" }]", f" }},{doors}", 1).replace("mass = 2 }", 'mass = 2, species = "heavy" }')
    text = text.replace("radius = 0.5 },\n]", 'radius = 0.5, species = "light" },\n]')
    output_of("scene", log_of(text).path, "--at", "5", "-o", tmp_path / "next.toml")
    following = log_of(tmp_path / "next.toml")
    assert [(s.name, s.count) for s in following.scene.species] == [("light", 1)]
    openings = [(wall.permeable_to, wall.permeable_from) for wall in following.scene.wall]
    assert openings == [(None, None)] * 2 + [(("light",), None)]
    assert following.summary["wall_hits"] == 1


@pytest.mark.parametrize("kind", ["csv", "extxyz", "gsd"])
def test_a_start_from_a_frame_has_those_that_are_left(two, tmp_path, kind):
    path = tmp_path / f"frames.{kind}"
    output_of("export", two.path, "--format", kind, "--frames", "2", "-o", path)
    columns, overlap = read_state(path, 10.0)
    assert columns["position"].tolist() == two.state_at(10.0).position[1:].tolist()
    assert columns["radius"].tolist() == [0.5]
    assert columns["species"] == ["disc"]
    assert np.isfinite(overlap)
    if kind == "extxyz":
        assert [line for line in path.read_text().splitlines() if line.isdigit()] == ["2", "1"]


@pytest.mark.usefixtures("uncompiled")
def test_a_program_cannot_move_it(tmp_path):
    with open_run(parse_scene(TWO + "[steering]\n"), tmp_path / "run.h5") as run:
        run.advance(until=3.0)
        assert run.state().inside.tolist() == [False, True]
        raised("disc 0 has left the gas", run.set_velocities, [[math.nan, math.nan], [0.0, 0.0]])
        run.set_velocities([[0.0, 2.0]], [1])
        run.reverse()
        assert abs(run.finish().energy_drift) < 1e-15
    with open_log(tmp_path / "run.h5") as log:
        (rows,) = log.chunks()
        assert rows.disc[rows.kind == Kind.STEERED].tolist() == [1, 1]


@pytest.mark.usefixtures("uncompiled")
def test_a_run_that_all_discs_leave(tmp_path):
    """It ends in time; a number of events that cannot come is one line, again and again, until it has such an end."""
    both = TWO.replace("[2, 8]", "[2, 6.1]")
    log = log_of(both)
    assert (log.summary["escaped"], log.summary["events"], log.end_time) == (2, 2, 10)
    (frame,) = flat_discs(log.discs, log.frames([10.0]))
    assert np.isnan([frame["x"], frame["y"], frame["vx"], frame["vy"]]).all()
    path, endless = tmp_path / "endless.h5", parse_scene(both, overrides=["run.until=", "run.events=9"])
    raised("all discs have left the gas, up to t = ", simulate, endless, path)
    raised("all discs have left the gas, up to t = ", resume, path)
    assert resume(path, ["run.events=", "run.until=1e4"]).end_time == 1e4
