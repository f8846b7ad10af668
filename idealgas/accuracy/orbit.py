"""Lifetime of an unstable periodic orbit of three discs, for several arithmetic precisions.

If two discs collide with the line of centres at 45° to their motion, both are deflected by 90°. The middle disc
collides alternately with the disc on its right and the disc on its left. After each collision one disc moves down and
the other up; they are reflected by the sides and collide again. The sides of the box, the radius and the speed are
free; all other lengths follow from the condition that both discs arrive at the same time.
"""

import math
from collections.abc import Callable
from dataclasses import asdict, dataclass
from decimal import Decimal, localcontext
from typing import Any, NamedTuple

import numpy as np

from idealgas.columns import empty_batch
from idealgas.engine.multiprecision import Columns, PreciseBruteForce, column_of
from idealgas.engine.simulation import Simulation, Stop
from idealgas.state import Gas

DIGITS = {"float32": 24 * math.log10(2), "float64": 53 * math.log10(2), "double-double": 106 * math.log10(2)}
"""Number of decimal digits of each precision."""

PLACEMENTS = 25
SPREAD = 0.25  # relative variation of the sides of the box and of the radius
LEAST_ROOM = 0.1  # smallest length of a flight between collisions or to a wall, radii
MOST_PERIODS = 200  # length of a run in periods; an orbit that lasts so long never breaks
AGREEMENT = 1e-9  # largest deviation of an initial state from the orbit, relative to the box

LEFT, RIGHT, BOTTOM, TOP = -1, -2, -3, -4
PARTNERS = ((LEFT, 1, TOP, 1), (2, BOTTOM, 2, 0, BOTTOM, 0), (1, TOP, 1, RIGHT))
"""Partners (discs or sides) with which each disc collides during a period, in order."""


class Orbit(NamedTuple):
    """Initial state of an orbit at speed 1, with 50 digits; the middle disc moves to the right, the others to the left.

    Attributes:
        x: x coordinates of the discs, length.
        y: y coordinates of the discs, length.
        period: period of the orbit, time.
        room: length of the shortest flight, length.
    """

    x: tuple[Decimal, ...]
    y: tuple[Decimal, ...]
    period: Decimal
    room: Decimal


def three_disc_orbit(box: tuple[float, float], radius: float) -> Orbit:
    """Return the orbit at speed 1 in a box of width and height `box`; the orbit exists if its `room` is positive.

    In the code, d is the distance between two discs in contact along x and along y, `drop` is the path of a disc to a
    side and back, and `flight` is the path of the middle disc from one partner to the other.
    """
    with localcontext() as context:
        context.prec = 50
        width, height, r = (Decimal(length) for length in (*box, radius))
        d = Decimal(2).sqrt() * r
        drop = height - d - 2 * r
        flight = (width - height - d) / 3
        y = (height - d) / 2
        meeting = width - r - d - flight - drop / 2
        x = (meeting - flight - d - flight / 2, meeting - flight / 2, meeting + d + flight / 2)
        return Orbit(x, (y + d, y, y + d), 2 * (drop + flight), min(flight, drop / 2))


def is_on_orbit(gas: Gas) -> bool:
    """Return whether a gas is, to within rounding, in the initial state of the periodic orbit known for its box."""
    if len(gas) != 3 or np.ptp(gas.radius) or np.ptp(gas.mass):
        return False
    orbit = three_disc_orbit(gas.box, float(gas.radius[0]))
    place = np.array([orbit.x, orbit.y], float).T
    direction = np.array([(-1, 0), (1, 0), (-1, 0)]) * np.abs(gas.velocity).max()
    here = np.abs(gas.position - place).max() < AGREEMENT * max(gas.box)
    return bool(orbit.room > 0 and here and np.abs(gas.velocity - direction).max() < AGREEMENT * direction.max())


@dataclass(frozen=True)
class Survival:
    """Lifetime of the orbit in one precision: time, at speed 1, until a collision that is not part of the exact orbit.

    Attributes:
        precision: name of the arithmetic.
        digits: number of decimal digits.
        scene: lifetime in the box of the scene; None if the orbit never broke.
        times: lifetimes of the orbits in other boxes that broke.
        unbroken: number of orbits in other boxes that did not break within MOST_PERIODS periods.
        median: median lifetime in the other boxes, where an unbroken orbit counts as MOST_PERIODS periods.
    """

    precision: str
    digits: float
    scene: float | None
    times: tuple[float, ...]
    unbroken: int
    median: float


@dataclass(frozen=True)
class OrbitStudy:
    """Lifetime of the orbit in each precision.

    Attributes:
        period: period of the orbit in the scene, time at speed 1.
        placements: number of other boxes and radii.
        survivals: lifetimes in each precision.
        time_per_digit: slope of a line through the medians, time per decimal digit.
    """

    period: float
    placements: int
    survivals: tuple[Survival, ...]
    time_per_digit: float

    def as_dict(self) -> dict[str, Any]:
        """Return plain values by name, with the results in sentences, ready for JSON."""
        return asdict(self) | {"sentences": self.sentences()}

    def sentences(self) -> list[str]:
        """Return the results in sentences."""
        medians = ", ".join(f"{s.median:.3g} in {s.precision} ({s.digits:.1f} digits)" for s in self.survivals)
        unbroken, trials = sum(s.unbroken for s in self.survivals), len(self.survivals) * self.placements
        spread = [max(s.times, default=math.inf) / s.median for s in self.survivals]
        return [
            f"In exact arithmetic the orbit would last indefinitely. Median over {self.placements} boxes and radii, in "
            f"time units at speed 1: {medians}.",
            f"Each additional decimal digit adds {self.time_per_digit:.3g} time units, the time in which a deviation "
            "grows tenfold. More digits, not a better method, make the orbit last longer.",
            f"{unbroken} of {trials} trials never broke; the longest-lived of the others "
            f"lasted {max(spread):.2g} times the median. If rounding errors happen to cancel, the computed motion can "
            "even be exactly periodic. A single trial is therefore not conclusive, and the median is used.",
        ]


def columns_at(orbit: Orbit, gas: Gas, precision: str) -> Columns:
    """Return the initial state of an orbit with all digits of a precision. gas: the same discs in float64."""

    def column(values: tuple[Decimal, ...]) -> np.ndarray:
        high = np.array([float(value) for value in values])
        numbers = column_of(high, precision)
        if numbers.ndim == 2:
            numbers[:, 1] = [float(value - Decimal(h)) for value, h in zip(values, high.tolist(), strict=True)]
        return numbers

    other_columns = (*gas.velocity.T, np.zeros(3), gas.radius, gas.mass, np.array(gas.box))
    with localcontext() as context:
        context.prec = 50
        return Columns(column(orbit.x), column(orbit.y), *(column_of(values, precision) for values in other_columns))


def orbit_gas(orbit: Orbit, box: tuple[float, float], radius: float) -> Gas:
    """Return a gas with the discs of an orbit, rounded to float64."""
    return Gas(
        box=box,
        position=np.array([orbit.x, orbit.y], float).T.copy(),
        velocity=np.array([(-1.0, 0.0), (1.0, 0.0), (-1.0, 0.0)]),
        radius=np.full(3, radius),
        mass=np.ones(3),
        species=np.zeros(3, np.uint16),
        species_names=("disc",),
    )


def survival(box: tuple[float, float], radius: float, precision: str) -> float:
    """Return the time of the first collision that is not part of the exact orbit.

    The result is infinity if there is no such collision within MOST_PERIODS periods.
    """
    orbit = three_disc_orbit(box, radius)
    gas = orbit_gas(orbit, box, radius)
    simulation = Simulation(gas, PreciseBruteForce(precision, columns_at(orbit, gas, precision)))
    most = MOST_PERIODS * sum(map(len, PARTNERS))
    batch = empty_batch(most + 2)
    rows = batch.rows(0, simulation.advance(Stop(time=MOST_PERIODS * float(orbit.period)), batch))
    first = math.inf
    for disc, partners in enumerate(PARTNERS):
        chosen = rows.disc == disc
        partner = rows.partner[chosen]
        wrong = np.flatnonzero(partner != np.resize(partners, len(partner)))
        if len(wrong):
            first = min(first, float(rows.time[chosen][wrong[0]]))
    return first


def placements(gas: Gas, number: int, seed: int) -> list[tuple[tuple[float, float], float]]:
    """Return random box sizes and radii, similar to those of a gas, for which the orbit exists."""
    random = np.random.default_rng(seed)
    boxes: list[tuple[tuple[float, float], float]] = []
    while len(boxes) < number:
        sizes = np.array([*gas.box, gas.radius[0]]) * random.uniform(1 - SPREAD, 1 + SPREAD, 3)
        width, height, radius = sizes.tolist()
        if three_disc_orbit((width, height), radius).room > LEAST_ROOM * radius:
            boxes.append(((width, height), radius))
    return boxes


def study_orbit(
    gas: Gas, number: int = PLACEMENTS, seed: int = 0, progress: Callable[[str, float], None] = lambda what, share: None
) -> OrbitStudy:
    """Measure the lifetime of the orbit of a gas, and of orbits in `number` similar boxes, in each precision.

    Args:
        gas: gas in the initial state of the orbit (`is_on_orbit`).
        number: number of other boxes.
        seed: seed for the random boxes.
        progress: function that is called with the name of the current task and the fraction of it that is done.
    """
    boxes = placements(gas, number, seed)
    period = float(three_disc_orbit(gas.box, float(gas.radius[0])).period)
    survivals = []
    for k, (precision, digits) in enumerate(DIGITS.items()):
        first, *times = (survival(box, radius, precision) for box, radius in [(gas.box, float(gas.radius[0])), *boxes])
        broken = tuple(t for t in times if t < math.inf)
        unbroken = number - len(broken)
        here = first if first < math.inf else None
        median = float(np.median(np.minimum(times, MOST_PERIODS * period)))
        survivals.append(Survival(precision, digits, here, broken, unbroken, median))
        progress(f"orbit in {precision}", (k + 1) / len(DIGITS))
    slope = float(np.polyfit([s.digits for s in survivals], [s.median for s in survivals], 1)[0])
    return OrbitStudy(period, number, tuple(survivals), slope)
