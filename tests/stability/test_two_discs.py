"""Contacts and collisions of pairs at the limits of arithmetic, against 50 digits.

u = 2⁻⁵³. If the relative position of two discs is off by δ, their contact time is off by up to δ S/√D: the condition
of the problem, which grows without bound as the contact becomes grazing (D → 0). Rounding puts positions off by u times
the largest coordinate on the way, and no method can know better. So an error may be a few u, times that length, times
the condition; and whether the discs meet at all is open only where D is that small.
"""

import math

import mpmath
import numpy as np
import pytest
from helpers.support import gas_of, record, within

from idealgas.columns import Kind, empty_batch
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop

U = 2.0**-53
FEW = 4.0

methods = pytest.mark.parametrize("method", [EventDriven, BruteForce])


def exact_contact(a, b):
    """D/(v S)², time (None if they miss), condition S/√D and largest length on the way, from (x, y, vx, vy, t, r)."""
    with mpmath.workdps(50):
        a, b = ([mpmath.mpf(float(value)) for value in disc] for disc in (a, b))
        start = max(a[4], b[4])
        own, other = ([*(disc[k] + disc[k + 2] * (start - disc[4]) for k in (0, 1)), *disc[2:4]] for disc in (a, b))
        x, y, vx, vy = (p - q for p, q in zip(own, other, strict=True))
        reach, speed_squared, approach = a[5] + b[5], vx**2 + vy**2, x * vx + y * vy
        D = approach**2 - speed_squared * (x**2 + y**2 - reach**2)
        largest = reach + max(abs(value) for value in (*a[:2], *b[:2], *own[:2], *other[:2]))
        share = float(D / (speed_squared * reach**2)) if speed_squared else 0.0
        if D <= 0 or approach >= 0:
            return share, None, math.inf, float(largest)
        delay = (-approach - mpmath.sqrt(D)) / speed_squared
        return share, start + delay, float(reach / mpmath.sqrt(D)), float(largest + mpmath.sqrt(speed_squared) * delay)


def meeting(gas, method):
    """Time of the first event if it is a collision of two discs, else None."""
    rows = record(Simulation(gas, method()), Stop(events=1))
    return float(rows.time[0]) if rows.kind[0] == Kind.DISC else None


@methods
@pytest.mark.parametrize("side", [1, -1], ids=["wide", "close"])
@pytest.mark.parametrize("exponent", range(1, 17))
def test_grazing_pairs(exponent, side, method):
    """Impact parameters σ(1 ± 10^-exponent) from all directions, with radii of all ratios between 1/100 and 100."""
    draw = np.random.default_rng(exponent)
    undecided, max_errors = 0, 0.0
    for _ in range(16):
        angle, radius = draw.uniform(0, 2 * np.pi), 10.0 ** draw.uniform(-2, 0, 2)
        along = np.array([math.cos(angle), math.sin(angle)])
        reach = radius.sum()
        start = np.array([8.0, 8.0]) + draw.uniform(-1, 1, 2)
        across = reach * (1 + side * 10.0**-exponent) * np.array([-along[1], along[0]])
        common = 0.01 * draw.normal(size=2)
        discs = [start, start + draw.uniform(1.1, 2) * reach * along + across]
        gas = gas_of((16, 16), discs, [along + common, common], radius)
        a, b = ((*gas.position[k], *gas.velocity[k], 0.0, radius[k]) for k in (0, 1))
        D, time, condition, largest = exact_contact(a, b)
        result = meeting(gas, method)
        if abs(D) > FEW * U * largest / reach:
            assert (result is None) == (time is None)
        else:
            undecided += 1
        if time is not None and result is not None:
            max_errors = max(max_errors, float(abs(result - time) / (U * (largest * condition + time))))
    within("grazing pairs: contact time, in u times condition", max_errors, FEW)
    assert undecided == 0 or exponent >= 12


@methods
@pytest.mark.parametrize("exponent", range(1, 16))
def test_nearly_equal_velocities(exponent, method):
    """One disc follows another and is faster by 10^-exponent; both move so slowly that no wall comes first."""
    draw, max_errors = np.random.default_rng(exponent), 0.0
    for _ in range(8):
        angle = draw.uniform(0, 2 * np.pi)
        along = np.array([math.cos(angle), math.sin(angle)])
        relative = 10.0**-exponent * (along + 0.3 * draw.normal(size=2))
        common = 0.1 * draw.normal(size=2)
        common *= min(1.0, 0.1 * 10.0**-exponent / np.hypot(*common) * 16)
        gas = gas_of((16, 16), [(8, 8), (8, 8) + 2.5 * along], [common + relative, common], 1.0)
        a, b = ((*gas.position[k], *gas.velocity[k], 0.0, 1.0) for k in (0, 1))
        _, time, condition, largest = exact_contact(a, b)
        result = meeting(gas, method)
        assert (result is None) == (time is None)
        if time is not None:
            max_errors = max(max_errors, float(abs(result - time) / (U * (largest * condition + time))))
    within("nearly equal velocities: contact time, in u times condition", max_errors, FEW)


@methods
def test_every_contact_of_a_gas(method):
    """Each collision of 100 unequal discs comes when the two discs' last records say, which are of different times."""
    draw = np.random.default_rng(3)
    place = np.stack(np.meshgrid(np.arange(10), np.arange(10)), axis=-1).reshape(-1, 2) * 2.0 + 1.0
    radius = 10.0 ** draw.uniform(-2, -0.05, 100)
    gas = gas_of((20, 20), place, draw.normal(size=(100, 2)), radius)
    simulation = Simulation(gas, method())
    batch = empty_batch(4096)
    rows = simulation.advance(Stop(events=800), batch)
    assert simulation.counters.events == 800, "records are of one epoch"
    last = [(*gas.position[k], *gas.velocity[k], 0.0, radius[k]) for k in range(100)]
    max_errors = 0.0
    for row in range(rows):
        i, j = int(batch.disc[row]), int(batch.partner[row])
        if j > i:
            _, time, condition, largest = exact_contact(last[i], last[j])
            error = float(abs(time - batch.time[row]))
            max_errors = max(max_errors, error / (U * (largest * condition + float(time))))
            after = [(*batch.position[r], *batch.velocity[r], batch.time[r], 0.0) for r in (row, row + 1)]
            last[i], last[j] = ((*values[:5], radius[k]) for k, values in zip((i, j), after, strict=True))
        elif j < 0:
            last[i] = (*batch.position[row], *batch.velocity[row], batch.time[row], radius[i])
    within("every contact of a gas: time, in u times condition", max_errors, FEW)


@methods
@pytest.mark.parametrize("exponent", [-12, -6, 0, 6, 12])
def test_collisions_of_unequal_masses(exponent, method):
    """Velocities after a collision to 30 u of the speeds' sum, whatever the ratio of the masses.

    A disc's velocity changes by at most twice that sum, a product of factors rounded 14 times in all, and is rounded
    once more itself.
    """
    draw, max_errors = np.random.default_rng(exponent + 100), 0.0
    for _ in range(20):
        velocity = draw.normal(size=(2, 2))
        closing = velocity[0] - velocity[1]
        angle = math.atan2(closing[1], closing[0]) + draw.uniform(-1, 1)
        normal = np.array([math.cos(angle), math.sin(angle)])
        gas = gas_of((16, 16), [(8, 8), (8, 8) + 1.01 * normal], velocity, 0.5, [10.0**exponent, 1.0])
        rows = record(Simulation(gas, method()), Stop(events=1))
        assert rows.kind[0] == Kind.DISC
        with mpmath.workdps(50):
            r = mpmath.matrix((rows.position[0] - rows.position[1]).tolist())
            v = [mpmath.matrix(row.tolist()) for row in velocity]
            m = [mpmath.mpf(float(mass)) for mass in gas.mass]
            k = 2 * (r.T * (v[0] - v[1]))[0] / ((r.T * r)[0] * (m[0] + m[1]))
            expected = [v[0] - k * m[1] * r, v[1] + k * m[0] * r]
            error = max(float(abs(rows.velocity[d, c] - expected[d][c])) for d in (0, 1) for c in (0, 1))
        max_errors = max(max_errors, error / (U * np.hypot(*velocity.T).sum()))
    within("collisions of unequal masses: velocities, in u times speeds", max_errors, 30)
