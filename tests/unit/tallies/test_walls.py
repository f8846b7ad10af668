"""Momentum that walls get and the room below a piston, against slow and obvious computations."""

import shutil
from collections import defaultdict
from itertools import pairwise

import numpy as np
import pytest
from helpers.crafted import craft
from helpers.logs import gas, raised, streamed

from idealgas.columns import Kind
from idealgas.log import open_log
from idealgas.movie.piston_track import piston_tracks
from idealgas.tallies.stream import stream
from idealgas.tallies.walls import MovingWall, WallGauge, WallImpulses

GAS = gas(12, 0.2, (9, 6), "events = 900", mass=2.0, seed=3)

SEGMENTS = (
    'wall=[{from=[3, 1.5], to=[3, 4.5], name="post"}, {from=[5, 2], to=[7, 3], name="ramp", temperature=1.5}, '
    '{from=[8, 0], to=[8, 2], name="gate", opens_at=2.0, closes_at=4.0}]'
)


@pytest.mark.slow
def test_every_hit_counts_for_its_wall_and_face(make):
    log = make(SEGMENTS, "gravity.acceleration=[0.2, -0.5]", "box.left={thermal=1.2}")
    edges, g = np.linspace(0.1, 0.9, 5) * log.end_time, np.array(log.gravity)
    tally = streamed(log, edges, WallImpulses(log))
    state = log.state_at(edges[0])
    since = {disc: (edges[0], state.velocity[disc]) for disc in range(12)}
    given, faces = np.zeros((4, 7, 2)), defaultdict(float)
    rows = log.chunks(None, log.row_at(edges[0], "right"), log.row_at(edges[-1], "right"))
    ends = 0
    for batch in rows:
        for time, disc, partner, kind, place, velocity in zip(*batch[:6], strict=True):
            began, before = since[disc]
            since[disc] = time, velocity
            if partner >= 0:
                continue
            wall, block = -1 - partner, min(int(edges.searchsorted(time) - 1), 3)
            momentum = 2.0 * (before + g * (time - began) - velocity)
            given[block, wall] += momentum
            if kind == Kind.WALL_END:
                ends += 1
            elif wall >= 4:
                start, end = map(np.array, (log.walls[wall].start, log.walls[wall].end))
                along = (end - start) / np.hypot(*(end - start))
                normal = np.array([-along[1], along[0]])
                face = 0 if (place - start) @ normal > 0 else 1
                faces[wall, face, 0] += abs(momentum @ normal)
                faces[wall, face, 1] += momentum @ along
    assert ends > 5
    assert tally.given == pytest.approx(given, abs=1e-10)
    for (wall, face, which), value in faces.items():
        assert tally.faces[:, wall, face, which].sum() == pytest.approx(value, abs=1e-10)
    assert len(faces) == 12
    outward = (tally.faces[:, 0, 0, 0], -given[:, 0, 0])  # of a side all pushes are outwards
    assert outward[0] == pytest.approx(outward[1], abs=1e-10)
    assert (tally.faces[:, :4, 1] == 0).all()


@pytest.mark.slow
def test_walls_and_gravity_account_for_all_momentum(make):
    """Exact: what the discs lose, less what gravity gave them, is what walls got."""
    log = make(SEGMENTS, "gravity.acceleration=[0.2, -0.5]")
    edges = np.array([0.2, 0.5, 0.8]) * log.end_time
    tally = streamed(log, edges, WallImpulses(log))
    momentum = [2.0 * log.state_at(time).velocity.sum(axis=0) for time in edges]
    for block, (start, end) in enumerate(pairwise(range(3))):
        weight = 24.0 * np.array(log.gravity) * (edges[end] - edges[start])
        lost = momentum[start] - momentum[end] + weight
        assert tally.given[block].sum(axis=0) == pytest.approx(lost, rel=1e-11)


@pytest.mark.slow
def test_a_gate_is_exposed_while_it_is_there(make):
    log = make(SEGMENTS, "run.events=", "run.until=6")
    edges = np.linspace(0, 6, 5)  # 1.5 each, the gate open from 2 to 4
    gauge = WallGauge(log)
    stream(log, edges, gauge.tallies)
    exposed = {face.name: face.exposed for face in gauge.faces(edges)}
    assert exposed["gate, left"] == pytest.approx([3.0, 1.0, 1.0, 3.0])
    assert exposed["post, right"] == pytest.approx([4.5] * 4)
    assert exposed["left wall"] == pytest.approx([9.0] * 4)
    assert set(exposed) == {
        *(f"{side} wall" for side in ("left", "right", "bottom", "top")),
        *(f"{name}, {face}" for name in ("post", "gate") for face in ("left", "right")),
        *(f"ramp, {face}" for face in ("up", "down")),
    }
    assert gauge.area(edges) == pytest.approx(np.full(4, 54.0))


@pytest.mark.parametrize("side", ["right", "top", "left"])
def test_the_room_below_a_piston_with_a_mass(side, make):
    """The mean of its place, looked up at many times on the path that films show."""
    log = make(f'piston=[{{side="{side}", position=4, mass=3, pressure=2}}]', "run.events=1500")
    edges = np.linspace(0.0, 1.0, 9) * log.end_time
    tally = streamed(log, edges, MovingWall(log, 0))
    (track,) = piston_tracks(log, 0.0, log.end_time)
    places = np.array([[track.at(t) for t in a + (b - a) * (np.arange(400) + 0.5) / 400] for a, b in pairwise(edges)])
    assert tally.place == pytest.approx(places.mean(axis=1), rel=1e-4)
    assert np.ptp(tally.place) > 0.1


def test_the_room_below_a_driven_piston_is_exact(make, tmp_path):
    log = make('piston=[{side="right", velocity=-0.3}]', "run.events=", "run.until=10")
    edges = np.linspace(1, 9, 5)
    gauge = WallGauge(log)
    stream(log, edges, gauge.tallies)
    expected = 9 - 0.3 * (edges[1:] + edges[:-1]) / 2
    assert gauge.moving[0].place == pytest.approx(expected, rel=1e-12)
    assert gauge.area(edges) == pytest.approx(6 * expected, rel=1e-12)
    exposed = {face.name: face.exposed for face in gauge.faces(edges)}
    assert exposed["top wall"] == pytest.approx(2 * expected, rel=1e-12)
    assert exposed["right wall"] == pytest.approx([12.0] * 4)
    assert gauge.moving[0].balance(1.0, 9.0) is None
    path = craft(shutil.copyfile(log.path, tmp_path / "none.h5"), lambda file: None, {"observables": 0})
    with open_log(path) as other:
        raised("has no sample of its piston", MovingWall, other, 0)
