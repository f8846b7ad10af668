"""Discs that are given individually, as arrays: from tables [[disc]], or from the state in which a scene starts."""

import hashlib
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np

from idealgas.effects.properties import ActiveEffect
from idealgas.effects.wall import FixedDisc

EXPLICIT = "disc"
"""Species of given discs without a species."""


@dataclass(frozen=True, eq=False)
class InitialDiscs:
    """Given discs, in order of id; they have the first ids of a scene.

    Attributes:
        position: (n, 2), length.
        velocity: (n, 2), length/time.
        radius: (n,), length.
        mass: (n,), mass.
        angular_velocity: (n,), 1/time.
        species: (n,), index into names.
        names: names of the species.
        index: (n,), number of each disc's table, or of the disc in its file.
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
        """Return the first discs; number: how many."""
        keys = ("position", "velocity", "radius", "mass", "angular_velocity", "species", "index")
        names = self.names[: int(self.species[:number].max()) + 1]
        return replace(self, names=names, **{key: getattr(self, key)[:number] for key in keys})

    def reversed(self) -> "InitialDiscs":
        """Return the discs with reversed velocities and spins."""
        return replace(self, velocity=0.0 - self.velocity, angular_velocity=0.0 - self.angular_velocity)

    def wrapped(self, size: Sequence[float], periodic: Sequence[bool], shear: float = 0.0) -> "InitialDiscs":
        """Return the discs wrapped into a box, which may be periodic along x or y.

        Between sheared sides, a disc that is moved down by a number of heights of the box becomes slower along x,
        because the image of the gas from which it comes is faster. At the start all images are above each other.

        Args:
            size: width and height of the box, length.
            periodic: whether the box is periodic along x, and along y.
            shear: shear rate of bottom and top, 1/time.
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
        """Number of discs of each species, by name."""
        return dict(zip(self.names, np.bincount(self.species, minlength=len(self.names)).tolist(), strict=True))

    @cached_property
    def digest(self) -> str:
        """Digest of all values and names."""
        sha = hashlib.sha256("\n".join(self.names).encode())
        for array in (self.position, self.velocity, self.radius, self.mass, self.angular_velocity, self.species):
            sha.update(np.ascontiguousarray(array).astype(array.dtype.newbyteorder("<")).tobytes())
        return sha.hexdigest()[:32]


def make_discs(columns: dict[str, Any], names: Sequence[str], index: Sequence[int] | None = None) -> InitialDiscs:
    """Make discs from columns by name, without checks. names: species of each disc."""
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
    """Discs of the valid tables [[disc]] that are not fixed; None marks invalid tables."""
    items = [(i, d) for i, d in enumerate(tables) if d is not None and not d.fixed]
    keys = ("position", "velocity", "radius", "mass")
    columns = {key: [getattr(d, key) for _, d in items] for key in keys}
    columns["angular_velocity"] = [d.angular_velocity or 0.0 for _, d in items]
    return make_discs(columns, [d.species or EXPLICIT for _, d in items], [i for i, _ in items])


def fixed_discs(tables: Sequence[Any]) -> tuple[FixedDisc, ...]:
    """Fixed discs of the valid tables [[disc]]."""
    return tuple(FixedDisc(i, d.position, d.radius) for i, d in enumerate(tables) if d is not None and d.fixed)


NO_DISCS = discs_of_tables(())


@dataclass(eq=False)
class ExplicitDiscs:
    """Given discs of a scene, and what else follows from its tables.

    All instances compare equal, because the digest in the table [start] distinguishes the discs.

    Attributes:
        discs: the discs.
        update: keys of the table [start] that follow from its state.
        tables: tables [[disc]] from which the discs were made; None for the discs of a start.
        walls: fixed discs of the tables `walls_of`.
        walls_of: tables [[disc]] from which `walls` were made.
        effects: active effects of the tables `effects_of`.
        effects_of: tables from which `effects` were found.
    """

    discs: InitialDiscs = NO_DISCS
    update: Mapping[str, Any] = field(default_factory=dict)
    tables: Sequence[Any] | None = None
    walls: Sequence[FixedDisc] = ()
    walls_of: Sequence[Any] = ()
    effects: tuple[ActiveEffect, ...] = ()
    effects_of: Sequence[Any] = ()

    def __eq__(self, discs: object) -> bool:
        return isinstance(discs, ExplicitDiscs)

    __hash__ = None  # type: ignore[assignment]
