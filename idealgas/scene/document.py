"""A scene's tables together, as a TOML file holds them, before anything between them is checked.

Reduced units, k_B = 1; a whole number will do for any number. The tables of the effects follow from
the list of effects.
"""

import math
from typing import TYPE_CHECKING, Annotated, Any

from pydantic import Field, create_model

from idealgas.effects import EFFECTS
from idealgas.effects.effect import EffectSpec, Tables
from idealgas.effects.properties import ActiveEffect, Properties, combine, lacking
from idealgas.effects.rotation import loses
from idealgas.scene.defaults import (
    RestingDisc,
    contact_duration,
    mean_free_time,
    number_of_discs,
    resting_disc,
    trial_time,
)
from idealgas.scene.lattice import TriangularLattice, triangular_lattice
from idealgas.scene.tables import Box, Disc, Header, Log, Run, Species
from idealgas.toml.table import Rectangle, Table, Vector


class _Discs(Table):
    """Box and discs."""

    scene: Header = Field(default_factory=Header, description="[scene]: title, seed")
    box: Box = Field(description="[box]: size")
    species: Annotated[tuple[Species, ...], Field(strict=False)] = Field(default=(), description="[[species]] tables")
    disc: Annotated[tuple[Disc, ...], Field(strict=False)] = Field(default=(), description="[[disc]] tables")


def _fields_of_effects() -> dict[str, Any]:
    """Fields for the tables of the effects; arrays of tables come first, next to those of the discs."""
    fields: dict[str, Any] = {}
    for effect in sorted(EFFECTS, key=lambda effect: not effect.many):
        if effect.table is not None and effect.many:
            array = Annotated[tuple[effect.table, ...], Field(strict=False)]  # type: ignore[name-defined]
            fields[effect.key] = array, Field(default=(), description=effect.description)
        elif effect.table is not None:
            fields[effect.key] = effect.table | None, Field(default=None, description=effect.description)
    return fields


if TYPE_CHECKING:

    class _DiscsAndEffects(_Discs):
        def __getattr__(self, name: str) -> Any:
            """The table of an effect."""
            ...

else:
    _DiscsAndEffects = create_model("_DiscsAndEffects", __base__=_Discs, **_fields_of_effects())


class Document(_DiscsAndEffects):
    """All tables of a scene."""

    run: Run = Field(description="[run]: until, events or collisions_per_disc")
    log: Log = Field(default_factory=Log, description="[log]: events, compression, checkpoint_every, ...")

    def tables_of(self, effect: EffectSpec[Any]) -> Tables:
        """The part of the scene that an effect sees; of a scene that is being checked, the box may be missing."""
        own = getattr(self, effect.key) if effect.key else None
        size, sides = (self.box.size, self.box.sides) if self.box else ((math.nan, math.nan), ())
        return Tables(own, size, sides, self.wall)

    @property
    def active_effects(self) -> tuple[ActiveEffect, ...]:
        """The effects that the scene has, in the order of EFFECTS."""
        found = (effect.find(self.tables_of(effect)) for effect in EFFECTS)
        return tuple(effect for effect in found if effect is not None)

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects that the scene has."""
        return tuple(effect.name for effect in self.active_effects)

    @property
    def properties(self) -> Properties:
        """Properties of the gas with all effects that the scene has."""
        return combine(self.active_effects)

    def lacking(self, *properties: str) -> tuple[str, ...]:
        """Names of the effects for which one of these properties is not true."""
        return lacking(self.active_effects, *properties)

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
        gravity = self.properties.acceleration
        body_force = list(gravity)
        if self.piston:
            axis = self.piston.axis
            body_force[axis] = max(body_force[axis], self.piston.acceleration(self.box.size, gravity), key=abs)
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
        return contact_duration(
            self.restitution, self.species, self.disc, self.room, self.box.periodic, self.body_force
        )

    @property
    def rest(self) -> RestingDisc | None:
        """What discs do that have come to rest; None if no constant force presses them, or nothing is lost."""
        if self.restitution is None:
            return None
        return resting_disc(self.restitution, self.contact_duration, self.free_time, self.body_force)

    @property
    def collapse_risk(self) -> bool:
        """Whether a constant force presses discs that roughness slows down, without bounds for their collisions."""
        return any(self.body_force) and loses(self.rotation) and self.thermostat is None
