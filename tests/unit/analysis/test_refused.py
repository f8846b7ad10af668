"""Gases and logs of which analyses have no answer: for each the line that says why."""

import pytest
from helpers.logs import log_of, raised
from helpers.small_gases import GAS, PERIODIC

from idealgas.analysis import registry
from idealgas.errors import NotApplicableError, UserError

pytestmark = pytest.mark.usefixtures("uncompiled")

BATH = "thermostat={temperature=1, rate=1}"
SUMS = "log.events=false"
REST = ("species.gas.temperature=", "species.gas.speed=0", "run.events=", "run.until=1")
SIX = ("species.gas.count=6", "species.gas.radius=0.5")
WITHOUT_POSITIONS = ("run.method=monte_carlo", "run.v_ref=20")
STROKE = ("piston=[{velocity=[[0, -0.01], [25, 0]]}]", "run.events=", "run.until=3")
HELD = "piston=[{position=7, mass=5, pressure=8}]"
PRESSED_IN_STEPS = ("piston=[{position=7, mass=5, pressure=[[0, 8], [2, 9]]}]",)
GATE = ("wall=[{from=[4, 3], to=[4, 5], opens_at=0.5, closes_at=1}]",)
TWO = "[{name='a', count=20, radius=0.1, temperature=1}, {name='b', count=20, radius=0.1, temperature=1}]"
FLOW = 'box={size=[8, 8], left="periodic", right="periodic"}'

NOT_APPLICABLE = [
    ("cooling", "cooling requires collisions that lose energy", ("restitution.normal=1",)),
    ("cooling", r"between discs change the energy \(got walls\)", ("restitution={normal=0.95, wall=0.9}",)),
    ("cooling", r"has 2\.\d+ collisions per disc, and averaging starts after", (PERIODIC, "restitution.normal=0.95")),
    ("entropy", "entropy requires events and a species of at least 8 discs", ("species.gas.count=7",)),
    ("escape", "escape requires a wall that absorbs discs", ()),
    ("lyapunov", "requires equilibrium, but the gas loses energy", ("restitution.normal=0.9",)),
    ("lyapunov", "not available, because discs receive random velocities from walls or a heat bath", (BATH,)),
    ("lyapunov", "not available, because discs spin", ("rotation.roughness=1",)),
    ("lyapunov", "not available, because the method does not follow the exact motion", WITHOUT_POSITIONS),
    ("lyapunov", "not available, because a gate may close on a disc", GATE),
    ("lyapunov", "not available, because the pressure on a piston changes", PRESSED_IN_STEPS),
    ("order", "order requires discs with positions", WITHOUT_POSITIONS),
    ("order", "requires a gas without piston; use `idealgas evolution`", (HELD,)),
    ("scattering", "one species in a periodic box", ()),
    ("shear", "requires sheared sides", ()),
    ("temperature", "gravity along periodic sides accelerates or heats the gas", (FLOW, "gravity.acceleration=[1, 0]")),
    (
        "temperature",
        "but discs leave this gas; use `idealgas escape`",
        ("wall=[{from=[4, 3], to=[4, 5], absorbing=true}]",),
    ),
    ("transport", "thermostat", (BATH,)),
    ("work", "requires one piston with prescribed velocities", STROKE),
    ("work", "requires a gas without restitution; use", (*STROKE, BATH, "restitution.normal=0.9")),
]
"""Analysis, words of the line, and overrides of the gas."""

OTHERS = [
    ("billiard", "no event between t = 0 and", ("run.events=", "run.until=1e-4"), {"start": 0.0}),
    ("evolution", "empty time window", (), {"start": 0.0, "end": 1e9}),
    ("heat-capacity", "16 needed", ("rotation.roughness=1", SUMS), {"start": 0.0}),
    ("histogram", "no event between|no disc moves", REST, {"quantity": "speed"}),
    ("lyapunov", r"exponents: 6 discs have 24 \(got 25\)", SIX, {"exponents": 25}),
    ("lyapunov", "too short for Lyapunov exponents, which require 52 events per disc", SIX, {"start": 0.0}),
    ("order", "has neither events", (PERIODIC, SUMS), {}),
    ("pressure", "has neither events", (SUMS,), {}),
    ("pressure", "has no events, and samples do not follow a piston", (HELD, SUMS, "log.pressure=true"), {}),
    ("pressure", "no event between|no disc moves", REST, {}),
    ("profile", "has no events", (SUMS,), {}),
    ("profile", "a profile requires discs with positions", WITHOUT_POSITIONS, {}),
    (
        "relaxation",
        "requires constant kinetic energy; use .* for a gas with gravity",
        ("gravity.acceleration=[0, -1]",),
        {},
    ),
    ("sound", "periodic sides", (), {}),
    ("sound", "one species", (PERIODIC, f"species={TWO}"), {}),
    ("relaxation", r"has no events \(made with log.events = false\)", (SUMS,), {}),
    ("scattering", "window too short", (PERIODIC,), {"start": 0.0, "end": 1.0}),
    ("sound", "window too short for waves to be followed", (PERIODIC,), {"start": 0.0, "end": 3.0}),
    ("temperature", "no event between|no disc moves", REST, {}),
    ("work", "no stroke of the piston after a rest", (*STROKE, BATH), {}),
]
"""The same, and options: refusals of what is asked, not of the gas as such."""


def of_few_events(overrides):
    return log_of(GAS, "run.collisions_per_disc=", "run.events=60", *overrides)


@pytest.mark.parametrize(("name", "words", "overrides"), NOT_APPLICABLE)
def test_other_gases(name, words, overrides):
    raised(words, registry.analyse, of_few_events(overrides), name, error=NotApplicableError)


@pytest.mark.parametrize(("name", "words", "overrides", "options"), OTHERS)
def test_other_refusals(name, words, overrides, options):
    with pytest.raises(UserError) as caught:
        registry.analyse(of_few_events(overrides), name, **options)
    assert not isinstance(caught.value, NotApplicableError)
    assert caught.match(words)
