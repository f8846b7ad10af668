"""All tables of a scene, before they are checked against each other, with the defaults and estimates derived from them.

All quantities are in reduced units (k_B = 1). The list of effects determines which tables of effects a scene may have.
"""

import math
from itertools import chain
from operator import is_not
from typing import TYPE_CHECKING, Annotated, Any

import numpy as np
from pydantic import Field, PrivateAttr, create_model

from idealgas.effects import EFFECTS
from idealgas.effects.effect import Effect, Tables
from idealgas.effects.piston import PistonTable, inner_pistons
from idealgas.effects.properties import ActiveEffect, Properties, combine, lacking
from idealgas.effects.rotation import loses
from idealgas.physics.collision_rates import DENSEST, collisions_per_length, mean_trial_time
from idealgas.physics.noninteracting import wall_hits_per_length
from idealgas.scene.defaults import RestingDisc, mean_kinetic_energy, mean_speed, reference_speed
from idealgas.scene.discs import ExplicitDiscs, FixedDisc, InitialDiscs, discs_of_tables, fixed_discs
from idealgas.scene.lattice import TriangularLattice, triangular_lattice
from idealgas.scene.sizes import Size
from idealgas.scene.solids import NO_SOLIDS, Solids, covered_area, find_solids
from idealgas.scene.tables import Box, Disc, Header, LogTable, Run, Species, StartTable
from idealgas.toml.table import Rectangle, Table, Vector

DEFAULT_CONTACT = 0.05
"""Default contact duration in units of the mean free time, used if a constant force presses discs together."""

SHORT_CONTACT = 1e-6
"""Default contact duration without such a force, in units of the mean diameter divided by the mean speed."""


class _Discs(Table):
    """Box and discs."""

    scene: Header = Field(default_factory=Header, description="[scene]: title, description, seed")
    box: Box = Field(description="[box]: size")
    species: Annotated[tuple[Species, ...], Field(strict=False)] = Field(default=(), description="[[species]] tables")
    disc: Annotated[tuple[Disc, ...], Field(strict=False)] = Field(default=(), description="[[disc]] tables")
    start: StartTable | None = Field(default=None, description="[start]: log or file, time, velocities")


def _fields_of_effects() -> dict[str, Any]:
    """Return the fields for the tables of effects; arrays of tables come first, next to the arrays of discs."""
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
            """Return the table of the effect with this key."""
            ...

else:
    _DiscsAndEffects = create_model("_DiscsAndEffects", __base__=_Discs, **_fields_of_effects())


_TABLES = ("box", "disc", *(effect.key for effect in EFFECTS if effect.key))
"""Fields that determine which effects a scene has."""


class Document(_DiscsAndEffects):
    """All tables of a scene."""

    run: Run = Field(description="[run]: until, events or collisions_per_disc")
    log: LogTable = Field(default_factory=LogTable, description="[log]: events, compression, checkpoint_every, ...")
    _explicit: ExplicitDiscs = PrivateAttr(default_factory=ExplicitDiscs)

    @property
    def explicit_discs(self) -> InitialDiscs:
        """Discs that are given individually, in the table [start] or the tables [[disc]]."""
        if self.start is None and self._explicit.tables is not self.disc:
            self._explicit = ExplicitDiscs(discs_of_tables(self.disc), tables=self.disc)
        return self._explicit.discs

    def _with_walls(self) -> ExplicitDiscs:
        """Return the cached values that follow from the tables, with the walls of the present tables."""
        known, tables = self._explicit, (self.wall, self.disc)
        if any(map(is_not, known.walls_of, tables)):
            of_tables = (wall.pieces(i) if wall is not None else (None,) for i, wall in enumerate(self.wall))
            known.pieces, known.fixed = tuple(chain.from_iterable(of_tables)), fixed_discs(self.disc)
            known.walls_of = tables
        return known

    @property
    def pieces(self) -> tuple[Any, ...]:
        """Walls that are declared in the tables [[wall]]: segments and arcs, with None for invalid tables."""
        return self._with_walls().pieces

    @property
    def fixed_discs(self) -> tuple[FixedDisc, ...]:
        """Fixed discs among the tables [[disc]]."""
        return self._with_walls().fixed

    @property
    def segments(self) -> tuple[Any, ...]:
        """Walls that are declared in the tables [[wall]], with None for invalid tables, followed by the fixed discs."""
        return (*self.pieces, *self.fixed_discs)

    @property
    def walls(self) -> tuple[Any, ...]:
        """Walls inside the box: the segments, followed by inner pistons at their initial positions."""
        return (*self.segments, *(inner_pistons(self.piston, self.box.size) if self.box else ()))

    @property
    def pistons(self) -> tuple[PistonTable, ...]:
        """Valid tables [[piston]]."""
        return tuple(piston for piston in self.piston if piston is not None)

    @property
    def solids(self) -> Solids:
        """Solids formed by the tables [[wall]]; their area includes the area covered by fixed discs."""
        width, height = self.box.size
        made = any(wall is not None and wall.solid for wall in self.wall)
        solids = find_solids(self.pieces, width * height) if made else NO_SOLIDS
        if fixed := self.fixed_discs:
            return solids._replace(area=solids.area + covered_area(fixed, (width, height), self.box.periodic))
        return solids

    @property
    def free_area(self) -> float:
        """Area of the room that is not covered by solids or fixed discs, length²."""
        left, bottom, right, top = self.room
        area, solid = (right - left) * (top - bottom), self.solids.area
        return area - solid if area > solid else area  # otherwise some solids are behind a piston

    @property
    def placed(self) -> list[tuple[int, Species]]:
        """Valid tables [[species]] with their indices; individually specified discs reduce their counts."""
        given = self.explicit_discs
        tables = [(i, s) for i, s in enumerate(self.species) if s is not None]
        if not given.names:
            return tables
        return [(i, s.model_copy(update={"count": max(s.count - given.numbers.get(s.name, 0), 0)})) for i, s in tables]

    @property
    def sizes(self) -> list[Size]:
        """Sizes and numbers of the discs that are placed by their species and not given individually."""
        return [size for _, s in self.placed for size in s.sizes]

    @property
    def has_discs(self) -> bool:
        """Whether the scene has any disc."""
        return bool(self.species or len(self.explicit_discs))

    @property
    def draws_velocities(self) -> bool:
        """Whether individually specified discs receive new velocities, drawn as their species prescribe."""
        return self.start is not None and self.start.velocities == "new"

    @property
    def accepted_overlap(self) -> float:
        """Overlap of individually specified discs that is accepted in addition to rounding errors, length."""
        return self._explicit.update.get("overlap", self.start and self.start.overlap) or 0.0

    def tables_of(self, effect: Effect[Any]) -> Tables:
        """Return the tables on which an effect depends; while a scene is being checked, its box may be missing."""
        table = getattr(self, effect.key) if effect.key else None
        table = self.segments if effect.key == "wall" else table
        size, sides = (self.box.size, self.box.sides) if self.box else ((math.nan, math.nan), ())
        return Tables(table, size, sides, self.walls)

    @property
    def active_effects(self) -> tuple[ActiveEffect, ...]:
        """Effects that the scene has, in the order of EFFECTS."""
        tables = [getattr(self, name) for name in _TABLES]
        known = self._explicit
        if len(known.effects_of) != len(tables) or any(map(is_not, known.effects_of, tables)):
            effects = (effect.find(self.tables_of(effect)) for effect in EFFECTS)
            known.effects, known.effects_of = tuple(effect for effect in effects if effect is not None), tables
        return known.effects

    @property
    def effects(self) -> tuple[str, ...]:
        """Names of the effects that the scene has."""
        return tuple(effect.name for effect in self.active_effects)

    @property
    def properties(self) -> Properties:
        """Combined properties of all effects that the scene has."""
        return combine(self.active_effects)

    def lacking(self, *properties: str) -> tuple[str, ...]:
        """Return the names of the effects for which at least one of the given properties is false."""
        return lacking(self.active_effects, *properties)

    @property
    def room(self) -> Rectangle:
        """Rectangle (x0, y0, x1, y1) available to the gas at the start, length."""
        rooms = [(0.0, 0.0, *self.box.size), *(piston.room(self.box.size) for piston in self.pistons)]
        left, bottom, right, top = zip(*rooms, strict=True)
        return max(left), max(bottom), min(right), min(top)

    @property
    def lattice(self) -> TriangularLattice | None:
        """Triangular lattice on which discs are placed; None if there are no such discs or their number is odd."""
        number = sum(s.count for _, s in self.placed if s.placement == "triangular")
        return triangular_lattice(number, self.box.size) if number else None

    @property
    def pressing_acceleration(self) -> Vector:
        """Largest acceleration along x and along y that presses discs and walls together, length/time²."""
        gravity = self.properties.strongest_pull
        pull = list(gravity)
        for piston in self.pistons:
            pull[piston.axis] = max(pull[piston.axis], piston.acceleration(self.box.size, gravity), key=abs)
        return pull[0], pull[1]

    @property
    def number_of_discs(self) -> int:
        """Number N of discs."""
        return sum(s.count for _, s in self.placed) + len(self.explicit_discs)

    @property
    def mean_speed(self) -> float:
        """Expected mean speed of the discs at the start, length/time."""
        if self.draws_velocities:
            return mean_speed(self.species, np.empty((0, 2)))
        return mean_speed([s for _, s in self.placed], self.explicit_discs.velocity)

    @property
    def mean_kinetic_energy(self) -> float:
        """Expected mean kinetic energy of the discs at the start, energy."""
        if self.draws_velocities:
            return mean_kinetic_energy(self.species, np.empty(0), np.empty((0, 2)))
        return mean_kinetic_energy([s for _, s in self.placed], self.explicit_discs.mass, self.explicit_discs.velocity)

    @property
    def largest_radius(self) -> float:
        """Largest radius of the discs, length; 0 without discs."""
        return max([float(self.explicit_discs.radius.max(initial=0.0)), *(s.largest_radius for _, s in self.placed)])

    @property
    def covered_area(self) -> float:
        """Area of all discs, length²."""
        placed = [size.radius * size.radius * size.number for size in self.sizes]
        return math.pi * math.fsum([*placed, *(self.explicit_discs.radius**2).tolist()])

    @property
    def mean_free_time(self) -> float:
        """Expected time between successive collisions of a disc with discs or sides, time; infinite if nothing moves.

        It is estimated for the speed of a disc that starts at the mean speed and has fallen through half of the room.
        """
        return self.free_time_at(self.mean_speed)

    def free_time_at(self, speed: float) -> float:
        """Return the expected time between successive collisions of a disc, time.

        Args:
            speed: mean speed before the fall, length/time.
        """
        n, (left, bottom, right, top), pull = self.number_of_discs, self.room, self.pressing_acceleration
        size, area = (right - left, top - bottom), self.free_area
        phi = self.covered_area / area
        diameter, largest = self._sum_of_diameters / n, self.largest_radius
        met = n if self.properties.interacting else 1  # number of discs that meet each other
        encounters = collisions_per_length(met, diameter, largest, phi, size, self.box.periodic) / met
        encounters *= size[0] * size[1] / area
        if not self.properties.interacting:
            segments = ((math.dist(w.start, w.end), w.radius) for w in self.segments if w is not None)
            encounters += wall_hits_per_length(segments, area)
        path = 1.0 / max(encounters, 1.0 / sum(size))
        speed = math.sqrt(speed**2 + abs(pull[0]) * size[0] + abs(pull[1]) * size[1])
        return path / speed if speed > 0 else math.inf

    @property
    def trial_time(self) -> float:
        """Expected time between successive trials of the Monte Carlo method, time; infinite if nothing moves."""
        n, speed = self.number_of_discs, reference_speed(self.run, self.mean_speed)
        if n < 2 or speed == 0:
            return math.inf
        area = self.box.size[0] * self.box.size[1]
        return mean_trial_time(n, area, min(self.covered_area / area, DENSEST), 2 * self.largest_radius, speed)

    @property
    def expected_end(self) -> float:
        """Estimated end time of the run, from the initial event rates; infinite if no stop rule will be met."""
        run = self.run
        ends = [run.until or math.inf]
        if run.events is not None:
            ends.append(run.events * self.mean_free_time / self.number_of_discs)
        if run.collisions_per_disc is not None:
            ends.append(run.collisions_per_disc * self.mean_free_time)
        if run.trials is not None:
            ends.append(run.trials * self.trial_time)
        return min(ends)

    @property
    def contact_duration(self) -> float:
        """Time after a collision during which further collisions of the disc are elastic; 0 in an elastic gas.

        If a constant force presses a resting disc against the wall below it, the default duration limits the disc's hit
        rate to a multiple of the collision rate of the gas. Without such a force, the discs of a cluster separate as
        soon as their collisions are elastic, so the default only has to end an inelastic collapse; it is so short that
        averages are the same as for zero. The default is infinite if nothing moves.
        """
        if self.restitution is None or self.restitution.elastic:
            return 0.0
        if self.restitution.contact_duration is not None:
            return self.restitution.contact_duration
        if any(self.pressing_acceleration):
            return DEFAULT_CONTACT * self.mean_free_time
        if self.mean_speed == 0:
            return math.inf
        return SHORT_CONTACT * self._sum_of_diameters / self.number_of_discs / self.mean_speed

    @property
    def _sum_of_diameters(self) -> float:
        return sum(2 * s.radius * s.number for s in self.sizes) + sum(
            2 * r for r in self.explicit_discs.radius.tolist()
        )

    @property
    def resting_disc(self) -> RestingDisc | None:
        """Motion of discs that have come to rest; None if there is no constant force or collisions are elastic."""
        force = math.hypot(*self.pressing_acceleration)
        if self.restitution is None or self.restitution.elastic or force == 0:
            return None
        duration, e = self.contact_duration, min(self.restitution.normal, self.restitution.wall)
        most = 1 / (e * duration) if e > 0 else None
        height, energy = force * duration**2 / 8, (force * duration) ** 2 / 8
        return RestingDisc((1 / duration, most), height, energy, None if most is None else most * self.mean_free_time)

    @property
    def collapse_risk(self) -> bool:
        """Whether roughness dissipates energy under a constant force, so that the collision rate may diverge."""
        return any(self.pressing_acceleration) and loses(self.rotation) and self.thermostat is None
