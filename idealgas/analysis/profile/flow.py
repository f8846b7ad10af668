"""Theory of Poiseuille flow with slip, which gravity drives along the periodic axis between two thermal sides."""

import math
from collections.abc import Iterator
from typing import NamedTuple

import numpy as np

from idealgas.analysis.profile.theory import JUMP, POINTS
from idealgas.columns import sides_across
from idealgas.log import Log
from idealgas.tallies.equilibration import Window
from idealgas.theory import enskog, hard_discs
from idealgas.theory.values import Theory

LAW = "Poiseuille with slip at the sides, viscosity by Enskog"
"""Name of the law of the flow."""

SLIP, SLIP_ERROR = 1.016, 0.031
"""Slip length in units of ℓ, and its error.

The slip length is the velocity of the flow at a thermal side, extrapolated from far away, divided by the gradient of
the velocity. The unit ℓ is η √(2T/m)/nT of a dilute gas with the same mean free path. The value follows from the BGK
equation and is the same in two dimensions: Albertoni, Cercignani & Gotusso, Phys. Fluids 6, 993 (1963). The error is
the difference from the value for hard spheres, 0.985: Sharipov, Proc. EuroSimE, 243 (2004).
"""

SECOND_ORDER, LAYER = 0.77, 0.31
"""Corrections to first-order slip; they are not applied but counted as errors.

According to the BGK equation, the slip velocity has a second-order term, 0.77 ℓ² times the second derivative of the
velocity, and next to a side the gas is slower by 0.31 ℓ times the gradient: Cercignani, J. Math. Anal. Appl. 10, 93
(1965).
"""

LARGEST_ERROR = 0.1
"""Largest error relative to the velocity in the middle; if it is exceeded, there is no theory.

The gap is then too narrow, or the flow heats the gas too much.
"""

STEADY, LEAST_WINDOW = 4.0, 10.0
"""Time after which a flow is steady to within 2 %, and smallest length of the window, in relaxation times."""


class Flow(NamedTuple):
    """Theoretical flow.

    Attributes:
        velocity: velocity along the other axis in each strip, length/time.
        relaxation: relaxation time H²/π²ν, where H is the gap and ν the kinematic viscosity.
    """

    velocity: list[Theory]
    relaxation: float

    def caveats(self, window: Window) -> Iterator[str]:
        """Yield a caveat if the flow is still developing in the window, or if the window is too short for errors."""
        if window.start < STEADY * self.relaxation or window.duration < LEAST_WINDOW * self.relaxation:
            yield (
                f"The flow relaxes in a time of {self.relaxation:.3g}: it is steady after "
                f"{STEADY * self.relaxation:.3g}, and its standard errors require a window of "
                f"{LEAST_WINDOW * self.relaxation:.3g}."
            )


def expected_flow(log: Log, axis: int, edges: np.ndarray) -> Flow | None:
    """Return the velocity along the other axis in strips between edges (K + 1,) along an axis; None if unknown.

    The viscous stress balances the weight of the gas: u = ρg/2η (y (H - y) + sH), where ρ is the mass density, s the
    slip length, and y runs from 0 to H over the positions that the centres can reach. This holds for equal elastic
    discs without spin. The bound LARGEST_ERROR requires a wide gap and a slow flow, because viscous heating raises the
    temperature between the sides and thereby η.
    """
    properties, gas = log.scene.properties, log.discs
    emits = [properties.emits[side] for side in sides_across(axis)]
    plain = (
        properties.collisions_conserve_energy and properties.fixed_walls and properties.empty and not properties.spins
    )
    alike = len(gas.species_names) == 1 and not gas.unlike
    driven = (
        properties.free_fall_axes[1 - axis]
        and not log.gravity[axis]
        and not properties.varies
        and properties.bath is None
    )
    if not (plain and alike and driven) or None in emits or len(properties.temperatures) > 1:
        return None
    temperature, mass, radius = min(properties.temperatures), float(gas.mass[0]), float(gas.radius[0])
    gap = log.box[axis] - 2 * radius
    density = len(gas) / (log.box[1 - axis] * gap)
    phi = math.pi * density * radius**2
    if phi > hard_discs.HIGHEST:
        return None
    chi = hard_discs.fluid_contact_value(phi)
    state = (2 * radius, density, temperature, mass, chi)
    viscosity, conductivity = enskog.viscosity(*state), enskog.conductivity(*state)
    path = hard_discs.mean_free_path(2 * radius, density, phi)
    thermal_path = 1.022 * 2 / math.sqrt(math.pi) * path  # ℓ
    weight = mass * density * log.gravity[1 - axis]
    curvature, slip = weight / (2 * viscosity), SLIP * thermal_path
    fastest = curvature * (gap / 4 + slip) * gap
    heat = viscosity * (curvature * gap * gap / 4) ** 2 / 3 + JUMP * path * abs(weight * fastest) * gap / 2
    off = enskog.relative_error("viscosity", phi) + heat / conductivity / temperature / 2
    steps = (np.arange(POINTS) + 0.5) / POINTS
    y = np.clip(edges[:-1, None] + np.diff(edges)[:, None] * steps - radius, 0.0, gap)
    layers = np.exp(-y / thermal_path) + np.exp((y - gap) / thermal_path)
    missing = 2 * SECOND_ORDER * thermal_path**2 + (SLIP_ERROR + LAYER * layers) * thermal_path * gap
    value = (curvature * (y * (gap - y) + slip * gap)).mean(axis=1)
    error = off * abs(value) + abs(curvature) * missing.mean(axis=1)
    middle = off * abs(fastest) + abs(curvature) * missing.min()
    if middle > LARGEST_ERROR * abs(fastest):
        return None
    velocity = [Theory(*strip, LAW) for strip in zip(value.tolist(), error.tolist(), strict=True)]
    return Flow(velocity, (gap / math.pi) ** 2 * mass * density / viscosity)
