"""Where laws and theories end: for each a gas of which they say nothing or less, and one within their range."""

import json

import numpy as np
import pytest
from helpers.small_gases import GAS, PERIODIC, SLIT, TWO, only, silent

from idealgas.analysis import registry
from idealgas.analysis.heat_capacity.fluctuations import energy_series
from idealgas.analysis.theory.forecast import forecast
from idealgas.analysis.theory.granular import GranularParameters, cooling_per_collision
from idealgas.errors import UserError
from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene

SPIN = "rotation={inertia=0.5, roughness=0}"


@pytest.mark.parametrize(
    ("change", "words"),
    [
        ({2: "wall=[{from=[4, 3], to=[4, 5], opens_at=1.0}]"}, "beside it is a gap of 3"),
        ({2: SLIT[2].replace("to=[4, 3]}", "to=[4, 2]}, {from=[4, 2.5], to=[4, 3]}")}, "beside it is a gap of 0.5"),
        ({2: SLIT[2].replace("to=[4, 3]}", "to=[4, 3], closes_at=100}")}, "beside it is a gap of 3"),
        ({2: SLIT[2].replace("wall=[", "wall=[{from=[4, 4.5], to=[4, 3]}, ")}, "a wall stands in the gate"),
        ({5: 'box={size=[8, 8], left="periodic", right="periodic"}'}, "discs pass through the periodic sides"),
    ],
    ids=["no wall", "second slit", "open beside it", "wall in it", "periodic"],
)
def test_effusion_takes_a_wall_that_divides_the_box(change, words, made):
    with pytest.raises(UserError, match=words):
        registry.analyse(
            made(*(change.get(k, part) for k, part in enumerate((*SLIT, "log.compression='none'")))), "effusion"
        )


def test_effusion_takes_empty_chambers_and_an_open_gate(made):
    more = SLIT[2].replace("wall=[", "wall=[{name='plate', from=[5, 3], to=[5, 5]}, ")
    only(registry.analyse(made(*SLIT[:2], more, *SLIT[3:]), "effusion"), "there is plate.")
    beside = SLIT[2].replace("from=[4, 0], to=[4, 3]", "from=[4.001, 3], to=[4.001, 0]")
    assert registry.analyse(made(*SLIT[:2], beside, *SLIT[3:]), "effusion").caveats == ()
    closing = SLIT[2].replace("opens_at=1.0", "opens_at=1.0, closes_at=6.0")
    found = registry.analyse(made(*SLIT[:2], closing, *SLIT[3:]), "effusion", start=0.0)
    assert (found.time[0], found.time[-1]) == (1.0, 6.0)
    with pytest.raises(UserError, match="the gate is open from t = 1 to inf"):
        registry.analyse(made(*SLIT), "effusion", end=0.5)


@pytest.mark.parametrize("axes", ["both", "one"])
def test_heat_capacity_is_that_of_heat(made, axes):
    """Fluctuations of a gas that moves as a whole are those of the same gas at rest."""
    sides = PERIODIC if axes == "both" else 'box={size=[8, 8], bottom="periodic", top="periodic"}'
    velocities = np.random.default_rng(3).normal((0, 3), 1, (40, 2)).tolist()
    moving = f"species=[{{name='gas', count=40, radius=0.1, velocities={velocities}}}]"
    scene = (sides, "rotation={inertia=0.5, roughness=1}", "log.snapshot_every=0.5", "run.collisions_per_disc=100")
    found = energy_series(made(*scene, moving), start=5.0)
    assert 0.4 < found.kinetic.mean() / 40 < 1.6  # 5.5 with the motion


@pytest.mark.slow
def test_laws_of_heat_take_collisions_that_lose_none(made):
    bath = "box={size=[8, 8], " + ", ".join(f"{s}={{thermal=1}}" for s in ("left", "right", "bottom", "top")) + "}"
    with pytest.raises(UserError, match="requires equilibrium"):
        registry.analyse(made(bath, SPIN), "heat-capacity")
    floor = ("box={size=[8, 8], bottom={thermal=1}}", "gravity.acceleration=[0, -0.2]")
    assert registry.analyse(made(*floor), "profile", start=0.0).law is not None
    assert registry.analyse(made(*floor, SPIN), "profile", start=0.0).law is None
    two = "box={size=[8, 8], left={thermal=1}, right={thermal=4}%s}"

    def law(*scene):
        return registry.analyse(made("species.gas.count=160", *scene), "profile", start=0.0).law

    assert "Fourier" in law(two % "")
    assert law(two % "", SPIN.replace("0}", "1}")) is None
    assert law(two % ", bottom={thermal=1}") is None
    assert law(two % "", "thermostat={temperature=1, rate=1}") is None


def test_fourier_s_law_takes_many_mean_free_paths(made):
    """In all strips deviations are as large as errors; without the jumps of T at the walls their rms would be 1.4."""
    two = ("box={size=[16, 4], left={thermal=1}, right={thermal=2}}", "run.collisions_per_disc=1500")
    (found,) = registry.analyse(made("species.gas.count=160", *two), "profile").species
    deviations = np.array([entry.deviation for entry in (*found.temperature, *found.density)])
    assert 0.6 < np.sqrt((deviations**2).mean()) < 1.2
    assert registry.analyse(made("species.gas.count=10", *two), "profile").law is None


def test_laws_of_many_discs_take_many(made):
    few = ("species.gas.count=10", PERIODIC)
    path = registry.analyse(made(*few), "histogram", quantity="free-path")
    assert path.no_law == "the law is that of many discs, and here are 10"
    many = registry.analyse(made(PERIODIC), "histogram", quantity="free-path")
    assert many.no_law is None
    assert many.distributions[0].mean.theory == pytest.approx(
        registry.analyse(made(PERIODIC), "transport").free_paths[0].path.theory
    )
    two = registry.analyse(made(TWO, PERIODIC), "histogram")
    assert two.no_law == "2 degrees of freedom are too few for a law"
    one = made("species.gas.count=1", "run.collisions_per_disc=", "run.until=50")
    assert registry.analyse(one, "histogram", quantity="vx").no_law == "2 degrees of freedom are too few for a law"
    found = registry.analyse(one, "temperature")
    only(found, "A single disc does not share its energy evenly")
    assert (found.species[0].x.theory, found.species[0].both.theory) == (None, 1.0)
    spinning = registry.analyse(
        made("species.gas.count=1", SPIN.replace("=0}", "=1}"), "run.collisions_per_disc=", "run.until=50"),
        "temperature",
    )
    assert spinning.species[0].both.theory is None
    assert registry.find("transport").figure(registry.analyse(one, "transport")).axes


def test_a_uniform_density_takes_no_layers(made):
    dense = made("species.gas.radius=0.4", "run.collisions_per_disc=20")
    only(registry.analyse(dense, "profile", start=0.0), "lie in layers at walls")
    assert silent(registry.analyse(made(), "profile", start=0.0), "layers")
    only(registry.analyse(made("species.gas.count=120"), "profile", start=0.0, bins=40), "lie in layers at walls")


def test_a_slit_takes_a_thin_gas(made):
    thick = (*SLIT[:1], "species.gas.radius=0.15", SLIT[2].replace("to=[4, 5], opens", "to=[4, 3.4], opens"), *SLIT[3:])
    thick = tuple(part.replace("{from=[4, 5]", "{from=[4, 3.4]") for part in thick)
    found = registry.analyse(made(*thick), "effusion")
    only(found, "discs crowd in the slit")
    assert (found.speed.theory, found.expected) == (None, None)
    thin = registry.analyse(made(*(part.replace("0.15", "0.03") for part in thick)), "effusion")
    assert silent(thin, "crowd")
    assert thin.speed.theory_error > 0


def test_waits_are_exponential_for_many_discs(made):
    few = registry.analyse(made("species.gas.count=10"), "histogram", quantity="waiting-time")
    assert few.distributions[0].tests == ()
    assert registry.analyse(made(), "histogram", quantity="waiting-time").distributions[0].tests


def test_faces_without_events_have_the_ends_too(made):
    wall = ("wall=[{from=[4, 2], to=[4, 6]}]", "log.pressure=true", "log.snapshot_every=0.2")
    only(registry.analyse(made(*wall, "log.events=false"), "pressure", start=0.0), "to the ends of its wall")
    assert silent(registry.analyse(made(*wall), "pressure", start=0.0), "to the ends of its wall")


def test_a_heat_bath_takes_time(made):
    hot = "species=[{name='gas', count=40, radius=0.1, temperature=100}]"
    for bath, rate, slow in ((1, 0.001, True), (1, 10.0, False), (100, 0.001, False)):
        scene = parse_scene(GAS, overrides=(hot, f"thermostat={{temperature={bath}, rate={rate}}}"))
        assert any("heat bath takes some" in said for said in forecast(scene, make_gas(scene)).caveats) == slow


def test_currents_and_heavy_discs_take_long_lags(made):
    log = made(PERIODIC, "species.gas.radius=0.3", "run.collisions_per_disc=400")
    short = registry.analyse(log, "transport", start=0.0, end=log.end_time / 40)
    only(short, "currents are followed for")
    assert silent(registry.analyse(log, "transport"), "currents are followed for")
    light, heavy = (
        "{name='a', count=36, radius=0.3, temperature=1}",
        "{name='b', count=4, radius=0.3, mass=50, temperature=1}",
    )
    mixed = registry.analyse(
        made(PERIODIC, f"species=[{light}, {heavy}]", "run.collisions_per_disc=800"), "transport", start=0.0
    )
    only(mixed, "b is followed for")


def test_theory_of_a_wide_box_takes_one(made):
    cooling = ("restitution={normal=0.95}", "run.collisions_per_disc=80")
    channel = 'box={size=[32, 2], left="periodic", right="periodic"}'
    only(
        registry.analyse(made(channel, *cooling, "species.gas.radius=0.2"), "cooling"),
        "The box is 5 diameters wide between walls",
    )
    assert silent(registry.analyse(made(PERIODIC, *cooling), "cooling"), "diameters wide")


def test_laws_of_cooling_end_at_strong_losses(made):
    def found(normal):
        return registry.analyse(made(PERIODIC, f"restitution.normal={normal}", "run.collisions_per_disc=60"), "cooling")

    known = found(0.9).loss
    assert known.theory_error / known.theory == pytest.approx(np.hypot(0.015, 1 / 78))
    assert known.theory == pytest.approx(cooling_per_collision(GranularParameters(0.9)) * 40 / 39)
    assert silent(found(0.9), "no theory of collisions that lose more")
    assert (found(0.6).loss.theory, found(0.6).haff.theory, found(0.6).fourth.theory) == (None, None, None)
    only(found(0.6), "no theory of collisions that lose more than those with e = 0.8")
    course = {e: registry.analyse(made(PERIODIC, f"restitution.normal={e}"), "evolution") for e in (0.9, 0.6)}
    assert "Haff" in course[0.9].law.text
    only(course[0.9], "Haff's law is that of a uniform gas")
    assert course[0.6].law is None


def test_a_relaxation_time_takes_a_start_like_that_of_its_error(made):
    fast = "species=[{name='gas', count=190, radius=0.05, speed=0.1}, {name='hot', count=10, radius=0.05, speed=10}]"
    only(registry.analyse(made(fast), "relaxation"), "a few discs are faster than most")
    equal = "species=[{name='gas', count=200, radius=0.05, speed=1}]"
    assert silent(registry.analyse(made(equal), "relaxation"), "faster than most")
    assert silent(registry.analyse(made(equal), "relaxation"), "later curves")
    only(registry.analyse(made(equal), "relaxation", start=0.2), "later curves scatter more")


def test_a_law_of_a_piston_takes_a_fluid(made):
    piston = (
        "piston=[{side='right', position=8, velocity=-0.4}]",
        "species.gas.radius=0.4",
        "run.collisions_per_disc=",
        "run.until=10",
    )
    found = registry.analyse(made(*piston), "evolution")
    assert found.law is None
    assert json.dumps(found.as_dict(), allow_nan=False)
    stopped = ("piston=[{side='right', position=7, mass=5, pressure=0.01}]", "run.collisions_per_disc=", "run.until=20")
    assert registry.analyse(made(*stopped), "evolution").law is None  # the gas pushes it to its end stop
    held = ("piston=[{side='right', position=6, mass=5, pressure=1}]", "run.collisions_per_disc=", "run.until=20")
    law = registry.analyse(made(*held), "evolution").law
    assert law.piston_error == pytest.approx(0.12 / 40 * law.piston)  # side='right': the gas begins at 0


def test_a_heat_capacity_under_gravity_is_that_of_many_discs(made):
    """Few of a fixed energy have another, by 0.47/N at most; between walls of a temperature they have the same."""
    pull, often = "gravity.acceleration=[0, -0.3]", "log.snapshot_every=1"

    def theory(*scene):
        return registry.analyse(made(pull, often, "run.collisions_per_disc=100", *scene), "heat-capacity", start=5.0)

    few = theory("species.gas.count=8")
    assert few.theory_error / few.theory == pytest.approx(0.47 / 8)
    assert theory("species.gas.count=4").theory is None
    bath = theory("species.gas.count=4", "thermostat={temperature=1, rate=1}")
    assert (bath.theory is not None, bath.theory_error) == (True, 0.0)


def test_a_conserved_momentum_is_no_degree_of_freedom(made):
    """Nor is the motion that goes with it heat: theory is exact, and measured within 4 standard errors."""
    drifting = np.random.default_rng(3).normal((3, 0), 1, (8, 2)).tolist()
    gas = f"species=[{{name='gas', count=8, radius=0.1, velocities={drifting}}}]"
    channel = 'box={size=[8, 8], left="periodic", right="periodic"}'
    (route,) = registry.analyse(made(channel, gas, "run.collisions_per_disc=1000"), "heat-capacity").routes.values()
    assert route.theory == 1 - 1 / 16
    assert abs(route.deviation) < 4
    rough = (PERIODIC, "rotation={inertia=0.5, roughness=1}", "species.gas.count=8", "log.snapshot_every=1")
    (route,) = registry.analyse(made(*rough, "run.collisions_per_disc=1000"), "heat-capacity").routes.values()
    assert route.theory == 1.5 - 1 / 8
    assert abs(route.deviation) < 4


def test_samples_of_the_energy_begin_in_the_window(made):
    log = made("gravity.acceleration=[0, -0.3]", "run.collisions_per_disc=800", "log.events=false")
    first = log.observables["energy"][0][1]
    assert energy_series(log, start=0.9 * first).start == first


def test_directions_are_alike_in_a_square_box(made):
    long = "run.collisions_per_disc=200"
    assert (
        registry.analyse(made(PERIODIC, long), "transport").collective.coefficients["viscosity"].difference.theory == 0
    )
    oblong = PERIODIC.replace("[8, 8]", "[16, 4]")
    found = registry.analyse(made(oblong, long), "transport").collective.coefficients
    assert found["viscosity"].difference.theory is None
    assert found["thermal_conductivity"].difference.theory is None
