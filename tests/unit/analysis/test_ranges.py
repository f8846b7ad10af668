"""Where laws and theories end: for each a gas of which they say nothing or less, and one within their range."""

import json

import numpy as np
import pytest
from helpers.logs import raised
from helpers.small_gases import GAS, PERIODIC, SLIT, TWO, WHOLE, analysed, made, only, silent

from idealgas.analysis import registry
from idealgas.analysis.heat_capacity.fluctuations import energy_series
from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.theory.forecast import forecast
from idealgas.theory.granular import GranularParameters, cooling_per_collision

SPIN = "rotation={inertia=0.5, roughness=0}"
STEEP, COLUMN = ((f"gravity.acceleration=[0, {pull}]", "run.collisions_per_disc=60") for pull in (-5, -0.2))
EQUAL = "species=[{name='gas', count=%d, radius=%g, speed=1}]"
FAST = "species=[{name='gas', count=190, radius=0.05, speed=0.1}, {name='hot', count=10, radius=0.05, speed=10}]"
LONG = (PERIODIC, "species.gas.radius=0.3", "run.collisions_per_disc=400")
HEAVY = "{name='b', count=4, radius=0.3, mass=50, temperature=1}"
MIXED = (
    PERIODIC,
    f"species=[{{name='a', count=36, radius=0.3, temperature=1}}, {HEAVY}]",
    "run.collisions_per_disc=800",
)
COOLING = ("restitution={normal=0.95}", "run.collisions_per_disc=80")
CHANNEL = 'box={size=[32, 2], left="periodic", right="periodic"}'
POINTS = ("species=[{name='gas', count=40, radius=1e-6, temperature=1}]", "run.collisions_per_disc=", "run.until=50")
PLATE = ("wall=[{from=[4, 2], to=[4, 6]}]", "log.pressure=true", "log.snapshot_every=0.2")


def pushed(speed):
    return f"piston=[{{side='right', position=8, velocity={speed}}}]", "run.collisions_per_disc=", "run.until=6"


SAID = [
    ("form layers at walls", "profile", {"start": 0.0}, ("species.gas.radius=0.4", "run.collisions_per_disc=20"), ()),
    ("form layers at walls", "profile", {"start": 0.0, "bins": 40}, ("species.gas.count=120",), None),
    ("strips hold a disc of gas in fewer than 32 frames", "profile", {"start": 0.0}, STEEP, ()),
    ("The theory assumes a dilute gas; the packing fraction of a strip reaches 0.", "profile",
     {"start": 0.0, "bins": 4}, (*COLUMN, "species.gas.radius=0.2"),
     (*COLUMN, "species.gas.radius=0.02", "run.collisions_per_disc=5")),
    ("of the mean speed of the discs, but the adiabat assumes a slow piston", "evolution", {}, pushed(-0.5),
     pushed(-0.05)),
    ("is therefore an extrapolation", "relaxation", {}, (EQUAL % (400, 0.05), "run.collisions_per_disc=1"),
     (EQUAL % (400, 0.05), "run.collisions_per_disc=20")),
    ("is therefore an extrapolation", "relaxation", {}, None, (EQUAL % (10, 0.5),)),
    ("a few discs are faster than most", "relaxation", {}, (FAST,), (EQUAL % (200, 0.05),)),
    ("later curves scatter more", "relaxation", {"start": 0.2}, (EQUAL % (200, 0.05),), None),
    ("later curves", "relaxation", {}, None, (EQUAL % (200, 0.05),)),
    ("Use periodic sides, or a box", "transport", {}, (), (PERIODIC,)),
    ("The window is short: gas is followed for", "transport", {"part": 1 / 40}, LONG, None),
    ("currents are followed for", "transport", {"part": 1 / 40}, LONG, None),
    ("followed for", "transport", {}, None, LONG),
    ("b is followed for", "transport", {"start": 0.0}, MIXED, None),
    ("The box is 5 diameters wide between walls", "cooling", {}, (CHANNEL, *COOLING, "species.gas.radius=0.2"), None),
    ("diameters wide", "cooling", {}, None, (PERIODIC, *COOLING)),
    ("Discs hardly collide with each other (0 times each", "pressure", {}, POINTS, ()),
    ("Discs hardly collide with each other (0 times each", "temperature", {}, POINTS, ()),
    ("Discs do not interact: each disc keeps its energy", "temperature", {}, (*POINTS, "interactions.discs=false"), ()),
    ("Discs hardly collide", "temperature", {}, None, (*POINTS, "box={size=[8, 8], left={thermal=1}}")),
    ("to the ends of its wall", "pressure", {"start": 0.0}, (*PLATE, "log.events=false"), PLATE),
    ("these contain plate.", "effusion", {}, [part.replace("wall=[", "wall=[{name='plate', from=[5, 3], to=[5, 5]}, ")
                                         for part in SLIT], SLIT),
]  # fmt: skip
"""Words of a caveat, an analysis and its options, a gas of which they are said, and one of which they are not.

part: the window as a part of the log, from its start.
"""


@pytest.mark.parametrize(("words", "name", "options", "scene", "other"), SAID)
def test_a_caveat_is_said_where_it_holds(words, name, options, scene, other):
    for gas, of_words in ((scene, only), (other, silent)):
        if gas is not None:
            log = made(*gas)
            window = {"start": 0.0, "end": log.end_time * options["part"]} if "part" in options else options
            assert of_words(registry.analyse(log, name, **window), words)


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        (SLIT[2], "wall=[{from=[4, 3], to=[4, 5], opens_at=1.0}]", "there is a gap of 3 beside the gate"),
        ("to=[4, 3]}", "to=[4, 2]}, {from=[4, 2.5], to=[4, 3]}", "there is a gap of 0.5 beside the gate"),
        ("to=[4, 3]}", "to=[4, 3], closes_at=100}", "there is a gap of 3 beside the gate"),
        ("wall=[", "wall=[{from=[4, 4.5], to=[4, 3]}, ", "a wall stands in the gate"),
        (SLIT[2], WHOLE[1], "opens the box from side to side, so that the gas expands freely"),
    ],
    ids=["no wall", "second slit", "open beside it", "wall in it", "whole"],
)
def test_effusion_takes_a_wall_that_divides_the_box(old, new, words):
    raised(words, registry.analyse, made(*(part.replace(old, new) for part in SLIT)), "effusion")


def test_effusion_takes_no_periodic_sides():
    log = made(*SLIT, 'box={size=[8, 8], left="periodic", right="periodic"}')
    raised("discs also pass through the periodic sides", registry.analyse, log, "effusion")


def test_effusion_takes_a_gate_in_line_with_its_walls():
    """Or nearly so; `test_effusion` has the windows in which it is open."""
    assert analysed("effusion", *SLIT).caveats == ()
    beside = SLIT[2].replace("from=[4, 0], to=[4, 3]", "from=[4.001, 3], to=[4.001, 0]")
    assert analysed("effusion", *SLIT[:2], beside, *SLIT[3:]).caveats == ()


@pytest.mark.parametrize(
    "sides", [PERIODIC, 'box={size=[8, 8], bottom="periodic", top="periodic"}'], ids=["both", "one"]
)
def test_heat_capacity_is_that_of_heat(sides):
    """Fluctuations of a gas that moves as a whole are those of the same gas at rest."""
    velocities = np.random.default_rng(3).normal((0, 3), 1, (40, 2)).tolist()
    moving = f"species=[{{name='gas', count=40, radius=0.1, velocities={velocities}}}]"
    scene = (sides, "rotation={inertia=0.5, roughness=1}", "log.snapshot_every=0.5", "run.collisions_per_disc=100")
    found = energy_series(made(*scene, moving), start=5.0)
    assert 0.4 < found.kinetic.mean() / 40 < 1.6  # 5.5 with the motion


@pytest.mark.slow
def test_laws_of_heat_take_collisions_that_lose_none():
    bath = "box={size=[8, 8], " + ", ".join(f"{s}={{thermal=1}}" for s in ("left", "right", "bottom", "top")) + "}"
    raised("requires equilibrium", registry.analyse, made(bath, SPIN), "heat-capacity")
    floor = ("box={size=[8, 8], bottom={thermal=1}}", "gravity.acceleration=[0, -0.2]")
    assert analysed("profile", *floor, start=0.0).law is not None
    assert analysed("profile", *floor, SPIN, start=0.0).law is None
    two = "box={size=[8, 8], left={thermal=1}, right={thermal=4}%s}"

    def law(*scene):
        return analysed("profile", "species.gas.count=160", *scene, start=0.0).law

    assert "Fourier" in law(two % "")
    assert law(two % "", SPIN.replace("0}", "1}")) is None
    assert law(two % ", bottom={thermal=1}") is None
    assert law(two % "", "thermostat={temperature=1, rate=1}") is None


def test_fourier_s_law_takes_many_mean_free_paths():
    """In all strips deviations are as large as errors; without the jumps of T at the walls their rms would be 1.4."""
    two = ("box={size=[16, 4], left={thermal=1}, right={thermal=2}}", "run.collisions_per_disc=1500")
    (found,) = analysed("profile", "species.gas.count=160", *two).species
    deviations = np.array([entry.deviation for entry in (*found.temperature, *found.density)])
    assert 0.6 < np.sqrt((deviations**2).mean()) < 1.2
    assert analysed("profile", "species.gas.count=10", *two).law is None


def test_laws_of_many_discs_take_many():
    few = ("species.gas.count=10", PERIODIC)
    path = analysed("histogram", *few, quantity="free-path")
    assert path.no_law == "theory assumes many discs, but this gas has only 10"
    many = analysed("histogram", PERIODIC, quantity="free-path")
    assert many.no_law is None
    assert many.distributions[0].mean.theory == pytest.approx(analysed("transport", PERIODIC).free_paths[0].path.theory)
    two = analysed("histogram", TWO, PERIODIC)
    assert two.no_law == "2 degrees of freedom are too few"
    result = made("species.gas.count=1", "run.collisions_per_disc=", "run.until=50")
    assert registry.analyse(result, "histogram", quantity="vx").no_law == "2 degrees of freedom are too few"
    found = registry.analyse(result, "temperature")
    only(found, "A single disc does not share its energy evenly")
    assert (found.species[0].x.theory, found.species[0].both.theory) == (None, 1.0)
    spinning = analysed(
        "temperature", "species.gas.count=1", SPIN.replace("=0}", "=1}"), "run.collisions_per_disc=", "run.until=50"
    )
    assert spinning.species[0].both.theory is None
    assert registry.analyse(result, "transport").figure().axes


def test_a_slit_takes_a_thin_gas():
    thick = (*SLIT[:1], "species.gas.radius=0.15", SLIT[2].replace("to=[4, 5], opens", "to=[4, 3.4], opens"), *SLIT[3:])
    thick = tuple(part.replace("{from=[4, 5]", "{from=[4, 3.4]") for part in thick)
    found = analysed("effusion", *thick)
    only(found, "discs crowd in the slit")
    assert (found.speed.theory, found.expected) == (None, None)
    thin = analysed("effusion", *(part.replace("0.15", "0.03") for part in thick))
    assert silent(thin, "crowd")
    assert thin.speed.theory_error > 0


def test_waits_are_exponential_for_many_discs():
    few = analysed("histogram", "species.gas.count=10", quantity="waiting-time")
    assert few.distributions[0].tests == ()
    assert analysed("histogram", quantity="waiting-time").distributions[0].tests


def test_a_heat_bath_takes_time():
    hot = "species=[{name='gas', count=40, radius=0.1, temperature=100}]"
    for bath, rate, slow in ((1, 0.001, True), (1, 10.0, False), (100, 0.001, False)):
        scene = parse_scene(GAS, overrides=(hot, f"thermostat={{temperature={bath}, rate={rate}}}"))
        assert any("heat bath needs a time" in said for said in forecast(scene, make_gas(scene)).caveats) == slow


def test_laws_of_cooling_end_at_strong_losses():
    def found(normal):
        return analysed("cooling", PERIODIC, f"restitution.normal={normal}", "run.collisions_per_disc=60")

    known = found(0.9).loss
    assert known.theory_error / known.theory == pytest.approx(np.hypot(0.015, 1 / 78))
    assert known.theory == pytest.approx(cooling_per_collision(GranularParameters(0.9)) * 40 / 39)
    assert silent(found(0.9), "Theory is not available below e")
    assert (found(0.6).loss.theory, found(0.6).haff.theory, found(0.6).fourth.theory) == (None, None, None)
    only(found(0.6), "Theory is not available below e = 0.8.")
    course = {e: analysed("evolution", PERIODIC, f"restitution.normal={e}") for e in (0.9, 0.6)}
    assert "Haff" in course[0.9].law.text
    only(course[0.9], "Haff's law assumes a uniform gas")
    assert course[0.6].law is None


def test_a_law_of_a_piston_takes_a_fluid():
    piston = (
        "piston=[{side='right', position=8, velocity=-0.4}]",
        "species.gas.radius=0.4",
        "run.collisions_per_disc=",
        "run.until=10",
    )
    found = analysed("evolution", *piston)
    assert found.law is None
    assert json.dumps(found.as_dict(), allow_nan=False)
    stopped = ("piston=[{side='right', position=7, mass=5, pressure=0.01}]", "run.collisions_per_disc=", "run.until=20")
    assert analysed("evolution", *stopped).law is None  # the gas pushes it to its end stop
    held = ("piston=[{side='right', position=6, mass=5, pressure=1}]", "run.collisions_per_disc=", "run.until=20")
    law = analysed("evolution", *held).law
    assert law.piston_error == pytest.approx(0.12 / 40 * law.piston)  # side='right': the gas begins at 0


def test_a_heat_capacity_under_gravity_is_that_of_many_discs():
    """Few of a fixed energy have another, by 0.47/N at most; between walls of a temperature they have the same."""
    pull, often = "gravity.acceleration=[0, -0.3]", "log.snapshot_every=1"

    def theory(*scene):
        return analysed("heat-capacity", pull, often, "run.collisions_per_disc=100", *scene, start=5.0)

    few = theory("species.gas.count=8")
    assert few.theory_error / few.theory == pytest.approx(0.47 / 8)
    assert theory("species.gas.count=4").theory is None
    bath = theory("species.gas.count=4", "thermostat={temperature=1, rate=1}")
    assert (bath.theory is not None, bath.theory_error) == (True, 0.0)


def test_a_conserved_momentum_is_no_degree_of_freedom():
    """Nor is the motion that goes with it heat: theory is exact, and measured within 4 standard errors."""
    drifting = np.random.default_rng(3).normal((3, 0), 1, (8, 2)).tolist()
    gas = f"species=[{{name='gas', count=8, radius=0.1, velocities={drifting}}}]"
    channel = 'box={size=[8, 8], left="periodic", right="periodic"}'
    (route,) = analysed("heat-capacity", channel, gas, "run.collisions_per_disc=1000").routes.values()
    assert route.theory == 1 - 1 / 16
    assert abs(route.deviation) < 4
    rough = (PERIODIC, "rotation={inertia=0.5, roughness=1}", "species.gas.count=8", "log.snapshot_every=1")
    (route,) = analysed("heat-capacity", *rough, "run.collisions_per_disc=1000").routes.values()
    assert route.theory == 1.5 - 1 / 8
    assert abs(route.deviation) < 4


def test_samples_of_the_energy_begin_in_the_window():
    log = made("gravity.acceleration=[0, -0.3]", "run.collisions_per_disc=800", "log.events=false")
    first = log.observables["energy"][0][1]
    assert energy_series(log, start=0.9 * first).start == first


def test_directions_are_alike_in_a_square_box():
    long = "run.collisions_per_disc=200"
    assert analysed("transport", PERIODIC, long).collective.coefficients["viscosity"].difference.theory == 0
    oblong = PERIODIC.replace("[8, 8]", "[16, 4]")
    found = analysed("transport", oblong, long).collective.coefficients
    assert found["viscosity"].difference.theory is None
    assert found["thermal_conductivity"].difference.theory is None
