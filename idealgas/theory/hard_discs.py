"""Hard-disc kinetic theory and equation of state, as plain formulas (two dimensions, k_B = 1).

Symbols: disc diameter σ, number density n, packing fraction φ = nπσ²/4, temperature T, mass m, and number D of velocity
degrees of freedom (2N for discs between reflecting walls, where momentum is not conserved).
"""

import math
from collections.abc import Callable, Iterator
from typing import overload

import numpy as np
from numpy.polynomial import Polynomial
from numpy.typing import ArrayLike

from idealgas.physics.collision_rates import contact_value

VIRIAL = (1.0, 1.0, 0.782004, 0.532232, 0.333556, 0.198843, 0.114873, 0.064993, 0.036219, 0.019954)
"""Virial coefficients B_k/B_2^(k-1) for k = 1 to 10 (no unit): Clisby & McCoy, J. Stat. Phys. 122, 15 (2006)."""

HIGHEST = 0.62
"""Packing fraction up to which the resummed virial series is accurate; the fluid freezes at 0.70."""

CLOSE_PACKING = math.pi / math.sqrt(12)
"""Packing fraction of a triangular lattice of discs that all touch their neighbours."""

_SERIES = Polynomial([b * 2.0**k for k, b in enumerate(VIRIAL)])
_RESUMMED = Polynomial((_SERIES * Polynomial([1.0, -2.0, 1.0])).coef[: len(VIRIAL)])
_PRESSURE = Polynomial([0.0, 1.0]) * _RESUMMED  # φZ (1 - φ)²


# equation of state


def virial_series(packing_fraction: ArrayLike) -> np.ndarray:
    """Return Z = PA/NT from the virial series with coefficients `VIRIAL`."""
    return _SERIES(np.asarray(packing_fraction, float))


def compressibility_factor(packing_fraction: ArrayLike, number: float = math.inf) -> np.ndarray:
    """Return Z = PA/NT of the hard-disc fluid from the virial series to B10, resummed with 1/(1 - φ)².

    The coefficients of the polynomial over (1 - φ)² decrease quickly, so that the neglected ones are unimportant up to
    φ = 0.5, where the formula was compared with simulations; between there and freezing it is an extrapolation. For a
    closed system of `number` discs, to first order in 1/N, Z_N = Z - (φ/2N) (φZ)″/(φZ)′: Lebowitz & Percus, Phys. Rev.
    124, 1673 (1961). At low density this amounts to a factor 1 - 1/N in Z - 1, from the number of pairs.
    """
    phi = np.asarray(packing_fraction, float)
    if math.isinf(number):
        return _RESUMMED(phi) / (1 - phi) ** 2
    q = _PRESSURE
    curvature = q.deriv(2)(phi) / (1 - phi) ** 2 + 4 * q.deriv()(phi) / (1 - phi) ** 3 + 6 * q(phi) / (1 - phi) ** 4
    return _RESUMMED(phi) / (1 - phi) ** 2 - phi * curvature / (2 * number * inverse_compressibility(phi))


def inverse_compressibility(packing_fraction: ArrayLike) -> np.ndarray:
    """Return d(φZ)/dφ = (∂P/∂n)/T = 1/S(k → 0) of the hard-disc fluid from the resummed series (no unit)."""
    phi = np.asarray(packing_fraction, float)
    return _PRESSURE.deriv()(phi) / (1 - phi) ** 2 + 2 * _PRESSURE(phi) / (1 - phi) ** 3


def henderson_compressibility_factor(packing_fraction: ArrayLike) -> np.ndarray:
    """Return Z = (1 + φ²/8)/(1 - φ)² of hard discs: Henderson, Mol. Phys. 30, 971 (1975)."""
    phi = np.asarray(packing_fraction, float)
    return (1 + phi**2 / 8) / (1 - phi) ** 2


def free_volume_compressibility_factor(packing_fraction: ArrayLike) -> np.ndarray:
    """Return Z = 1/(1 - √(φ/φcp)) of a crystal of hard discs, each in the cage of its neighbours.

    This is free-volume theory: Kirkwood, J. Chem. Phys. 18, 380 (1950). It becomes exact at close packing, φcp.
    """
    return np.asarray(1 / (1 - np.sqrt(np.asarray(packing_fraction, float) / CLOSE_PACKING)))


def fluid_contact_value(packing_fraction: float, number: float = math.inf) -> float:
    """Return the contact value χ = (Z - 1)/2φ of `number` equal discs from the resummed virial series."""
    return float((compressibility_factor(packing_fraction, number) - 1) / (2 * packing_fraction))


def mixture_contact_value(
    radius: ArrayLike, number: ArrayLike, area: float, equal: Callable[[float], float] = contact_value
) -> np.ndarray:
    """Return contact values χ_ij (S, S) of a mixture: Santos, Yuste & López de Haro, J. Chem. Phys. 117, 5785 (2002).

    χ_ij = 1/(1 - φ) + [χ - 1/(1 - φ)] (⟨R⟩/⟨R²⟩) 2 R_i R_j/(R_i + R_j), where χ is the contact value of equal discs,
    `equal(φ)`. With Henderson's χ, this is the result of Jenkins & Mancini, J. Appl. Mech. 54, 27 (1987).
    """
    radius, number = np.asarray(radius, float), np.asarray(number, float)
    square = (number * radius**2).sum()
    phi = math.pi * float(square) / area
    reduced = 2 * radius[:, None] * radius / (radius[:, None] + radius)
    return 1 / (1 - phi) + (equal(phi) - 1 / (1 - phi)) * (number * radius).sum() / square * reduced


def mixture_compressibility_factor(radius: ArrayLike, number: ArrayLike, area: float) -> float:
    """Return Z = (1 - ξ)/(1 - φ) + ξ Z₁(φ) of a mixture of discs, with ξ = ⟨R⟩²/⟨R²⟩.

    Z₁ is the `compressibility_factor` of equal discs: Santos, Yuste & López de Haro, Mol. Phys. 96, 1 (1999). The
    second virial coefficient is exact, and the contact values of `mixture_contact_value` give the same Z.
    """
    radius, number = np.asarray(radius, float), np.asarray(number, float)
    phi, alike = math.pi * float((number * radius**2).sum()) / area, likeness(radius, number)
    return (1 - alike) / (1 - phi) + alike * float(compressibility_factor(phi))


def likeness(radius: ArrayLike, number: ArrayLike) -> float:
    """Return ξ = ⟨R⟩²/⟨R²⟩ of discs of several radii; 1 for equal discs."""
    radius, number = np.asarray(radius, float), np.asarray(number, float)
    return float((number @ radius) ** 2 / (number.sum() * (number @ radius**2)))


# a closed box with reflecting walls


def thin_pair_distribution(distance: ArrayLike, diameter: float, number_density: float) -> np.ndarray:
    """Return g(r) of equal discs to first order in the number density n (1/length²), at distances r >= σ.

    g(r) = 1 + n A(r), where A is the common area of two circles of radius σ whose centres are r apart: Hansen &
    McDonald, Theory of Simple Liquids, section 4.6, in two dimensions. The next order is about 2 φ² at contact.
    """
    half = np.minimum(np.asarray(distance, float) / (2 * diameter), 1.0)
    return 1 + number_density * 2 * diameter**2 * (np.arccos(half) - half * np.sqrt(1 - half**2))


def confinement(
    radius: ArrayLike, box: tuple[float, float], periodic: tuple[bool, bool] = (False, False), axis: int | None = None
) -> np.ndarray:
    """Return the factor (S, S) by which walls change the number of contacts between species i and j.

    Walls confine the centres to the area (Lx - 2R)(Ly - 2R), which increases the number of contacts. On the other hand,
    a disc near a wall has neighbours on one side only, which decreases it. The factor is the average fraction of the
    contact circle that lies inside the box, divided by its value in a periodic box. It is exact for two isolated discs
    and correct to first order in density for a gas; its errors, estimated from simulations, are in `values.ERRORS`.
    Periodic axes have no walls and contribute a factor of 1. If `axis` is given, each contact is weighted by its
    contribution to the pair virial along this axis, which is balanced by the forces on the walls perpendicular to it.
    """
    radius = np.asarray(radius, float)
    along_x, along_y = (_room_along(radius, *side) for side in zip(box, periodic, strict=True))
    total = np.zeros((len(radius), len(radius)))
    for x_constant, x_slope, x_least, x_most in along_x:  # quarter circle: x by |cos θ|, y by |sin θ|
        for y_constant, y_slope, y_least, y_most in along_y:
            first, last = (
                np.maximum(np.arccos(x_most), np.arcsin(y_least)),
                np.minimum(np.arccos(x_least), np.arcsin(y_most)),
            )
            parts = _trigonometric_integrals(np.minimum(first, last), last, axis)
            terms = (x_constant * y_constant, x_slope * y_constant, x_constant * y_slope, x_slope * y_slope)
            total += sum(term * part for term, part in zip(terms, parts, strict=True))
    return total / (math.pi / 2)


def _room_along(radius: np.ndarray, side: float, is_periodic: bool) -> list[tuple[np.ndarray, ...]]:
    """Return the length available to a pair in contact along an axis, relative to the length for two random discs.

    It is a function of the component c = 0 to 1 of r̂ and consists of pieces a + b c for least < c < most, given as (a,
    b, least, most), each (S, S): first the length for the larger disc, then a decrease with c, then zero.
    """
    none, all_of = np.zeros((len(radius), len(radius))), np.ones((len(radius), len(radius)))
    if is_periodic:
        return [(all_of, none, none, all_of)]
    sigma, larger = radius[:, None] + radius, np.maximum(radius[:, None], radius)
    scale = side / ((side - 2 * radius[:, None]) * (side - 2 * radius))
    bend, end = (2 * larger - sigma) / sigma, np.minimum(side / sigma - 1, 1.0)
    bend = np.minimum(bend, end)
    return [
        ((side - 2 * larger) * scale, none, none, bend),
        ((side - sigma) * scale, -sigma * scale, bend, end),
    ]


def _trigonometric_integrals(first: np.ndarray, last: np.ndarray, axis: int | None) -> Iterator[np.ndarray]:
    """Yield integrals of w, w cos θ, w sin θ and w cos θ sin θ over θ.

    The weight w is 1, or 2 cos² θ for axis 0, or 2 sin² θ for axis 1.
    """

    def primitives(angle: np.ndarray) -> tuple[np.ndarray, ...]:
        c, s = np.cos(angle), np.sin(angle)
        if axis is None:
            return angle, s, -c, s**2 / 2
        if axis == 0:
            return angle + s * c, 2 * s - 2 / 3 * s**3, -2 / 3 * c**3, -(c**4) / 2
        return angle - s * c, 2 / 3 * s**3, 2 / 3 * c**3 - 2 * c, s**4 / 2

    return (after - before for before, after in zip(primitives(first), primitives(last), strict=True))


def box_contacts(
    radius: ArrayLike, number: ArrayLike, box: tuple[float, float], periodic: tuple[bool, bool] = (False, False)
) -> np.ndarray:
    """Return the collision rate over relative speed, 2 σ_ij n_j χ_ij (S, S), of species i with species j, 1/length.

    A disc does not collide with itself, and walls confine the discs (`confinement`). Equal discs have the contact value
    (Z - 1)/2φ of the resummed virial series for this number of discs; those of mixtures are derived from it with
    `mixture_contact_value`. The result is nan above φ = 0.62.
    """
    radius, number = np.asarray(radius, float), np.asarray(number, float)
    area = box[0] * box[1]
    phi = math.pi * (number * radius**2).sum() / area
    if phi > HIGHEST:
        return np.full((len(radius), len(radius)), math.nan)
    sigma = radius[:, None] + radius
    if len(radius) == 1:
        alone = fluid_contact_value(phi, number[0])
        return 2 * sigma * number / area * alone * confinement(radius, box, periodic)
    n = float(number.sum())
    chi = mixture_contact_value(radius, number, area, lambda phi: fluid_contact_value(phi, n))
    partners = (number - np.eye(len(number))) * n / (n - 1)  # a disc does not collide with itself
    return 2 * sigma * partners / area * chi * confinement(radius, box, periodic)


def contacts_without_positions(radius: ArrayLike, number: ArrayLike, box: tuple[float, float]) -> np.ndarray:
    """Return the collision rate over relative speed 2 σ_ij n_j χ (S, S) of discs without positions, 1/length.

    A disc does not collide with itself; χ is Henderson's contact value at the total packing fraction.
    """
    radius, number = np.asarray(radius, float), np.asarray(number, float)
    area = box[0] * box[1]
    chi = contact_value(math.pi * (number * radius**2).sum() / area)
    return 2 * (radius[:, None] + radius) * (number - np.eye(len(number))) / area * chi


def box_compressibility_factor(
    radius: ArrayLike, number: ArrayLike, box: tuple[float, float], periodic: tuple[bool, bool] = (False, False)
) -> float:
    """Return Z = 1 + (π/4N) Σ N_i σ_ij (contacts)_ij in a box, the expected value from both virials.

    The contacts are those of `box_contacts`.
    """
    radius, number = np.asarray(radius, float), np.asarray(number, float)
    contacts = box_contacts(radius, number, box, periodic)
    return float(1 + math.pi / 4 * (number[:, None] * (radius[:, None] + radius) * contacts).sum() / number.sum())


# kinetic theory


def finite_speed_factor(dof: float) -> float:
    """Return the ratio of the mean speed at fixed total energy to its Maxwell-Boltzmann value, about 1 + 1/4D.

    It is √(D/2) Γ(D/2)/Γ(D/2 + 1/2), where dof is the number D of degrees of freedom that share the energy. Relative
    speeds have the same ratio, because both are lengths of two-dimensional projections of a uniform distribution on a
    sphere in D dimensions.
    """
    if math.isinf(dof):
        return 1.0
    return math.sqrt(dof / 2) * math.exp(math.lgamma(dof / 2) - math.lgamma(dof / 2 + 0.5))


@overload
def mean_speed(temperature: float, mass: float, dof: float = math.inf) -> float: ...
@overload
def mean_speed(temperature: float, mass: np.ndarray, dof: float = math.inf) -> np.ndarray: ...
def mean_speed(temperature: float, mass: float | np.ndarray, dof: float = math.inf) -> float | np.ndarray:
    """Return ⟨v⟩ = √(πT/2m) for a mass or an array of masses; for a reduced mass it is a mean relative speed."""
    return np.sqrt(math.pi * temperature / (2 * mass)) * finite_speed_factor(dof)


def mean_relative_speed(temperature: float, mass: float) -> float:
    """Return the mean relative speed ⟨|v₁ - v₂|⟩ = √(πT/m) of discs of equal mass, length/time."""
    return math.sqrt(2) * float(mean_speed(temperature, mass))


def mean_relative_speeds(temperature: float, mass: ArrayLike, dof: float = math.inf) -> np.ndarray:
    """Return mean relative speeds ⟨|v_i - v_j|⟩ = √(πT/2μ_ij) (S, S) for masses (S,), with reduced masses μ_ij."""
    mass = np.asarray(mass, float)
    return mean_speed(temperature, mass[:, None] * mass / (mass[:, None] + mass), dof)


def collision_rate(
    diameter: float, number_density: float, temperature: float, mass: float, packing_fraction: float
) -> float:
    """Return the Enskog collision rate Γ = 2σnχ√(πT/m) of one disc with other discs, 1/time.

    χ is Henderson's contact value. The gas has NΓ/2 pair collisions per time.
    """
    chi = float(contact_value(packing_fraction))
    return 2 * diameter * number_density * chi * mean_relative_speed(temperature, mass)


def mixture_collision_rate(
    radius: ArrayLike, mass: ArrayLike, number: ArrayLike, area: float, temperature: float
) -> np.ndarray:
    """Return the collision rates Γ_ij (S, S) of one disc of species i with the discs of species j, 1/time.

    Γ_ij = 2σ_ij n_j χ_ij √(πT/2μ_ij), where μ_ij is the reduced mass. radius, mass, number: (S,).
    """
    radius, number = (np.asarray(values, float) for values in (radius, number))
    sigma, speed = radius[:, None] + radius, mean_relative_speeds(temperature, mass)
    return 2 * sigma * (number / area) * mixture_contact_value(radius, number, area) * speed


def mean_free_path(diameter: float, number_density: float, packing_fraction: float) -> float:
    """Return the mean free path λ = ⟨v⟩/Γ = 1/(2√2 σnχ) of equal discs, length, with Henderson's contact value χ."""
    return 1 / (2 * math.sqrt(2) * diameter * number_density * float(contact_value(packing_fraction)))


def mixture_free_paths(radius: np.ndarray, mass: np.ndarray, number_density: np.ndarray) -> np.ndarray:
    """Return the mean free paths ⟨v⟩/Σ Γ_ij (S,) of the species of a mixture at a common temperature, length."""
    return mean_speed(1.0, mass) / mixture_collision_rate(radius, mass, number_density, 1.0, 1.0).sum(axis=1)


def effusion_flux(number_density: float, temperature: float, mass: float) -> float:
    """Return the flux n⟨v⟩/π through a slit in one direction, 1/(length time); also the hits on a wall per length."""
    return number_density * mean_speed(temperature, mass) / math.pi


def long_time_tail(time: ArrayLike, number_density: float, diffusion: float, kinematic_viscosity: float) -> np.ndarray:
    """Return the velocity correlation ⟨v(0)·v(t)⟩/⟨v²⟩ = 1/(8πn(D + ν)t) at long times t (no unit).

    Sources: Alder & Wainwright, Phys. Rev. A 1, 18 (1970); Ernst, Hauge & van Leeuwen, Phys. Rev. Lett. 25, 1254
    (1970).
    """
    return 1 / (8 * math.pi * number_density * (diffusion + kinematic_viscosity) * np.asarray(time, float))
