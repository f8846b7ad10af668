"""Caveat for gases that are simulated with time steps."""

import math

from idealgas.scene import Scene
from idealgas.state import Gas
from idealgas.theory import conserved


def caveats(scene: Scene, gas: Gas) -> tuple[str, ...]:
    """Return a caveat on the time step, based on the relative displacement of two discs per step.

    `gas` is the initial state; for discs that start at rest, the displacement is unknown.
    """
    if scene.run.method != "time_driven" or scene.run.dt is None:
        return ()
    heat = gas.kinetic_energy - conserved.centre_of_mass_energy(scene, gas)
    if not heat > 0:
        return ("With time steps, collisions are detected late or missed; `idealgas accuracy` measures the effect.",)
    moved = scene.run.dt * math.sqrt(math.pi * heat / gas.mass.sum())  # √2 ⟨|v|⟩ dt
    part = moved / (2 * float(gas.radius.mean()))
    return (
        "With time steps, collisions are detected late or missed. On average, two discs initially move "
        f"{part:.2g} diameters relative to each other per step: Z - 1 is too small by one to two times this fraction, "
        "and rates by less; `idealgas accuracy` measures the effect.",
    )
