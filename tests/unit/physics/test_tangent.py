"""Tangent maps against differences of the exact motion in 60 digits."""

import mpmath
import numpy as np
import pytest

from idealgas.physics.tangent import collide_smooth, fly, reflect

pytestmark = pytest.mark.interpreted

STEP = mpmath.mpf(10) ** -25


def differences(motion, state):
    """Derivatives of a motion's end with respect to its start, (n, n), by central differences."""
    columns = []
    for k in range(len(state)):
        ends = []
        for sign in (1, -1):
            moved = [mpmath.mpf(each) for each in state]
            moved[k] += sign * STEP
            ends.append(motion(moved))
        columns.append([float((a - b) / (2 * STEP)) for a, b in zip(*ends, strict=True)])
    return np.array(columns).T


@pytest.mark.parametrize("masses", [(1.0, 1.0), (1.0, 0.1), (0.3, 50.0)])
def test_flight_collision_and_flight(masses):
    """Two discs whose radii add up to 1; the collision is in the middle of the flight of 4 units of time."""
    start = [-2.0, 0.1, 0.9, 0.02, 1.5, -0.3, -0.7, 0.11]  # x, y, vx, vy of both
    whole = 4.0

    def motion(state):
        x, y, vx, vy = (state[k] - state[4 + k] for k in range(4))
        b, c, v2 = x * vx + y * vy, x * x + y * y - 1, vx * vx + vy * vy
        time = c / (-b + mpmath.sqrt(b * b - v2 * c))
        nx, ny = x + vx * time, y + vy * time
        impulse = 2 * mpmath.mpf(masses[0]) * masses[1] / (mpmath.mpf(masses[0]) + masses[1]) * (nx * vx + ny * vy)
        end = []
        for k, sign in ((0, -1), (1, 1)):
            old = state[4 * k + 2 : 4 * k + 4]
            new = [old[0] + sign * impulse * nx / masses[k], old[1] + sign * impulse * ny / masses[k]]
            end += [state[4 * k + a] + old[a] * time + new[a] * (whole - time) for a in (0, 1)] + new
        return end

    with mpmath.workdps(60):
        expected = differences(motion, start)
        x, y, vx, vy = (mpmath.mpf(start[k]) - start[4 + k] for k in range(4))
        b, c, v2 = x * vx + y * vy, x * x + y * y - 1, vx * vx + vy * vy
        time = c / (-b + mpmath.sqrt(b * b - v2 * c))
        contact = [float(each) for each in (x + vx * time, y + vy * time, vx, vy)]
        time = float(time)
    deviations = np.eye(8).reshape(2, 4, 8)
    for i in (0, 1):
        fly(deviations, i, time)
    collide_smooth(deviations, 0, 1, np.array(masses), *contact)
    for i in (0, 1):
        fly(deviations, i, whole - time)
    assert np.abs(deviations.reshape(8, 8) - expected).max() < 1e-12 * np.abs(expected).max()


@pytest.mark.parametrize("gravity", [0.0, -1.3, 0.4])
@pytest.mark.parametrize("axis", [0, 1])
def test_flight_reflection_and_flight(axis, gravity):
    """A disc falls or flies to a side at 0 along the axis, and away from it for the rest of 2 units of time."""
    start, whole = [0.7, 0.5, -1.0, -1.1], 2.0

    def motion(state):
        place, velocity = state[axis], state[2 + axis]
        root = mpmath.sqrt(velocity**2 - 2 * gravity * place)
        time = 2 * place / (-velocity + root)
        hit = velocity + gravity * time
        rest = whole - time
        end = [state[0] + state[2] * whole, state[1] + state[3] * whole, state[2], state[3]]
        end[axis], end[2 + axis] = -hit * rest + mpmath.mpf(gravity) * rest**2 / 2, -hit + gravity * rest
        return end

    with mpmath.workdps(60):
        expected = differences(motion, start)
        place, velocity = mpmath.mpf(start[axis]), mpmath.mpf(start[2 + axis])
        time = 2 * place / (-velocity + mpmath.sqrt(velocity**2 - 2 * gravity * place))
        time, hit = float(time), float(velocity + gravity * time)
    deviations = np.eye(4)[None].copy()
    fly(deviations, 0, time)
    reflect(deviations, 0, axis, hit, gravity)
    fly(deviations, 0, whole - time)
    assert np.abs(deviations[0] - expected).max() < 1e-12 * np.abs(expected).max()
