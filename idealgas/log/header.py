"""The header of a log, which is written before the run: scene, box, discs, walls and program versions."""

from dataclasses import replace
from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.columns import FIRST_SEGMENT, Column, Kind
from idealgas.errors import NotApplicableError
from idealgas.log.check_parts import check_boundary, check_images, check_species, check_walls
from idealgas.log.errors import LogError
from idealgas.log.log_file import LogFile
from idealgas.log.schema import DISC_COLUMNS, ROOT_ATTRIBUTES, RUN_COLUMNS, VERSIONS, Wall
from idealgas.state import Gas

if TYPE_CHECKING:
    from idealgas.scene import Scene
    from idealgas.scene.changes import SceneChange
    from idealgas.scene.discs import InitialDiscs


class LogHeader:
    """The part of a `Log` that is written before the run; see `Log` for the attributes."""

    def __init__(self, file: LogFile) -> None:
        self._file = file
        file.rules.has_time_steps = self._has_time_steps
        self.path = file.path
        self.unclosed = file.unclosed
        self.box: tuple[float, float] = tuple(file.fixed("box").tolist())
        self._first_gravity: tuple[float, float] = tuple(file.fixed("gravity").tolist())
        words = np.asarray(file.attribute("box", "boundary")).tolist()
        file.checked(lambda: check_boundary(words), "box")
        self.periodic = tuple(word == b"periodic" for word in words)
        file.checked(lambda: check_images(any(self.periodic), file.names("checkpoints")), "checkpoints/image")

    @cached_property
    def wrapped_axes(self) -> tuple[bool, bool]:
        """Whether flights continue through periodic sides along x and along y; crossing a sheared side is an event."""
        x, y = self.periodic
        return x, y and not self.scene.properties.shear

    @cached_property
    def runs(self) -> list[tuple[str, str]]:
        """Scene (TOML with all defaults) and command line of the run and of each run that resumed it, in order.

        The scenes differ only in their stop rules.
        """
        return list(zip(*(self._file.texts(f"runs/{column.name}") for column in RUN_COLUMNS), strict=True))

    @property
    def scene_text(self) -> str:
        """Scene of the latest run, as TOML with all defaults."""
        return self.runs[-1][0]

    @cached_property
    def changes(self) -> list["SceneChange"]:
        """Changes that a program made to the scene, up to the time of the last checkpoint."""
        from idealgas.scene.changes import SceneChange

        if not self._file.rows("changes"):
            return []
        last = self._file.column("checkpoints/time")[-1:].max(initial=0.0)
        rows = zip(self._file.column("changes/time").tolist(), self._file.texts("changes/setting"), strict=True)
        return [SceneChange(*row) for row in rows if row[0] <= last]

    @cached_property
    def scene(self) -> "Scene":
        """Scene of the latest run, with all defaults and with the changes that a program made during the run."""
        from idealgas.log.check_consistency import check_scene
        from idealgas.scene import Scene, parse_scene

        def read() -> Scene:
            scene = parse_scene(self.scene_text, "scene", discs=self.initial_discs, changes=self.changes)
            columns = {*self._file.names("events"), *self._file.names("checkpoints")}
            discs, kinds = self._stored_discs, self._file.kinds
            check_scene(
                scene, discs, self.walls, self.periodic, self._first_gravity, kinds, columns, self._file.pistons
            )
            return scene

        return self._file.checked(read, "runs/scene")

    @property
    def gravity(self) -> tuple[float, float]:
        """Acceleration (gx, gy) between events, length/time². Raises NotApplicableError if it changes with time."""
        if self._steps_of_gravity is not None:
            raise NotApplicableError(f"{self.path}: constant gravity is required, but gravity changes in time")
        return self._first_gravity

    def gravity_at(self, time: np.ndarray) -> np.ndarray:
        """Return the acceleration at times (n,), length/time²: an array (n, 2), or (2,) if gravity is constant.

        The acceleration never changes during a flight.
        """
        if self._steps_of_gravity is None:
            return np.array(self._first_gravity)
        times, values = self._steps_of_gravity
        return values[times.searchsorted(time, "right") - 1]

    @property
    def has_gravity(self) -> bool:
        """Whether gravity accelerates the discs at any time."""
        return any(self._first_gravity) or self._steps_of_gravity is not None

    @cached_property
    def _steps_of_gravity(self) -> tuple[np.ndarray, np.ndarray] | None:
        """Times (n,) at which gravity changes, and the accelerations (n, 2) from then on; None if it is constant."""
        if Kind.STEERED not in self._file.kinds or not self.scene.properties.later_accelerations:
            return None
        times, values = zip(*self.scene.gravity.steps, strict=True)
        return np.array(times), np.array(values)

    @property
    def escapes(self) -> bool:
        """Whether discs may leave the gas."""
        return Kind.ESCAPED in self._file.kinds

    def _has_time_steps(self) -> bool:
        """Return whether the run has time steps; False if the scene is damaged."""
        try:
            return self.scene.run.dt is not None
        except LogError:
            return False

    @property
    def command(self) -> str:
        """Command line of the latest run; empty if it was started from Python."""
        return self.runs[-1][1]

    @cached_property
    def attributes(self) -> dict[str, Any]:
        """Attributes of the file, by name: format, format_version, seed, created (UTC) and versions.

        The versions are those of idealgas, python, numpy, numba, h5py, isal and hdf5, and `trajectory`, the version of
        the laws of motion. Only a program with the same value of `trajectory` can resume the log.
        """
        return self._file.attributes("/", ROOT_ATTRIBUTES) | self._file.attributes("versions", VERSIONS)

    @cached_property
    def discs(self) -> Gas:
        """Discs at the start of the run: their constants and their initial positions and velocities."""
        inner = len(self.walls) > FIRST_SEGMENT
        return replace(self._stored_discs, solid_area=self.scene.solids.area) if inner else self._stored_discs

    @cached_property
    def _stored_discs(self) -> Gas:
        """Discs at the start of the run as stored in the file, without any information from the scene."""
        columns: dict[str, Any] = {column.name: self._file.fixed(f"discs/{column.name}") for column in DISC_COLUMNS}
        names = tuple(self._file.texts("discs/species_name"))
        self._file.checked(lambda: check_species(columns["species"], names), "discs/species")
        return Gas(self.box, **columns, species_names=names)

    @property
    def initial_discs(self) -> "InitialDiscs":
        """Discs at the start of the run, in a form from which a scene can start."""
        from idealgas.scene.discs import InitialDiscs

        gas, n = self._stored_discs, len(self._stored_discs)
        spin = self._file.fixed("discs/angular_velocity") if self.inertia is not None else np.zeros(n)
        species = gas.species.astype(np.uint32)
        return InitialDiscs(
            gas.position, gas.velocity, gas.radius, gas.mass, spin, species, gas.species_names, np.arange(n)
        )

    def stored(self, table: str) -> list[Column]:
        """Return the columns of a table as stored in the file, each with name, type and shape of an entry."""
        return self._file.stored(table)

    @cached_property
    def inertia(self) -> np.ndarray | None:
        """Moments of inertia of the discs, (N,), mass·length²; None without rotation."""
        spins = "angular_velocity" in self._file.names("checkpoints")
        return self._file.fixed("discs/inertia") if spins else None

    @cached_property
    def walls(self) -> list[Wall]:
        """Sides of the box (left, right, bottom, top), then the wall segments; in events, wall k is partner -1 - k."""
        ends, names = self._file.fixed("walls/endpoints").tolist(), self._file.texts("walls/name")
        walls = [Wall(name, *map(tuple, end)) for name, end in zip(names, ends, strict=True)]
        self._file.checked(lambda: check_walls(walls, self.box), "walls/endpoints")
        return walls
