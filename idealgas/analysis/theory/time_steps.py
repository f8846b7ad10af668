"""What time steps take from the numbers of a gas."""

import math

from idealgas.analysis.theory import conserved
from idealgas.gas.state import Gas
from idealgas.scene import Scene


def premises(scene: Scene, gas: Gas) -> tuple[str, ...]:
    """Sentence on the time steps by which a gas moves, with how far two discs do so in one at its start, `gas`."""
    if scene.run.method != "time_driven" or scene.run.dt is None:
        return ()
    velocity = conserved.common_motion(scene, gas)
    heat = gas.kinetic_energy - gas.mass.sum() * (velocity @ velocity) / 2
    moved = scene.run.dt * math.sqrt(math.pi * max(heat, 0.0) / gas.mass.sum())  # √2 ⟨|v|⟩ dt
    part = moved / (2 * float(gas.radius.mean()))
    return (
        f"By time steps, in which two discs move {part:.2g} diameters relative to each other at the start, Z - 1 is "
        "too small by one to two times that part, and rates by less; `idealgas accuracy` measures it.",
    )
