"""What a log holds from before its run: scene, box, discs and walls, and what made it."""

from functools import cached_property
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.events import Column
from idealgas.log.errors import LogError
from idealgas.log.log_file import LogFile
from idealgas.log.rules import check_boundary, check_images, check_species, check_walls
from idealgas.log.schema import DISC_COLUMNS, ROOT_ATTRIBUTES, RUN_COLUMNS, VERSIONS, Wall
from idealgas.state import Gas

if TYPE_CHECKING:
    from idealgas.scene import Scene


class LogHeader:
    """The part of a `Log` that is written before its run begins; `Log` says what the attributes are."""

    def __init__(self, file: LogFile) -> None:
        self._file = file
        file.rules.in_steps = self._in_steps
        self.path = file.path
        self.unclosed = file.unclosed
        self.box: tuple[float, float] = tuple(file.fixed("box").tolist())
        self.gravity: tuple[float, float] = tuple(file.fixed("gravity").tolist())
        words = file.attribute("box", "boundary").tolist()
        file.checked(lambda: check_boundary(words), "box")
        self.periodic = tuple(word == b"periodic" for word in words)
        file.checked(lambda: check_images(any(self.periodic), file.names("checkpoints")), "checkpoints/image")

    @cached_property
    def runs(self) -> list[tuple[str, str]]:
        """Scene (TOML, all defaults filled in) and command of every run that wrote into the log, in order.

        The first one is the run that made it, the others went on with it; their scenes differ only in where they end.
        """
        return list(zip(*(self._file.texts(f"runs/{column.name}") for column in RUN_COLUMNS), strict=True))

    @property
    def scene_text(self) -> str:
        """Scene of the last run as TOML, with all defaults filled in."""
        return self.runs[-1][0]

    @cached_property
    def scene(self) -> "Scene":
        """Scene of the last run, with all defaults filled in."""
        from idealgas.log.check_consistency import check_scene
        from idealgas.scene import Scene, parse_scene

        def read() -> Scene:
            scene = parse_scene(self.scene_text, "scene")
            kept = {*self._file.names("events"), *self._file.names("checkpoints")}
            check_scene(scene, self.discs, self.walls, self.periodic, self.gravity, self._file.kicks, kept)
            return scene

        return self._file.checked(read, "runs/scene")

    def _in_steps(self) -> bool:
        """Whether discs move in steps of time; not known where the scene is damaged."""
        try:
            return self.scene.run.dt is not None
        except LogError:
            return False

    @property
    def command(self) -> str:
        """Command line of the last run; empty for a run from Python."""
        return self.runs[-1][1]

    @cached_property
    def attributes(self) -> dict[str, Any]:
        """Facts about the file by name: format, format_version, seed, created (UTC), and versions of what made it.

        The versions are those of idealgas, python, numpy, numba, h5py, isal and hdf5; `trajectory` is the version of
        the laws of motion: a log is resumed only by a program with the same one.
        """
        return self._file.attributes("/", ROOT_ATTRIBUTES) | self._file.attributes("versions", VERSIONS)

    @cached_property
    def discs(self) -> Gas:
        """The discs at the start of the run: constants of each disc, and position and velocity at time 0."""
        columns = {column.name: self._file.fixed(f"discs/{column.name}") for column in DISC_COLUMNS}
        names = tuple(self._file.texts("discs/species_name"))
        self._file.checked(lambda: check_species(columns["species"], names), "discs/species")
        return Gas(box=self.box, species_names=names, **columns)

    def stored(self, table: str) -> list[Column]:
        """Columns of a table, as they are in the file: names, types and shapes of an entry."""
        return self._file.stored(table)

    @cached_property
    def inertia(self) -> np.ndarray | None:
        """(N,) moment of inertia of each disc, mass length²; None where discs do not spin."""
        spins = "angular_velocity" in self._file.names("checkpoints")
        return self._file.fixed("discs/inertia") if spins else None

    @cached_property
    def walls(self) -> list[Wall]:
        """Sides of the box (left, right, bottom, top), then the wall segments; events name wall k as partner -1 - k."""
        ends, names = self._file.fixed("walls/endpoints").tolist(), self._file.texts("walls/name")
        walls = [Wall(name, *map(tuple, end)) for name, end in zip(names, ends, strict=True)]
        self._file.checked(lambda: check_walls(walls, self.box), "walls/endpoints")
        return walls
