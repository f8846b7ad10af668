"""Gases of the calibration of error bars, and what is measured of each."""

import math
from collections.abc import Callable, Sequence
from typing import Literal, NamedTuple

from helpers import calibration_estimates as estimates
from helpers.calibration_estimates import Named
from idealgas import Log, profile, scattering, shear, transport
from idealgas.analysis.core.caveats import of_window


class Case(NamedTuple):
    """Gas of a calibration: text of its scene, run lengths as text for [run], and what is measured of a log.

    more: text for [log]. steady: whether the gas is in equilibrium from early on. caveats: caveats of results besides
    that of a window that is short for the slow fluctuations of the gas. energies_differ: whether the starts of seeds
    differ in their energy, and with it what their runs fluctuate about.
    """

    scene: str
    runs: tuple[str, ...]
    measured: Callable[[Log], Named]
    more: str = ""
    steady: bool = True
    caveats: Callable[[Log], Sequence[str]] = lambda _: ()
    energies_differ: bool = False


def two_sizes(number: int, fraction: float) -> str:
    """Closed box of discs of which half are 1.6 times as large and three times as heavy as the others."""
    radius = math.sqrt(2 * fraction / (number * math.pi * (1 + 1.6**2)))
    species = "[[species]]\nname = '{}'\ncount = {}\nradius = {!r}\nmass = {}\ntemperature = 1\n"
    both = ("light", number // 2, radius, 1), ("heavy", number // 2, 1.6 * radius, 3)
    return "[box]\nsize = [1, 1]\n" + "".join(species.format(*one) for one in both)


def equal(number: int, fraction: float, sides: str = "") -> str:
    """Box of equal discs."""
    radius = math.sqrt(fraction / (number * math.pi))
    discs = f"[[species]]\nname = 'gas'\ncount = {number}\nradius = {radius!r}\ntemperature = 1\n"
    return f"[box]\nsize = [1, 1]\n{sides}{discs}"


FIFTY = f"count = 50\nradius = {math.sqrt(0.2 / (50 * math.pi))!r}\n"
GAS = "[box]\nsize = [1, 1]\n{sides}\n[[species]]\nname = 'gas'\n" + FIFTY + "temperature = 1\n"
PERIODIC = "".join(f'{side} = "periodic"\n' for side in ("left", "right", "bottom", "top"))
THERMAL = "".join(f"{side} = {{ thermal = 1 }}\n" for side in ("left", "right", "bottom", "top"))
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

HOLE = "[box]\nsize = [10, 10]\n[[species]]\nname = 'points'\ncount = 100\nradius = 1e-6\nspeed = 1\n" + "".join(
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
"""Box of points with a hole; its walls bulge inwards, as those of the scene `escape`."""

STROKES = [[0, 0]] + [[22 * k + at, v] for k in range(400) for at, v in ((20, (-0.5, 0.5)[k % 2]), (22, 0))]
"""Velocities of a piston that rests for 20 and moves for 2, in and out."""

HALF_PERIODIC = "".join(f'{side} = "periodic"\n' for side in ("bottom", "top"))
RADIUS = math.sqrt(0.4 / (60 * math.pi * (1 + 0.15**2)))
UNLIKE = (
    "[box]\nsize = [1, 1]\n[[species]]\nname = 'gas'\ncount = 60\ntemperature = 1\n"
    f"radius = {{ normal = [{RADIUS!r}, {0.15 * RADIUS!r}] }}\nmass = {{ density = {1 / (math.pi * RADIUS**2)!r} }}\n"
)
"""Closed box of 60 discs of radii of a standard deviation of 15 %, packing fraction 0.4."""

ONE_TO_FIVE = f"[box]\nsize = [1, 1]\n{HALF_PERIODIC}" + "".join(
    f"[[species]]\nname = '{name}'\ncount = 30\nradius = {math.sqrt(0.2 / (60 * math.pi))!r}\nmass = {mass}\n"
    "temperature = 1\n"
    for name, mass in (("light", 1), ("heavy", 5))
)
"""Discs of one size and masses 1 and 5 between walls on the left and on the right."""


def exchange(collisions: int) -> tuple[str, str]:
    """Runs in which heat and discs cross the box a few times, and often enough that errors have no caveat.

    collisions: of each disc in the longer runs.
    """
    return "collisions_per_disc = 350", f"collisions_per_disc = {collisions}"


def slow_along(axis: Literal["x", "y"]) -> Callable[[Log], Sequence[str]]:
    """Caveats of a window that is short for what crosses the box along an axis."""
    return lambda log: of_window(profile(log, axis, 2).window)


def in_a_row(*gases: tuple[int, float, float]) -> str:
    """Gases in a row with pistons between them: numbers of discs, lengths, and masses of the pistons after them."""
    text, place = f"[box]\nsize = [{sum(length for _, length, _ in gases)}, 10]\n", 0.0
    for k, (count, length, mass) in enumerate(gases):
        region = f"region = [{place}, 0, {place + length}, 10]\n"
        text += f"[[species]]\nname = 'gas{k}'\ncount = {count}\nradius = 0.05\ntemperature = 1\n{region}"
        place += length
        if mass:
            text += f"[[piston]]\nname = 'piston{k}'\ninner = 'x'\nposition = {place}\nmass = {mass}\n"
    return text


CASES = {
    "closed box": Case(GAS.format(sides=""), SHORT_AND_LONG, estimates.box),
    "closed box, strips": Case(GAS.format(sides=""), SLOW, estimates.strips),
    "periodic box": Case(GAS.format(sides=PERIODIC), CURRENTS, estimates.periodic),
    "closed box, entropy": Case(GAS.format(sides=""), SHORT_AND_LONG, estimates.in_phase_space),
    "periodic box, scattering": Case(
        GAS.format(sides=PERIODIC), CURRENTS, estimates.scattered, caveats=lambda log: scattering(log).caveats
    ),
    "work of a piston": Case(
        "[box]\nsize = [5, 4]\n[thermostat]\ntemperature = 1\nrate = 0.5\n[[species]]\nname = 'gas'\ncount = 2\n"
        f"radius = 0.5\ntemperature = 1\n[[piston]]\nvelocity = {STROKES}\n",
        ("until = 2200", "until = 8800"),
        estimates.strokes,
        "events = false\n",
        steady=False,
    ),
    "periodic box, collisions": Case(GAS.format(sides=PERIODIC), SHORT, estimates.counted),
    "periodic box, order": Case(GAS.format(sides=PERIODIC), SHORT, estimates.ordered),
    "periodic mixture": Case(
        f"[box]\nsize = [1, 1]\n{PERIODIC}[[species]]\nname = 'light'\ncount = 25\nradius = 0.03\ntemperature = 1\n"
        "[[species]]\nname = 'heavy'\ncount = 25\nradius = 0.04\nmass = 4\ntemperature = 1\n",
        CURRENTS,
        estimates.in_each_other,
    ),
    "cooling gas": Case(
        GAS.format(sides=PERIODIC) + "[restitution]\nnormal = 0.95\n",
        ("collisions_per_disc = 400", "collisions_per_disc = 800"),
        estimates.cools,
        steady=False,
    ),
    "cooling rough gas": Case(
        GAS.format(sides=PERIODIC) + "[restitution]\nnormal = 0.95\n[rotation]\ninertia = 0.5\nroughness = 0.5\n",
        ("collisions_per_disc = 200", "collisions_per_disc = 400"),
        estimates.cools,
        steady=False,
    ),
    "heat bath": Case(GAS.format(sides=THERMAL), SLOWEST, estimates.bath, SELDOM),
    "rough discs": Case(
        GAS.format(sides="") + "[rotation]\ninertia = 0.5\nroughness = 1\n", SHORT_AND_LONG, estimates.rough, OFTEN
    ),
    "waves": Case(
        f"[box]\nsize = [12, 12]\n{PERIODIC}[[species]]\nname = 'gas'\ncount = 56\nradius = 0.5\ntemperature = 1\n",
        ("until = 4000", "until = 6000"),
        estimates.waves,
    ),
    "sheared gas": Case(
        equal(50, 0.3, PERIODIC[: PERIODIC.index("bottom")] + "bottom = { shear = 0.5 }\ntop = { shear = 0.5 }\n")
        + "[thermostat]\ntemperature = 1\nrate = 3\n",
        SHORT,
        estimates.sheared,
        caveats=lambda log: shear(log).caveats,
    ),
    "mixture": Case(
        "[box]\nsize = [1, 1]\n[[species]]\nname = 'light'\ncount = 30\nradius = 0.03\ntemperature = 1.3\n"
        "[[species]]\nname = 'heavy'\ncount = 20\nradius = 0.045\nmass = 4\ntemperature = 0.5\n",
        SLOW,
        estimates.mixture,
    ),
    "small mixture": Case(two_sizes(20, 0.45), STRUCTURE, estimates.fluid),
    "mixture of 40": Case(two_sizes(40, 0.45), STRUCTURE, estimates.fluid),
    "mixture of 100": Case(two_sizes(100, 0.45), STRUCTURE, estimates.fluid),
    "small mixture, 0.3": Case(two_sizes(20, 0.3), STRUCTURE, estimates.fluid),
    "mixture of 40, 0.3": Case(two_sizes(40, 0.3), STRUCTURE, estimates.fluid),
    "dense box": Case(equal(30, 0.6), STRUCTURE, estimates.fluid),
    "thermal walls": Case(equal(40, 0.2, THERMAL), STRUCTURE, estimates.fluid),
    "small periodic box": Case(equal(64, 0.3, PERIODIC), STRUCTURE, estimates.fluid),
    "small periodic box, currents": Case(
        equal(64, 0.3, PERIODIC), FEW_LAGS, estimates.currents, caveats=lambda log: transport(log).caveats
    ),
    "column": Case(
        equal(40, 0.2).replace("temperature = 1", "speed = 1.5\nplacement = 'lattice'")
        + "[gravity]\nacceleration = [0, -2]\n",
        STRUCTURE,
        estimates.steady_state,
    ),
    "driven grains": Case(equal(40, 0.2, THERMAL) + "[restitution]\nnormal = 0.9\n", STRUCTURE, estimates.gauges),
    "escaping points": Case(HOLE, ("until = 150", "until = 600"), estimates.escapes, steady=False),
    "two chambers": Case(
        "[box]\nsize = [2, 1]\n[[wall]]\nfrom = [1, 0]\nto = [1, 0.47]\n[[wall]]\nfrom = [1, 0.53]\nto = [1, 1]\n"
        "[[wall]]\nname = 'gate'\nfrom = [1, 0.47]\nto = [1, 0.53]\nopens_at = 1\n[[species]]\nname = 'gas'\n"
        "count = 100\nradius = 0.002\ntemperature = 1\nregion = [0, 0, 1, 1]\n",
        ("until = 11", "until = 41"),
        estimates.slit,
        steady=False,
    ),
    "held piston": Case(
        "[box]\nsize = [20, 5]\n[[piston]]\nposition = 10\nmass = 50\npressure = 1.5\n[[species]]\nname = 'gas'\n"
        "count = 50\nradius = 0.05\ntemperature = 1\n",
        ("until = 3000", "until = 6000"),
        estimates.gauges,
    ),
    "column on a hot floor": Case(
        "[box]\nsize = [10, 10]\nbottom = { thermal = 1 }\n[gravity]\nacceleration = [0, -0.3]\n"
        "[[species]]\nname = 'gas'\ncount = 50\nradius = 0.3\ntemperature = 1\n",
        ("until = 2000", "until = 4000"),
        estimates.gauges,
    ),
    "equal speeds": Case(
        "[box]\nsize = [1, 1]\n[[species]]\nname = 'gas'\ncount = 200\nradius = 0.0178\nspeed = 1\n",
        ("collisions_per_disc = 45",),
        estimates.equal_speeds,
        steady=False,
    ),
    "box of 60": Case(equal(60, 0.4), exchange(4000), estimates.along_x, caveats=slow_along("x")),
    "box of 60, unlike radii": Case(UNLIKE, exchange(65000), estimates.along_x, caveats=slow_along("x")),
    "thin box of 60": Case(equal(60, 0.1), exchange(2000), estimates.along_x, caveats=slow_along("x")),
    "half-periodic mixture": Case(ONE_TO_FIVE, exchange(12500), estimates.along_x, caveats=slow_along("x")),
    "inner piston": Case(in_a_row((40, 8, 20), (60, 12, 0)), ("until = 700", "until = 25000"), estimates.of_parts),
    # the last three were chosen before any result was known
    "long box": Case(
        equal(80, 0.05).replace("[1, 1]", "[4, 1]"), exchange(2000), estimates.along_x, caveats=slow_along("x")
    ),
    "column of two masses": Case(
        "[box]\nsize = [10, 10]\n[gravity]\nacceleration = [0, -0.3]\n"
        "[[species]]\nname = 'light'\ncount = 40\nradius = 0.2\ntemperature = 1\n"
        "[[species]]\nname = 'heavy'\ncount = 20\nradius = 0.2\nmass = 3\ntemperature = 1\n",
        exchange(4000),
        estimates.along_y,
        caveats=slow_along("y"),
        energies_differ=True,
    ),
    "three gases": Case(
        in_a_row((30, 8, 5), (40, 10, 20), (50, 12, 0)), ("until = 700", "until = 40000"), estimates.of_parts
    ),
}
