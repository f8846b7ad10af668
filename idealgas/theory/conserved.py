"""Conserved motion of a gas: total momentum, the motion of the gas as a whole, and states that it cannot reach.

`caveats` returns a sentence for each assumption of the analyses that a gas violates.
"""

import numpy as np

from idealgas.physics.shear import flow_at
from idealgas.scene import Scene
from idealgas.state import Gas

CHANCE = 12.0
"""Largest share of the kinetic energy, times the number N of discs, that the centre of mass may have by chance.

The kinetic energy of the centre of mass along one axis is T/2 on average; its share of the energy exceeds s with a
probability of about exp(-s N).
"""

FIXED = 1e12
"""Mass, relative to that of the lightest disc, above which a disc counts as fixed.

To acquire its share of the energy, such a disc would need about as many collisions as this ratio, more than occur in
any run.
"""

KEPT = "discs that do not interact do not share their energy"
"""Why a gas of such discs never reaches equilibrium without a source of heat, as part of a sentence."""

SAID_FROM = 0.01
"""Fraction of the kinetic energy above which a conserved motion of the gas as a whole causes a caveat."""


def conserved_momentum(scene: Scene) -> np.ndarray:
    """Return whether the total momentum of the discs is conserved along x and y, (2,) bool.

    Smooth walls conserve the component parallel to them; thermal and rough walls do not. Methods without positions of
    the discs conserve both components.
    """
    without_positions = scene.run.method == "monte_carlo"
    return np.array((True, True) if without_positions else scene.properties.conserves_momentum)


def centre_of_mass_velocity(scene: Scene, gas: Gas) -> np.ndarray:
    """Return the velocity of the centre of mass, (2,), length/time; 0 along axes where momentum is not conserved.

    Between sheared sides the velocity is relative to their flow, which is rate · (y − height/2) at the start. If
    momentum along y is conserved there, momentum along x is also conserved, relative to a flow that moves along y with
    the gas.
    """
    conserved = conserved_momentum(scene)
    if scene.properties.shear:
        conserved = conserved[[1, 1]]
    return np.where(conserved, _mean_velocity(scene, gas), 0.0)


def _mean_velocity(scene: Scene, gas: Gas) -> np.ndarray:
    """Return the initial velocity of the centre of mass, (2,), length/time, relative to the flow of sheared sides."""
    flow = flow_at(gas.position[:, 1], scene.properties.shear, gas.box[1]) if scene.properties.shear else 0.0
    return np.asarray(gas.mass @ (gas.velocity - np.multiply.outer(flow, (1.0, 0.0))) / gas.mass.sum())


def centre_of_mass_energy(scene: Scene, gas: Gas) -> float:
    """Return the kinetic energy of the conserved motion of the gas as a whole."""
    velocity = centre_of_mass_velocity(scene, gas)
    return float(gas.mass.sum() * (velocity @ velocity) / 2)


def are_fixed(mass: np.ndarray) -> np.ndarray:
    """Return whether discs or species of these masses are too heavy to exchange energy with the lightest."""
    return mass >= FIXED * mass.min()


def degrees_of_freedom(scene: Scene, gas: Gas) -> int:
    """Return the number D of translational degrees of freedom of the discs that share energy.

    Directions of conserved momentum do not count. Fixed discs absorb momentum, so that the momentum of the others is
    not conserved.
    """
    fixed = int(are_fixed(gas.mass).sum())
    return 2 * (len(gas) - fixed) - (0 if fixed else int(conserved_momentum(scene).sum()))


def motion_at_start(scene: Scene, gas: Gas) -> np.ndarray:
    """Return the non-thermal part of the initial velocity of the gas as a whole, (2,), length/time.

    It consists of the conserved motion and, along the other axes, of the motion of the centre of mass if this is too
    fast to be due to chance.
    """
    velocity = _mean_velocity(scene, gas)
    chance = [share_of_motion(gas, velocity * axis) * len(gas) <= CHANCE for axis in np.eye(2)]
    return np.where(chance, centre_of_mass_velocity(scene, gas), velocity)


def lost_motion(scene: Scene, gas: Gas) -> tuple[str, ...]:
    """Return a caveat on the part of `motion_at_start` that walls or a heat bath remove; empty if there is none."""
    lost = motion_at_start(scene, gas) - centre_of_mass_velocity(scene, gas)
    if not lost.any():
        return ()
    return (
        f"The gas starts with a common velocity ({lost[0]:.4g}, {lost[1]:.4g}), {share_of_motion(gas, lost):.1%} of "
        "its kinetic energy; this motion is not included in the initial temperatures and "
        f"{'becomes heat at the walls' if scene.properties.bath is None else 'is lost to the heat bath'}.",
    )


def share_of_motion(gas: Gas, velocity: np.ndarray) -> float:
    """Return the fraction of the kinetic energy that is due to a common velocity (2,); 0 for a gas at rest."""
    energy = gas.kinetic_energy
    return float(gas.mass.sum() * (velocity @ velocity) / 2 / energy) if energy > 0 else 0.0


def is_ergodic(scene: Scene, gas: Gas) -> bool:
    """Return whether a gas reaches all states of its energy.

    A single disc does not: it keeps its speeds along x and along y, or at rough walls exchanges energy between few
    motions. Two equal discs between walls with zero total momentum do not either: each component of their velocities
    remains equal up to sign, and as long as they collide only with opposite velocities, the sum of their positions,
    unfolded at the walls, is conserved. Discs that do not interact keep their energies too.
    """
    properties, walled = scene.properties, ~np.array(scene.properties.periodic)
    if not properties.shares_energy:
        return False
    if len(gas) > 2 or not properties.isolated or not properties.uniform or scene.run.method == "monte_carlo":
        return True
    if len(gas) == 1:
        return False
    if not walled.any() or np.ptp(gas.mass) > 0:
        return True
    speeds = np.abs(gas.velocity[:, walled])
    return bool(np.abs(speeds[0] - speeds[1]).max() > 1e-9 * speeds.max())


def caveats(scene: Scene, gas: Gas) -> tuple[str, ...]:
    """Return the caveats, valid for every time average, that follow from the initial state `gas`."""
    sentences = []
    if any(scene.properties.free_fall_axes):
        sentences.append(
            "Gravity makes the gas flow along periodic sides: temperatures and speeds include this motion, except "
            "in `profile`."
        )
    if len(gas) == 1 and not is_ergodic(scene, gas):
        if not all(scene.properties.periodic):
            sentences.append("A single disc does not share its energy evenly: its motions have no common temperature.")
    elif scene.properties.interacting and not is_ergodic(scene, gas):
        sentences.append(
            "Two equal discs with zero total momentum between walls do not reach all states: pressures and "
            "temperatures along x and y may differ indefinitely. Give them different speeds."
        )
    velocity = centre_of_mass_velocity(scene, gas)
    if (share := share_of_motion(gas, velocity)) > SAID_FROM:
        sentences.append(
            f"The gas moves as a whole with velocity ({velocity[0]:.4g}, {velocity[1]:.4g}), {share:.1%} of its "
            "kinetic energy; temperatures and speeds are relative to this motion, which never stops."
        )
    return tuple(sentences)
