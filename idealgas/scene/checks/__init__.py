"""Checks that the tables of a scene are consistent with each other."""

from __future__ import annotations

import math
from collections.abc import Iterator, Sequence
from collections.abc import Set as AbstractSet
from typing import TYPE_CHECKING, TypeVar

from idealgas.columns import MOST_SPECIES, MOST_WALLS
from idealgas.effects import EFFECTS
from idealgas.scene.checks import piston
from idealgas.scene.checks.discs import permeable_issues, placement_issues, room_issues, species_issues
from idealgas.scene.checks.overlaps import discs_in_walls, label, overlap_issues
from idealgas.scene.checks.run import endless_issues, method_issues, number_issues
from idealgas.scene.checks.sides import shear_issues, vibration_issues
from idealgas.scene.checks.solids import solid_issues
from idealgas.scene.checks.walls import walls_issues
from idealgas.scene.sizes import wrong_radius
from idealgas.toml.issues import Issue, Key

if TYPE_CHECKING:
    from idealgas.scene.document import Document


Item = TypeVar("Item")

MOST_DISCS = 2_000_000
"""Largest number of discs in a scene; a gas of this size needs 2 GB of memory."""

MAX_THERMOSTAT_COLLISIONS = 1e10
"""Largest number of thermostat collisions in a run; more would take many hours."""


def issues(scene: Document, invalid: AbstractSet[str] = frozenset()) -> Iterator[Issue]:
    """Yield the contradictions between the tables of a scene and between the keys of a table.

    Tables named in `invalid`, and tables replaced by None in an array, have errors of their own and are not checked.
    """
    if errors := list(_radius_issues(scene)) or list(_size_issues(scene)):
        yield from errors  # before checks that would take too long
        return
    box = None if "box" in invalid else scene.box
    if box is not None and "piston" not in invalid and (errors := list(piston.closed_issues(scene, invalid))):
        yield from errors  # before checks that require room for the gas
        return
    mobile = [i for i, disc in enumerate(scene.disc) if disc is None or not disc.fixed]
    if not scene.species and not mobile and scene.start is None:
        yield Issue((("species",),), "no discs", "nothing", "at least one [[species]] or [[disc]], or [start]")
    for i, disc in _valid(scene.disc):
        if disc.fixed and any(disc.velocity):
            keys = (("disc", i, "velocity"), ("disc", i, "fixed"))
            yield Issue(keys, "a fixed disc cannot move", str(list(disc.velocity)), "[0, 0]")
    if mobile and scene.start is not None:
        yield Issue(
            (("disc", mobile[0]), ("start",)), "[[disc]] tables in addition to [start]", "[[disc]]", "[start] alone"
        )
    yield from species_issues(scene)
    if not {"species", "disc"} & invalid:
        yield from permeable_issues(scene)
    if scene.properties.interacting:
        yield from overlap_issues(scene, box)
    if "rotation" not in invalid:
        yield from _spin_issues(scene, invalid)
    if not {"restitution", "species", "disc", "box", "gravity", "piston"} & invalid:
        yield from _contact_issues(scene)
    if box is not None:
        for effect in EFFECTS:
            if effect.find(tables := scene.tables_of(effect)) is not None:
                yield from effect.check(tables)
        yield from walls_issues(scene)
        yield from discs_in_walls(scene)
        if solid := list(solid_issues(scene)):
            yield from solid
            return  # the solids may leave no area
    yield from piston.issues(scene, invalid)
    if not invalid:
        yield from _thermostat_issues(scene)
        yield from vibration_issues(scene)
        yield from shear_issues(scene)
    if box is not None:
        yield from room_issues(scene, invalid)
        yield from placement_issues(scene)
    if not {"run", "species", "disc", "gravity", "piston"} & invalid:
        yield from endless_issues(scene)
        if box is not None and scene.has_discs:
            yield from number_issues(scene, invalid)
    if "run" not in invalid:
        yield from method_issues(scene, invalid)


def _radius_issues(scene: Document) -> Iterator[Issue]:
    """Check the distributions from which radii are taken."""
    for i, s in _valid(scene.species):
        if wrong := wrong_radius(s.radius):
            yield Issue((("species", i, "radius"),), *wrong)


def _size_issues(scene: Document) -> Iterator[Issue]:
    """Check that there are not too many species, walls and discs for their arrays to fit in memory."""
    names = {s.name for s in scene.species if s is not None} | set(scene.explicit_discs.names)
    for key, what, number, most in (
        ("species", "species", len(names), MOST_SPECIES),
        ("wall", "walls", len(scene.walls), MOST_WALLS),
        ("species", "discs", scene.number_of_discs, MOST_DISCS),
    ):
        if number > most:
            yield Issue(((key,), ("start",), ("disc",)), f"too many {what}", f"{number:,}", f"<= {most:,}")


def _valid(items: Sequence[Item | None]) -> list[tuple[int, Item]]:
    """Return the valid tables of an array with their indices; None marks an invalid table."""
    return [(i, item) for i, item in enumerate(items) if item is not None]


def _spin_issues(scene: Document, invalid: AbstractSet[str]) -> Iterator[Issue]:
    """Check for spins without a table [rotation], and for rotation in which no spin ever changes."""
    rotation = scene.rotation
    for table, items in (("species", scene.species), ("disc", scene.disc)):
        for i, item in _valid(items):
            given = [key for key in ("angular_velocity", "spin_temperature") if getattr(item, key, None) is not None]
            keys: tuple[Key, ...] = tuple((table, i, key) for key in given)
            if given and rotation is None:
                yield Issue(
                    (*keys, ("rotation",)), "a spin without rotation", given[0], "a table [rotation], or no spin"
                )
            elif len(given) > 1:
                yield Issue(keys, "two spins", " and ".join(given), "only one of them")
    if scene.start is not None and rotation is None and scene.explicit_discs.angular_velocity.any():
        number = int(scene.explicit_discs.angular_velocity.nonzero()[0][0])
        keys = (("start",), ("rotation",))
        yield Issue(keys, "a spin without rotation", label(scene, number).strip(), "a table [rotation], or no spin")
    smooth = rotation is not None and rotation.roughness == -1 and rotation.wall_roughness == -1
    if smooth and scene.thermostat is None and "thermostat" not in invalid:
        keys = (("rotation", "roughness"), ("rotation", "wall_roughness"))
        allowed = "no [rotation], or a roughness > -1"
        yield Issue(keys, "nothing changes the spins", "smooth discs and smooth walls", allowed)


def _contact_issues(scene: Document) -> Iterator[Issue]:
    """Check that the default contact duration is finite."""
    if scene.has_discs and math.isinf(scene.contact_duration):
        keys: tuple[Key, ...] = (("restitution", "contact_duration"),)
        yield Issue(keys, "no default, because nothing moves at the start", "nothing", "a time > 0")


def _thermostat_issues(scene: Document) -> Iterator[Issue]:
    """Check that there will not be too many thermostat collisions."""
    thermostat, until = scene.thermostat, scene.run.until
    if thermostat is None or until is None:
        return
    collisions = thermostat.rate * until * scene.number_of_discs
    if collisions > MAX_THERMOSTAT_COLLISIONS:
        most = thermostat.rate * MAX_THERMOSTAT_COLLISIONS / collisions
        allowed = f"<= {MAX_THERMOSTAT_COLLISIONS:g}, with a rate <= {most:.3g}"
        yield Issue(
            (("thermostat", "rate"), ("run", "until")),
            "too many thermostat collisions",
            f"about {collisions:.3g}",
            allowed,
        )
