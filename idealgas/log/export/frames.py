"""Write frames with all discs as GSD, extended XYZ, or H5MD in three dimensions."""

import errno
import io
import os
import re
from collections.abc import Callable, Sequence
from contextlib import suppress
from pathlib import Path
from typing import Any, BinaryIO

import h5py
import numpy as np

from idealgas._version import __version__
from idealgas.columns import IMAGE, POSITION, VELOCITY
from idealgas.errors import plain
from idealgas.log.reader import Log


def write_gsd(log: Log, times: Sequence[float], path: Path) -> int:
    """Write GSD with HOOMD's schema, in two dimensions and float32, with the origin at the centre of the box.

    GSD has no walls, so programs treat the box as periodic. Names of species are written in ASCII. The positions of
    discs that have left the gas are nan.
    """
    import gsd.hoomd

    try:
        with gsd.hoomd.open(str(path), "w") as file:
            _append_gsd(file, log, times)
    except RuntimeError as error:  # gsd raises this if the end of a file cannot be written
        raise OSError(errno.EIO, str(error)) from error
    return len(times)


def _append_gsd(file: Any, log: Log, times: Sequence[float]) -> None:
    import gsd.hoomd

    discs, (width, height) = log.discs, log.box
    for step, state in enumerate(log.frames(times)):
        frame = gsd.hoomd.Frame()
        frame.configuration.step = step
        frame.configuration.dimensions = 2
        frame.configuration.box = [width, height, 0, 0, 0, 0]
        frame.log["time"] = np.array([state.time])
        particles = frame.particles
        particles.N = len(discs)
        particles.position = _with_zeros(state.position - np.array(log.box) / 2)
        particles.velocity = _with_zeros(state.velocity)
        if state.image is not None:
            particles.image = _with_zeros(state.image)
        if step == 0:  # later frames inherit these values
            particles.types = [name.encode("ascii", "backslashreplace").decode() for name in discs.species_names]
            particles.typeid, particles.mass, particles.diameter = discs.species, discs.mass, 2 * discs.radius
        file.append(frame)


ELEMENTS = frozenset(
    re.findall(
        "[A-Z][a-z]?",
        "HHeLiBeBCNOFNeNaMgAlSiPSClArKCaScTiVCrMnFeCoNiCuZnGaGeAsSeBrKrRbSrYZrNbMoTcRuRhPdAgCdInSnSbTeIXeCsBaLaCePrNd"
        "PmSmEuGdTbDyHoErTmYbLuHfTaWReOsIrPtAuHgTlPbBiPoAtRnFrRaAcThPaUNpPuAmCmBkCfEsFmMdNoLrRfDbSgBhHsMtDsRgCnNhFlMc"
        "LvTsOg",
    )
)
"""Symbols of the chemical elements."""

PROPERTIES = "id:I:1:type:S:1:species:S:1:tags:I:1:pos:R:3:velo:R:3:momenta:R:3:radius:R:1:mass:R:1:masses:R:1"
"""Columns of extended XYZ. OVITO reads `type`, `velo` and `mass`; ASE reads `species`, `tags`, `momenta`, `masses`."""


def write_extxyz(log: Log, times: Sequence[float], file: BinaryIO) -> int:
    """Write extended XYZ with enough digits to represent every float64 exactly.

    The depth of the box is the largest diameter. The column `species` contains the name of a disc's species if it is
    the symbol of a chemical element, and X otherwise. Discs that have left the gas are omitted.
    """
    discs, (width, height) = log.discs, log.box
    pbc = " ".join("T" if periodic else "F" for periodic in (*log.periodic, False))
    lattice = f"{width!r} 0 0 0 {height!r} 0 0 0 {float(2 * discs.radius.max())!r}"
    names = ["_".join(plain(name).split()) or "_" for name in discs.species_names]
    kinds = [f"{name} {name if name in ELEMENTS else 'X'} {k}" for k, name in enumerate(names)]
    fixed = list(zip((kinds[k] for k in discs.species), discs.radius.tolist(), discs.mass.tolist(), strict=True))
    for state in log.frames(times):
        time = f'Lattice="{lattice}" Properties={PROPERTIES} Time={float(state.time)!r} pbc="{pbc}"'
        inside = state.inside.tolist()
        momenta = (discs.mass[:, np.newaxis] * state.velocity).tolist()
        moving = zip(fixed, state.position.tolist(), state.velocity.tolist(), momenta, strict=True)
        rows = [
            f"{i} {kind} {x!r} {y!r} 0.0 {vx!r} {vy!r} 0.0 {px!r} {py!r} 0.0 {radius!r} {mass!r} {mass!r}"
            for i, ((kind, radius, mass), (x, y), (vx, vy), (px, py)) in enumerate(moving)
            if inside[i]
        ]
        file.write("\n".join((str(len(rows)), time, *rows, "")).encode())
    return len(times)


def write_h5md3d(log: Log, times: Sequence[float], path: Path) -> int:
    """Write H5MD 1.1 with a third coordinate equal to zero, in the group that MDAnalysis expects.

    If no sides are periodic, the edges of the box are omitted, because MDAnalysis would treat the box as periodic. The
    positions of discs that have left the gas are nan.
    """
    with _Target(path) as target, h5py.File(target, "w", libver=("v110", "v110")) as file:
        _fill_h5md3d(file, log, times)
    if target.failure:
        raise target.failure
    return len(times)


class _Target(io.RawIOBase):
    """A file that hides failures from HDF5, which may crash if a write fails; after a failure, all calls are ignored.

    Attributes:
        failure: error raised by the first call that failed; None if no call failed.
    """

    def __init__(self, path: Path) -> None:
        self._file = path.open("w+b")
        self.failure: OSError | None = None

    def write(self, data: memoryview) -> int:  # type: ignore[override]
        """Write bytes at the current position."""
        self._try(lambda: self._file.write(data))
        return len(data)

    def readinto(self, buffer: memoryview) -> int:  # type: ignore[override]
        """Read bytes into a buffer."""
        return self._try(lambda: self._file.readinto(buffer))

    def seek(self, offset: int, whence: int = os.SEEK_SET) -> int:
        """Change the position in the file."""
        return self._try(lambda: self._file.seek(offset, whence))

    def truncate(self, size: int | None = None) -> int:
        """Set the size of the file."""
        return self._try(lambda: self._file.truncate(size))

    def flush(self) -> None:
        """Flush the file."""
        self._try(self._file.flush)

    def close(self) -> None:
        """Close the file."""
        super().close()  # which flushes
        with suppress(OSError):
            self._file.close()

    def _try(self, action: Callable[[], int | None]) -> int:
        try:
            return (not self.failure and action()) or 0
        except OSError as error:
            self.failure = error
            return 0


def _fill_h5md3d(file: h5py.File, log: Log, times: Sequence[float]) -> None:
    frames, discs = len(times), len(log.discs)
    h5md = file.create_group("h5md")
    h5md.attrs["version"] = (1, 1)
    h5md.create_group("author").attrs["name"] = np.bytes_("unknown")
    h5md.create_group("creator").attrs.update({"name": np.bytes_("idealgas"), "version": np.bytes_(__version__)})
    group = file.create_group("particles/trajectory")
    group["position/step"], group["position/time"] = np.arange(frames), np.asarray(times, "f8")
    columns = (POSITION, VELOCITY, IMAGE) if any(log.periodic) else (POSITION, VELOCITY)
    for name, dtype, *_ in columns:
        group.create_dataset(f"{name}/value", (frames, discs, 3), dtype, chunks=(1, discs, 3), compression="gzip")
        _share_times(group, name)
    box = group.create_group("box")
    boundary = ["periodic" if periodic else "none" for periodic in (*log.periodic, False)]
    box.attrs.update({"dimension": 3, "boundary": np.array(boundary, "S")})
    if any(log.periodic):
        box["edges/value"] = np.tile((*log.box, 2 * log.discs.radius.max()), (frames, 1))
        _share_times(group, "box/edges")
    group["id"], group["species"] = np.arange(discs), log.discs.species
    group["mass"], group["radius"] = log.discs.mass, log.discs.radius
    for frame, state in enumerate(log.frames(times)):
        for name, *_ in columns:
            group[f"{name}/value"][frame] = _with_zeros(getattr(state, name))


def _share_times(group: h5py.Group, name: str) -> None:
    """Let an element share the steps and times of the positions."""
    for shared in ("step", "time") if name != "position" else ():
        group[f"{name}/{shared}"] = group[f"position/{shared}"]


def _with_zeros(vectors: np.ndarray) -> np.ndarray:
    """Return the vectors (N, 2) with a third component of 0, (N, 3)."""
    return np.pad(vectors, ((0, 0), (0, 1)))
