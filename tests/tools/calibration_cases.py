"""Gases of the calibration of error bars, and what is measured of each."""

import math
from collections.abc import Callable, Iterable, Sequence
from typing import Literal, NamedTuple

from helpers.logs import species
from tools import calibration_estimates as estimates
from tools.calibration_estimates import Of, of

from idealgas import Log, profile, scattering, shear, transport
from idealgas.analysis.caveats import window_caveats
from idealgas.columns import SIDES
from idealgas.statistics.estimates import Estimate


class Case(NamedTuple):
    """Gas of a calibration: text of its scene, run lengths as text for [run], and what is measured of a log.

    more: text for [log]. steady: whether the gas is in equilibrium from early on. caveats: caveats of results besides
    that of a window that is short for the slow fluctuations of the gas. energies_differ: whether the starts of seeds
    differ in their energy, and with it what their runs fluctuate about. besides: further estimates by their names.
    """

    scene: str
    runs: tuple[str, ...]
    measured: tuple[Of, ...]
    more: str = ""
    steady: bool = True
    caveats: Callable[[Log], Sequence[str]] = lambda _: ()
    energies_differ: bool = False
    besides: Callable[[Log], Iterable[tuple[str, Estimate]]] = lambda _: ()


UNIT = "[box]\nsize = [1, 1]\n"


def two_sizes(number: int, fraction: float) -> str:
    """Closed box of discs of which half are 1.6 times as large and three times as heavy as the others."""
    radius = math.sqrt(2 * fraction / (number * math.pi * (1 + 1.6**2)))
    return UNIT + species("light", number // 2, radius) + species("heavy", number // 2, 1.6 * radius, mass=3)


def equal(number: int, fraction: float, sides: str = "") -> str:
    """Box of equal discs."""
    return UNIT + sides + species("gas", number, math.sqrt(fraction / (number * math.pi)))


def fifty(sides: str = "") -> str:
    """Box of 50 equal discs at packing fraction 0.2."""
    return equal(50, 0.2, sides)


PERIODIC = "".join(f'{side} = "periodic"\n' for side in SIDES)
THERMAL = "".join(f"{side} = {{ thermal = 1 }}\n" for side in SIDES)
SHORT_AND_LONG = ("collisions_per_disc = 1000", "collisions_per_disc = 4000")
SHORT = ("collisions_per_disc = 1000", "collisions_per_disc = 2000")
OFTEN, SELDOM = "snapshot_every = 0.2\n", "snapshot_every = 1\n"
"""Samples of the energy: some in the time for which it fluctuates."""

SLOW = ("collisions_per_disc = 3000", "collisions_per_disc = 6000")
"""Runs for what follows the slow exchange of discs and heat across the box: the shorter ones have some 60 times it."""

CURRENTS = ("collisions_per_disc = 4000", "collisions_per_disc = 8000")
"""Runs for the spread of currents: the shorter ones have 200 times the longest lag."""

FEW_LAGS = ("collisions_per_disc = 1500", "collisions_per_disc = 3000")
"""Runs of 75 and 150 times the longest lag of the currents."""

STRUCTURE = ("collisions_per_disc = 300", "collisions_per_disc = 2000")
"""Runs of small dense gases; at packing fraction 0.45 two sizes of discs mix in some 300 collisions per disc."""

SLOWEST = ("collisions_per_disc = 6000", "collisions_per_disc = 12000")
"""Runs for the energy of a gas that only its walls change."""

HOLE = "[box]\nsize = [10, 10]\n" + "".join(
    f"[[wall]]\nsolid = 'outside'\nfrom = {start}\nto = {end}\n{more}\n"
    for start, end, more in (
        ([1, 1], [4.85, 2], "via = [3, 1.8]"),
        ([4.85, 2], [5.15, 2], "absorbing = true"),
        ([5.15, 2], [9, 1], "via = [7, 1.8]"),
        ([9, 1], [9, 9], "via = [8, 5]"),
        ([9, 9], [1, 9], "via = [5, 8]"),
        ([1, 9], [1, 1], "via = [2, 5]"),
    )
)
"""Box with a hole; its walls bulge inwards, as those of the scene `escape`."""

SLIT = "[box]\nsize = [2, 1]\n" + "".join(
    f"[[wall]]\nfrom = [1, {low}]\nto = [1, {high}]\n{more}"
    for low, high, more in ((0, 0.47, ""), (0.53, 1, ""), (0.47, 0.53, "name = 'gate'\nopens_at = 1\n"))
)
"""Two chambers with a slit between them."""

LEFT = [0, 0, 1, 1]

STROKES = [[0, 0]] + [[22 * k + at, v] for k in range(400) for at, v in ((20, (-0.5, 0.5)[k % 2]), (22, 0))]
"""Velocities of a piston that rests for 20 and moves for 2, in and out."""

HALF_PERIODIC = "".join(f'{side} = "periodic"\n' for side in ("bottom", "top"))
RADIUS = math.sqrt(0.4 / (60 * math.pi * (1 + 0.15**2)))
UNLIKE = (
    "[box]\nsize = [1, 1]\n[[species]]\nname = 'gas'\ncount = 60\ntemperature = 1\n"
    f"radius = {{ normal = [{RADIUS!r}, {0.15 * RADIUS!r}] }}\nmass = {{ density = {1 / (math.pi * RADIUS**2)!r} }}\n"
)
"""Closed box of 60 discs of radii of a standard deviation of 15 %, packing fraction 0.4."""

ONE_TO_FIVE = f"{UNIT}{HALF_PERIODIC}" + "".join(
    species(name, 30, math.sqrt(0.2 / (60 * math.pi)), mass=mass) for name, mass in (("light", 1), ("heavy", 5))
)
"""Discs of one size and masses 1 and 5 between walls on the left and on the right."""


def exchange(collisions: int) -> tuple[str, str]:
    """Runs in which heat and discs cross the box a few times, and often enough that errors have no caveat.

    collisions: of each disc in the longer runs.
    """
    return "collisions_per_disc = 350", f"collisions_per_disc = {collisions}"


def slow_along(axis: Literal["x", "y"]) -> Callable[[Log], Sequence[str]]:
    """Caveats of a window that is short for what crosses the box along an axis."""
    return lambda log: window_caveats(profile(log, axis, 2).window)


def in_a_row(*gases: tuple[int, float, float]) -> str:
    """Gases in a row with pistons between them: numbers of discs, lengths, and masses of the pistons after them."""
    text, place = f"[box]\nsize = [{sum(length for _, length, _ in gases)}, 10]\n", 0.0
    for k, (count, length, mass) in enumerate(gases):
        text += species(f"gas{k}", count, 0.05, region=[place, 0, place + length, 10])
        place += length
        if mass:
            text += f"[[piston]]\nname = 'piston{k}'\ninner = 'x'\nposition = {place}\nmass = {mass}\n"
    return text


STRIPS = of(
    "profile", "species.gas.density.[01]", "species.gas.temperature.[01]", "=species.gas.gradient", along="x", bins=4
)

CASES = {
    "closed box": Case(fifty(), SHORT_AND_LONG, estimates.BOX),
    "closed box, strips": Case(
        fifty(),
        SLOW,
        (STRIPS,),
    ),
    "periodic box": Case(fifty(PERIODIC), CURRENTS, estimates.TRANSPORT),
    "closed box, entropy": Case(
        fifty(), SHORT_AND_LONG, (of("entropy", "=species.*.mean_h", "species.*.mean_positions"),)
    ),
    "periodic box, scattering": Case(
        fifty(PERIODIC), CURRENTS, (estimates.SCATTERING,), caveats=lambda log: scattering(log).caveats
    ),
    "work of a piston": Case(
        f"[box]\nsize = [5, 4]\n[thermostat]\ntemperature = 1\nrate = 0.5\n[[piston]]\nvelocity = {STROKES}\n"
        + species("gas", 2, 0.5),
        ("until = 2200", "until = 8800"),
        (estimates.WORK,),
        "events = false\n",
        steady=False,
    ),
    "periodic box, collisions": Case(
        fifty(PERIODIC),
        SHORT,
        (
            of("histogram", "=distributions.*.mean", quantity="impact-parameter"),
            of("histogram", "distributions.*.mean", "distributions.*.cumulants.*", quantity="collisions"),
        ),
    ),
    "periodic box, order": Case(
        fifty(PERIODIC),
        SHORT,
        (of("order", "local", "whole", "hexagons", "correlation[0]", "structure.value[0]", parts=128),),
    ),
    "periodic mixture": Case(
        UNIT + PERIODIC + species("light", 25, 0.03) + species("heavy", 25, 0.04, mass=4),
        CURRENTS,
        (
            of("transport", "collective.mutual_diffusion.coefficient", "collective.mutual_diffusion.difference"),
            of("transport", "diffusion.*.coefficient"),
        ),
    ),
    "cooling gas": Case(
        fifty(PERIODIC) + "[restitution]\nnormal = 0.95\n",
        ("collisions_per_disc = 400", "collisions_per_disc = 800"),
        (estimates.COOLING,),
        steady=False,
    ),
    "cooling rough gas": Case(
        fifty(PERIODIC) + "[restitution]\nnormal = 0.95\n[rotation]\ninertia = 0.5\nroughness = 0.5\n",
        ("collisions_per_disc = 200", "collisions_per_disc = 400"),
        (estimates.COOLING,),
        steady=False,
    ),
    "heat bath": Case(
        fifty(THERMAL),
        SLOWEST,
        (
            of("heat-capacity", "routes.Var*"),
            of("temperature", "=species.gas.both"),
            of("profile", "heat.left", along="x", bins=2),
        ),
        SELDOM,
    ),
    "rough discs": Case(
        fifty() + "[rotation]\ninertia = 0.5\nroughness = 1\n",
        SHORT_AND_LONG,
        (of("heat-capacity", "routes.fluctuations*", "temperature"),),
        OFTEN,
    ),
    "waves": Case(
        f"[box]\nsize = [12, 12]\n{PERIODIC}{species('gas', 56, 0.5)}",
        ("until = 4000", "until = 6000"),
        (of("sound", "waves.*"),),
    ),
    "sheared gas": Case(
        equal(50, 0.3, PERIODIC[: PERIODIC.index("bottom")] + "bottom = { shear = 0.5 }\ntop = { shear = 0.5 }\n")
        + "[thermostat]\ntemperature = 1\nrate = 3\n",
        SHORT,
        (of("shear", "temperature", "normal_stress", "slope"),),
        caveats=lambda log: shear(log).caveats,
        besides=estimates.sheared,
    ),
    "mixture": Case(
        UNIT + species("light", 30, 0.03, temperature=1.3) + species("heavy", 20, 0.045, mass=4, temperature=0.5),
        SLOW,
        (of("temperature", "=species.light.both", "=species.heavy.both"), of("pressure", "collision_rates.*.rate")),
    ),
    "small mixture": Case(two_sizes(20, 0.45), STRUCTURE, estimates.FLUID),
    "mixture of 40": Case(two_sizes(40, 0.45), STRUCTURE, estimates.FLUID),
    "mixture of 100": Case(two_sizes(100, 0.45), STRUCTURE, estimates.FLUID),
    "small mixture, 0.3": Case(two_sizes(20, 0.3), STRUCTURE, estimates.FLUID),
    "mixture of 40, 0.3": Case(two_sizes(40, 0.3), STRUCTURE, estimates.FLUID),
    "dense box": Case(equal(30, 0.6), STRUCTURE, estimates.FLUID),
    "thermal walls": Case(equal(40, 0.2, THERMAL), STRUCTURE, estimates.FLUID),
    "small periodic box": Case(equal(64, 0.3, PERIODIC), STRUCTURE, estimates.FLUID),
    "small periodic box, currents": Case(
        equal(64, 0.3, PERIODIC), FEW_LAGS, (estimates.COEFFICIENTS,), caveats=lambda log: transport(log).caveats
    ),
    "column": Case(
        equal(40, 0.2).replace("temperature = 1", "speed = 1.5\nplacement = 'lattice'")
        + "[gravity]\nacceleration = [0, -2]\n",
        STRUCTURE,
        (estimates.GAUGES, of("temperature", "species.gas.both")),
    ),
    "driven grains": Case(equal(40, 0.2, THERMAL) + "[restitution]\nnormal = 0.9\n", STRUCTURE, (estimates.GAUGES,)),
    "escaping points": Case(
        HOLE + species("points", 100, 1e-6, speed=1),
        ("until = 150", "until = 600"),
        (of("escape", "per_path", "mean_time"),),
        steady=False,
    ),
    "escaping mixture": Case(
        HOLE + species("light", 120, 0.02) + species("heavy", 120, 0.03, mass=4),
        ("until = 150", "until = 600"),
        (of("escape", "species.*"),),
        steady=False,
    ),
    "two chambers": Case(
        SLIT + species("gas", 100, 0.002, region=LEFT),
        ("until = 11", "until = 41"),
        (of("effusion", "speed"),),
        steady=False,
    ),
    "two chambers, mixture": Case(
        SLIT + species("light", 300, 0.001, region=LEFT) + species("heavy", 300, 0.0015, mass=4, region=LEFT),
        ("until = 16", "until = 31"),
        (of("effusion", "species.*.speed"),),
        steady=False,
        besides=estimates.graham,
    ),
    "held piston": Case(
        "[box]\nsize = [20, 5]\n[[piston]]\nposition = 10\nmass = 50\npressure = 1.5\n[[species]]\nname = 'gas'\n"
        "count = 50\nradius = 0.05\ntemperature = 1\n",
        ("until = 3000", "until = 6000"),
        (estimates.GAUGES,),
    ),
    "column on a hot floor": Case(
        "[box]\nsize = [10, 10]\nbottom = { thermal = 1 }\n[gravity]\nacceleration = [0, -0.3]\n"
        "[[species]]\nname = 'gas'\ncount = 50\nradius = 0.3\ntemperature = 1\n",
        ("until = 2000", "until = 4000"),
        (estimates.GAUGES,),
    ),
    "equal speeds": Case(
        "[box]\nsize = [1, 1]\n[[species]]\nname = 'gas'\ncount = 200\nradius = 0.0178\nspeed = 1\n",
        ("collisions_per_disc = 45",),
        (of("relaxation", "relaxation_*"),),
        steady=False,
    ),
    "box of 60": Case(equal(60, 0.4), exchange(4000), estimates.ALONG_X, caveats=slow_along("x")),
    "box of 60, unlike radii": Case(UNLIKE, exchange(65000), estimates.ALONG_X, caveats=slow_along("x")),
    "thin box of 60": Case(equal(60, 0.1), exchange(2000), estimates.ALONG_X, caveats=slow_along("x")),
    "half-periodic mixture": Case(ONE_TO_FIVE, exchange(12500), estimates.ALONG_X, caveats=slow_along("x")),
    "inner piston": Case(
        in_a_row((40, 8, 20), (60, 12, 0)), ("until = 700", "until = 25000"), (estimates.TEMPERATURES,)
    ),
    # the last three were chosen before any result was known
    "long box": Case(
        equal(80, 0.05).replace("[1, 1]", "[4, 1]"), exchange(2000), estimates.ALONG_X, caveats=slow_along("x")
    ),
    "column of two masses": Case(
        "[box]\nsize = [10, 10]\n[gravity]\nacceleration = [0, -0.3]\n"
        "[[species]]\nname = 'light'\ncount = 40\nradius = 0.2\ntemperature = 1\n"
        "[[species]]\nname = 'heavy'\ncount = 20\nradius = 0.2\nmass = 3\ntemperature = 1\n",
        exchange(4000),
        estimates.ALONG_Y,
        caveats=slow_along("y"),
        energies_differ=True,
    ),
    "three gases": Case(
        in_a_row((30, 8, 5), (40, 10, 20), (50, 12, 0)), ("until = 700", "until = 40000"), (estimates.TEMPERATURES,)
    ),
}
