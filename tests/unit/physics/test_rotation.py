"""The tangential impulse of rough discs and walls, beside 50 digits."""

import mpmath
import numpy as np
import pytest
from helpers.rounding import body, copy_of, exact, gamma

from idealgas.physics.rotation import Rotation, moment_of_inertia, tangential_impulse, tangential_impulse_at_wall

pytestmark = pytest.mark.interpreted

ROUGHNESS = (-1.0, -0.4, 0.0, 0.6, 1.0)


def test_moment_of_inertia():
    """A product and a square of an ulp."""
    for kappa, mass, radius in np.random.default_rng(1).uniform(0.1, 3, (100, 3)):
        with mpmath.workdps(50):
            expected = exact(kappa) * exact(mass) * exact(radius) ** 2
            assert abs(moment_of_inertia(kappa, mass, radius) - expected) <= gamma(4) * expected
    assert moment_of_inertia(0.5, np.array([2.0, 4.0]), np.array([1.0, 3.0])).tolist() == [1.0, 18.0]


def two_discs(draw, roughness):
    """Touching discs, where a is seen from b, and their rotation."""
    radius, mass, angle = draw.uniform(0.1, 2, 2), 10.0 ** draw.uniform(-2, 2, 2), draw.uniform(0, 2 * np.pi)
    x, y = radius.sum() * np.cos(angle), radius.sum() * np.sin(angle)
    v, spin = draw.normal(size=4), draw.normal(size=2) / radius
    a = body(x=x, y=y, vx=v[0], vy=v[1], r=radius[0], m=mass[0])
    b = body(x=0, y=0, vx=v[2], vy=v[3], r=radius[1], m=mass[1])
    rotation = Rotation(spin, moment_of_inertia(draw.uniform(0.1, 1, 2), mass, radius), roughness, roughness)
    return a, b, x, y, rotation


def slip(a, b, x, y, omega):
    """Velocity of a's surface relative to b's at the contact, along it; exact."""
    x, y = exact(x), exact(y)
    distance = mpmath.sqrt(x * x + y * y)
    tangential = ((exact(a.vx) - exact(b.vx)) * y - (exact(a.vy) - exact(b.vy)) * x) / distance
    return tangential + exact(a.r) * exact(omega[0]) + exact(b.r) * exact(omega[1])


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_two_discs(roughness):
    """Every surface velocity changes by at most twice the sum of all of them, by factors rounded less than 15 times: to
    30 roundings of that sum. The slip turns round by the roughness; momentum is kept, and so is angular momentum; with
    roughness 1 and -1 the energy.
    """
    draw = np.random.default_rng(2)
    with mpmath.workdps(50):
        for _ in range(60):
            a, b, x, y, rotation = two_discs(draw, roughness)
            before, omega = (copy_of(a), copy_of(b)), rotation.omega.copy()
            scale = sum(np.abs([a.vx, a.vy, b.vx, b.vy])) + np.abs(omega * (a.r, b.r)).sum()
            tangential_impulse(a, b, 0, 1, x, y, rotation)
            error = gamma(30) * scale
            after = slip(a, b, x, y, rotation.omega)
            assert abs(after + exact(roughness) * slip(*before, x, y, omega)) <= 4 * error  # of four surface velocities
            impulse = [[exact(p.m) * (exact(getattr(p, c)) - exact(getattr(q, c))) for c in ("vx", "vy")]
                       for p, q in zip((a, b), before, strict=True)]  # fmt: skip
            mass = exact(a.m) + exact(b.m)
            for there, back in zip(*impulse, strict=True):
                assert abs(there + back) <= error * mass
            distance = mpmath.sqrt(exact(x) ** 2 + exact(y) ** 2)
            inertia, kick = (
                [exact(i) for i in rotation.inertia],
                (impulse[0][0] * exact(y) - impulse[0][1] * exact(x)) / distance,
            )
            turned = [i * (exact(w) - exact(o)) for i, w, o in zip(inertia, rotation.omega, omega, strict=True)]
            for turn, radius, i in zip(turned, (a.r, b.r), inertia, strict=True):  # I Δω = R times the impulse of a
                assert abs(turn - exact(radius) * kick) <= error * (i / exact(radius) + exact(radius) * mass)
            if abs(roughness) == 1:

                def energy(discs, spin, inertia=inertia):
                    moving = sum(exact(d.m) * (exact(d.vx) ** 2 + exact(d.vy) ** 2) for d in discs)
                    return (moving + sum(i * exact(w) ** 2 for i, w in zip(inertia, spin, strict=True))) / 2

                most = mass + sum(i / exact(r) ** 2 for i, r in zip(inertia, (a.r, b.r), strict=True))
                change = energy((a, b), rotation.omega) - energy(before, omega)
                assert abs(change) <= 3 * error * scale * most  # no speed beyond three times the sum


@pytest.mark.parametrize("roughness", ROUGHNESS)
def test_a_wall(roughness):
    """As of two discs, with a wall that does not slide and takes any impulse; the normal velocity stays."""
    draw = np.random.default_rng(3)
    with mpmath.workdps(50):
        for angle in draw.uniform(0, 2 * np.pi, 60):
            vx, vy, spin = draw.normal(size=3)
            disc, nx, ny = (
                body(vx=vx, vy=vy, r=draw.uniform(0.1, 2), m=draw.uniform(0.1, 5)),
                np.cos(angle),
                np.sin(angle),
            )
            inertia = 0.4 * disc.m * disc.r**2
            rotation = Rotation(np.array([spin]), np.array([inertia]), 0.0, roughness)
            tangential_impulse_at_wall(disc, 0, nx, ny, rotation)
            error = gamma(30) * (abs(vx) + abs(vy) + disc.r * abs(spin))
            n, r = (exact(nx), exact(ny)), exact(disc.r)

            def surface(vx, vy, spin, n=n, r=r):
                return exact(vx) * n[1] - exact(vy) * n[0] + r * exact(spin)

            before, after = surface(vx, vy, spin), surface(disc.vx, disc.vy, rotation.omega[0])
            assert abs(after + exact(roughness) * before) <= 3 * error
            along, spun = (exact(disc.vx) - exact(vx)) * n[1] - (exact(disc.vy) - exact(vy)) * n[0], rotation.omega[0]
            assert abs((exact(disc.vx) - exact(vx)) * n[0] + (exact(disc.vy) - exact(vy)) * n[1]) <= 2 * error
            turn = exact(inertia) * (exact(spun) - exact(spin))
            assert abs(turn - r * exact(disc.m) * along) <= 4 * error * (exact(inertia) / r + r * exact(disc.m))


def test_a_smooth_disc_keeps_its_spin():
    a, b, x, y, rotation = two_discs(np.random.default_rng(4), -1.0)
    before = a.vx, a.vy, b.vx, b.vy, *rotation.omega
    tangential_impulse(a, b, 0, 1, x, y, rotation)
    assert (a.vx, a.vy, b.vx, b.vy, *rotation.omega) == before
