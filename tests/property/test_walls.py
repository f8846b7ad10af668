"""Discs among walls drawn at random: no path between two events comes nearer to a wall than the disc's radius.

The bound on the depth is rounding: contacts are rounded by less than 1e-12 of the box.
"""

from typing import NamedTuple

import numpy as np
import pytest
from helpers.random_walls import HEIGHT, WIDTH, crossings, distances, some_walls
from helpers.support import batches, gas_of
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from idealgas.effects.bundle import Effects
from idealgas.effects.wall import make_segments
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.physics.gravity import Gravity
from idealgas.state import Gas

EVENTS = 120
DEPTH = 1e-11
SAMPLES = 33  # of a parabola


class Scene(NamedTuple):
    walls: list[tuple[tuple[float, float], tuple[float, float]]]
    number: int
    radius: float
    seed: int


scenes = st.builds(
    Scene,
    walls=some_walls.filter(bool),
    number=st.integers(1, 4),
    radius=st.sampled_from([0.02, 0.1, 0.3, 0.45]),
    seed=st.integers(0, 2**32),
)


def place_discs(scene: Scene) -> Gas | None:
    """Discs at random clear of the walls and of each other; None if that does not come about."""
    draw, placed = np.random.default_rng(scene.seed), []
    walls = np.array(scene.walls)
    for _ in range(200):
        p = draw.uniform(scene.radius, (WIDTH - scene.radius, HEIGHT - scene.radius))
        clear = distances(p[None], walls).min() > scene.radius * (1 + 1e-9)
        if clear and all(np.hypot(*(p - q)) > 2 * scene.radius for q in placed):
            placed.append(p)
        if len(placed) == scene.number:
            return gas_of((WIDTH, HEIGHT), placed, draw.normal(size=(scene.number, 2)), scene.radius)
    return None


def assert_walls_hold(scene: Scene, gravity: tuple[float, float] | None = None) -> None:
    gas = place_discs(scene)
    if gas is None:
        return
    walls, pull = np.array(scene.walls), np.array(gravity or (0.0, 0.0))
    segments = make_segments(walls[:, 0], walls[:, 1])
    effects = Effects(segments=segments, gravity=Gravity(*gravity) if gravity else None)
    simulation, stop = Simulation(gas, EventDriven(), effects), Stop(events=EVENTS)
    since = np.zeros(scene.number)
    position, velocity = gas.position.copy(), gas.velocity.copy()
    for rows in batches(simulation, stop, 2 * EVENTS):
        for time, disc, place, after in zip(rows.time, rows.disc, rows.position, rows.velocity, strict=True):
            assert_clear(position[disc], velocity[disc], pull, time - since[disc], place, walls, scene.radius)
            since[disc], position[disc], velocity[disc] = time, place, after


def assert_clear(start, velocity, pull, duration, end, walls, radius) -> None:
    """A flight stays clear of the walls and inside the box, and ends where it should."""
    time = np.linspace(0.0, duration, SAMPLES)[:, None]
    path = start + velocity * time + 0.5 * pull * time**2
    assert np.abs(path[-1] - end).max() < DEPTH
    assert distances(path, walls).min() > radius - DEPTH
    assert not crossings(path[:-1], path[1:], walls).any()
    assert (path > radius - DEPTH).all()
    assert (path < np.array([WIDTH, HEIGHT]) - radius + DEPTH).all()


few = settings(max_examples=300, deadline=None, derandomize=True, suppress_health_check=[HealthCheck.too_slow])
many = settings(few, max_examples=20_000)


pulls = st.sampled_from([None, (0.0, -1.0), (0.3, 0.1), (-2.0, 0.0)])


@few
@given(scenes, pulls)
@pytest.mark.slow
def test_no_disc_crosses_a_wall(scene, gravity):
    assert_walls_hold(scene, gravity)


@pytest.mark.long
@many
@given(scenes, pulls)
def test_no_disc_crosses_a_wall_in_many_scenes(scene, gravity):
    assert_walls_hold(scene, gravity)
