"""Reading columns of discs from .npz, .csv, .gsd and .extxyz files, including those written by `idealgas export`."""

import csv
import math
import re
import zipfile
from collections.abc import Callable, Iterable, Iterator, Sequence
from itertools import compress, islice
from pathlib import Path
from typing import IO, Any, Literal

import numpy as np

from idealgas.errors import install
from idealgas.locks import regular
from idealgas.scene.checks import MOST_DISCS
from idealgas.scene.start import COLUMNS, SINGLE, StartError

Instant = float | Literal["end"]
State = tuple[dict[str, Any], float]
"""Columns by name, and the largest overlap that the precision of the file can cause, length."""

LABELS = {"time", "disc", "image_x", "image_y", "speed"}
"""Columns of exported frames that are not part of a state."""

MOST_BYTES, MOST_COLUMN_BYTES = 2**31, 2**28
"""Largest sizes of a file, and of a column in memory, bytes."""

LONGEST_LINE = 2**17
"""Largest number of characters in a line; Python's csv module has the same limit for a field."""

ROWS = 2**14
"""Number of rows of a text file that are held in memory as text at any time."""


def read_state(path: Path, time: Instant) -> State:
    """Read the columns of the discs at a given time from a file. Raises StartError if they cannot be read."""
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
        csv.Error,
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
    """Return the columns without the discs that have left the gas; their positions and velocities are nan in frames."""
    motion = [np.asarray(columns.get(name, 0.0), float) for name in ("position", "velocity")]
    if motion[0].shape != motion[1].shape or motion[0].ndim != 2:
        return columns
    here = ~np.isnan(np.hstack(motion)).all(axis=1)

    def kept(values: Any) -> Any:
        if isinstance(values, list):
            return list(compress(values, here))
        return np.asarray(values)[here] if np.ndim(values) else values  # a single number applies to all discs

    return {name: kept(values) for name, values in columns.items()}


def _npz(path: Path, time: Instant) -> State:
    if time != "end":
        raise StartError("time", "no times in a .npz file", f"{time:g}", '"end"')
    with zipfile.ZipFile(path) as archive:
        for name in archive.namelist():
            with archive.open(name) as file:
                _check_column(Path(name).stem, *_shape_of(file))
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


def _shape_of(file: IO[bytes]) -> tuple[tuple[int, ...], np.dtype]:
    """Return the shape and type of the array in a .npy file, from the header of the file."""
    read = {1: np.lib.format.read_array_header_1_0, 2: np.lib.format.read_array_header_2_0}
    major, _ = np.lib.format.read_magic(file)
    if major not in read:
        raise ValueError(f"unknown version {major} of the .npy format")
    shape, _, dtype = read[major](file)
    return shape, dtype


def _check_column(name: str, shape: tuple[int, ...], dtype: np.dtype) -> None:
    """Raise StartError for a column that is too large, before it is read, or that does not contain real numbers."""
    _check_number(shape[0] if shape else 1)
    if name not in COLUMNS:
        raise StartError("file", "unknown column", name, ", ".join(COLUMNS))
    if name != "species" and dtype.kind not in "biuf":
        raise StartError("file", f"column {name} does not contain real numbers", str(dtype), "numbers such as float64")
    if (size := math.prod(shape) * dtype.itemsize) > MOST_COLUMN_BYTES:
        raise StartError("file", f"column {name} too large", f"{size:,} bytes", f"<= {MOST_COLUMN_BYTES:,}")


def _check_number(discs: int) -> None:
    if discs > MOST_DISCS:
        raise StartError("file", "too many discs", f"{discs:,}", f"<= {MOST_DISCS:,}")


def _single(columns: dict[str, Any]) -> float:
    return SINGLE * float(np.nanmax(np.abs(np.array(columns["position"], float)), initial=0.0))


def _lines(file: IO[str]) -> Iterator[str]:
    """Yield the lines of a text file; ValueError if a line is longer than LONGEST_LINE."""
    while line := file.readline(LONGEST_LINE + 1):
        if len(line) > LONGEST_LINE:
            raise ValueError(f"a line of more than {LONGEST_LINE:,} characters")
        yield line


def _chunks(rows: Iterable[Sequence[str]], width: int) -> Iterator[np.ndarray]:
    """Yield the cells of the rows as text, in chunks (n, width) of n rows."""
    rows = iter(rows)
    while chunk := list(islice(rows, ROWS)):
        if any(len(row) != width for row in chunk):
            raise ValueError("rows of different lengths")
        yield np.array(chunk, object).reshape(-1, width)


class _Moment:
    """State at the requested time, or at the last time for "end", assembled from parts of a file."""

    def __init__(self, wanted: Instant) -> None:
        self._wanted, self._range = wanted, (math.inf, -math.inf)
        self.begin(-math.inf)

    def begin(self, time: float) -> None:
        """Discard all previous parts, because the parts that follow belong to another time or a later frame."""
        self.time, self._parts, self._discs = time, list[dict[str, np.ndarray]](), 0

    def wants(self, time: float) -> bool:
        """Whether files written at this time may be parts of the requested state."""
        self._range = min(self._range[0], time), max(self._range[1], time)
        return time >= self.time if self._wanted == "end" else time == self._wanted

    def add(self, columns: dict[str, np.ndarray]) -> None:
        """Add discs to the state."""
        self._discs += len(columns["position"])
        _check_number(self._discs)
        self._parts.append(columns)

    def columns(self) -> dict[str, Any]:
        """Return the columns of the state, text as lists. Raises StartError if the file has no such time."""
        if not self._parts:
            allowed = "{:g} to {:g}".format(*self._range) if self._range[0] < math.inf else "a file with discs"
            raise StartError("time", "no such time in the file", f"{self._wanted}", allowed)
        columns = {name: np.concatenate([part[name] for part in self._parts]) for name in self._parts[0]}
        return {name: values.tolist() if values.dtype == object else values for name, values in columns.items()}


def _csv(path: Path, time: Instant) -> State:
    moment = _Moment(time)
    with open(path, newline="", encoding="utf-8-sig") as file:
        rows = csv.reader(_lines(file))
        names = next(rows, [])
        known = {"x", "y", "vx", "vy", *COLUMNS[2:], *LABELS}
        if wrong := [name for name in names if name not in known] or [n for n in names if names.count(n) > 1]:
            raise StartError("file", "unknown or repeated column", wrong[0], ", ".join(sorted(known)))
        if "time" not in names:
            if time != "end":
                raise StartError("time", "no time column in the file", f"{time:g}", '"end"')
            moment.begin(0.0)
            moment.add(_state_columns(dict.fromkeys(names, np.empty(0, object))))
        for cells in _chunks((row for row in rows if row), len(names)):
            texts = dict(zip(names, cells.T, strict=True))
            times = np.array(texts["time"], float) if "time" in texts else np.zeros(len(cells))
            now = float(times.max()) if time == "end" else time
            if moment.wants(now):
                if now != moment.time:
                    moment.begin(now)
                moment.add(_state_columns({name: column[times == now] for name, column in texts.items()}))
    return moment.columns(), 0.0


def _state_columns(texts: dict[str, np.ndarray]) -> dict[str, Any]:
    """Convert columns of text, by name, to the columns of a state."""
    columns: dict[str, Any] = {}
    for name in (name for name in COLUMNS[2:] if name in texts):
        columns[name] = texts[name] if name == "species" else np.array(texts[name], float)
    for name, parts in (("position", ("x", "y")), ("velocity", ("vx", "vy"))):
        if name == "position" or parts[0] in texts or parts[1] in texts:
            columns[name] = np.column_stack([np.array(texts[part], float) for part in parts])
    return columns


def _gsd(path: Path, time: Instant) -> State:
    import gsd.hoomd

    moment = _Moment(time)
    with gsd.hoomd.open(str(path), "r") as file:
        wanted = None
        for k in range(len(file)):
            has_time = file.file.chunk_exists(frame=k, name="log/time")
            now = float(file.file.read_chunk(frame=k, name="log/time")[0]) if has_time else float(k)
            if moment.wants(now):
                moment.begin(now)
                wanted = k
        if wanted is None:
            return moment.columns(), 0.0
        for k in (wanted, 0):  # a frame that does not store its number of discs has as many as the first frame
            if file.file.chunk_exists(frame=k, name="particles/N"):
                _check_number(int(file.file.read_chunk(frame=k, name="particles/N")[0]))
        frame = file[wanted]
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
"""Column of a state that corresponds to each property of extended XYZ."""


def _extxyz(path: Path, time: Instant) -> State:
    moment = _Moment(time)
    with open(path, encoding="utf-8") as file:
        lines, frame = _lines(file), 0
        while first := next(lines, "").strip():
            discs, head = int(first), next(lines, "")
            _check_number(discs)
            stated = re.search(r"\bTime=(\S+)", head)
            now = float(stated[1]) if stated else float(frame)
            rows, read = islice(lines, discs), 0
            if moment.wants(now):
                moment.begin(now)
                places = _places_of(head)
                for cells in _chunks(map(str.split, rows), max((last for _, last, _ in places.values()), default=0)):
                    moment.add(_frame_columns(cells, places))
                    read += len(cells)
            else:
                read = sum(1 for _ in rows)
            if read < discs:
                raise ValueError("a frame is incomplete")
            frame += 1
    return moment.columns(), 0.0


def _places_of(head: str) -> dict[str, tuple[int, int, str]]:
    """Return the first column, the column after the last, and the type of each property, from a frame's second line."""
    if (stated := re.search(r"\bProperties=(\S+)", head)) is None:
        raise ValueError("no Properties in the second line")
    parts, first = stated[1].split(":"), 0
    places: dict[str, tuple[int, int, str]] = {}
    for name, kind, width in zip(parts[::3], parts[1::3], map(int, parts[2::3]), strict=True):
        places.setdefault(name, (first, first + width, kind))
        first += width
    return places


def _frame_columns(cells: np.ndarray, places: dict[str, tuple[int, int, str]]) -> dict[str, np.ndarray]:
    """Convert the cells (n, columns) of a frame of extended XYZ, as text, to the columns of a state."""
    columns: dict[str, np.ndarray] = {}
    for name, (first, last, kind) in places.items():
        if name in _NAMES and kind in "RI":
            values = np.array(cells[:, first:last], float)
            columns.setdefault(_NAMES[name], values[:, :2] if last - first > 1 else values[:, 0])
        elif name == "type" or (name == "species" and "species" not in columns):
            columns["species"] = cells[:, first]
    return columns


READERS: dict[str, Callable[[Path, Instant], State]] = {".npz": _npz, ".csv": _csv, ".gsd": _gsd, ".extxyz": _extxyz}
