"""Theoretical values with errors and ranges: the pressure and the collision rates of hard discs in a box.

Outside its range a theory gives no value, only a reason. Errors are standard deviations, to be combined with those of a
measurement as √(s.e.² + error²).

The resummed virial series (`hard_discs.compressibility_factor`) is accurate to 1.5e-4 of Z - 1 up to φ = 0.5 and to
2.5e-4 at 0.6, as measured with molecular dynamics (Erpenbeck & Luban, Phys. Rev. A 32, 2920 (1985)) and with this
engine. At higher φ the error grows by a factor e for every 0.0166 in φ: with 870 discs it is 8e-4 at 0.62, 3e-3 at 0.64
and 1.7 % at 0.67. Above 0.62 there is no value.

For finite gases (`hard_discs.box_compressibility_factor`), the theory is of first order in 1/N and in the effect of the
walls. Its error was determined from simulations of 3 to 400 discs (ERRORS; tests/physics/test_theory_errors.py repeats
them); if the error exceeds a tenth of Z - 1, there is no value. The result for two discs is exact.
"""

import math
from collections.abc import Sequence
from dataclasses import dataclass
from typing import NamedTuple

import numpy as np

from idealgas.theory import hard_discs
from idealgas.theory.two_discs import two_discs

THINNEST = 1e-12
"""Smallest packing fraction for which there is a theoretical value; Z - 1 still has four digits there."""

LARGEST_ERROR = 0.1
"""Largest relative error of Z - 1 for which a formula is accepted as theory."""

PUBLISHED = {0.670: (7.98678, 3e-5), 0.680: (8.51325, 4e-5), 0.690: (8.96990, 8e-5), 0.700: (9.1297, 2e-4)}
"""βP(2R)² and its error by packing fraction, for 870 discs in a square periodic box: Li, Nishikawa, Höllmer, Carillo,
Maggs & Krauth, J. Chem. Phys. 157, 234111 (2022).
"""

IDEAL = "ideal gas"
"""Name of the theory of discs that do not interact."""

MIXTURE = "Santos, Yuste & López de Haro 1999"
"""Name of the theory of mixtures."""

MIXING_ERROR = 0.02
"""Relative error of Z - 1 of mixtures when it is derived from equal discs, in units of φ (1 - ξ).

For 2 000 discs of two radii in the ratio 4, Z - 1 differs by -0.28 ± 0.10 % at φ = 0.5 and by -0.36 ± 0.17 % at 0.3;
for the ratio 2 it differs by 0.02 ± 0.09 %, and for radii spread uniformly by 20 % by -0.13 ± 0.08 %.
"""

FREEZING, MELTING, SOLID = 0.700, 0.716, 0.720
"""Packing fractions between which fluid and hexatic phase coexist, and above which discs form a crystal.

Source: Engel, Anderson, Glotzer, Isobe, Bernard & Krauth, Phys. Rev. E 87, 042134 (2013).
"""

TOO_LOW = (0.4, 0.8)
"""Estimated upper limit of the excess of Z of a crystal over free-volume theory: 0.4 + 0.8 (φcp/φ - 1).

For 480 discs the excess is 0.71, 0.58, 0.44, 0.36 and 0.20 at φ = 0.72, 0.75, 0.82, 0.86 and 0.89.
"""

PUBLISHED_NUMBER, SAME_FRACTION, SLOPE = 870, 1e-4, 50.0
"""Number of discs in the published simulations, largest accepted difference from their φ, and largest dZ/dφ there."""

FRACTIONS = (0.05, 0.1, 0.2, 0.3, 0.4, 0.5, 0.6)
NUMBERS = (3, 4, 6, 10, 20, 50, 100)
ERRORS = {
    "without walls": (
        (0.005, 0.010, 0.015, 0.035, 0.150, 0.300, 0.900),
        (0.003, 0.005, 0.006, 0.015, 0.200, 0.400, 0.600),
        (0.0015, 0.003, 0.003, 0.006, 0.050, 0.150, 0.250),
        (0.0015, 0.0025, 0.0025, 0.003, 0.020, 0.060, 0.160),
        (0.0005, 0.001, 0.0015, 0.0015, 0.0015, 0.0045, 0.010),
        (0.0005, 0.0005, 0.0008, 0.0008, 0.001, 0.0025, 0.005),
        (0.0005, 0.0005, 0.0005, 0.0005, 0.0005, 0.0008, 0.0008),
    ),
    "with walls": (
        (0.008, 0.032, 0.085, 0.120, 0.300, 0.650, 1.000),
        (0.006, 0.020, 0.060, 0.110, 0.200, 0.350, 0.400),
        (0.004, 0.012, 0.030, 0.060, 0.200, 0.350, 0.600),
        (0.0015, 0.005, 0.012, 0.020, 0.060, 0.180, 0.300),
        (0.0008, 0.002, 0.0045, 0.005, 0.006, 0.008, 0.080),
        (0.0006, 0.0012, 0.002, 0.002, 0.002, 0.003, 0.020),
        (0.0005, 0.001, 0.001, 0.001, 0.001, 0.0015, 0.006),
    ),
    "one axis": (
        (0.008, 0.032, 0.085, 0.140, 0.310, 0.650, 1.000),
        (0.007, 0.020, 0.060, 0.110, 0.200, 0.350, 0.400),
        (0.005, 0.012, 0.030, 0.060, 0.200, 0.350, 0.600),
        (0.004, 0.006, 0.012, 0.020, 0.060, 0.180, 0.300),
        (0.003, 0.004, 0.0045, 0.006, 0.008, 0.010, 0.080),
        (0.002, 0.003, 0.004, 0.006, 0.008, 0.011, 0.020),
        (0.001, 0.002, 0.003, 0.004, 0.008, 0.008, 0.018),
    ),
}
"""Relative error of Z - 1 by number of discs (rows, NUMBERS) and packing fraction (columns, FRACTIONS) in a square box.

The errors are those of Z from the virials in a periodic box and in a box with walls, and of the pressure along one axis
if the two axes differ. In an elongated box the error is at most that for the number of discs in a square with its
shorter side.
"""


@dataclass(frozen=True)
class Theory:
    """Theoretical value of a quantity, the standard deviation of its error (same unit) and the name of the theory."""

    value: float
    error: float
    source: str

    def times(self, factor: float) -> "Theory":
        """Return the theoretical value of the quantity multiplied by a factor."""
        return Theory(self.value * factor, self.error * abs(factor), self.source)

    def inverse(self) -> "Theory":
        """Return the theoretical value of the reciprocal of the quantity."""
        return Theory(1 / self.value, self.error / self.value**2, self.source)


class NoTheoryError(ValueError):
    """Theory is not available; the message is the reason, as part of a sentence."""


class BoxTheory(NamedTuple):
    """Theoretical values of Z = PA/NT of a gas in a box from each route, and of its contacts.

    pairs, walls: Z from the virial of the pairs and of the walls. sides: Z from the force on the walls across x and
    across y, divided by the whole length of the side; None without theory or without such walls. contacts: (S, S), 2
    σ_ij n_j χ_ij as in `hard_discs.box_contacts`. rate_error: (S, S), relative error of the contacts; both arrays are
    nan without theory. reason: why there is no theoretical value; empty if there is one.
    """

    pairs: Theory | None
    walls: Theory | None
    sides: tuple[Theory | None, Theory | None]
    contacts: np.ndarray
    rate_error: np.ndarray
    reason: str = ""

    def along_axes(
        self, radius: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool]
    ) -> tuple[Theory | None, Theory | None]:
        """Return Z from the pair virial along x and along y, whose mean is `pairs`; None if unknown."""
        if self.pairs is None or (periodic[0] == periodic[1] and box[0] == box[1]):
            return self.pairs, self.pairs
        if periodic[0] != periodic[1] and self.walls is not None:
            error = 2 * self.pairs.error + self.walls.error
            periodic_axis = Theory(2 * self.pairs.value - self.walls.value, error, self.pairs.source)
            return (periodic_axis, self.walls) if periodic[0] else (self.walls, periodic_axis)
        if any(periodic) or np.ptp(radius) > 0 or None in self.sides:
            return None, None
        x, y = (side and side.times((size - 2 * radius[0]) / size) for side, size in zip(self.sides, box, strict=True))
        return x, y


def fluid(packing_fraction: float) -> Theory:
    """Return the compressibility factor Z of an infinite fluid of equal discs.

    Raises:
        NoTheoryError: above φ = 0.62.
    """
    if packing_fraction > hard_discs.HIGHEST:
        raise NoTheoryError(
            f"the packing fraction is above {hard_discs.HIGHEST:g}, where the virial series is no longer accurate"
        )
    z = float(hard_discs.compressibility_factor(packing_fraction))
    return Theory(z, _series_error(packing_fraction) * (z - 1), "virial series to B10, resummed")


def crystal(packing_fraction: float) -> Theory:
    """Return Z of an infinite crystal of equal discs from free-volume theory; its error is an estimate.

    Raises:
        NoTheoryError: if discs form no crystal, or beyond close packing.
    """
    if not SOLID <= packing_fraction < hard_discs.CLOSE_PACKING:
        raise NoTheoryError(f"discs form a crystal only at packing fractions from {SOLID:g} to close packing")
    room = hard_discs.CLOSE_PACKING / packing_fraction - 1
    error = TOO_LOW[0] + TOO_LOW[1] * room
    return Theory(
        float(hard_discs.free_volume_compressibility_factor(packing_fraction)), error, "free volume, of a crystal"
    )


def box_theory(
    radius: Sequence[float] | np.ndarray,
    number: Sequence[int] | np.ndarray,
    box: tuple[float, float],
    periodic: tuple[bool, bool] = (False, False),
    *,
    ergodic: bool = True,
    interacting: bool = True,
) -> BoxTheory:
    """Return theoretical values for the pressure and the contacts of a uniform gas of finite N in its box.

    Args:
        radius: (S,), radius of each species, length.
        number: (S,), number of discs of each species.
        box: width and height of the box, length.
        periodic: whether the box is periodic along x and along y.
        ergodic: False for a gas that does not reach all states of its energy, for which theory is not available.
        interacting: False for discs that do not interact, an ideal gas.
    """
    radius, number = np.asarray(radius, float), np.asarray(number, float)
    if not interacting:
        return _ideal_gas(radius, number, box, periodic, ergodic)
    try:
        if not ergodic and number.sum() > 1:
            raise NoTheoryError("two equal discs with zero total momentum do not reach all states between walls")
        if math.pi * float((number * radius**2).sum()) / (box[0] * box[1]) < THINNEST:
            raise NoTheoryError(f"the packing fraction is below {THINNEST:g}, where Z - 1 loses its digits to rounding")
        if number.sum() == 2:
            return _two(radius, number, box, periodic)
        if len(radius) > 1 and np.ptp(radius) > 0:
            return _mixture(radius, number, box, periodic)
        return _equal_discs(radius, number, box, periodic)
    except NoTheoryError as reason:
        nothing = np.full((len(radius), len(radius)), math.nan)
        return BoxTheory(None, None, (None, None), nothing, nothing, str(reason))


def _ideal_gas(
    radius: np.ndarray, number: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool], ergodic: bool
) -> BoxTheory:
    """Return the exact values for discs that do not interact; without heat, unequal energies along x and y persist."""
    z, none = Theory(1.0, 0.0, IDEAL), np.zeros((len(radius), len(radius)))
    x, y = (
        z.times(float(number @ (size / (size - 2 * radius)) / number.sum())) if ergodic and not on else None
        for size, on in zip(box, periodic, strict=True)
    )
    return BoxTheory(z, z if not any(periodic) or x or y else None, (x, y), none, none)


def _two(radius: np.ndarray, number: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool]) -> BoxTheory:
    radii = np.repeat(radius, number.astype(int))
    exact = two_discs((radii[0], radii[1]), box, periodic)
    if exact is None:
        raise NoTheoryError("the box is too small for two of these discs")
    pairs, walls, *sides = (
        None if z is None else Theory(z, 0.0, "two discs, exact") for z in (exact.pairs, exact.walls, *exact.sides)
    )
    contacts = np.full((len(radius), len(radius)), 4 * (exact.pairs - 1) / (math.pi * radii.sum()))
    if len(radius) == 2:
        np.fill_diagonal(contacts, 0.0)  # a disc does not collide with itself
    return BoxTheory(pairs, walls, (sides[0], sides[1]), contacts, np.zeros_like(contacts))


def _equal_discs(
    radius: np.ndarray, number: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool]
) -> BoxTheory:
    n, r = int(number.sum()), float(radius[0])
    phi = math.pi * n * r**2 / (box[0] * box[1])
    published = _published(n, phi, box, periodic)
    series = published or fluid(phi)
    z = float(hard_discs.compressibility_factor(phi, n))

    def of(axis: int | None, kind: str) -> Theory:
        excess = (z - 1) * float(hard_discs.confinement([r], box, periodic, axis)[0, 0])
        relative = math.hypot(series.error / (series.value - 1), _finite_error(kind, n, r, phi, box))
        return Theory(1 + excess, relative * excess, f"{series.source}, for this N and box")

    pairs = published or of(None, "without walls" if all(periodic) else "with walls")
    open_axes = [axis for axis in (0, 1) if not periodic[axis]]
    by_axis: list[Theory | None] = [None, None]
    for axis in open_axes:
        alike = len(open_axes) == 2 and box[0] == box[1]
        along = pairs if alike else of(axis, "one axis")
        by_axis[axis] = along.times(box[axis] / (box[axis] - 2 * r))  # the centres cannot reach the walls
    walls = None if not open_axes else pairs if len(open_axes) == 2 else of(open_axes[0], "one axis")
    partners = (number - np.eye(len(number))) / (
        n - 1
    )  # fraction of each species among the possible partners of a disc
    contacts = partners * 2 * (pairs.value - 1) / (math.pi * r)
    error = np.full_like(contacts, pairs.error / (pairs.value - 1))
    return BoxTheory(pairs, walls, (by_axis[0], by_axis[1]), contacts, error)


def _mixture(
    radius: np.ndarray, number: np.ndarray, box: tuple[float, float], periodic: tuple[bool, bool]
) -> BoxTheory:
    """Return theoretical values for a mixture from the equation of state of equal discs, with errors from simulations.

    The collision rates of each pair of species have an additional error of up to 0.04 φ. For two discs that are larger
    than average, which many small discs push together, this error is multiplied by the ratio of their radius to the
    mean radius.
    """
    n = int(number.sum())
    phi = math.pi * float((number * radius**2).sum()) / (box[0] * box[1])
    exact, alike = fluid(phi).value - 1, hard_discs.likeness(radius, number)
    z = hard_discs.box_compressibility_factor(radius, number, box, periodic)
    first_order = abs((float(hard_discs.compressibility_factor(phi, n)) - 1) / exact - (1 - 1 / n))
    kind = "without walls" if all(periodic) else "with walls"
    finite = _finite_error(kind, n, float(radius.max()), phi, box)
    relative = 1.5 * math.hypot(mixture_error(phi, alike) + first_order, finite)  # the factor 1.5 is from simulations
    if relative > LARGEST_ERROR:
        raise NoTheoryError(f"the theory of mixtures is off by {relative:.0%} for so few discs")
    pairs = Theory(z, relative * (z - 1), f"{MIXTURE}, for this N and box")
    mixed = any(periodic) and not all(periodic)
    contacts = hard_discs.box_contacts(radius, number, box, periodic)
    walls = None if all(periodic) or mixed else pairs
    larger = np.minimum(radius[:, None], radius) / (number @ radius / n)
    return BoxTheory(pairs, walls, (None, None), contacts, relative + 0.04 * phi * np.maximum(larger, 1.0))


def mixture_error(packing_fraction: float, alike: float) -> float:
    """Return the relative error of Z - 1 of infinite mixtures as derived from equal discs; alike: ξ (`likeness`)."""
    series = fluid(packing_fraction)
    return math.hypot(series.error / (series.value - 1), MIXING_ERROR * packing_fraction * (1 - alike))


def _published(n: int, phi: float, box: tuple[float, float], periodic: tuple[bool, bool]) -> Theory | None:
    if n != PUBLISHED_NUMBER or not all(periodic) or box[0] != box[1]:
        return None
    for fraction, (pressure, error) in PUBLISHED.items():
        if (off := abs(phi - fraction)) < SAME_FRACTION:
            unit = math.pi / (4 * fraction)
            source = f"simulations of {n} discs, Li et al. 2022"
            return Theory(pressure * unit, math.hypot(error * unit, SLOPE * off), source)
    return None


def _series_error(phi: float) -> float:
    """Return the relative error of Z - 1 from the resummed virial series."""
    return float(np.exp(np.interp(phi, (0.5, 0.6, 0.67), np.log((1.5e-4, 2.5e-4, 1.7e-2)))))


def _finite_error(kind: str, n: int, radius: float, phi: float, box: tuple[float, float]) -> float:
    """Return the relative error of Z - 1 from the formula for finite gases, interpolated in ERRORS.

    Raises:
        NoTheoryError: outside the range of the simulations, or if the error is too large.
    """
    across = min(box) / (2 * radius)
    n_square = min(n, 4 * phi / math.pi * across**2 * (1 + 1e-9))  # discs in the square of the shorter side
    if n_square < NUMBERS[0]:
        raise NoTheoryError(
            "at this packing fraction a square as long as the shorter side of the box holds fewer than "
            f"{NUMBERS[0]} of the largest discs"
        )
    if phi > FRACTIONS[-1] and n_square < NUMBERS[-1]:
        raise NoTheoryError(f"the packing fraction is above {FRACTIONS[-1]:g}, too high for so few discs")
    by_number = np.log(ERRORS[kind])
    at_number = [np.interp(math.log(n_square), np.log(NUMBERS), column) for column in by_number.T]
    growth = (at_number[-1] - at_number[-2]) / (FRACTIONS[-1] - FRACTIONS[-2])
    beyond = max(phi - FRACTIONS[-1], 0.0) * growth
    error = math.exp(float(np.interp(phi, FRACTIONS, at_number)) + beyond)
    if error > LARGEST_ERROR:
        raise NoTheoryError(f"theory is off by {error:.0%} for so few discs in so small a box")
    return error
