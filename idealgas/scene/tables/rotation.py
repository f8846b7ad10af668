"""The table of rough discs that spin."""

from pydantic import Field

from idealgas.scene.properties import Effect, Properties
from idealgas.toml.table import Real, Table

NAME = "rotation"


class Rotation(Table):
    """`[rotation]`: discs have a spin, and a tangential coefficient couples it to their motion.

    The coefficient runs from -1 (smooth) to 1 (perfectly rough); energy is conserved at these two. A piston is smooth.
    """

    inertia: Real = Field(
        default=0.5, gt=0, le=1, description="moment of inertia in units of mass * radius²: 0.5 for a uniform disc"
    )
    roughness: Real = Field(default=1.0, ge=-1, le=1, description="of discs, -1 to 1")
    wall_roughness: Real = Field(default=-1.0, ge=-1, le=1, description="of a disc with a wall, -1 to 1")


def loses(rotation: Rotation | None) -> bool:
    """Whether collisions of rough discs, with each other or with walls, lose energy."""
    return rotation is not None and any(-1 < r < 1 for r in (rotation.roughness, rotation.wall_roughness))


def effect(rotation: Rotation | None) -> Effect | None:
    """What spins change, if discs have any."""
    if rotation is None:
        return None
    properties = Properties(
        dissipative=loses(rotation), inertia=rotation.inertia, has_rough_walls=rotation.wall_roughness > -1
    )
    return Effect(NAME, (("rotation",),), properties)
