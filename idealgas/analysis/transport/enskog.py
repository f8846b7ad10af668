"""Transport coefficients from Enskog theory for the gas of a log, with their errors."""

import math
from dataclasses import dataclass

import numpy as np

from idealgas.log import Log
from idealgas.tallies.collisions import ExpectedRates
from idealgas.theory import enskog, hard_discs
from idealgas.theory.conserved import conserved_momentum
from idealgas.theory.ensemble import Composition, Ensemble
from idealgas.theory.values import Theory


@dataclass(frozen=True)
class Enskog:
    """Transport coefficients of equal discs from Enskog theory.

    Attributes:
        density: number density n, 1/length².
        diffusion: diffusion coefficient D, length²/time.
        viscosity: shear viscosity η, mass/time.
        conductivity: thermal conductivity λ, 1/time.
        bulk_viscosity: bulk viscosity ζ, mass/time.
        kinematic_viscosity: ν = η/nm, length²/time.
    """

    density: float
    diffusion: Theory
    viscosity: Theory
    conductivity: Theory
    bulk_viscosity: Theory
    kinematic_viscosity: float


def self_diffusion(log: Log, equilibrium: Ensemble, rates: ExpectedRates) -> list[Theory | None]:
    """Return D of each species of a mixture, length²/time, in the first approximation of Enskog theory.

    If the discs of a species differ, D is averaged over them. The velocity of discs of species i decays at the rate
    γ_i = Σ_j 2 (μ_ij/m_i) Γ_ij, where μ_ij are reduced masses and Γ_ij collision rates. This is the friction of a
    Brownian disc among lighter discs; for equal discs it is the collision rate Γ. D_i = T/(m_i γ_i).

    Along an axis along which momentum is conserved, two effects each multiply D by 1 - m/M, where M is the mass of all
    discs. First, m_i⟨vx²⟩ is T(1 - m/M). Second, the other discs recoil with velocity -m v/(M - m), so that the
    relative velocity decays at the rate γ/(1 - m/M). This is exact initially, because the covariance of a velocity with
    a relative velocity is T/m, as without the constraint.

    The error is the sum of the errors for equal discs, of the rates and of the first approximation, and of two
    corrections: for the momentum that discs of the same species take up, and for the recoil if walls stop it. An entry
    is None if the rates are unknown.
    """
    discs, (rate, off) = rates.discs, rates.of_kinds
    values = np.empty((2, len(discs.mass)))  # value and error
    whole, walled = log.discs.mass.sum(), 1 - conserved_momentum(log.scene).mean()
    error = enskog.relative_error("diffusion", log.discs.packing_fraction)
    for i, (mass, rest) in enumerate(zip(discs.mass, discs.mass_share_of_others, strict=True)):
        reduced = mass * discs.mass / (mass + discs.mass)
        parts = 2 * reduced * rate[i]
        resistance = float(parts.sum())
        if not resistance > 0:
            values[:, i] = math.nan
            continue
        first = float(parts @ first_order_error(mass, discs.mass)) / resistance
        alike = rates.discs.number[discs.species == discs.species[i]].sum()
        shared = (alike - 1) * (mass / whole / rest) ** 2
        relative = error + float(off[i].max()) + 2 * walled * mass / whole + shared + first
        value = float((equilibrium.of_axes[discs.species[i]] ** 2).mean()) / equilibrium.temperature / resistance
        values[:, i] = value, relative * value
    means = (discs.shares @ values.T).tolist()
    return [Theory(value, error, "Enskog") if math.isfinite(value) else None for value, error in means]


def first_order_error(mass: float, others: np.ndarray) -> np.ndarray:
    """Return the relative excess of D over the first approximation, for discs of one mass among discs of other masses.

    Among fixed discs D is ⟨v⟩⟨v³⟩/⟨v²⟩² = 3π/8 times the first approximation, because discs keep their speed. For a
    Brownian disc the approximation is exact. In between, the excess is assumed to be proportional to the cube of the
    mass fraction of the partner; this agrees with the excess of 2.3 ± 0.2 % measured for equal discs in the dilute
    limit.
    """
    return (3 * math.pi / 8 - 1) * (others / (mass + others)) ** 3


def mutual_diffusion(log: Log, discs: Composition, equilibrium: Ensemble, rates: ExpectedRates) -> Theory | None:
    """Return the Maxwell–Stefan diffusion coefficient of two species, length²/time, from Enskog theory.

    In the first approximation the relative velocity of the species decays only through collisions of unlike discs:
    D₁₂ = x₂ T/(2 μ Γ₁₂), where x₂ is the fraction of the discs that belong to the second species, μ the reduced mass,
    and Γ₁₂ the rate at which a disc of the first species meets discs of the second. If the species differ only in name,
    D₁₂ is the self-diffusion coefficient. The result is None unless there are two species, each of equal discs, whose
    rates are known.
    """
    if len(discs.name) != 2 or log.discs.unlike or not rates.rate[0, 1] > 0:
        return None
    reduced, share = discs.mass[0] * discs.mass[1] / discs.mass.sum(), discs.number[1] / discs.number.sum()
    value = float(share * equilibrium.temperature / (2 * reduced * rates.rate[0, 1]))
    relative = enskog.relative_error("diffusion", log.discs.packing_fraction) + float(rates.relative_error[0, 1])
    return Theory(value, relative * value, "Enskog")


def coefficients_of(log: Log, discs: Composition, equilibrium: Ensemble) -> Enskog | None:
    """Return Enskog's coefficients for equal discs; None for unequal discs, above φ = 0.62, and for one or two discs.

    The coefficients are those of an infinite gas. At fixed energy and momentum the currents of N discs are smaller: in
    a dilute gas the mean square of Σ m v_x v_y is lower by a fraction 2/N, and that of Σ m v² v by 6/N. The errors
    include such a term.
    """
    gas = log.discs
    if len(discs.name) > 1 or gas.unlike or gas.packing_fraction > hard_discs.HIGHEST or len(gas) <= 2:
        return None
    density, mass, kept = len(gas) / gas.area, discs.mass[0], 1 - conserved_momentum(log.scene).mean() / len(gas)
    chi = hard_discs.fluid_contact_value(gas.packing_fraction)
    state = (2 * discs.radius[0], density, equilibrium.temperature, mass, chi)
    viscosity = enskog.viscosity(*state)

    def theory(quantity: str, value: float, part: float = 6.0, first: float = 0.0) -> Theory:
        relative = enskog.relative_error(quantity, gas.packing_fraction) + part / len(gas) + first
        return Theory(value, relative * value, "Enskog")

    return Enskog(
        density,
        theory("diffusion", enskog.diffusion(*state) * kept, 1.0, float(first_order_error(mass, discs.mass)[0])),
        theory("viscosity", viscosity, 2.0),
        theory("conductivity", enskog.conductivity(*state)),
        theory("bulk viscosity", enskog.bulk_viscosity(*state)),
        viscosity / (density * mass),
    )
