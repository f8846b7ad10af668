"""Coefficients of restitution, and the contact duration within which collisions are elastic."""

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, copy_of, exact, gamma

from idealgas.effects.bundle import Effects
from idealgas.physics.disc_disc import collide
from idealgas.physics.disc_wall import collide_with_wall
from idealgas.physics.periodic import NO_IMAGES
from idealgas.physics.restitution import (
    Restitution,
    end_epoch,
    record_collision,
    restitution_factor,
    wall_restitution_factor,
)

pytestmark = pytest.mark.interpreted


def inelastic(*last, normal=0.7, wall=0.6, contact_duration=0.25):
    return Restitution(normal, wall, contact_duration, np.array(last, float))


def test_factors_and_records():
    """1 + e, rounded once; exactly 2 of what collided less than the contact duration ago, or without the effect."""
    assert restitution_factor(None, 0, 1, 3.0) == wall_restitution_factor(None, 0, 3.0) == 2.0
    assert restitution_factor(inelastic(0.0, 2.0), 0, 1, 3.0) == 1.7
    assert restitution_factor(inelastic(0.0, 2.75), 0, 1, 3.0) == 1.7  # a contact duration ago is not less
    assert restitution_factor(inelastic(0.0, 2.875), 0, 1, 3.0) == 2.0
    assert restitution_factor(inelastic(2.875, 0.0), 0, 1, 3.0) == 2.0
    assert wall_restitution_factor(inelastic(2.0, 2.9), 0, 3.0) == 1.6
    assert wall_restitution_factor(inelastic(2.0, 2.9), 1, 3.0) == 2.0
    effect = inelastic(0.0, 0.0)
    record_collision(effect, 1, 4.5)
    record_collision(None, 1, 5.5)
    assert effect.last.tolist() == [0.0, 4.5]
    end_epoch(effect, 6.0)
    assert effect.last.tolist() == [-6.0, -1.5]


def test_discs_part_with_e_times_their_approach():
    """To 30 roundings of the speeds' sum: a velocity changes by at most twice that, by factors rounded 14 times."""
    draw = np.random.default_rng(1)
    with mpmath.workdps(50):
        for _ in range(100):
            angle, masses = draw.uniform(0, 2 * np.pi), 10.0 ** draw.uniform(-3, 3, 2)
            v = draw.normal(size=4)
            a = body(x=5.0, y=4.0, vx=v[0], vy=v[1], r=0.5, m=masses[0], t=9.0)
            b = body(x=5.0 + np.cos(angle), y=4.0 + np.sin(angle), vx=v[2], vy=v[3], r=0.5, m=masses[1], t=9.0)
            before = copy_of(a), copy_of(b)
            collide(a, b, 0, 1, NO_IMAGES, None, None, Effects(restitution=inelastic(0.0, 0.0)))
            nx, ny = exact(a.x) - exact(b.x), exact(a.y) - exact(b.y)
            speed = sum(map(abs, v)) * (abs(nx) + abs(ny))

            def approach(p, q, nx=nx, ny=ny):
                return (exact(p.vx) - exact(q.vx)) * nx + (exact(p.vy) - exact(q.vy)) * ny

            assert abs(approach(a, b) + exact(0.7) * approach(*before)) <= 2 * gamma(30) * speed
            for component in ("vx", "vy"):
                parted = zip((a, b), before, strict=True)
                change = [exact(getattr(p, component)) - exact(getattr(q, component)) for p, q in parted]
                momentum = exact(masses[0]) * change[0] + exact(masses[1]) * change[1]
                assert abs(momentum) <= gamma(30) * sum(map(abs, v)) * masses.sum()


def test_a_disc_leaves_a_wall_with_e_times_its_speed():
    """14 roundings of the speed: of k 4 by v·n, doubled, and 7 by the quotient and 1 + e; 2 by k n, 1 by v - k n."""
    draw = np.random.default_rng(2)
    with mpmath.workdps(50):
        for angle in draw.uniform(0, 2 * np.pi, 100):
            vx, vy = draw.normal(size=2)
            n = np.cos(angle), np.sin(angle)
            disc = body(vx=vx, vy=vy, r=0.5, m=2.0, t=9.0)
            collide_with_wall(disc, 0, *n, 5, inelastic(0.0), None, None)
            nx, ny = map(exact, n)
            k = (1 + exact(0.6)) * (exact(vx) * nx + exact(vy) * ny) / (nx**2 + ny**2)
            error = gamma(14) * np.hypot(vx, vy)
            assert abs(disc.vx - (exact(vx) - k * nx)) <= error
            assert abs(disc.vy - (exact(vy) - k * ny)) <= error
