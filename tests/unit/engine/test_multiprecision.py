"""Brute force in single, double and double-double precision: one algorithm, beside the plain one and beside mpmath."""

import math

import mpmath
import numpy as np
import pytest
from helpers.support import gas_of, record, same_rows
from mpmath import mpf

from idealgas.engine.brute_force import BruteForce
from idealgas.engine.multiprecision import Columns, PreciseBruteForce
from idealgas.engine.simulation import Simulation, Stop

PRECISIONS = ("float32", "float64", "double-double")
DIGITS = {"float32": 1e4 * 2**-24, "float64": 1e4 * 2**-53, "double-double": 1e-28}
"""Largest errors after a dozen events, which multiply the first rounding by up to 1e4."""


def some_gas(n, seed, spread=False):
    """Discs of up to three radii and masses, from a lattice."""
    random = np.random.default_rng(seed)
    columns = math.ceil(math.sqrt(n))
    place = np.stack(np.meshgrid(np.arange(columns), np.arange(columns)), axis=-1).reshape(-1, 2)[:n] + 0.5
    place = place + random.uniform(-0.1, 0.1, place.shape)
    radius = random.choice([0.3, 0.2, 0.15], n) if spread else 0.3
    mass = random.choice([1.0, 5.0, 0.3], n) if spread else 1.0
    return gas_of((columns, columns), place, random.normal(size=(n, 2)), radius, mass)


@pytest.mark.parametrize("seed", range(4))
@pytest.mark.parametrize("n", [1, 2, 3, 30])
def test_in_double_precision_it_is_brute_force_bit_for_bit(n, seed):
    gas = some_gas(n, seed, spread=seed % 2 == 1)
    stop = Stop(time=3.0, events=400)
    plain, precise = Simulation(gas, BruteForce()), Simulation(gas, PreciseBruteForce("float64"))
    assert plain.length > stop.time
    assert same_rows(record(precise, stop), record(plain, stop))
    assert precise.state()[0].position.tolist() == plain.state()[0].position.tolist()


def lattice(n):
    """A lattice that touches its walls and moves along few directions: many events at one instant."""
    place = np.stack(np.meshgrid(np.arange(n), np.arange(n)), axis=-1).reshape(-1, 2) + 0.5
    velocity = np.random.default_rng(n).choice([-1.0, 0.0, 1.0], (n * n, 2))
    return gas_of((n, n), place, velocity, 0.25)


def test_ties_are_settled_as_in_brute_force():
    stop, gas = Stop(events=600), lattice(6)
    precise, plain = (record(Simulation(gas, method), stop) for method in (PreciseBruteForce("float64"), BruteForce()))
    assert same_rows(precise, plain)


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize("rows", [3, 17])
def test_neither_batches_nor_slices_change_anything(precision, rows):
    gas, stop = some_gas(9, 5), Stop(events=200)
    whole, parts = (Simulation(gas, PreciseBruteForce(precision)) for _ in range(2))
    assert same_rows(record(whole, stop), record(parts, stop, rows))
    assert all(map(np.array_equal, whole.method.columns, parts.method.columns))


def test_single_precision_has_seven_digits_all_the_way():
    made = Simulation(some_gas(9, 5), PreciseBruteForce("float32"))
    rows = record(made, Stop(events=100))
    assert {column.dtype for column in made.method.columns} == {np.dtype("f4")}
    assert (rows.position == rows.position.astype("f4")).all()
    assert (rows.time == rows.time.astype("f4")).all()


# beside 50 digits


def mp_motion(gas, events):
    """Discs after so many events: x, y, vx, vy, all at the time of the last one, and that time. O(N²), 50 digits."""
    n = len(gas)
    x, y = ([mpf(v) for v in gas.position[:, k].tolist()] for k in (0, 1))
    vx, vy = ([mpf(v) for v in gas.velocity[:, k].tolist()] for k in (0, 1))
    r, m = ([mpf(v) for v in values.tolist()] for values in (gas.radius, gas.mass))
    clock = mpf(0)
    for _ in range(events):
        actual = []
        for i in range(n):
            for place, speed, length, side in ((x, vx, gas.box[0], 0), (y, vy, gas.box[1], 2)):
                if speed[i]:
                    target = mpf(length) - r[i] if speed[i] > 0 else r[i]
                    actual.append(((target - place[i]) / speed[i], i, -1 - side))
            for j in range(i + 1, n):
                ax, ay, bx, by = x[i] - x[j], y[i] - y[j], vx[i] - vx[j], vy[i] - vy[j]
                b, c = ax * bx + ay * by, ax**2 + ay**2 - (r[i] + r[j]) ** 2
                d = b**2 - (bx**2 + by**2) * c
                if b < 0 and d >= 0:
                    actual.append(((-b - mpmath.sqrt(d)) / (bx**2 + by**2), i, j))
        delay, i, j = min(actual)
        assert delay > 0
        for k in range(n):
            x[k] += vx[k] * delay
            y[k] += vy[k] * delay
        clock += delay
        if j >= 0:
            nx, ny = (x[j] - x[i]) / (r[i] + r[j]), (y[j] - y[i]) / (r[i] + r[j])
            closing = ((vx[j] - vx[i]) * nx + (vy[j] - vy[i]) * ny) * 2 / (m[i] + m[j])
            vx[i], vy[i] = vx[i] + m[j] * closing * nx, vy[i] + m[j] * closing * ny
            vx[j], vy[j] = vx[j] - m[i] * closing * nx, vy[j] - m[i] * closing * ny
        elif j == -1:
            vx[i] = -vx[i]
        else:
            vy[i] = -vy[i]
    return x, y, vx, vy, clock


def exact(column):
    """The numbers of a column, with all their digits."""
    return [mpf(float(v)) if column.ndim == 1 else mpf(float(v[0])) + mpf(float(v[1])) for v in column]


def errors(columns: Columns, truth):
    """Largest differences of positions and velocities, over the box and the largest speed."""
    *motion, clock = truth
    x, y, vx, vy, t = (exact(column) for column in columns[:5])
    actual = (
        [a + v * (clock - s) for a, v, s in zip(x, vx, t, strict=True)],
        [a + v * (clock - s) for a, v, s in zip(y, vy, t, strict=True)],
        vx,
        vy,
    )
    fastest = max(max(map(abs, motion[2])), max(map(abs, motion[3])))
    scales = (mpf(float(exact(columns.box)[0])),) * 2 + (fastest,) * 2
    return max(
        abs(a - b) / scale
        for ours, true, scale in zip(actual, motion, scales, strict=True)
        for a, b in zip(ours, true, strict=True)
    )


@pytest.mark.parametrize("precision", PRECISIONS)
@pytest.mark.parametrize(("n", "events", "seed"), [(2, 12, 1), (3, 12, 2), (4, 12, 3), (4, 12, 4), (9, 20, 5)])
def test_it_moves_as_with_50_digits(precision, n, events, seed):
    """As many digits as it carries, less those that a dozen events cost; asked of the state before it is rounded."""
    gas = some_gas(n, seed, spread=True)
    if precision == "float32":
        gas = gas_of(
            *(np.float32(v).astype(float) for v in (gas.box, gas.position, gas.velocity, gas.radius, gas.mass))
        )
    made = Simulation(gas, PreciseBruteForce(precision))
    record(made, Stop(events=events))
    with mpmath.workdps(50):
        truth = mp_motion(gas, events)
        assert made.counters.disc_collisions > 0
        assert errors(made.method.columns, truth) < DIGITS[precision]
