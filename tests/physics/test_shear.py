"""Sheared sides: exact crossings and contacts, the same wherever the sides are."""

import math

import numpy as np
import pytest
from helpers.logs import gas, log_of, raised
from helpers.support import ROOT, gas_of, record, same_rows, within

from idealgas import load_scene, shear, transport
from idealgas.analysis import registry
from idealgas.columns import SIDES, Kind
from idealgas.effects.bundle import Effects
from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Simulation, Stop
from idealgas.errors import NotApplicableError
from idealgas.initial.build import make_gas
from idealgas.log.start import continued_scene
from idealgas.physics.exact_sum import make_sums
from idealgas.physics.exact_sum import values as values_of
from idealgas.physics.periodic import Periodic
from idealgas.physics.shear import flow_at, make_shear
from idealgas.run.effects import make_effects
from idealgas.theory import enskog

GOLDEN = ROOT / "tests" / "cases" / "golden" / "sheared.toml"


def shear_of(*overrides):
    """Analysis of the small shipped gas, from the start."""
    return shear(log_of("shear", "species.gas.count=30", "box.size=[8.9, 8.9]", *overrides), start=0)


@pytest.mark.usefixtures("uncompiled")
def test_what_a_heat_bath_does_to_the_theory():
    """At x times the collision rate it takes a part of about x of the viscosity, and the rate a part of 2a²."""
    result = shear_of("run.until=6")
    a, phi = result.reduced_rate, 30 * math.pi / 4 / 8.9**2
    error = enskog.relative_error("viscosity", phi) + a * 0.02 / 0.06 + 2 * a**2
    assert result.viscosity.theory_error == pytest.approx(error * result.viscosity.theory)
    result = shear_of("run.until=2", "thermostat.rate=2", "box.bottom.shear=0.6", "box.top.shear=0.6")
    assert result.viscosity.theory is None
    assert result.pressure.theory is not None
    (fast,) = (sentence for sentence in result.caveats if sentence.startswith("The shear rate"))
    assert fast.endswith("the viscosity may be less than that of a slow flow.")


@pytest.mark.usefixtures("uncompiled")
def test_a_temperature_that_changes():
    """Inelastic discs cool from a hot start, though the shear heats them."""
    log = log_of(GOLDEN, "run.events=300", "restitution.normal=0.5")
    assert "in the window: the viscosity describes a single state only if" in " ".join(shear(log, start=0).caveats)


@pytest.mark.parametrize(
    ("width", "height", "rate", "count"),
    [
        (4, 9, 2.0, 5),
        (2.2, 2.3, 1.0, 1),
        (30, 2.2, 0.1, 10),
        (2.2, 30, 0.01, 10),
        (12, 14, 20.0, 20),
        (20, 20, 1e-3, 60),
    ],
)
@pytest.mark.slow
def test_cells_of_any_size_give_the_log_of_brute_force(width, height, rate, count):
    """Also few cells, in which a disc meets several images of another, and images that move fast."""
    sides = [f"box.{side}.shear={rate}" for side in ("bottom", "top")]
    counts = [f"species.{name}.count={count}" for name in ("large", "small")]
    scene = load_scene(GOLDEN, [f"box.size=[{width},{height}]", *sides, *counts])
    gas, stop = make_gas(scene), Stop(events=3000)
    oracle = record(Simulation(gas, BruteForce(), make_effects(scene, gas)), stop)
    for filling in (None, 0.2, 1e9):
        assert same_rows(record(Simulation(gas, EventDriven(filling), make_effects(scene, gas)), stop, 100), oracle)


def simulation_of(box, rate, position, velocity, radius, mass=1.0, start=0.0):
    """A gas between sheared sides, from a time on."""
    gas = gas_of(box, position, velocity, radius, mass)
    none = np.zeros((len(gas), 2), np.int32)
    sides = Periodic(True, False, *box, none)
    effects = Effects(periodic=sides, shear=make_shear(rate, box), wall_energy=make_sums([1.0] * 4))
    return Simulation(gas, EventDriven(), effects, start)


def test_a_disc_that_leaves_through_the_top_enters_at_the_bottom():
    """After 5 the image above is 7.5 ahead and 1.5 faster."""
    simulation = simulation_of((8.0, 6.0), 0.25, [[1.0, 1.0]], [[0.3, 1.0]], 0.5)
    (up, again) = zip(*(column for column in record(simulation, Stop(events=2))[:6]), strict=True)
    assert up[:4] == (5.0, 0, -1 - SIDES.index("top"), Kind.WALL)
    assert up[4] == pytest.approx([1 + 1.5 - 7.5 + 8, 0])
    assert up[5] == pytest.approx([0.3 - 1.5, 1])
    assert again[0] == pytest.approx(11)
    assert again[4] == pytest.approx([(3 - 1.2 * 6 - 1.5 * 11) % 8, 0])
    work = values_of(simulation.effects.wall_energy)
    assert work[3] == pytest.approx(0.5 * ((0.3 - 3) ** 2 - 0.3**2))


@pytest.mark.parametrize("start", [0.0, 100.0])
def test_a_contact_through_the_top_is_that_with_the_moving_image(start):
    """The discs meet where the one below would be that much ahead and faster; velocities change in its frame."""
    box, rate, low, x = (16.0, 12.0), 0.5, np.array([4.0, 1.0]), np.array([2.5, -1.3])
    ahead, u = (rate * 12 * start) % 16, rate * 12
    high = np.array([(low[0] + ahead + x[0]) % 16, low[1] + 12 + x[1]])
    slow, fast = np.array([0.4, -0.3]), np.array([0.5, 0.7])
    v = fast - slow - (u, 0)
    rows = record(
        simulation := simulation_of(box, rate, [low, high], [slow, fast], 0.5, [1.0, 3.0], start), Stop(events=1)
    )
    b, gap = x @ v, x @ x - 1
    delay = gap / (-b + math.sqrt(b * b - (v @ v) * gap))
    assert rows.time[0] == pytest.approx(start + delay, rel=1e-14)
    n = x + v * delay
    impulse = -2 * (v @ n) / (1 + 1 / 3) * n  # on the disc above, over n² = 1
    assert rows.velocity == pytest.approx(np.array([slow - impulse, fast + impulse / 3]), abs=1e-13)
    work = values_of(simulation.effects.wall_energy)
    before, after = slow @ slow / 2 + 1.5 * fast @ fast, (rows.velocity**2).sum(axis=1) @ [0.5, 1.5]
    assert work.tolist() == pytest.approx([0, 0, 0, after - before], abs=1e-13)


def test_sides_may_be_anywhere():
    """Moved up by h and faster by rate h, a gas has the same collisions at the same times, in another frame."""
    log = log_of(GOLDEN)
    first, gas, rate, (width, height) = log.state_at(0.0), log.discs, 0.4, log.box
    (rows,) = log.chunks()
    met = np.flatnonzero(rows.kind == Kind.DISC)[:400]
    pairs = np.column_stack((rows.disc, rows.partner))[met]
    times, turned = rows.time[met], rows.velocity[met, 1]
    y = first.position[:, 1] + 2.5
    up = np.floor(y / height)
    position = np.column_stack((first.position[:, 0], y - up * height))
    velocity = first.velocity + np.column_stack((rate * (2.5 - up * height), np.zeros(len(y))))
    moved = record(
        simulation_of((width, height), rate, position, velocity, gas.radius, gas.mass), Stop(disc_collisions=200)
    )
    again = np.flatnonzero(moved.kind == Kind.DISC)
    assert (np.column_stack((moved.disc, moved.partner))[again] == pairs).all()
    assert np.abs(moved.time[again] - times)[:60].max() < 1e-9  # rounding grows by a factor of e in a few collisions
    assert np.abs(moved.velocity[again, 1] - turned)[:60].max() < 1e-7


def test_the_stress_heats_the_gas():
    """Energy relative to the flow grows by -rate A ∫ P_xy dt exactly, by flights and collisions, also through sides."""
    log = log_of(GOLDEN)
    result = shear(log, start=0.0)
    width, height = log.box
    energy = []
    for time in (0.0, log.end_time):
        state = log.state_at(time)
        vx = state.velocity[:, 0] - flow_at(state.position[:, 1], result.rate, height)
        energy.append(float(log.discs.mass @ (vx**2 + state.velocity[:, 1] ** 2)) / 2)
    work = result.rate**2 * width * height * result.viscosities.mean() * log.end_time
    assert energy[1] - energy[0] == pytest.approx(work, rel=1e-12)
    assert result.reduced_rate == pytest.approx(0.4 / (2 * 2810 / 45 / log.end_time), rel=0.2)
    raised(
        r"with sheared sides, cannot start from t = 1 \(allowed multiples of 3.21",
        continued_scene,
        log,
        1.0,
        "run.h5",
    )
    assert "run.h5" in continued_scene(log, 9 / 2.8, "run.h5")
    for analysis in registry.analyses():
        if not analysis.supports_shear:
            raised(
                r"but this gas is sheared; use|equal discs in each species, but",
                analysis.analyse,
                log,
                error=NotApplicableError,
            )


FLUID = gas(400, 0.5, (1, 1), "collisions_per_disc = 3000", periodic="x")


def fluid(phi, side, *overrides):
    """The log of a gas of this packing fraction between two such sides."""
    length = math.sqrt(400 * math.pi / 4 / phi)
    return log_of(FLUID, f"box.size=[{length!r}, {length!r}]", f"box.bottom={side}", f"box.top={side}", *overrides)


@pytest.mark.parametrize(("phi", "rate"), [(0.1, 0.03), (0.3, 0.08)])
@pytest.mark.slow
def test_the_viscosity_is_that_of_the_same_gas_at_rest(phi, rate):
    """By Helfand's moments of its equilibrium (transport), within 3 standard errors; pressure and slope by theory.

    The flow is slow: 0.06 of the collision rate at first, and less as the gas becomes hotter.
    """
    at_rest = transport(fluid(phi, "'periodic'")).collective.coefficients["viscosity"].value
    result = shear(fluid(phi, f"{{ shear = {rate} }}"))
    flowing = result.viscosity.times(result.temperature.value**-0.5)
    error = math.hypot(at_rest.standard_error, flowing.standard_error)
    within("viscosity in units of √(mT)/σ, σ", abs(flowing.value - at_rest.value) / error, 3)
    assert flowing.standard_error < 0.05 * flowing.value
    assert error < 0.1 * at_rest.value
    assert abs(flowing.deviation) < 3  # from Enskog
    assert abs(result.pressure.deviation) < 3
    low, high = result.slope.interval(math.erf(3 / math.sqrt(2)))
    assert low < 1 < high
    assert result.reduced_rate < 0.03


@pytest.mark.slow
def test_normal_stress_of_a_dilute_granular_gas():
    """(P_xx - P_yy)/P = 2ζ/(β + ζ) where collisions take what shear brings: ζ = (1 - e²)/2, β = (1 + e)(3 + e)/8.

    Moments of Boltzmann's equation, for two dimensions: Santos, Garzó & Dufty, Phys. Rev. E 69, 061303 (2004).
    """
    result = shear(fluid(0.01, "{ shear = 0.0148 }", "restitution.normal=0.9", "run.collisions_per_disc=300"))
    decay, exchange = (1 - 0.9**2) / 2, 1.9 * 3.9 / 8
    expected, stress = 2 * decay / (exchange + decay), result.normal_stress
    assert result.window.state == "steady state"
    assert stress.standard_error < 0.06 * expected
    within("normal stress of a granular gas, σ", abs(stress.value - expected) / stress.standard_error, 3)
