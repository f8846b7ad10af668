"""Check that the scene stored in a log agrees with the arrays of the log."""

from collections.abc import Collection, Sequence

import numpy as np

from idealgas.columns import IMAGES, POSITIONS, SPINS, TRIALS, Kind, event_columns
from idealgas.initial.build import disc_constants
from idealgas.log.schema import Wall
from idealgas.scene import Scene
from idealgas.scene.walls import number_walls
from idealgas.state import Gas

DRAWN = 1e-12
"""Largest relative difference between the radii that two computers obtain from the same distribution.

They can differ because mathematical libraries round logarithms differently.
"""


def check_scene(
    scene: Scene,
    gas: Gas,
    walls: Sequence[Wall],
    periodic: tuple[bool, ...],
    gravity: tuple[float, float],
    kinds: Collection[Kind],
    columns: Collection[str],
    pistons: int,
) -> None:
    """Check that a scene has the same discs, walls and effects as a log.

    Args:
        scene: scene stored in the log.
        gas: initial discs stored in the log.
        walls: walls stored in the log.
        periodic: whether the log's box is periodic along x and along y.
        gravity: acceleration stored in the log, length/time².
        kinds: optional kinds of events that the log declares.
        columns: names of the columns of the log's events and checkpoints.
        pistons: number of pistons in the log.

    Raises:
        ValueError: if the scene and the log differ.
    """
    if scene.box.size != gas.box:
        raise ValueError(f"a box of {scene.box.size} (box: {gas.box})")
    if scene.number_of_discs != len(gas):
        raise ValueError(f"{scene.number_of_discs} discs (discs/id: {len(gas)})")
    radius, mass, species, names = disc_constants(scene)
    if names != gas.species_names:
        raise ValueError(f"species {', '.join(names)} (discs/species_name: {', '.join(gas.species_names)})")
    rounding = 0.0 if all(isinstance(s.radius, float) for s in scene.species) else DRAWN
    for name, values in {"radius": radius, "mass": mass, "species": species}.items():
        if not np.allclose(values, getattr(gas, name), rtol=rounding, atol=0.0):
            raise ValueError(f"the discs do not have the values of discs/{name}")
    if [(wall.name, wall.start, wall.end) for wall in number_walls(scene)] != list(walls):
        raise ValueError("walls differ from walls/name and walls/endpoints")
    if len(scene.piston) != pistons:
        raise ValueError(f"{len(scene.piston)} pistons (checkpoints/piston_position: {pistons})")
    if scene.properties.acceleration != gravity:
        raise ValueError(f"gravity {scene.properties.acceleration} (gravity: {gravity})")
    if scene.properties.periodic != periodic:
        raise ValueError(f"periodic sides {scene.properties.periodic} (box: {periodic})")
    steered = scene.steering is not None or bool(scene.properties.later_accelerations)
    for kind, cause, events, wanted in (
        (Kind.THERMOSTAT, "heat bath", "thermostat collisions", scene.thermostat is not None),
        (Kind.STEERED, "steering", "steered discs", steered),
        (Kind.ESCAPED, "wall that absorbs", "discs that escape", scene.properties.escapes),
    ):
        if wanted != (kind in kinds):
            raise ValueError(f"{'a' if wanted else 'no'} {cause} (got {'no ' * wanted}{events})")
    has = {
        POSITIONS: scene.run.method != "monte_carlo",
        TRIALS: scene.run.method == "monte_carlo",
        SPINS: scene.properties.spins,
        IMAGES: any(scene.properties.periodic),
    }
    for column in event_columns(*has):
        if column.when and has[column.when] != (column.name in columns):
            raise ValueError(
                f"{'with' if has[column.when] else 'without'} {column.when} (the columns of the log differ)"
            )
