"""A side that follows a sine: its motion in closed form, and its contacts beside 50 digits and beside a fine scan."""

import math
from functools import partial
from types import SimpleNamespace

import mpmath
import numpy as np
import pytest
from helpers.rounding import U, exact
from helpers.support import within

from idealgas import open_log, parse_scene, simulate
from idealgas.effects.vibration import EFFECT, VibratingSide
from idealgas.engine.records import DISC
from idealgas.jit import aligned, inline, njit
from idealgas.physics.gravity import Gravity
from idealgas.physics.motion import NEVER
from idealgas.physics.vibration import begin_epoch, concave_share, motion_at, vibrating_contact

LENGTH, RADIUS = 9.0, 0.3


def sides(amplitude, frequency, time=0.0, motion="sine"):
    table = {"vibrating": {"amplitude": amplitude, "frequency": frequency, "motion": motion}}
    vibration = EFFECT.make(SimpleNamespace(sides=(VibratingSide.model_validate(table),) * 4), None)
    begin_epoch(vibration, time, 0.0)
    return vibration


@pytest.mark.interpreted
@pytest.mark.parametrize("frequency", [0.1, 1.7, 30.0])
def test_height_velocity_and_acceleration(frequency):
    """A (1 - cos ωt), A ω sin ωt and A ω² cos ωt with 50 digits, though the clock restarts at 12345.678."""
    draw, side = np.random.default_rng(1), sides(0.3, frequency, 12345.678)[0]
    half = exact(side.half)
    assert side.start == -math.fmod(12345.678, 2 * float(side.half))
    with mpmath.workdps(50):
        for time in draw.uniform(0, 4 * side.half, 300).tolist():
            since = exact(time) - exact(side.start)
            phase, omega = mpmath.pi * since / half, mpmath.pi / half
            expected = 1 - mpmath.cos(phase), omega * mpmath.sin(phase), omega**2 * mpmath.cos(phase)
            turn = 2 * U * float(phase)  # two roundings of the phase
            for value, known, scale in zip(motion_at(side, time), expected, (1, omega, omega**2), strict=True):
                assert abs(value - 0.3 * known) <= 0.3 * scale * (turn + 12 * U)


@pytest.mark.interpreted
def test_the_start_is_at_rest_without_loss_of_digits():
    """Soon after the start the height is A (ωt)²/2, to the last digits of a number of 1e-20."""
    side = sides(0.3, 1.0)[0]
    assert motion_at(side, 0.0) == (0.0, 0.0, side.acceleration)
    assert side.acceleration == pytest.approx(0.3 * (2 * math.pi) ** 2, rel=4 * U)
    assert motion_at(side, 1e-10)[0] == pytest.approx(0.3 * (2e-10 * math.pi) ** 2 / 2, rel=16 * U, abs=0)


@pytest.mark.interpreted
def test_both_motions_have_the_same_range_and_known_mean_squares():
    """Mean squares of the velocity are (2πAf)²/2 and (8Af)²/3, of the height about its mean A²/2 and 8A²/15."""
    times = (np.arange(4000) + 0.5) / 4000 / 1.7
    for motion, speed, height in (("sine", (2 * math.pi) ** 2 / 2, 0.5), ("parabolas", 64 / 3, 8 / 15)):
        side = sides(0.3, 1.7, motion=motion)[0]
        heights, velocities, _ = np.array([motion_at(side, time) for time in times]).T
        assert (heights.min(), heights.max()) == pytest.approx((0, 0.6), abs=1e-6)
        assert heights.mean() == pytest.approx(0.3, rel=1e-6)
        assert (velocities**2).mean() == pytest.approx(speed * (0.3 * 1.7) ** 2, rel=1e-6)
        assert ((heights - 0.3) ** 2).mean() == pytest.approx(height * 0.3**2, rel=1e-6)
        peak = EFFECT.driving_speed(sides(0.3, 1.7, motion=motion), None)
        assert peak == pytest.approx(np.abs(velocities).max(), rel=1e-3)


@pytest.mark.interpreted
def test_where_the_curvature_of_the_gap_changes():
    """At the time of arccos(pull/Aω²), to the precision of the formula; beyond Aω² it never does."""
    side = sides(0.3, 1.7)[0]
    for ratio in np.linspace(-1, 1, 201).tolist():
        share = concave_share(side, ratio * side.acceleration)
        assert share == pytest.approx(math.acos(ratio) / math.pi, abs=3e-8 / math.pi)
    assert [concave_share(side, pull) for pull in (-1e9, 1e9)] == [1.0, 0.0]


def rounding(side, disc, pull, time):
    """How far rounding may take a gap from zero at a contact, and its slope there.

    Each term is a number that is rounded, times the number of its roundings; the last are those of the clock.
    """
    delay, since = time - disc.t, time - side.start
    height, speed, _ = motion_at(side, time)
    velocity = disc.vy + pull * delay
    slope = velocity - speed
    terms = 2 * LENGTH + abs(disc.y) + 4 * abs(disc.vy * delay) + 3 * abs(pull) * delay**2 + 12 * height
    return U * (terms + abs(velocity) * delay + 3 * since * abs(speed) + 2 * abs(slope) * time), slope


def exact_gap(side, disc, pull, time):
    """Gap between a disc and the bottom, with the surrounding precision."""
    delay, since = time - exact(disc.t), time - exact(side.start)
    above = exact(disc.y) - exact(disc.r) + exact(disc.vy) * delay + exact(pull) / 2 * delay**2
    return above - exact(side.amplitude) * (1 - mpmath.cos(mpmath.pi * since / exact(side.half)))


@pytest.mark.interpreted
@pytest.mark.parametrize("hits", [300, pytest.param(10**4, marks=pytest.mark.slow)])
def test_contacts_beside_50_digits(hits):
    """The gap is 0 within rounding, and the time is the zero's within this error over the slope, unless it grazes."""
    draw, grazing = np.random.default_rng(hits), 0
    while hits:
        (*_, side, _) = sides(0.3, draw.choice([0.1, 1.0, 7.3]), draw.uniform(0, 50))
        pull = draw.choice([0.0, 0.1, -0.1, 1.0, -1.0, -20.0]) * draw.choice([1.0, side.acceleration])
        y, speed, t = draw.uniform(1.0, 8.0), draw.choice([1.0, 0.01, 30.0]), draw.uniform(0, 3)
        disc = SimpleNamespace(x=4.0, y=y, vx=0.0, vy=speed * draw.normal(), t=t, r=RADIUS)
        time = vibrating_contact(disc, side, 2, LENGTH, Gravity(0.0, pull) if pull else None)
        if time == NEVER:
            assert pull > 0 or disc.vy >= 0
            continue
        hits -= 1
        error, slope = rounding(side, disc, pull, time)
        with mpmath.workdps(50):
            gap = partial(exact_gap, side, disc, pull)
            assert abs(gap(exact(time))) <= error
            if slope**2 > 8 * error * (side.acceleration + abs(pull)):
                late = 2 * error / abs(slope)
                assert gap(exact(time) - late) > 0 > gap(exact(time) + late)
            else:
                grazing += 1
    assert grazing < 5


@pytest.mark.interpreted
def test_a_gap_that_is_negative_because_of_rounding():
    """By 1e-12, at the lowest point, where the gap has the curvature -Aω²: as in free fall with this acceleration.

    The disc is met at once if it sinks, when it begins to sink if it does not rise to zero, and else when it is back.
    """
    side = sides(0.3, 1.0)[2]
    a = float(side.acceleration)
    for slope, expected in ((-1e-9, 0.0), (0.0, 0.0), (1e-7, 1e-7 / a), (1e-3, 2e-3 / a)):
        disc = SimpleNamespace(x=4.0, y=RADIUS - 1e-12, vx=0.0, vy=slope, t=0.0, r=RADIUS)
        time = vibrating_contact(disc, side, 2, LENGTH, None)
        assert time == pytest.approx(expected, rel=1e-4, abs=1e-50)
    late = 0.25 - 1e-7  # the end of the concave piece comes before the gap is zero, and then it rises ever faster
    height, speed, _ = motion_at(side, late)
    disc = SimpleNamespace(x=4.0, y=RADIUS + height - 1e-12, vx=0.0, vy=speed + 1e-6, t=late, r=RADIUS)
    assert vibrating_contact(disc, side, 2, LENGTH, None) == NEVER


@inline
def scanned_gap(side, disc, pull, time):
    """Gap between a disc and the bottom, with the sine of the C library."""
    delay, sine = time - disc.t, math.sin(math.pi * (time - side.start) / (2.0 * side.half))
    return disc.y - disc.r + disc.vy * delay + 0.5 * pull * delay * delay - 2.0 * side.amplitude * sine * sine


@njit
def scan(vibration, discs, pulls, result):
    """Contact times, and least gaps before: at 200 points a period, and where three of them have a minimum by search.

    Where a disc leaves for good, the scan ends.
    """
    for i in range(discs.shape[0]):
        side, disc, pull = vibration[i], discs[i], pulls[i]
        result[i, 0] = end = vibrating_contact(disc, side, 2, LENGTH, Gravity(0.0, pull))
        now = before_last = last = disc.t
        least = earlier = earliest = np.inf
        leaves = False
        while now < end and not leaves:
            now = min(now + 0.01 * side.half, end)
            gap = scanned_gap(side, disc, pull, now)
            if earliest >= earlier and earlier <= gap:
                low, high = before_last, now
                for _ in range(60):
                    a, b = low + (high - low) / 3.0, high - (high - low) / 3.0
                    at_a, at_b = scanned_gap(side, disc, pull, a), scanned_gap(side, disc, pull, b)
                    low, high = (low, b) if at_a < at_b else (a, high)
                    least = min(least, min(at_a, at_b))
            least = min(least, gap)
            earliest, earlier, before_last, last = earlier, gap, last, now
            leaves = gap > 2.0 * side.amplitude and disc.vy + pull * (now - disc.t) >= 0.0 <= pull
        result[i, 1], result[i, 2] = least, last


def approaches(n):
    """Sides, n discs and their accelerations: any, grazing, grazing where the curvature changes, and after a contact.

    A disc that would have to begin inside the side is left out.
    """
    least, n = n, 3 * n // 2
    draw = np.random.default_rng(n)
    few = zip(10.0 ** draw.uniform(-3, 0, 100), 10.0 ** draw.uniform(-1, 1, 100), draw.uniform(0, 50, 100), strict=True)
    vibration = np.resize(np.concatenate([sides(*values)[:1] for values in few]), n).view(np.recarray)
    amplitude, omega = vibration.amplitude, vibration.omega
    pull = draw.choice([-1.0, 1.0, -1.0, 1.0, 0.0], n) * 10.0 ** draw.uniform(-2, 2, n) * vibration.acceleration
    t, kind = draw.uniform(0, 2, n) * vibration.half, draw.integers(0, 4, n)
    ahead = np.where((kind == 1) | (kind == 2), 10.0 ** draw.uniform(-2, 0, n) * vibration.half, 0.0)
    bend = np.arccos(np.clip(pull / vibration.acceleration, -1, 1)) * draw.choice([-1, 1], n)
    phase = omega * (t + ahead - vibration.start)
    ahead += np.where(kind == 2, np.mod(bend - phase, 2 * np.pi) / omega, 0.0)
    phase = omega * (t + ahead - vibration.start)
    grazing = amplitude * draw.choice([-1, 1], n) * 10.0 ** draw.uniform(-14, -2, n)
    gap = np.choose(kind, [amplitude * 10.0 ** draw.uniform(-6, 0.6, n), grazing, grazing, 0.0])
    any_speed = draw.choice([-1, 1], n) * 10.0 ** draw.uniform(-2, 2, n)
    slope = amplitude * omega * np.choose(kind, [any_speed, 0.0, 0.0, 10.0 ** draw.uniform(-9, 1, n)])
    slope = np.where(
        pull < 0, np.minimum(slope, -6 * pull * vibration.half), slope
    )  # up to some six periods in the air
    velocity = slope + amplitude * omega * np.sin(phase)
    discs = aligned(n, DISC)
    discs.r, discs.t, discs.vy = RADIUS, t, velocity - pull * ahead
    height = gap + 2 * amplitude * np.sin(phase / 2) ** 2 - velocity * ahead + 0.5 * pull * ahead**2
    discs.y = RADIUS + height
    outside = (kind == 3) | (height > 2 * amplitude * np.sin(omega * (t - vibration.start) / 2) ** 2)
    outside = np.flatnonzero(outside)[:least]
    return vibration[outside], discs[outside], pull[outside], kind[outside]


@pytest.mark.parametrize(
    "n", [pytest.param(100, marks=pytest.mark.interpreted), 10**4, pytest.param(10**6, marks=pytest.mark.slow)]
)
def test_no_contact_is_missed(n):
    """Before a contact the gap is nowhere below zero, and at the contact it is zero, within rounding."""
    vibration, discs, pull, kind = approaches(n)
    result = np.empty((n, 3))
    scan(vibration, discs, pull, result)
    time, least, last = result.T
    missed = worst = 0.0
    for side, disc, a, begin, lowest, end in zip(vibration, discs, pull, time, least, last, strict=True):
        error, _ = rounding(side, disc, a, end)
        worst = max(worst, -lowest / error)
        if begin < NEVER:
            missed = max(missed, abs(scanned_gap(side, disc, a, begin)) / error)
    within("gap before a contact with a sine / bound of rounding", worst, 1.0)
    within("gap at a contact with a sine / bound of rounding", missed, 1.0)
    assert np.bincount(kind, minlength=4).min() > n / 10
    assert 0.2 < (time < NEVER).mean() < 0.95


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
def test_a_disc_leaves_with_twice_the_velocity_of_the_side_more(tmp_path):
    """After a quarter, a half and three quarters of a period the height is A, 2A, A, the velocity πA/2, 0, -πA/2."""
    disc = "[[disc]]\nposition = [4, {}]\nvelocity = [0, -4]\nradius = 0.5\n"
    side = 'vibrating = {amplitude = 0.25, frequency = 0.25, motion = "sine"}'
    for time, height, speed in ((1, 0.25, math.pi / 8), (2, 0.5, 0), (3, 0.25, -math.pi / 8)):
        text = f"[box]\nsize = [8, 19]\nbottom = {{ {side} }}\n" + disc.format(height + 0.5 + 4 * time)
        simulate(parse_scene(text + "[run]\nevents = 1\n"), tmp_path / "run.h5", force=True)
        with open_log(tmp_path / "run.h5") as log:
            (rows,) = log.chunks()
            assert rows.time.tolist() == pytest.approx([time], rel=2 * U)
            assert rows.velocity.tolist() == [[0, pytest.approx(4 + 2 * speed, rel=8 * U)]]
            given = (rows.velocity[0, 1] ** 2 - 16) / 2
            assert log.observables["wall_energy"][1][-1].tolist() == [0, 0, pytest.approx(given, abs=16 * U), 0]
