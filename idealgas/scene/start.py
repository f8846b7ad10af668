"""Read the discs from which a scene starts: columns by name, from a log, a file or a Python program.

| column | unit | default |
|---|---|---|
| `position` (n, 2) | length | required; `x` and `y` in a .csv file |
| `velocity` (n, 2) | length/time | 0; `vx` and `vy` in a .csv file |
| `radius`, `mass` (n,) | length, mass | value in the species' table; if it has none, radius is required and mass is 1 |
| `angular_velocity` (n,) | 1/time | 0 |
| `species` (n,) | names | name of the only table [[species]], or "disc" |

A radius or mass that differs from the value in the species' table is an error.
"""

from __future__ import annotations

import math
from collections.abc import Mapping
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from idealgas.scene.discs import EXPLICIT, InitialDiscs, make_discs
from idealgas.scene.sizes import mass_of
from idealgas.toml.table import LARGEST, SMALLEST

if TYPE_CHECKING:
    from idealgas.scene.document import Document

VECTORS = ("position", "velocity")
SINGLE = 2.0**-22
"""Largest relative difference due to rounding to single precision: four roundings of 2⁻²⁴."""

COLUMNS = (*VECTORS, "radius", "mass", "angular_velocity", "species")
"""Names of the columns."""


class StartError(ValueError):
    """A start is invalid; `key` is the key of the table [start], and the other attributes are as in `Issue`."""

    def __init__(self, key: str, wrong: str, got: str, allowed: str) -> None:
        super().__init__(wrong)
        self.key, self.wrong, self.got, self.allowed = key, wrong, got, allowed


def read_start(
    scene: Document, folder: Path = Path(), columns: Mapping[str, Any] | None = None, discs: InitialDiscs | None = None
) -> tuple[InitialDiscs, dict[str, Any]]:
    """Return the initial discs of a scene, and the keys of its [start] table that follow from them.

    Args:
        scene: the scene, with valid tables.
        folder: folder to which paths are relative.
        columns: columns from a Python program.
        discs: discs stored in the log of this scene; the discs from which it starts come first.

    Raises:
        StartError: if the discs cannot be read or are invalid.
    """
    start = scene.start
    assert start is not None
    if discs is not None and start.number is not None:
        return discs.first(start.number), {}
    given = [key for key in ("log", "file") if getattr(start, key) is not None]
    if len(given) != (columns is None):
        raise StartError(
            "log", "exactly one source of discs is required", " and ".join(given) or "nothing", "either log or file"
        )
    update: dict[str, Any] = {}
    if columns is None:
        path = (folder / (start.source or "")).absolute()
        # Imported here because the log module imports scenes, which import this module.
        module = "idealgas.log.start" if start.log is not None else "idealgas.initial.files"
        columns, state_overlap = import_module(module).read_state(path, start.time)
        update = {given[0]: str(path), "overlap": state_overlap if start.overlap is None else start.overlap}
    key = given[0] if given else "discs"
    box, shear = scene.box, scene.properties.shear
    start_discs = _checked(columns, key, {s.name: s for s in scene.species}).wrapped(box.size, box.periodic, shear)
    if start.velocities == "reversed":
        start_discs = start_discs.reversed()
    return start_discs, update


def _checked(columns: Mapping[str, Any], key: str, tables: Mapping[str, Any]) -> InitialDiscs:
    """Check columns, and return their discs with the missing radii and masses filled in from the tables of species.

    tables: tables [[species]] by name.
    """
    if unknown := [name for name in columns if name not in COLUMNS]:
        raise StartError(key, "unknown column", str(unknown[0]), ", ".join(COLUMNS))
    if "position" not in columns:
        raise StartError(key, "no position column", ", ".join(columns) or "nothing", ", ".join(COLUMNS))
    arrays = {name: _numbers(name, values, key) for name, values in columns.items() if name != "species"}
    n = len(arrays["position"])
    if n == 0:
        raise StartError(key, "no discs", "0 rows", "at least one")
    names = _names(columns.get("species"), n, next(iter(tables)) if len(tables) == 1 else EXPLICIT, key)
    arrays = {"velocity": np.zeros((n, 2)), "angular_velocity": np.zeros(n)} | arrays
    arrays = {name: array if array.ndim else np.full(n, array) for name, array in arrays.items()}
    for name, array in arrays.items():
        if len(array) != n:
            raise StartError(
                key, f"column {name} has the wrong length", f"{len(array)} rows", f"{n}, as in column position"
            )
    kinds = np.array(names)
    for name, default in (("radius", math.nan), ("mass", 1.0)):
        given, values = name in arrays, arrays.setdefault(name, np.full(n, default))
        for table in tables.values():
            members = np.flatnonzero(kinds == table.name)
            if name == "radius" and not isinstance(table.radius, float):
                continue
            expected = table.radius if name == "radius" else mass_of(table.mass, arrays["radius"][members])
            differs = ~(np.abs(values[members] - expected) <= SINGLE * np.abs(expected)) if given else np.zeros(1, bool)
            if differs.any():
                row = int(members[differs.argmax()])
                allowed = (
                    f'{np.broadcast_to(expected, len(members))[differs.argmax()]}, the value of species "{table.name}"'
                )
                raise StartError(key, f"column {name}, disc {row}: differs from its species", f"{values[row]}", allowed)
            values[members] = expected
    for name, array in arrays.items():
        size = np.abs(array).reshape(n, -1)
        wrong = ~np.isfinite(size) | (size > LARGEST) | ((size > 0) & (size < SMALLEST))
        if name in ("radius", "mass"):
            wrong |= array.reshape(n, -1) <= 0
        if wrong.any():
            row = int(wrong.any(axis=1).argmax())
            allowed = f"numbers{' > 0' if name in ('radius', 'mass') else ''} up to {LARGEST:g}, 0 or >= {SMALLEST:g}"
            raise StartError(key, f"column {name}, disc {row}: invalid number", str(array[row].tolist()), allowed)
    return make_discs(arrays, names)


def _numbers(name: str, values: Any, key: str) -> np.ndarray:
    """Return a column as an array of numbers, (n,) or (n, 2)."""
    try:
        if np.iscomplexobj(values):
            raise TypeError
        array = np.array(values, float)
    except (TypeError, ValueError, OverflowError):
        raise StartError(key, f"column {name} is not numeric", type(values).__name__, "an array of numbers") from None
    shape = (len(array) if array.ndim else 1, *((2,) if name in VECTORS else ()))
    if (name not in VECTORS and array.ndim == 0) or array.shape == shape:
        return array
    raise StartError(
        key, f"column {name} has the wrong shape", str(array.shape), "(n, 2)" if name in VECTORS else "(n,)"
    )


def _names(values: Any, n: int, default: str, key: str) -> list[str]:
    """Return the name of each disc's species."""
    if values is None or isinstance(values, str):
        return [values or default] * n
    names = [values] if isinstance(values, bytes) else list(values)
    if len(names) != n or not all(isinstance(name, str) and 0 < len(name) <= 255 for name in names):
        wrong = "column species does not contain names"
        raise StartError(key, wrong, f"{len(names)} entries", f"{n} names")
    return [str(name) for name in names]
