"""Tangent maps in 60 digits against differences of the exact motion."""

import mpmath
import numpy as np
import pytest

from idealgas.physics.tangent import collide, fly

pytestmark = pytest.mark.interpreted

STEP = mpmath.mpf(10) ** -18
WHOLE = 4
"""Time of flight, collision and flight together."""

START = [-2.0, 0.1, 0.9, 0.02, 1.5, -0.3, -0.7, 0.11]
"""x, y, vx, vy of both bodies."""


def contact_of(distance, state, fall):
    """Time at which two bodies touch, and their positions and velocities then, as an array (2, 4)."""

    def moved(time):
        bodies = [np.array(state[:4]), np.array(state[4:])]
        return np.array(
            [
                [*(b[:2] + b[2:] * time + a * time * time / 2), *(b[2:] + a * time)]
                for b, a in zip(bodies, fall, strict=True)
            ]
        )

    def gap(time):
        return distance(*np.subtract(*moved(time))[:2])

    times = [k * mpmath.mpf(WHOLE) / 64 for k in range(65)]
    after = next(k for k in range(64) if gap(times[k]) * gap(times[k + 1]) < 0)
    time = mpmath.findroot(gap, (times[after], times[after + 1]), solver="anderson", tol=mpmath.mpf(10) ** -110)
    return time, moved(time)


def shares_of(masses, e):
    """(1 + e) μ/m of both bodies; None is an infinite mass."""
    inverse = [0 if mass is None else 1 / mpmath.mpf(mass) for mass in masses]
    return [(1 + mpmath.mpf(e)) * each / sum(inverse) for each in inverse]


def motion_of(shape, masses, e, fall):
    """The end of flight, collision and flight as a function of the start."""
    distance, normal_at = shape

    def motion(state):
        time, bodies = contact_of(distance, state, fall)
        apart = bodies[0] - bodies[1]
        normal, rest = normal_at(*apart[:2]), WHOLE - time
        impact = apart[2:] @ normal
        for body, sign, share, a in zip(bodies, (-1, 1), shares_of(masses, e), fall, strict=True):
            body[2:] += sign * share * impact * normal
            body[:2] += body[2:] * rest + a * rest * rest / 2
            body[2:] += a * rest
        return bodies.ravel()

    return motion


def differences(motion, state):
    """Derivatives of a motion's end, (n, n), by central differences extrapolated to a step of 0 after Richardson."""
    columns = []
    for k in range(len(state)):
        ends = []
        for step in (2, 1, -1, -2):
            moved = [mpmath.mpf(each) for each in state]
            moved[k] += step * STEP
            ends.append(motion(moved))
        columns.append((8 * (ends[1] - ends[2]) - (ends[0] - ends[3])) / (12 * STEP))
    return np.array(columns).T


def flat(angle):
    """Shape of a flat wall: distance from it, and its normal."""
    normal = np.array([mpmath.cos(angle), mpmath.sin(angle)])
    return (lambda x, y: normal[0] * x + normal[1] * y, lambda x, y: normal)


def round_about(distance):
    """Shape of a round wall or of a pair of discs that touch at this distance of their centres."""
    return (
        lambda x, y: mpmath.hypot(x, y) - distance,
        lambda x, y: np.array([x, y]) / mpmath.hypot(x, y),
    )


STILL, FALL, PULL = (0, 0), (-0.1, -0.2), (-0.3, 0)
"""Accelerations (x, y)."""

CASES = {
    "pair": (round_about, 1, (1.0, 1.0), 1, (STILL, STILL)),
    "light and heavy": (round_about, 1, (0.3, 50.0), 1, (FALL, FALL)),
    "inelastic pair": (round_about, 1.25, (1.0, 0.1), 0.7, (STILL, STILL)),
    "fixed disc": (round_about, 0.5, (1.0, None), 1, (STILL, STILL)),
    "fixed disc, gravity": (round_about, 0.5, (1.0, None), 0.9, (FALL, STILL)),
    "inside of a circle": (round_about, 4, (1.0, None), 1, ((-2, 3), STILL)),
    "wall": (flat, 0.3, (1.0, None), 1, (STILL, STILL)),
    "wall, gravity": (flat, -0.4, (1.0, None), 0.8, (FALL, STILL)),
    "vibrating wall": (flat, 0, (1.0, None), 1, (FALL, PULL)),
    "piston": (flat, 0, (1.0, 7.0), 0.6, (FALL, PULL)),
}
"""Shape and its size or angle, masses (None is infinite), coefficient of restitution, and accelerations."""


@pytest.mark.parametrize("sign", [1, -1])
@pytest.mark.parametrize("case", CASES)
def test_flight_collision_and_flight(case, sign):
    """Relative to the largest derivative, each one is right to 1e-20, for either sign of the normal."""
    kind, size, masses, e, fall = CASES[case]
    with mpmath.workdps(120):
        shape, curvature = kind(mpmath.mpf(size)), 1 / mpmath.mpf(size) if kind is round_about else mpmath.mpf(0)
        fall = np.array([[mpmath.mpf(each) for each in pull] for pull in fall])
        expected = differences(motion_of(shape, masses, e, fall), START)
        time, bodies = contact_of(shape[0], [mpmath.mpf(each) for each in START], fall)
        apart = bodies[0] - bodies[1]
        normal = sign * shape[1](*apart[:2])
        deviations = np.array([mpmath.mpf(int(each)) for each in np.eye(8).ravel()]).reshape(2, 4, 8)
        for i in (0, 1):
            fly(deviations, i, time)
        pull = (fall[0] - fall[1]) @ normal
        collide(deviations, 0, 1, *shares_of(masses, e), normal, sign * curvature, apart[2:], pull)
        for i in (0, 1):
            fly(deviations, i, WHOLE - time)
        largest = max(abs(each) for each in expected.ravel())
        assert max(abs(each) for each in (deviations.reshape(8, 8) - expected).ravel()) < 1e-20 * largest
