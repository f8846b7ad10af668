"""Discs in static contact with a wall against which they are pressed; they would collide endlessly at one instant.

A disc is in static contact only if it touches the wall exactly and has no velocity along the normal; any other disc
moves freely or bounces.
"""

from collections.abc import Iterator

import numpy as np

from idealgas.columns import OUTWARD, SIDES, axis_of, is_upper
from idealgas.physics.arc_geometry import nearest_points
from idealgas.scene import Scene
from idealgas.scene.checks.piston import piston_names
from idealgas.state import Gas
from idealgas.toml.issues import Issue, Key


def static_contact_issues(scene: Scene, gas: Gas) -> Iterator[Issue]:
    """Yield an issue for each explicit disc and each species with a disc in static contact with a wall or piston."""
    reported = set()
    for name, in_contact in _supports(scene, gas):
        for i in np.flatnonzero(in_contact):
            key = _key_of(scene, gas, int(i))
            if key not in reported:
                reported.add(key)
                got = f"disc {i} in contact, with no velocity along the normal"
                yield Issue((key,), f"at rest on {name}, against which it is pressed", got, "a gap or a velocity")


def _supports(scene: Scene, gas: Gas) -> Iterator[tuple[str, np.ndarray]]:
    """Yield the name of each wall against which discs are pressed, and a mask (N,) of the discs in static contact."""
    properties = scene.properties
    accelerations = np.array([properties.acceleration, *properties.later_accelerations])
    for side, name in enumerate(SIDES):
        axis = axis_of(side)
        pressed = _first(accelerations @ OUTWARD[side]) > 0 or hasattr(scene.box.sides[side], "vibrating")
        if pressed and not properties.periodic[axis] and name not in (piston.wall for piston in scene.piston):
            coordinate = gas.position[:, axis]
            touches = coordinate >= gas.box[axis] - gas.radius if is_upper(side) else coordinate <= gas.radius
            yield f"the {name} side", touches & (gas.velocity[:, axis] == 0)
    if accelerations.any():
        for wall in scene.segments:
            if wall.is_present(0.0):
                normal = gas.position - nearest_points(gas.position, wall.start, wall.end, wall.arc)
                touches = (normal**2).sum(axis=1) <= (gas.radius + wall.radius) ** 2
                if wall.is_permeable and wall.permeable_from is None:
                    touches &= ~np.array([wall.lets_pass(name) for name in gas.species_names])[gas.species]
                pressed = _first(accelerations @ normal.T) < 0
                yield wall.title, touches & pressed & ((normal * gas.velocity).sum(axis=1) == 0)
    for piston, name in zip(scene.piston, piston_names(scene.piston), strict=True):
        outward = piston.outward_from(gas.position, gas.box)
        gap = outward * (piston.start(gas.box) - gas.position[:, piston.axis]) - gas.radius
        piston_acceleration = np.array([piston.acceleration(gas.box, acceleration) for acceleration in accelerations])
        relative = _first(piston_acceleration - accelerations[:, piston.axis])
        pressed = outward * relative < 0
        in_contact = (gap <= 0) & (gas.velocity[:, piston.axis] == piston.start_velocity)
        yield name, in_contact & pressed


def _first(accelerations: np.ndarray) -> np.ndarray:
    """Return the first nonzero value of each series along axis 0, which moves a disc off a wall or presses it on."""
    return np.take_along_axis(accelerations, (accelerations != 0).argmax(axis=0)[None, ...], axis=0)[0]


def _key_of(scene: Scene, gas: Gas, i: int) -> Key:
    """Return the key of the scene that sets disc i's velocity."""
    if i < len(scene.explicit_discs) and not scene.draws_velocities:
        return ("start", "velocities") if scene.start else ("disc", i, "velocity")
    names = [s.name for s in scene.species]
    k = names.index(gas.species_names[gas.species[i]])
    motion = next(key for key in ("temperature", "speed", "velocities") if getattr(scene.species[k], key) is not None)
    return "species", k, motion
