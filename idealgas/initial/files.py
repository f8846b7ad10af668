"""Columns of discs from files: .npz, .csv, .gsd and .extxyz, those of `idealgas export` among them."""

import csv
import re
import zipfile
from collections.abc import Callable, Iterator
from itertools import compress
from pathlib import Path
from typing import Any, Literal

import numpy as np

from idealgas.errors import install
from idealgas.locks import regular
from idealgas.scene.start import COLUMNS, StartError

Instant = float | Literal["end"]
State = tuple[dict[str, Any], float]
"""Columns by name, and the overlap that the precision of the file explains, length."""

LABELS = {"time", "disc", "image_x", "image_y", "speed"}
"""Columns of exported frames that are not part of a state."""

MOST_BYTES = 2**31
"""Largest size of a file, and of an array in it, bytes."""

SINGLE = 2.0**-22
"""Overlap in units of the largest coordinate that rounding to single precision explains: four roundings by 2⁻²⁴."""


def read_state(path: Path, time: Instant) -> State:
    """Columns of the discs of a file at a time. Raises StartError if they cannot be read."""
    reader = READERS.get(path.suffix.lower())
    if reader is None:
        raise StartError("file", "unknown kind of file", path.name, ", ".join(READERS))
    try:
        with open(path, "rb", opener=regular) as file:
            if (size := file.seek(0, 2)) > MOST_BYTES:
                raise StartError("file", "too large", f"{size:,} bytes", f"<= {MOST_BYTES:,}")
        columns, overlap = reader(path, time)
        return _inside(columns), overlap
    except OSError as error:
        raise StartError("file", "cannot be read", error.strerror or str(error), "a file") from None
    except ImportError as error:
        missing = f"a {path.suffix} file requires {error.name}"
        raise StartError("file", missing, "no such package", install("export")) from None
    except StartError:
        raise
    except (
        zipfile.BadZipFile,
        ValueError,
        TypeError,
        LookupError,
        EOFError,
        RuntimeError,
        OverflowError,
        MemoryError,
    ) as error:
        reason = (str(error).splitlines() or [type(error).__name__])[0]
        raise StartError("file", f"not a valid {path.suffix} file", reason, "columns by name") from None


def _inside(columns: dict[str, Any]) -> dict[str, Any]:
    """Columns without discs that have left the gas, whose position and velocity are nan in frames."""
    motion = [np.asarray(columns.get(name, 0.0), float) for name in ("position", "velocity")]
    if motion[0].shape != motion[1].shape or motion[0].ndim != 2:
        return columns
    here = ~np.isnan(np.hstack(motion)).all(axis=1)
    return {
        name: list(compress(values, here)) if isinstance(values, list) else np.asarray(values)[here]
        for name, values in columns.items()
    }


def _npz(path: Path, time: Instant) -> State:
    if time != "end":
        raise StartError("time", "no times in a .npz file", f"{time:g}", '"end"')
    with zipfile.ZipFile(path) as archive:
        if (size := max((entry.file_size for entry in archive.infolist()), default=0)) > MOST_BYTES:
            raise StartError("file", "too large", f"{size:,} bytes", f"<= {MOST_BYTES:,}")
    with np.load(path, allow_pickle=False) as archive:
        columns = {name: archive[name] for name in archive.files}
    if "species" in columns:
        columns["species"] = columns["species"].tolist()
    single = any(
        array.dtype.itemsize < 8 and array.dtype.kind == "f"
        for array in columns.values()
        if isinstance(array, np.ndarray)
    )
    return columns, _single(columns) if single else 0.0


def _single(columns: dict[str, Any]) -> float:
    return SINGLE * float(np.nanmax(np.abs(np.array(columns["position"], float)), initial=0.0))


def _csv(path: Path, time: Instant) -> State:
    with open(path, newline="", encoding="utf-8") as file:
        reader = csv.reader(file)
        names = next(reader, [])
        rows = [row for row in reader if row]
    known = {"x", "y", "vx", "vy", *COLUMNS[2:], *LABELS}
    if wrong := [name for name in names if name not in known] or [name for name in names if names.count(name) > 1]:
        raise StartError("file", "unknown column, or one that appears twice", wrong[0], ", ".join(sorted(known)))
    if any(len(row) != len(names) for row in rows):
        raise ValueError("rows of different lengths")
    texts = dict(zip(names, zip(*rows, strict=True), strict=True)) if rows else dict.fromkeys(names, ())
    chosen = _at(np.array(texts["time"], float), time) if "time" in texts else slice(None)
    if "time" not in texts and time != "end":
        raise StartError("time", "no column time in the file", f"{time:g}", '"end"')
    columns: dict[str, Any] = {}
    for name in COLUMNS[2:]:
        if name == "species" and name in texts:
            columns[name] = np.array(texts[name], object)[chosen].tolist()
        elif name in texts:
            columns[name] = np.array(texts[name], float)[chosen]
    for name, parts in (("position", ("x", "y")), ("velocity", ("vx", "vy"))):
        if name == "position" or parts[0] in texts or parts[1] in texts:
            columns[name] = np.column_stack([np.array(texts[part], float)[chosen] for part in parts])
    return columns, 0.0


def _at(times: np.ndarray, time: Instant) -> np.ndarray:
    """Mask of the rows of a time."""
    wanted = times.max(initial=-np.inf) if time == "end" else time
    found = times == wanted
    if not found.any():
        raise StartError("time", "no such time in the file", f"{time}", f"one of {len(np.unique(times))}")
    return found


def _gsd(path: Path, time: Instant) -> State:
    import gsd.hoomd

    with gsd.hoomd.open(str(path), "r") as file:
        times = np.array([float(frame.log.get("time", [k])[0]) for k, frame in enumerate(file)])
        frame = file[int(np.flatnonzero(_at(times, time))[-1])]
    particles, box = frame.particles, np.array(frame.configuration.box[:2], float)
    columns = {
        "position": np.array(particles.position[:, :2], float) + box / 2,
        "velocity": np.array(particles.velocity[:, :2], float),
        "radius": np.array(particles.diameter, float) / 2,
        "mass": np.array(particles.mass, float),
        "species": [particles.types[k] for k in particles.typeid.tolist()],
    }
    return columns, _single(columns)


_NAMES = {"pos": "position", "velo": "velocity", "radius": "radius", "mass": "mass", "masses": "mass"}
"""Columns of extended XYZ."""


def _extxyz(path: Path, time: Instant) -> State:
    frames = list(_frames(path))
    times = np.array(
        [float(found[1]) if (found := re.search(r"\bTime=(\S+)", head)) else k for k, (head, _) in enumerate(frames)]
    )
    head, rows = frames[int(np.flatnonzero(_at(times, time))[-1])]
    if (found := re.search(r"\bProperties=(\S+)", head)) is None:
        raise ValueError("no Properties in the second line")
    parts = found[1].split(":")
    columns: dict[str, Any] = {}
    first = 0
    for name, kind, width in zip(parts[::3], parts[1::3], map(int, parts[2::3]), strict=True):
        cells = [row[first : first + width] for row in rows]
        if name in _NAMES and kind in "RI":
            values = np.array(cells, float)
            columns.setdefault(_NAMES[name], values[:, :2] if width > 1 else values[:, 0])
        elif name == "type" or (name == "species" and "species" not in columns):
            columns["species"] = [cell[0] for cell in cells]
        first += width
    return columns, 0.0


def _frames(path: Path) -> Iterator[tuple[str, list[list[str]]]]:
    """Second line and rows of each frame."""
    with open(path, encoding="utf-8") as file:
        while (line := file.readline()).strip():
            head = file.readline()
            rows = [file.readline().split() for _ in range(int(line))]
            if not all(rows):
                raise ValueError("a frame is incomplete")
            yield head, rows


READERS: dict[str, Callable[[Path, Instant], State]] = {".npz": _npz, ".csv": _csv, ".gsd": _gsd, ".extxyz": _extxyz}
