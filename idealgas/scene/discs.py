"""Arrays of the discs that are given individually, in tables [[disc]] or in the state from which a scene starts."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from idealgas.effects.properties import ActiveEffect
from idealgas.effects.wall import PermanentWall, WallTable
from idealgas.toml.issues import Key

EXPLICIT = "disc"
"""Name of the species of individually specified discs that do not name their species."""


@dataclass(frozen=True, eq=False)
class InitialDiscs:
    """Individually given discs, in order of id; they have the lowest ids in a scene.

    Attributes:
        position: (n, 2), length.
        velocity: (n, 2), length/time.
        radius: (n,), length.
        mass: (n,), mass.
        angular_velocity: (n,), 1/time.
        species: (n,), index of each disc's species in `names`.
        names: names of the species.
        index: (n,), number of the table [[disc]] of each disc, or of its row in the file or log.
    """

    position: np.ndarray
    velocity: np.ndarray
    radius: np.ndarray
    mass: np.ndarray
    angular_velocity: np.ndarray
    species: np.ndarray
    names: tuple[str, ...]
    index: np.ndarray

    def __len__(self) -> int:
        return len(self.radius)

    def first(self, number: int) -> "InitialDiscs":
        """Return the first `number` discs."""
        keys = ("position", "velocity", "radius", "mass", "angular_velocity", "species", "index")
        names = self.names[: int(self.species[:number].max()) + 1]
        return replace(self, names=names, **{key: getattr(self, key)[:number] for key in keys})

    def reversed(self) -> "InitialDiscs":
        """Return the discs with reversed velocities and angular velocities."""
        return replace(self, velocity=0.0 - self.velocity, angular_velocity=0.0 - self.angular_velocity)

    def wrapped(self, size: Sequence[float], periodic: Sequence[bool], shear: float = 0.0) -> "InitialDiscs":
        """Return the discs wrapped into the box along its periodic axes.

        Between sheared sides, the periodic image above the box moves faster along x. A disc that is shifted down by k
        box heights therefore loses k times the velocity difference between the top and the bottom. At the start the
        periodic images are aligned vertically, so positions along x do not change.

        Args:
            size: width and height of the box, length.
            periodic: whether the box is periodic along x and along y.
            shear: shear rate imposed by the bottom and top sides, 1/time.
        """
        position, velocity = self.position.copy(), self.velocity.copy()
        for axis in (a for a in range(2) if periodic[a]):
            x = position[:, axis]
            boxes = np.floor(x / size[axis])
            x -= size[axis] * boxes
            beyond = x >= size[axis]  # because of rounding
            x[beyond] = 0.0
            if shear and axis == 1:
                velocity[:, 0] -= shear * size[1] * (boxes + beyond)
        return replace(self, position=position, velocity=velocity)

    @cached_property
    def numbers(self) -> dict[str, int]:
        """Number of discs of each species, by name of the species."""
        return dict(zip(self.names, np.bincount(self.species, minlength=len(self.names)).tolist(), strict=True))

    @cached_property
    def digest(self) -> str:
        """Digest of the values of all discs and the names of their species."""
        sha = hashlib.sha256("\n".join(self.names).encode())
        for array in (self.position, self.velocity, self.radius, self.mass, self.angular_velocity, self.species):
            sha.update(np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<")).tobytes())
        return sha.hexdigest()[:32]


@dataclass(frozen=True)
class FixedDisc(PermanentWall):
    """A fixed disc: a wall around a point.

    Attributes:
        number: number of its `[[disc]]` table.
        start: centre, length.
        radius: length.
    """

    number: int
    start: tuple[float, float]
    radius: float

    @property
    def end(self) -> tuple[float, float]:
        """Centre of the disc."""
        return self.start

    @property
    def place(self) -> Key:
        """Key that declares the disc as fixed."""
        return ("disc", self.number, "fixed")

    @property
    def name(self) -> str:
        """Name for the log."""
        return f"fixed disc {self.number}"

    @property
    def action(self) -> str:
        """Short description for output."""
        return f"fixed disc, radius {self.radius:g}"


def make_discs(columns: dict[str, Any], names: Sequence[str], index: Sequence[int] | None = None) -> InitialDiscs:
    """Make discs from columns, without checking them.

    Args:
        columns: columns by name.
        names: (n,), name of each disc's species.
        index: (n,), see `InitialDiscs`; 0 to n - 1 by default.
    """
    numbers = {name: k for k, name in enumerate(dict.fromkeys(names))}
    n = len(names)
    return InitialDiscs(
        position=np.array(columns["position"], float).reshape(n, 2),
        velocity=np.array(columns["velocity"], float).reshape(n, 2),
        radius=np.array(columns["radius"], float),
        mass=np.array(columns["mass"], float),
        angular_velocity=np.array(columns["angular_velocity"], float),
        species=np.array([numbers[name] for name in names], np.uint32),
        names=tuple(numbers),
        index=np.arange(n) if index is None else np.array(index),
    )


def discs_of_tables(tables: Sequence[Any]) -> InitialDiscs:
    """Return the discs of the valid tables [[disc]], except fixed discs; None marks an invalid table."""
    items = [(i, d) for i, d in enumerate(tables) if d is not None and not d.fixed]
    keys = ("position", "velocity", "radius", "mass")
    columns = {key: [getattr(d, key) for _, d in items] for key in keys}
    columns["angular_velocity"] = [d.angular_velocity or 0.0 for _, d in items]
    return make_discs(columns, [d.species or EXPLICIT for _, d in items], [i for i, _ in items])


def fixed_discs(tables: Sequence[Any]) -> tuple[FixedDisc, ...]:
    """Return the fixed discs among the valid tables [[disc]]; None marks an invalid table."""
    return tuple(FixedDisc(i, d.position, d.radius) for i, d in enumerate(tables) if d is not None and d.fixed)


NO_DISCS = discs_of_tables(())


@dataclass(eq=False)
class ExplicitDiscs:
    """The individually specified discs of a scene, with cached values that follow from its tables.

    All instances compare equal, because the digest in the table [start] distinguishes the discs.

    Attributes:
        discs: the individually specified discs.
        update: keys of the [start] table that follow from the state it names.
        tables: tables [[disc]] from which the discs were made; None if the discs come from the table [start].
        pieces: walls that are declared in the tables [[wall]]; None marks an invalid table.
        fixed: fixed discs.
        walls_of: tables [[wall]] and [[disc]] from which `pieces` and `fixed` were made.
        effects: active effects of the tables `effects_of`.
        effects_of: tables from which `effects` were determined.
    """

    discs: InitialDiscs = NO_DISCS
    update: Mapping[str, Any] = field(default_factory=dict)
    tables: Sequence[Any] | None = None
    pieces: tuple[WallTable | None, ...] = ()
    fixed: tuple[FixedDisc, ...] = ()
    walls_of: Sequence[Any] = (None, None)
    effects: tuple[ActiveEffect, ...] = ()
    effects_of: Sequence[Any] = ()

    def __eq__(self, discs: object) -> bool:
        return isinstance(discs, ExplicitDiscs)

    __hash__ = None  # type: ignore[assignment]
