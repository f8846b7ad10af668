"""Frames of all discs as GSD, extended XYZ, and H5MD in three dimensions."""

from collections.abc import Sequence
from pathlib import Path

import h5py
import numpy as np

from idealgas._version import __version__
from idealgas.events import IMAGE, POSITION, VELOCITY
from idealgas.log.reader import Log


def write_gsd(log: Log, times: Sequence[float], path: Path) -> int:
    """HOOMD's schema of GSD: two dimensions, the origin in the middle of the box, float32.

    GSD knows no walls: its box counts as periodic. Its names are ASCII.
    """
    import gsd.hoomd

    discs, (width, height) = log.discs, log.box
    with gsd.hoomd.open(str(path), "w") as file:
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
            if step == 0:  # frames without them have those of the first
                particles.types = [name.encode("ascii", "backslashreplace").decode() for name in discs.species_names]
                particles.typeid, particles.mass, particles.diameter = discs.species, discs.mass, 2 * discs.radius
            file.append(frame)
    return len(times)


def write_extxyz(log: Log, times: Sequence[float], path: Path) -> int:
    """Extended XYZ: 17 digits, so every float64 comes back. The box's depth is the largest diameter."""
    discs, (width, height) = log.discs, log.box
    pbc = " ".join("T" if periodic else "F" for periodic in (*log.periodic, False))
    lattice = f"{width!r} 0 0 0 {height!r} 0 0 0 {float(2 * discs.radius.max())!r}"
    properties = "id:I:1:type:S:1:pos:R:3:velo:R:3:radius:R:1:mass:R:1"
    names = np.array(discs.species_names)[discs.species]
    fixed = list(zip(names.tolist(), discs.radius.tolist(), discs.mass.tolist(), strict=True))
    with path.open("w", encoding="utf-8") as file:
        for state in log.frames(times):
            file.write(
                f'{len(discs)}\nLattice="{lattice}" Properties={properties} Time={float(state.time)!r} pbc="{pbc}"\n'
            )
            moving = zip(state.position.tolist(), state.velocity.tolist(), strict=True)
            for i, ((name, radius, mass), ((x, y), (vx, vy))) in enumerate(zip(fixed, moving, strict=True)):
                file.write(f"{i} {name} {x!r} {y!r} 0.0 {vx!r} {vy!r} 0.0 {radius!r} {mass!r}\n")
    return len(times)


def write_h5md3d(log: Log, times: Sequence[float], path: Path) -> int:
    """H5MD 1.1 with a third coordinate, zero, in a group of the name that MDAnalysis looks for.

    A box without periodic sides has no edges there: they would be taken for periodic.
    """
    frames, discs = len(times), len(log.discs)
    with h5py.File(path, "w", libver=("v110", "v110")) as file:
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
    return frames


def _share_times(group: h5py.Group, name: str) -> None:
    """Let an element have the times of the positions."""
    for shared in ("step", "time") if name != "position" else ():
        group[f"{name}/{shared}"] = group[f"position/{shared}"]


def _with_zeros(vectors: np.ndarray) -> np.ndarray:
    """(N, 3) from (N, 2)."""
    return np.pad(vectors, ((0, 0), (0, 1)))
