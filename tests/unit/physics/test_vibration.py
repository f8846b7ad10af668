"""Contacts with a vibrating side: against exact roots, and never late; velocities and energies after them."""

import math
from fractions import Fraction
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest

from idealgas import open_log, parse_scene, simulate
from idealgas.effects.vibration import EFFECT, VibratingSide
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.vibration import begin_epoch, height_on, parabola_at, vibrating_contact

pytestmark = pytest.mark.interpreted

LENGTH = 9.0


def sides(amplitude, frequency, time=0.0):
    side = VibratingSide.model_validate({"vibrating": {"amplitude": amplitude, "frequency": frequency}})
    vibration = EFFECT.make(SimpleNamespace(sides=(side,) * 4), None)
    begin_epoch(vibration, time, 0.0)
    return vibration


def exact_height(side, time):
    """By rational numbers."""
    half, start = Fraction(float(side.half)), Fraction(float(side.start))
    since = (time - start) / half
    parabola = math.floor(since + Fraction(1, 2))
    square = Fraction(float(side.acceleration)) / 2 * ((since - parabola) * half) ** 2
    return square if parabola % 2 == 0 else 2 * Fraction(float(side.amplitude)) - square


def exact_gap(side, number, disc, pull, time):
    """Height of a disc over a side, by rational numbers."""
    delay = time - Fraction(disc.t)
    position, velocity = (disc.x, disc.vx) if number < 2 else (disc.y, disc.vy)
    place = Fraction(position) + Fraction(velocity) * delay + Fraction(pull) / 2 * delay**2
    above = Fraction(LENGTH) - place if number & 1 else place
    return above - Fraction(disc.r) - exact_height(side, time)


def draw_disc(random):
    speed = random.choice([1.0, 0.01, 30.0])
    x, y = random.uniform(1.0, 8.0, 2)
    vx, vy = speed * random.normal(size=2)
    return SimpleNamespace(x=float(x), y=float(y), vx=float(vx), vy=float(vy), t=float(random.uniform(0, 3)), r=0.3)


@pytest.mark.parametrize("seed", range(60))
def test_first_contacts(seed):
    """At a contact the gap is 0 within rounding, and before it is nowhere below 0."""
    random = np.random.default_rng(seed)
    number, frequency = int(random.integers(4)), float(random.choice([0.1, 1.0, 7.3]))
    (*_, side) = sides(0.3, frequency, float(random.uniform(0, 50)))
    pull = float(random.choice([0.0, -1.0, 1.0, -20.0]))
    gravity = Gravity(pull, pull) if pull else None
    disc = draw_disc(random)
    time = vibrating_contact(disc, side, number, LENGTH, gravity)
    assert time > disc.t
    end = min(time, disc.t + 40.0)
    instants = [Fraction(float(t)) for t in np.linspace(disc.t, end, 400)[:-1]]
    assert min(exact_gap(side, number, disc, pull, t) for t in instants) > -1e-12
    if time < NEVER:
        assert abs(float(exact_gap(side, number, disc, pull, Fraction(time)))) < 1e-13 * (10 + abs(pull) * time**2)


def test_a_contact_against_mpmath():
    """About t = 0.5 the side is at 0.6 - 9.6 s²/2, while the edge of a disc falls from 1.7 with speed 2."""
    side = sides(0.3, 1.0)[2]
    disc = SimpleNamespace(x=4.0, y=2.0, vx=0.0, vy=-2.0, t=0.0, r=0.3)
    acceleration = float(side.acceleration)
    assert acceleration == pytest.approx(32 * 0.3, rel=1e-15)
    with mpmath.workdps(40):
        radius, wall = mpmath.mpf(disc.r), mpmath.mpf(0.3) * 2
        root = mpmath.findroot(
            lambda t: 2 - 2 * t - radius - wall + mpmath.mpf(acceleration) / 2 * (t - 0.5) ** 2, 0.55
        )
        assert vibrating_contact(disc, side, 2, LENGTH, None) == pytest.approx(float(root), rel=4e-16, abs=0)


def test_the_motion_is_continuous_and_its_phase_exact():
    side = sides(0.3, 1.7, 12345.678)[0]
    assert side.start == -math.fmod(12345.678, 2 * float(side.half))
    for parabola in range(1, 6):
        edge = side.start + (parabola + 0.5) * side.half
        below, above = (height_on(side, float(k), edge) for k in (parabola, parabola + 1))
        assert below[0] == pytest.approx(above[0], abs=1e-15) == pytest.approx(0.3, abs=1e-15)
        assert below[1] == pytest.approx(above[1], rel=1e-12)
    assert abs(below[1]) == pytest.approx(8 * 0.3 * 1.7, rel=1e-12)
    assert parabola_at(side, 0.0) in (0, 1, 2)


@pytest.mark.usefixtures("uncompiled")
def test_a_disc_leaves_with_twice_the_velocity_of_the_side_more(tmp_path):
    """The acceleration is 32 A f² = 8: up to t = 0.25 the side is at 4 t² and has the speed 8 t; at 0.5 it rests."""
    disc = "[[disc]]\nposition = [4, {}]\nvelocity = [0, -4]\nradius = 0.5\n"
    box = "[box]\nsize = [8, 9]\nbottom = {{ vibrating = {{ amplitude = 0.25, frequency = 1 }} }}\n"
    for time, height, speed in ((0.25, 0.25, 2.0), (0.5, 0.5, 0.0), (0.125, 0.0625, 1.0)):
        text = box.format() + disc.format(height + 0.5 + 4 * time) + "[run]\nevents = 1\n"
        summary = simulate(parse_scene(text), tmp_path / "run.h5", force=True)
        with open_log(tmp_path / "run.h5") as log:
            (rows,) = log.chunks()
            assert rows.time.tolist() == [time]
            assert rows.velocity.tolist() == [[0, 4 + 2 * speed]]
            assert log.observables["wall_energy"][1][-1].tolist() == [0, 0, ((4 + 2 * speed) ** 2 - 16) / 2, 0]
        assert summary.energy_drift == 0
