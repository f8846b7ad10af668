"""A scene's tables together, as a TOML file holds them, before anything between them is checked.

Reduced units, k_B = 1; a whole number will do for any number. An effect is a table of its own: one class in a file of
its name here and one field below, `None` when absent.
"""

from typing import Annotated

from pydantic import Field

from idealgas.document.table import Table
from idealgas.scene.tables.box import Box
from idealgas.scene.tables.discs import Disc, Species
from idealgas.scene.tables.gravity import Gravity
from idealgas.scene.tables.piston import Piston
from idealgas.scene.tables.restitution import Restitution
from idealgas.scene.tables.rotation import Rotation
from idealgas.scene.tables.run import Header, Log, Run
from idealgas.scene.tables.thermal import ThermalSide
from idealgas.scene.tables.wall import Wall

EFFECTS = ("gravity", "periodic sides", "wall segments", "rotation", "restitution", "thermal walls", "piston")
"""What a scene may add to smooth elastic discs in a reflecting box; no code of the others runs."""


class Document(Table):
    """All tables of a scene."""

    scene: Header = Field(default_factory=Header, description="[scene]: title, seed")
    box: Box = Field(description="[box]: size")
    species: Annotated[tuple[Species, ...], Field(strict=False)] = Field(default=(), description="[[species]] tables")
    disc: Annotated[tuple[Disc, ...], Field(strict=False)] = Field(default=(), description="[[disc]] tables")
    wall: Annotated[tuple[Wall, ...], Field(strict=False)] = Field(default=(), description="[[wall]] tables")
    gravity: Gravity | None = Field(default=None, description="[gravity]: acceleration")
    rotation: Rotation | None = Field(default=None, description="[rotation]: inertia, roughness, wall_roughness")
    restitution: Restitution | None = Field(default=None, description="[restitution]: normal, wall, contact_duration")
    piston: Piston | None = Field(default=None, description="[piston]: side, position, velocity or mass and pressure")
    run: Run = Field(description="[run]: until, events or collisions_per_disc")
    log: Log = Field(default_factory=Log, description="[log]: events, compression, checkpoint_every, ...")

    @property
    def effects(self) -> tuple[str, ...]:
        """Which of EFFECTS the scene calls for."""
        thermal = any(isinstance(side, ThermalSide) for side in self.box.sides) or any(w.temperature for w in self.wall)
        called = (
            self.gravity,
            any(self.box.periodic),
            self.wall,
            self.rotation,
            self.restitution and not self.restitution.elastic,
            thermal,
            self.piston,
        )
        return tuple(name for name, call in zip(EFFECTS, called, strict=True) if call)
