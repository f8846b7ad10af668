"""Lyapunov exponents: what a whole spectrum has to fulfil, published values, exact orbits, and growth in other ways."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.logs import PERIODIC, gas, log_of, raised

import idealgas
from idealgas import open_log, simulate
from idealgas.columns import SIDES, Kind


def log_of_discs(number, side, collisions, *overrides):
    return log_of(gas(number, 0.5, (side, side), f"collisions_per_disc = {collisions}", seed=1), *overrides)


@pytest.mark.parametrize(
    ("overrides", "zeros"),
    [(PERIODIC, 6), (PERIODIC[:2], 4), ((), 2), (("gravity.acceleration=[0, -0.5]",), 2)],
    ids=["periodic", "channel", "walls", "gravity"],
)
def test_pairs_and_zeros(overrides, zeros):
    """Conservative motion has pairs λ, -λ; of the whole spectrum as many are 0 as conservation laws ask for.

    Zeros fall with time: a deviation in them grows like t, so the bound is 3 ln(t)/t.
    """
    log = log_of_discs(6, 6.0, 400, *overrides)
    result = idealgas.lyapunov(log, start=0.0, exponents=24)
    values = np.array([each.value for each in result.exponents])
    assert result.zeros == zeros
    assert 1 / 6 < result.localisation.value < 1
    assert result.mean_free_time == pytest.approx(log.end_time / 400, rel=0.1)
    assert math.exp(result.lifetime(7) * values[0]) == pytest.approx(1e7)
    assert result.pairing < 1e-6 * values[0]
    assert result.largest_zero < 3 * math.log(log.end_time) / log.end_time
    assert values[12 - zeros // 2 - 1] > 5 * result.largest_zero
    assert (np.diff(values) < 0.02 * values[0]).all()
    each = idealgas.lyapunov(log, start=0.0)
    assert abs(each.exponents[0].value - values[0]) < 4 * result.exponents[0].standard_error
    assert result.entropy.value == pytest.approx(values[values > 0].sum(), rel=1e-12)


@pytest.mark.slow
@pytest.mark.parametrize("density", [0.01, 0.001])
def test_entropy_of_dilute_gases(density):
    """h/N = 0.499(1) ν (-ln nσ² + 1.366(5)): van Beijeren et al., Phys. Rev. E 56, 5272 (1997); k = 4."""
    log = log_of_discs(64, math.sqrt(64 / density), 500, *PERIODIC)
    result = idealgas.lyapunov(log, start=0.0, exponents=256)
    per_collision = result.mean_free_time / 64
    published = 0.499 * (-math.log(density) + 1.366)
    assert abs(result.entropy.value * per_collision - published) < 4 * result.entropy.standard_error * per_collision


def test_two_runs_separate_at_this_rate(tmp_path):
    """Runs that start 1e-9 apart are e^(λt) times as far apart later: rates of ten pairs, k = 4."""
    log, sides = log_of_discs(30, 9.0, 400, *PERIODIC), dict.fromkeys(SIDES, "periodic")
    result = idealgas.lyapunov(log, start=0.0).exponents[0]
    half, rates = 3 * math.log(10) / result.value, []
    for begin in np.linspace(20.0, log.end_time - 1.0, 10):
        state, ends = log.state_at(begin), []
        for shift in (0.0, 1e-9):
            position = (state.position + [shift, 0.0] * (np.arange(30) == 0)[:, None]) % 9.0
            discs = {"position": position, "velocity": state.velocity, "radius": 0.5, "mass": 1.0}
            scene = idealgas.Scene(box={"size": [9.0, 9.0], **sides}, discs=discs, run={"until": 2 * half})
            simulate(scene, tmp_path / "pair.h5", force=True)
            with open_log(tmp_path / "pair.h5") as pair:
                ends.append([np.hstack([each.position, each.velocity]) for each in pair.frames([half, 2 * half])])
        apart = np.abs(np.subtract(*ends))
        apart[..., :2] = np.minimum(apart[..., :2], 9.0 - apart[..., :2])
        rates.append(math.log(np.linalg.norm(apart[1]) / np.linalg.norm(apart[0])) / half)
    error = math.hypot(np.std(rates, ddof=1) / math.sqrt(10), result.standard_error)
    assert abs(np.mean(rates) - result.value) < 4 * error
    assert error < 0.2 * result.value


# ── billiards ──

TORUS = "box.size = [1, 1]\n" + "".join(f"box.{side} = 'periodic'\n" for side in SIDES)
LORENTZ = (
    TORUS
    + """
run.events = 120
disc = [
    { position = [0.5, 0.5], radius = 0.2, fixed = true },
    { position = [0.1, 0.17], velocity = [0.8, 0.6], radius = 1e-3 },
]
"""
)
STADIUM = """
box.size = [9, 5]
run.events = 150
disc = [{ position = [3.3, 2.1], velocity = [0.8, 0.6], radius = 0.01 }]
wall = [
    { from = [2.5, 0.5], to = [6.5, 0.5] },
    { from = [6.5, 0.5], to = [6.5, 4.5], via = [8.5, 2.5] },
    { from = [6.5, 4.5], to = [2.5, 4.5] },
    { from = [2.5, 4.5], to = [2.5, 0.5], via = [0.5, 2.5] },
]
"""
SQUARE_PEG = """
box.size = [9, 5]
run.events = 300
disc = [{ position = [1.3, 2.1], velocity = [0.8, 0.6], radius = 0.5 }]
wall = [
    { from = [4, 2], to = [5, 2], solid = "inside" },
    { from = [5, 2], to = [5, 3], solid = "inside" },
    { from = [5, 3], to = [4, 3], solid = "inside" },
    { from = [4, 3], to = [4, 2], solid = "inside" },
]
"""


ROUND = {STADIUM: {-6: ((6.5, 2.5), -1.99), -8: ((2.5, 2.5), -1.99)}}
"""Centre of each arc, and the radius of the path's walls: positive if they bulge towards the disc."""


def round_contact(scene, rows, row):
    """Centre and radius of the round wall that is hit; None for flat walls."""
    if rows.kind[row] == Kind.FIXED_DISC:
        return (0.5, 0.5), 0.201
    if rows.kind[row] == Kind.WALL_END:
        return np.round(rows.position[row]), 0.5
    return ROUND.get(scene, {}).get(rows.partner[row])


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("scene", [LORENTZ, STADIUM, SQUARE_PEG], ids=["Lorentz gas", "stadium", "square"])
def test_growth_is_that_of_the_curvature_of_a_wavefront(scene):
    """Each factor is 1 + τ B for a wavefront of curvature B, which grows by 2/(S cos φ) in a hit of a wall of radius S.

    This is Sinai's formula: Chernov, J. Stat. Phys. 88, 1 (1997), section 3.
    """
    log = log_of(scene)
    (rows,) = log.chunks()
    curvature, expected = 0.3, []
    for row in range(1, len(rows.time)):
        flight, before = rows.time[row] - rows.time[row - 1], curvature
        curvature = before / (1 + flight * before)
        if (contact := round_contact(scene, rows, row)) is not None:
            centre, radius = contact
            normal = (rows.position[row] - centre) / np.hypot(*(rows.position[row] - centre))
            assert np.hypot(*(rows.position[row] - centre)) == pytest.approx(abs(radius), rel=1e-9)
            curvature += 2 / (radius * abs(rows.velocity[row] @ normal))
        length = math.sqrt((1 + curvature**2) / (1 + before**2))  # of the deviation of position and velocity
        expected.append(math.log(abs(1 + flight * before) * length))
    result = idealgas.lyapunov(log, start=0.0)
    growth = np.diff(result.growth)[30:]
    assert growth == pytest.approx(expected[-len(growth) :], abs=1e-9)
    assert result.per_collision.value == pytest.approx(result.growth[-1] / len(result.growth), rel=1e-12)
    assert result.mean_free_time == pytest.approx(result.time[-1] / len(result.growth), rel=1e-12)
    assert result.exponents[0].value == pytest.approx(result.growth[-1] / result.time[-1], rel=1e-12)


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize(
    ("scene", "growth"),
    [
        (LORENTZ.replace("[0.1, 0.17]", "[0.1, 0.5]").replace("[0.8, 0.6]", "[1, 0]"), 1 + 0.598 / 0.201),
        (STADIUM.replace("[3.3, 2.1]", "[3.3, 2.5]").replace("[0.8, 0.6]", "[1, 0]"), 7.98 / 1.99 - 1),
    ],
    ids=["between discs", "along a stadium"],
)
def test_exact_exponents_of_an_orbit_on_an_axis(scene, growth):
    """The deviation between two round walls of radius S at distance L grows by e^μ, with cosh μ = 1 ± L/S."""
    result = idealgas.lyapunov(log_of(scene), start=0.0, exponents=4)
    rates = [each.value * result.mean_free_time for each in result.exponents]
    exact = math.acosh(growth)
    assert np.diff(result.growth)[20:] == pytest.approx(exact, rel=1e-9)
    assert rates == pytest.approx([exact, 0, 0, -exact], abs=1e-3)  # the time before the first event is no whole flight
    assert result.entropy.value == pytest.approx(result.exponents[0].value, rel=1e-9)


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("scene", [LORENTZ, STADIUM, SQUARE_PEG], ids=["Lorentz gas", "stadium", "square"])
def test_pairs_of_a_single_disc(scene):
    """Two exponents are ±λ, and two are 0 because the energy is conserved; a single disc has no localisation."""
    result = idealgas.lyapunov(log_of(scene), start=0.0, exponents=4)
    values = [each.value for each in result.exponents]
    assert result.pairing < 1e-10 * values[0]
    assert abs(values[0] + values[3]) < 1e-12
    assert result.zeros == 2
    assert result.largest_zero < 1e-3 * values[0]
    assert result.localisation is None


FLAT = gas(30, 0.1, (8, 6), "until = 250", seed=1, then="interactions.discs = false")
DECAYING = """
box.size = [8, 6]
run.events = 300
restitution = { normal = 1, wall = 0.9 }
disc = [{ position = [3, 3], velocity = [0.8, 0.6], radius = 0.5 }]
"""
TRIANGLE = """
box.size = [9, 5]
run.events = 150
disc = [{ position = [3.3, 2.1], velocity = [0.8, 0.6], radius = 0.01 }]
wall = [
    { from = [0.3, 0.2], to = [8.1, 1.3] },
    { from = [8.1, 1.3], to = [4.2, 4.4] },
    { from = [4.2, 4.4], to = [0.3, 0.2] },
]
"""


@pytest.mark.usefixtures("uncompiled")
@pytest.mark.parametrize("scene", [FLAT, TRIANGLE, DECAYING], ids=["flat walls", "triangle", "decaying"])
def test_motion_that_is_not_chaotic(scene):
    """No digits are ever lost if λ1 is 0, as in the whole spectrum between flat walls, or negative; all is drawn."""
    result = idealgas.lyapunov(log_of(scene), start=0.0, exponents=4)
    values = [each.value for each in result.exponents]
    if scene == DECAYING:
        assert max(values) < 0
    else:
        assert values == pytest.approx([0.0] * 4, abs=1e-14)
        rounded_up = replace(result, exponents=(replace(result.exponents[0], value=3e-17),))
        assert rounded_up.lifetime(7) == math.inf
    assert result.lifetime(7) == math.inf
    assert result.summary().startswith("Small deviations do not grow exponentially: λ = ")
    assert [cell for _, cell in result.plain_tables()[-1].shown] == ["never"] * 3
    growth, spectrum = (ax.lines[0].get_data() for ax in result.figure().axes)
    assert np.array_equal(growth, [result.time, result.growth / math.log(10)])
    assert np.array_equal(spectrum, [range(1, 5), values])


@pytest.mark.usefixtures("uncompiled")
def test_single_exponent_between_flat_walls():
    """A deviation that grows like t has a rate of order ln(t)/t."""
    result = idealgas.lyapunov(log_of(FLAT), start=0.0)
    assert 0.2 < result.exponents[0].value * result.time[-1] / math.log(result.time[-1]) < 1


DRIVEN = "gravity.acceleration = [0, -0.02]\nbox.left = { vibrating = { amplitude = 0.1, frequency = 0.2 } }\n"


@pytest.mark.usefixtures("uncompiled")
def test_spectra_with_moving_walls():
    """A piston of finite mass adds a pair; a vibrating side leaves the pairs but takes the zeros of the energy."""
    left = "{ position = [2, 2], velocity = [0.8, 0.6], radius = 0.4 }"
    right = "{ position = [7, 3], velocity = [-0.8, 0.5], radius = 0.4 }"
    text = f"box.size = [9, 5]\nrun.events = 240\ndisc = [{left}, {right}]\n"
    piston = text + "piston = [{ mass = 4, pressure = 1, position = 8 }]"
    pressed = idealgas.lyapunov(log_of(piston), start=0.0, exponents=10)
    shaken = idealgas.lyapunov(log_of(text + DRIVEN), start=0.0, exponents=8)
    assert (pressed.zeros, shaken.zeros) == (2, 0)
    assert shaken.largest_zero is None
    for result in (pressed, shaken):
        values = np.array([each.value for each in result.exponents])
        assert result.pairing < 1e-10 * values[0]
        assert values[0] > 0.05
    raised(r"exponents: 2 discs have 10 \(got 11\)", idealgas.lyapunov, log_of(piston), exponents=11)


@pytest.mark.usefixtures("uncompiled")
def test_discs_that_do_not_interact_are_systems_of_their_own():
    """The derivatives of three discs are those of three runs of one disc each, and exponents are means over discs."""
    discs = [
        "{ position = [3.3, 2.1], velocity = [0.8, 0.6], radius = 0.01 }",
        "{ position = [5.1, 1.3], velocity = [-0.28, 0.96], radius = 0.01 }",
        "{ position = [4.2, 3.2], velocity = [0.6, -0.8], radius = 0.01, mass = 3 }",
    ]
    start, rest = STADIUM.replace("run.events = 150", "run.until = 250").split("disc = [")
    rest = rest.split("]\n", 1)[1]
    singles = [log_of(f"{start}disc = [{disc}]\n{rest}") for disc in discs]
    log = log_of(f"{start}disc = [{', '.join(discs)}]\ninteractions.discs = false\n{rest}")
    derivatives = idealgas.sensitivity(log, end=20.0)
    for k, single in enumerate(singles):
        assert np.array_equal(derivatives[k, :, k], idealgas.sensitivity(single, end=20.0)[0, :, 0])
    assert all(not derivatives[k, :, j].any() for k in range(3) for j in range(3) if j != k)
    whole = idealgas.lyapunov(log, start=0.0, exponents=4)
    parts = [idealgas.lyapunov(single, start=0.0, exponents=4) for single in singles]
    assert whole.pairing < 1e-10 * whole.exponents[0].value
    assert whole.zeros == 2
    for k in range(4):
        mean = np.mean([part.exponents[k].value for part in parts])
        assert abs(whole.exponents[k].value - mean) < 0.1 * whole.exponents[0].value  # other events are for alignment
    raised(r"exponents: each disc has 4 \(got 5\)", idealgas.lyapunov, log, exponents=5)


def torus_of(radius, count, hits, seed=1):
    """Points on the unit torus with a fixed disc, and the time in which each hits it `hits` times on average."""
    until = hits * (1 - math.pi * radius**2) / (2 * radius)
    disc = f"disc = [{{ position = [0.5, 0.5], radius = {radius - 1e-7!r}, fixed = true }}]\n"
    points = f"species = [{{ name = 'points', count = {count}, radius = 1e-7, speed = 1 }}]\n"
    return f"scene.seed = {seed}\n{TORUS}interactions.discs = false\nrun.until = {until!r}\n{disc}{points}"


@pytest.mark.usefixtures("uncompiled")
def test_many_independent_discs():
    """Errors come from the discs; events, growth and time end at the same moment, although the log goes on."""
    result = idealgas.lyapunov(log_of(torus_of(0.2, 24, 70)), start=0.0)
    assert result.per_collision.value == pytest.approx(result.exponents[0].value * result.mean_free_time, rel=1e-12)
    assert result.exponents[0].independent_samples == 24
    assert result.per_collision.standard_error < 0.7 * result.exponents[0].standard_error * result.mean_free_time
    assert result.time[-1] < result.window.duration
    assert any("means over 24 independent discs" in note for note in result.plain_tables()[0].notes)


@pytest.mark.slow
def test_lorentz_gas_with_small_scatterers():
    """The exponent per collision tends to -2 ln R + 1 - 4 ln 2 + 27 ζ(3)/(2π²), with a correction O(R ln² R).

    The logarithm is due to Friedman, Oono & Kubo, Phys. Rev. Lett. 52, 709 (1984), the constant and the order of the
    correction to Dahlqvist, arXiv:chao-dyn/9601007. The correction is found to be between 0 and 1.5 R; k = 4.
    """
    zeta = 1.2020569031595942
    corrections, errors = [], []
    for radius in (0.05, 0.02, 0.01):
        result = idealgas.lyapunov(log_of(torus_of(radius, 1000, 400)), start=0.0).per_collision
        limit = -2 * math.log(radius) + 1 - 4 * math.log(2) + 27 * zeta / (2 * math.pi**2)
        corrections.append(result.value - limit)
        errors.append(result.standard_error)
        assert result.standard_error < 0.0005 * limit
        assert -4 * errors[-1] < corrections[-1] < 1.5 * radius + 4 * errors[-1]
    assert corrections[0] - corrections[2] > 4 * math.hypot(errors[0], errors[2])


@pytest.mark.slow
@pytest.mark.parametrize(("count", "runs"), [(1, 100), (25, 40)])
def test_errors_of_single_discs_and_of_many(count, runs):
    """Deviations from a long run in units of their errors have a mean square of 1; flights are bounded here; k = 4."""

    def result_of(count, hits, seed):
        settings = f"species.gas.count={count}", f"run.until={0.6213 * hits}", f"scene.seed={seed}"
        return idealgas.lyapunov(log_of("lorentz", *settings), start=0.0)

    exact = result_of(4000, 400, 1)
    results = [result_of(count, 300 if count == 1 else 100, seed) for seed in range(2, 2 + runs)]
    for estimates, value in (
        ([each.exponents[0] for each in results], exact.exponents[0].value),
        ([each.per_collision for each in results], exact.per_collision.value),
    ):
        deviations = [(each.value - value) / each.standard_error for each in estimates]
        assert abs(np.mean(np.square(deviations)) - 1) < 4 * math.sqrt(2 / runs)
