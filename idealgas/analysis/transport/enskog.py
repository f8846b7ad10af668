"""Enskog's transport coefficients of the gas of a log, with their errors."""

from dataclasses import dataclass

from idealgas.analysis.core.composition import Composition
from idealgas.analysis.core.equilibrium import Ensemble
from idealgas.analysis.theory import hard_discs
from idealgas.analysis.theory.values import Theory, enskog_error
from idealgas.log import Log


@dataclass(frozen=True)
class Enskog:
    """Transport coefficients of equal discs by Enskog's theory.

    density: number density n, 1/length². diffusion: D, length²/time. viscosity, bulk_viscosity: η and ζ, mass/time.
    conductivity: λ, 1/time. kinematic_viscosity: ν = η/nm, length²/time.
    """

    density: float
    diffusion: Theory
    viscosity: Theory
    conductivity: Theory
    bulk_viscosity: Theory
    kinematic_viscosity: float


def enskog(log: Log, discs: Composition, equilibrium: Ensemble) -> Enskog | None:
    """Enskog's coefficients of the gas of a log; None for several species and above φ = 0.62.

    They are those of an infinite gas. At fixed energy and momentum the currents of N discs are smaller: in a dilute gas
    the mean square of Σ m v_x v_y by a part 2/N, that of Σ m v² v by 6/N. The errors have such a part.
    """
    gas = log.discs
    if len(discs.name) > 1 or gas.packing_fraction > hard_discs.HIGHEST:
        return None
    density, mass = len(gas) / gas.area, discs.mass[0]
    chi = hard_discs.fluid_contact_value(gas.packing_fraction)
    state = (2 * discs.radius[0], density, equilibrium.temperature, mass, chi)
    viscosity = hard_discs.enskog_viscosity(*state)

    def theory(quantity: str, value: float, part: float = 6.0) -> Theory:
        return Theory(value, (enskog_error(quantity, gas.packing_fraction) + part / len(gas)) * value, "Enskog")

    return Enskog(
        density,
        theory("diffusion", hard_discs.enskog_diffusion(*state), 0.0),
        theory("viscosity", viscosity, 2.0),
        theory("conductivity", hard_discs.enskog_conductivity(*state)),
        theory("bulk viscosity", hard_discs.enskog_bulk_viscosity(*state)),
        viscosity / (density * mass),
    )
