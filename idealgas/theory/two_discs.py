"""Exact pressure of two discs of equal or unequal radii in a box, each axis of which is reflecting or periodic.

The volume of the configurations of the two discs without overlap is Q = ∬ g_x(x) g_y(y) dx dy over all separations (x,
y) longer than σ = R₁ + R₂, where g is the length along an axis over which the pair can be shifted. Between reflecting
walls g is ½(a₁ + a₂) - |x|, but at most the smaller of a₁ and a₂, where a_i = L - 2R_i is the length available to the
centre of disc i; along a periodic axis it is L, for |x| ≤ L/2. If D degrees of freedom share a fixed energy, T = 2E/D,
and a force is exactly T ∂lnQ/∂(length); the same is true at the temperature of thermal walls. For equal radii between
reflecting walls and σ ≤ min(a, b), Q = a²b² - πσ²ab + (4/3)σ³(a + b) - σ⁴/2. In a periodic box with σ ≤ min(Lx, Ly)/2,
Q = A(A - πσ²).

Z = PA/NT is defined as in the measurements, with N = 2 and T = 2E/D for any D: 4 between reflecting walls, 3 if one
axis is periodic and 2 if both are, because the total momentum along a periodic axis is conserved and the motion of the
centre of mass does not count.
"""

import math
from collections.abc import Callable, Sequence
from typing import NamedTuple

import numpy as np

_NODES, _WEIGHTS = np.polynomial.legendre.leggauss(40)


class TwoDiscs(NamedTuple):
    """Z = PA/2T from each route; None for a route that requires walls where there are none.

    Attributes:
        pairs: from the virial of the pair.
        walls: from the virial of all walls. It differs from `pairs` if one axis is periodic, because walls then measure
            the pressure along the other axis only.
        sides: (x, y), from the force on the left or right wall and on the bottom or top wall, divided by the whole
            length of the side.
    """

    pairs: float
    walls: float | None
    sides: tuple[float | None, float | None]


class _Axis(NamedTuple):
    """g along an axis: `most` for |x| up to `kink`; then it falls to 0 at `reach`, with slope -1 or abruptly."""

    length: float
    periodic: bool
    most: float
    kink: float
    reach: float

    def shifts(self, separation: np.ndarray) -> np.ndarray:
        """Return g, the length over which a pair with this separation can be shifted."""
        inside = np.abs(separation) < self.reach
        room = self.most if self.periodic else np.clip(self.reach - np.abs(separation), 0.0, self.most)
        return np.where(inside, room, 0.0)

    def allowed(self, separation: np.ndarray) -> np.ndarray:
        """Return ∂g/∂L between reflecting walls: 1 if there is room for the pair, otherwise 0."""
        return np.where(np.abs(separation) < self.reach, 1.0, 0.0)

    @property
    def kinks(self) -> tuple[float, float]:
        """Separations at which g is not smooth."""
        return self.kink, self.reach


def two_discs(
    radius: Sequence[float], box: tuple[float, float], periodic: tuple[bool, bool] = (False, False)
) -> TwoDiscs | None:
    """Return the exact Z of two discs of radii R₁ and R₂ in a box, from every route.

    The result is None if the discs do not fit without overlap, or if they are too large for a periodic box.
    """
    x, y = (_axis(radius, length, around) for length, around in zip(box, periodic, strict=True))
    sigma = radius[0] + radius[1]
    if min(x.most, y.most) <= 0 or any(axis.periodic and sigma > axis.length for axis in (x, y)):
        return None
    if math.hypot(x.reach, y.reach) <= sigma:
        return None
    states = _outside(sigma, x, y, x.shifts, y.shifts)
    contact = sigma**2 / states
    along_x = contact * _around(sigma, x, y, lambda c, s: c**2)  # virial of the pair over T, along each axis
    along_y = contact * _around(sigma, x, y, lambda c, s: s**2)
    sides = (
        None if x.periodic else x.length * _outside(sigma, x, y, x.allowed, y.shifts) / states / 2,
        None if y.periodic else y.length * _outside(sigma, x, y, x.shifts, y.allowed) / states / 2,
    )
    felt = [virial for axis, virial in ((x, along_x), (y, along_y)) if not axis.periodic]
    walls = 1 + sum(felt) / (2 * len(felt)) if felt else None
    return TwoDiscs(1 + (along_x + along_y) / 4, walls, sides)


def configurations(
    radius: Sequence[float], box: tuple[float, float], periodic: tuple[bool, bool] = (False, False)
) -> float:
    """Return the volume Q of the configurations of two discs without overlap in a box, length⁴; 0 if none exist."""
    x, y = (_axis(radius, length, around) for length, around in zip(box, periodic, strict=True))
    return _outside(radius[0] + radius[1], x, y, x.shifts, y.shifts) if min(x.most, y.most) > 0 else 0.0


def _axis(radius: Sequence[float], length: float, periodic: bool) -> _Axis:
    if periodic:
        return _Axis(length, True, length, length / 2, length / 2)
    a, b = (length - 2 * r for r in radius)
    return _Axis(length, False, min(a, b), abs(a - b) / 2, (a + b) / 2)


def _outside(
    sigma: float, x: _Axis, y: _Axis, along: Callable[[np.ndarray], np.ndarray], up: Callable[[np.ndarray], np.ndarray]
) -> float:
    """Return ∬ along(x) up(y) dx dy over separations longer than σ, by Gauss-Legendre quadrature between all kinks.

    The area is divided into columns at x = σ sin t that start at the height √(σ² - x²) = σ cos t, which is smooth in t;
    for x > σ the columns start at 0.
    """
    top = max(y.reach, sigma)

    def column(height: np.ndarray) -> np.ndarray:  # integral from each height upwards
        start = np.minimum(height, y.reach)
        inner = np.clip(y.kink, start, y.reach)
        total = np.zeros_like(height)
        for low, high in ((start, inner), (inner, np.full_like(height, y.reach))):  # linear in each interval
            total += (high - low) * up((low + high) / 2)
        return total

    turns = [_angle(k, sigma) for k in x.kinks] + [math.pi / 2 - _angle(k, sigma) for k in (*y.kinks, top)]
    t, weight = _nodes([0.0, math.pi / 2, *turns])
    inside = (weight * sigma * np.cos(t) * along(sigma * np.sin(t)) * column(sigma * np.cos(t))).sum()
    beyond = 0.0
    if x.reach > sigma:
        far, weight = _nodes([sigma, x.reach, *(k for k in x.kinks if sigma < k < x.reach)])
        beyond = float((weight * along(far)).sum() * column(np.zeros(1))[0])
    return 4 * (float(inside) + beyond)


def _around(sigma: float, x: _Axis, y: _Axis, part: Callable[[np.ndarray, np.ndarray], np.ndarray]) -> float:
    """Return ∮ g_x(σ cos θ) g_y(σ sin θ) part(cos θ, sin θ) dθ for the pair in contact."""
    turns = [math.pi / 2 - _angle(k, sigma) for k in x.kinks] + [_angle(k, sigma) for k in y.kinks]
    angle, weight = _nodes([0.0, math.pi / 2, *turns])
    c, s = np.cos(angle), np.sin(angle)
    return 4 * float((weight * x.shifts(sigma * c) * y.shifts(sigma * s) * part(c, s)).sum())


def _angle(separation: float, sigma: float) -> float:
    """Return the arcsine of a separation over σ, at most π/2."""
    return math.asin(min(separation / sigma, 1.0))


def _nodes(edges: Sequence[float]) -> tuple[np.ndarray, np.ndarray]:
    """Return points and weights that integrate any function that is smooth between the edges, to rounding error."""
    ends = np.unique(edges)
    half = np.diff(ends)[:, None] / 2
    return (ends[:-1, None] + half * (1 + _NODES)).ravel(), (half * _WEIGHTS).ravel()
