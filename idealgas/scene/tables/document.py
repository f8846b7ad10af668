"""A scene's tables together, as a TOML file holds them, before anything between them is checked.

Reduced units, k_B = 1; a whole number will do for any number. An effect is a table of its own, or a part of the box's:
a file of its name here says what it changes. It has one field below, `None` when absent, and one line in `CALLS`.
"""

import math
from collections.abc import Callable
from typing import Annotated

from pydantic import Field

from idealgas.scene.defaults import mean_free_time, number_of_discs, trial_time
from idealgas.scene.lattice import TriangularLattice, triangular_lattice
from idealgas.scene.properties import Effect, Properties, combine, lacking
from idealgas.scene.tables import gravity, periodic, piston, restitution, rotation, thermal, thermostat, wall
from idealgas.scene.tables.box import Box
from idealgas.scene.tables.discs import Disc, Species
from idealgas.scene.tables.gravity import Gravity
from idealgas.scene.tables.piston import Piston
from idealgas.scene.tables.restitution import RestingDisc, Restitution
from idealgas.scene.tables.rotation import Rotation
from idealgas.scene.tables.run import Header, Log, Run
from idealgas.scene.tables.thermostat import Thermostat
from idealgas.scene.tables.wall import Wall
from idealgas.toml.table import Rectangle, Table, Vector


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
    thermostat: Thermostat | None = Field(default=None, description="[thermostat]: temperature, rate")
    run: Run = Field(description="[run]: until, events or collisions_per_disc")
    log: Log = Field(default_factory=Log, description="[log]: events, compression, checkpoint_every, ...")

    @property
    def called(self) -> tuple[Effect, ...]:
        """The effects that the scene calls for."""
        return tuple(effect for call in CALLS.values() if (effect := call(self)) is not None)

    @property
    def effects(self) -> tuple[str, ...]:
        """Which of EFFECTS the scene calls for."""
        return tuple(effect.name for effect in self.called)

    @property
    def properties(self) -> Properties:
        """What is true of the gas with all effects that the scene calls for."""
        return combine(self.called)

    def lacking(self, *properties: str) -> tuple[str, ...]:
        """Names of the effects for which one of these properties is not true."""
        return lacking(self.called, *properties)

    @property
    def room(self) -> Rectangle:
        """What the gas has at the start."""
        return self.piston.room(self.box.size) if self.piston else (0.0, 0.0, *self.box.size)

    @property
    def lattice(self) -> TriangularLattice | None:
        """Triangular lattice on which discs start; None if none do, or if their number is odd."""
        number = sum(s.count for s in self.species if s.placement == "triangular")
        return triangular_lattice(number, self.box.size) if number else None

    @property
    def body_force(self) -> Vector:
        """Constant acceleration that presses discs on walls or a wall on discs, along x and y, length/time²."""
        body_force = list(self.properties.acceleration)
        if self.piston:
            axis = self.piston.axis
            body_force[axis] = max(body_force[axis], self.piston.acceleration(self.box.size, self.gravity), key=abs)
        return body_force[0], body_force[1]

    @property
    def free_time(self) -> float:
        """Expected time between two collisions of a disc at the start, see `mean_free_time`, time."""
        return mean_free_time(self.species, self.disc, self.room, self.box.periodic, self.body_force)

    @property
    def trial_time(self) -> float:
        """Expected time between two trials of Monte Carlo, see `trial_time`, time."""
        return trial_time(self.run, self.species, self.disc, self.box.size)

    @property
    def expected_end(self) -> float:
        """About when the run ends, by what happens at the start, time; infinite if nothing ends it."""
        run, n = self.run, number_of_discs(self.species, self.disc)
        ends = [run.until or math.inf]
        if run.events is not None:
            ends.append(run.events * self.free_time / n)
        if run.collisions_per_disc is not None:
            ends.append(run.collisions_per_disc * self.free_time)
        if run.trials is not None:
            ends.append(run.trials * self.trial_time)
        return min(ends)

    @property
    def contact_duration(self) -> float:
        """Time after a collision in which a disc loses nothing, time; 0 if discs never lose anything."""
        if self.restitution is None or self.restitution.elastic:
            return 0.0
        return restitution.contact_duration(
            self.restitution, self.species, self.disc, self.room, self.box.periodic, self.body_force
        )

    @property
    def rest(self) -> RestingDisc | None:
        """What discs do that have come to rest; None if no constant force presses them, or nothing is lost."""
        if self.restitution is None:
            return None
        return restitution.rest(self.restitution, self.contact_duration, self.free_time, self.body_force)

    @property
    def collapse_risk(self) -> bool:
        """Whether a constant force presses discs that roughness slows down, without bounds for their collisions."""
        return any(self.body_force) and rotation.loses(self.rotation) and self.thermostat is None


CALLS: dict[str, Callable[[Document], Effect | None]] = {
    gravity.NAME: lambda scene: gravity.effect(scene.gravity),
    periodic.NAME: lambda scene: periodic.effect(scene.box.sides if scene.box else ()),
    wall.NAME: lambda scene: wall.effect(scene.wall),
    rotation.NAME: lambda scene: rotation.effect(scene.rotation),
    restitution.NAME: lambda scene: restitution.effect(scene.restitution),
    thermal.NAME: lambda scene: thermal.effect(scene.box.sides if scene.box else (), scene.wall),
    piston.NAME: lambda scene: piston.effect(scene.piston),
    thermostat.NAME: lambda scene: thermostat.effect(scene.thermostat),
}
"""Every effect by its name, and whether a scene calls for it; one that is being checked may lack its box."""

EFFECTS = tuple(CALLS)
"""What a scene may add to smooth elastic discs in a reflecting box; no code of the others runs."""
