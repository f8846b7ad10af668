"""Discs in contact as decimals or an earlier run leave them: an overlap that rounding explains is accepted."""

import numpy as np
import pytest
from helpers.support import logged

from idealgas.scene import SceneError, parse_scene
from idealgas.scene.checks.overlaps import rounding

SIZE = 10.0
HEAD = f"box.size = [{SIZE}, {SIZE}]\nrun.until = 1\n"
DISC = "[[disc]]\nposition = [{}, {}]\nradius = {}\n"
BOUND = rounding(SIZE, 1.0)
"""For a radius of 0.5."""


def discs(*given):
    return HEAD + "".join(DISC.format(*disc) for disc in given)


@pytest.mark.parametrize(
    "more", ["", "gravity.acceleration = [0, -1]\n", "box.left = 'periodic'\nbox.right = 'periodic'\n"]
)
def test_the_end_of_a_run_is_a_start(tmp_path, more):
    """A contact is the last event: the discs or the disc and the side touch as well as rounding allows."""
    gas = '[[species]]\nname = "gas"\ncount = 60\nradius = 0.3\ntemperature = 1\nplacement = "lattice"\n'
    deepest = 0.0
    for seed in range(10):
        path = tmp_path / f"{seed}.h5"
        head = HEAD.replace("run.until = 1", f"run.events = {900 + seed}\nscene.seed = {seed}")
        with logged(parse_scene(head + more + gas), path) as log:
            state, radius = log.state_at(log.end_time), log.discs.radius
            deepest = max(
                deepest, *(values.max() for values in (log.observables["overlap"][1], log.observables["outside"][1]))
            )
        given = [(*map(float, place), float(r)) for place, r in zip(state.position, radius, strict=True)]
        velocities = "".join(
            f"disc.{k}.velocity = [{vx}, {vy}]\n" for k, (vx, vy) in enumerate(state.velocity.tolist())
        )
        scene = parse_scene(
            HEAD + more + "".join(DISC.format(*disc) for disc in given), overrides=velocities.splitlines()
        )
        assert np.array_equal([disc.position for disc in scene.disc], state.position)
    assert deepest > 0


def test_rows_of_touching_discs_with_two_decimals_are_accepted():
    for hundredths in range(1, 51):
        radius = hundredths / 100
        row = [(round(radius * (2 * k + 1), 2), round(radius, 2), radius) for k in range(int(SIZE / (2 * radius)))]
        assert len(parse_scene(discs(*row)).disc) == len(row)


@pytest.mark.parametrize("upper", [False, True])
def test_discs_that_touch_a_side_or_a_wall_with_two_decimals_are_accepted(upper):
    wall = "[[wall]]\nfrom = [5.1, 0.3]\nto = [5.1, 9.7]\n"
    for hundredths in range(1, 200):
        radius = hundredths / 100
        x, y = (round(SIZE - radius, 2), round(SIZE - radius, 2)) if upper else (radius, radius)
        beside = round(5.1 + (radius if upper else -radius), 2)
        assert parse_scene(discs((x, y, radius))).disc[0].position == (x, y)
        assert parse_scene(discs((beside, 5, radius)) + wall).disc[0].position == (beside, 5)


@pytest.mark.parametrize(
    ("layout", "wrong"),
    [
        (lambda depth: discs((2, 5, 0.5), (3 - depth, 5, 0.5)), "overlaps disc 0"),
        (lambda depth: discs((0.5 - depth, 5, 0.5)), "disc not in the box"),
        (lambda depth: discs((2, 9.5 + depth, 0.5)), "disc not in the box"),
        (lambda depth: discs((2 + depth, 5, 0.5)) + "[[wall]]\nfrom = [2.5, 2]\nto = [2.5, 8]\n", "overlaps wall 0"),
    ],
    ids=["disc", "left", "top", "wall"],
)
def test_the_bound_is_that_of_rounding(layout, wrong):
    parse_scene(layout(0.9 * BOUND))
    with pytest.raises(SceneError, match=wrong):
        parse_scene(layout(1.1 * BOUND))
    assert BOUND < 2e-11


def test_discs_next_to_others_in_contact_stay_in_the_way():
    """A disc placed at random overlaps no explicit disc, also where two of these overlap by rounding."""
    from idealgas.initial.build import make_gas

    gas = '[[species]]\nname = "gas"\ncount = 60\nradius = 0.3\ntemperature = 1\n'
    row = [(0.5, 0.5, 0.5), (1.5 - BOUND / 2, 0.5, 0.5), *((k + 0.5, 5, 0.5) for k in range(10))]
    position = make_gas(parse_scene(discs(*row) + gas)).position
    apart = np.hypot(*(position[:12, None] - position[12:]).transpose(2, 0, 1))
    assert apart.min() >= 0.8
