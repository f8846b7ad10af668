"""What a thermal wall emits, as a function of its random numbers, beside 50 digits; and those numbers."""

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, exact, gamma

from idealgas.physics.disc_wall import collide_with_wall
from idealgas.physics.rotation import Rotation
from idealgas.physics.thermal import Thermal, emit, is_thermal, uniform

pytestmark = [pytest.mark.interpreted, pytest.mark.filterwarnings("ignore:overflow encountered")]

WORD = 1 << 64


def walls(*temperature, seed=7, discs=4):
    return Thermal(np.array(temperature, float), np.uint64(seed), np.zeros(discs, np.uint64))


def mixed(z):
    """SplitMix64's output function in whole numbers."""
    z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9 % WORD
    z = (z ^ (z >> 27)) * 0x94D049BB133111EB % WORD
    return z ^ (z >> 31)


def test_random_numbers_are_those_of_splitmix64_for_disc_and_emission():
    """Exactly: 53 bits of a counter's hash, one added, so that none is zero."""
    golden = 0x9E3779B97F4A7C15
    thermal = walls(1.0, seed=2**63 + 5)
    for disc_id in range(4):
        for emission in (0, 1, 2, 10**9):
            thermal.emissions[disc_id] = emission
            for draw in range(3):
                key = mixed((2**63 + 5 + golden * (disc_id + 1)) % WORD)
                bits = mixed((mixed((key + golden * (8 * emission + draw + 1)) % WORD) + key) % WORD)
                assert uniform(thermal, disc_id, draw) == ((bits >> 11) + 1) * 2.0**-53


@pytest.mark.parametrize("angle", [0.0, 0.7, 2.5, 5.0])
def test_emitted_velocities(angle):
    """exp(-m v²/2T) of the normal speed is the first number; the tangential velocity and the spin are Box and Muller's.

    The speed: 4 roundings of the logarithm's product (itself good to an ulp), halved by the root, and its own: 3. The
    others: 22 of their length: its two roots 6, products 2, and 14 of the turn, which is off by a product and 2π.
    """
    draw = np.random.default_rng(int(10 * angle))
    n = np.cos(angle), np.sin(angle)
    nx, ny = map(float, n)
    with mpmath.workdps(50):
        for seed in range(60):
            temperature, mass, inertia = 10.0 ** draw.uniform(-3, 3, 3)
            thermal, rotation = (
                walls(-1.0, temperature, seed=seed),
                Rotation(np.zeros(4), np.full(4, inertia), 0.0, 0.0),
            )
            u = [exact(uniform(thermal, 2, k)) for k in range(3)]
            disc = body(vx=9.0, vy=9.0, m=mass)
            emit(disc, 2, nx, ny, 1, thermal, rotation)
            t, m, i = map(exact, (temperature, mass, inertia))
            speed = mpmath.sqrt(-2 * t / m * mpmath.log(u[0]))
            length, turn = mpmath.sqrt(-2 * mpmath.log(u[1])), 2 * mpmath.pi * u[2]
            along = mpmath.sqrt(t / m) * length
            expected = speed * exact(nx) - along * mpmath.cos(turn) * exact(ny)
            across = speed * exact(ny) + along * mpmath.cos(turn) * exact(nx)
            error = gamma(3 + 2) * speed + gamma(22 + 2) * along  # each times a component, and summed
            assert abs(disc.vx - expected) <= error
            assert abs(disc.vy - across) <= error
            spin = mpmath.sqrt(t / i) * length
            assert abs(rotation.omega[2] - spin * mpmath.sin(turn)) <= gamma(22) * spin
            assert thermal.emissions.tolist() == [0, 0, 1, 0]
            assert not rotation.omega[[0, 1, 3]].any()


def test_it_is_the_law_of_a_gas_that_streams_out():
    """P(speed > v) = exp(-m v²/2T) is the first number: with v from it, it comes back to the rounding of v."""
    thermal = walls(0.7)
    with mpmath.workdps(50):
        for disc_id in range(4):
            disc = body(vx=0.0, vy=0.0, m=1.3)
            number = exact(uniform(thermal, disc_id, 0))
            emit(disc, disc_id, 1.0, 0.0, 0, thermal, None)
            exponent = exact(1.3) * exact(disc.vx) ** 2 / (2 * exact(0.7))
            assert abs(mpmath.exp(-exponent) - number) <= 2 * gamma(5) * exponent * number


def test_which_walls_emit_and_on_what_their_random_numbers_depend():
    thermal = walls(-1.0, 0.0, 2.0)
    assert [is_thermal(thermal, wall) for wall in range(3)] == [False, True, True]
    assert not is_thermal(None, 0)
    cold, mirrored = body(vx=1.0, vy=-2.0, m=1.0), body(vx=1.0, vy=-2.0, m=1.0)
    collide_with_wall(cold, 0, 0.0, 1.0, 1, None, None, thermal)
    collide_with_wall(mirrored, 0, 0.0, 1.0, 0, None, None, thermal)
    assert (cold.vx, cold.vy) == (0.0, 0.0)
    assert (mirrored.vx, mirrored.vy) == (1.0, 2.0)
    result, other = walls(1.0), walls(9.0, 2.0, discs=3)
    result.emissions[:] = 3
    other.emissions[:] = [8, 3, 0]
    assert [uniform(result, 1, draw) for draw in range(3)] == [uniform(other, 1, draw) for draw in range(3)]
    assert uniform(result, 1, 0) == uniform(result, 1, 0)
    numbers = {
        uniform(walls(1.0, seed=seed), disc_id, draw) for seed in range(3) for disc_id in range(3) for draw in range(3)
    }
    assert len(numbers) == 27
