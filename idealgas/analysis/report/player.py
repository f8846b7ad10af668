"""What the page of a report needs to move the discs: a state, and the events after it, as compact arrays.

The page flies each disc from its last event, as a log's reader does, so that every instant is exact up to the 24 bits
of a 32-bit float.
"""

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps

from idealgas.analysis.core.composition import composition
from idealgas.analysis.core.style import COLOURS
from idealgas.analysis.core.window import span
from idealgas.analysis.movie.painter import BRIGHTEST, COLOUR_MAP, CROSSING, FASTEST, PALEST
from idealgas.analysis.movie.piston_track import piston_track
from idealgas.events import Kind
from idealgas.log import Log
from idealgas.scene.walls import walls_inside

MOST_ROWS = 600_000
"""Events that are put into a page, about 19 MB."""

MOST_DISCS = 100_000
SHADES = 16
TICKS = 2.0**32 - 1
"""Times are whole numbers of the player's span over this many."""


@dataclass(frozen=True)
class Player:
    """head: plain values for JSON. arrays: little-endian bytes, base64, by name. start, end: of what is played."""

    head: dict[str, Any]
    arrays: dict[str, str]
    start: float
    end: float


def player(log: Log, start: float | None = None) -> Player | None:
    """From `start`, by default the log's own, as far as the page can hold; None if it has no events or many discs."""
    gas = log.discs
    if not log.has_events or len(gas) > MOST_DISCS:
        return None
    first, last = span(log, start, None)
    rows = log.row_at(first, "right")
    if len(log) - rows > MOST_ROWS:
        (cut,) = log.chunks(("time",), rows + MOST_ROWS, rows + MOST_ROWS + 1)
        last = float(np.nextafter(cut.time[0], first))
    state = log.state_at(first)
    typical = float(np.sqrt((state.velocity**2).sum(axis=1).mean())) or 1.0
    species = composition(gas)
    shades = colormaps[COLOUR_MAP]
    head = {
        "box": gas.box,
        "periodic": log.periodic,
        "gravity": log.gravity,
        "positions": log.has_positions,
        "start": first,
        "end": last,
        "ticks": TICKS,
        "speed": max(gas.box) / CROSSING / typical,
        "fastest": FASTEST * typical,
        "brightest": BRIGHTEST * typical,
        "light": _hex(shades(np.linspace(0, PALEST, SHADES))),
        "dark": _hex(shades(np.linspace(0.3, 1, SHADES))),
        "bars": COLOURS[5],
        "curve": COLOURS[0],
        "pistonColour": COLOURS[1],
        "kinds": [
            {"share": share, "mass": mass}
            for share, mass in zip((species.number / len(gas)).tolist(), species.mass.tolist(), strict=True)
        ],
        "walls": [
            {"from": w.start, "to": w.end, "absent": [t if np.isfinite(t) else None for t in w.absence]}
            for w in walls_inside(log.scene)
        ],
        "piston": _piston(log, first, last),
    }
    arrays = {"radius": gas.radius, "mass": gas.mass, "velocity": state.velocity}
    if log.has_positions:
        arrays["position"] = state.position
    return Player(head, {name: _packed(a) for name, a in arrays.items()} | _events(log, first, last, rows), first, last)


def _piston(log: Log, first: float, last: float) -> dict[str, Any] | None:
    """Where it begins and ends, and how it falls in between; the events of the page tell where discs hit it."""
    track = piston_track(log, first, last)
    if track is None or log.scene.piston is None:
        return None
    return {
        "axis": track.axis,
        "outward": log.scene.piston.outward,
        "pull": track.pull,
        "limits": track.limits,
        "ends": [track.at(first), track.at(last)],
    }


def _events(log: Log, first: float, last: float, start: int) -> dict[str, str]:
    """Columns of the events after the first time up to the last, and which of them were hits of the piston."""
    names = ("time", "disc", "kind", "velocity", *(("position",) if log.has_positions else ()))
    blocks = list(log.chunks(names, start, log.row_at(last, "right")))
    empty = {"velocity": np.empty((0, 2)), "position": np.empty((0, 2))}
    columns = {
        name: np.concatenate([empty.get(name, np.empty(0)), *(getattr(block, name) for block in blocks)])
        for name in names
    }
    ticks = np.round((columns.pop("time") - first) / (last - first) * TICKS)
    hits = np.flatnonzero(columns.pop("kind") == Kind.PISTON)
    whole = {"tick": ticks, "disc": columns.pop("disc"), "hit": hits}
    columns |= {name: numbers.astype("<u4") for name, numbers in whole.items()}
    return {f"event_{name}": _packed(column) for name, column in columns.items()}


def _packed(array: np.ndarray) -> str:
    """Floats with 32 bits, base64."""
    narrow = array.astype("<f4") if array.dtype.kind == "f" else array
    return base64.b64encode(np.ascontiguousarray(narrow).tobytes()).decode()


def _hex(colours: np.ndarray) -> list[str]:
    return ["#" + bytes(np.round(255 * colour[:3]).astype(np.uint8)).hex() for colour in colours]
