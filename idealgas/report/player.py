"""Data of the player in a report page: a state of the gas and the subsequent events, as compact arrays.

Velocities are 32-bit floats, with 24 significant bits. The page computes the flight of each disc from event to event.
Where the computed position would be off by more than ACCURACY, the data contain the position from the log, so that
positions at any time are nearly as accurate as if each were stored as a 32-bit float.
"""

import base64
from dataclasses import dataclass
from typing import Any

import numpy as np
from matplotlib import colormaps

from idealgas.columns import Kind
from idealgas.errors import UserError
from idealgas.log import Log, LogState
from idealgas.movie.order_colours import order_colours
from idealgas.movie.painter import COLOUR_MAP, CROSSING, PALEST
from idealgas.movie.panels import BRIGHTEST, FASTEST
from idealgas.movie.piston_track import piston_tracks
from idealgas.presentation.style import COLOURS
from idealgas.scene.walls import NumberedWall, walls_inside
from idealgas.tallies.bond_order import DENSE, bond_order
from idealgas.tallies.equilibrium import tends_to_equilibrium
from idealgas.tallies.stream import span
from idealgas.theory.conserved import centre_of_mass_velocity
from idealgas.theory.ensemble import classes

MOST_ROWS = 600_000
"""Largest number of event rows in a page; so many rows take up about 10 MB."""

MOST_DISCS = 100_000
SHADES = 16
MOST_INSTANTS, FEWEST_INSTANTS, MOST_NEIGHBOURHOODS = 64, 8, 2**15
"""Limits for the local order of discs in a page.

They are the largest and the smallest number of instants, and the largest product of the numbers of discs and instants.
The order is omitted if there are more discs than this product, because finding their neighbours would take longer than
the rest of the page.
"""

TICKS = 2.0**32 - 1
"""Number of ticks in the time interval of the player; event times are multiples of a tick."""

LEAP = 2**16 - 1
"""Smallest number of ticks between two events that is stored separately, in 32 bits instead of 16."""

ACCURACY = 2.0**-24
"""Largest difference between a position and that in the log, relative to the longer side of the box."""


@dataclass(frozen=True)
class Player:
    """Data of the player.

    Attributes:
        head: plain values for JSON.
        arrays: little-endian numbers as base64 text, by name.
        start: start of the time interval that can be played.
        end: end of this interval.
    """

    head: dict[str, Any]
    arrays: dict[str, str]
    start: float
    end: float


def player(log: Log, start: float | None = None, rows: int | None = None, order: bool = True) -> Player | None:
    """Return the data of the player for a log.

    The result is None if the log has no events or too many discs, or if gravity depends on time.

    Args:
        log: the log.
        start: start of the time interval; by default the start of the log.
        rows: largest number of event rows; by default MOST_ROWS.
        order: whether to include the local order ψ₆ of the discs.
    """
    gas = log.discs
    if not log.has_events or len(gas) > MOST_DISCS or log.scene.properties.later_accelerations:
        return None
    first, last = span(log, start, None)
    row, rows = log.row_at(first, "right"), rows or MOST_ROWS
    if len(log) - row > rows:
        (cut,) = log.chunks(("time",), row + rows, row + rows + 1)
        last = float(np.nextafter(cut.time[0], first))
    state = log.state_at(first)
    flow = centre_of_mass_velocity(log.scene, log.discs)
    moving = state.velocity[state.inside]
    thermal = _rms_speed(moving - flow)
    kinds = classes(gas)
    pistons, knots = _pistons(log, first, last)
    shades = colormaps[COLOUR_MAP]
    head = {
        "box": gas.box,
        "periodic": log.periodic,
        "wraps": log.wrapped_axes,
        "slide": log.scene.properties.shear * gas.box[1],
        "gravity": log.gravity,
        "positions": log.has_positions,
        "start": first,
        "end": last,
        "ticks": TICKS,
        "speed": crossing(gas.box, moving),
        "flow": flow.tolist(),
        "fastest": FASTEST * thermal,
        "mixes": tends_to_equilibrium(log),
        "brightest": BRIGHTEST * thermal,
        "colours": {"order": _hex(_order_shades()), "species": COLOURS[: len(gas.species_names)]},
        "light": _hex(shades(np.linspace(0, PALEST, SHADES))),
        "dark": _hex(shades(np.linspace(0.3, 1, SHADES))),
        "bars": COLOURS[5],
        "curve": COLOURS[0],
        "pistonColour": COLOURS[1],
        "kinds": [
            {"share": share, "mass": mass}
            for share, mass in zip((kinds.number / len(gas)).tolist(), kinds.mass.tolist(), strict=True)
        ],
        "walls": [
            {
                "name": w.label,
                "points": w.points,
                "radius": w.radius,
                "permeable": w.is_permeable,
                "absent": _absences(w, last),
            }
            for w in walls_inside(log.scene)
        ],
        "pistons": pistons,
    }
    arrays = {"radius": gas.radius, "mass": gas.mass, "species": gas.species.astype("<u2"), "velocity": state.velocity}
    if log.has_positions:
        arrays["position"] = state.position
        arrays |= _order(log, first, last) if order else {}
    arrays |= knots | _events(log, first, last, row, state)
    return Player(head, {name: _packed(a) for name, a in arrays.items()}, first, last)


def crossing(box: tuple[float, float], velocity: np.ndarray) -> float:
    """Return the simulated time per second of playback at which a typical disc crosses the box in CROSSING seconds."""
    return max(box) / CROSSING / _rms_speed(velocity)


def _rms_speed(velocity: np.ndarray) -> float:
    """Return the root-mean-square speed of discs with velocities (N, 2); 1 if they are at rest."""
    return float(np.sqrt((velocity**2).sum() / max(len(velocity), 1))) or 1.0


def _absences(wall: NumberedWall, last: float) -> list[list[float]]:
    """Return the times at which a wall opens and closes, as finite numbers."""
    return [[opens, min(closes, 2 * last + 1)] for opens, closes in wall.absences]


def _pistons(log: Log, first: float, last: float) -> tuple[list[dict[str, Any]], dict[str, np.ndarray]]:
    """Return axis, acceleration, limits and name of each piston, and its known times and positions in an interval."""
    heads: list[dict[str, Any]] = []
    knots: dict[str, np.ndarray] = {}
    for k, track in enumerate(piston_tracks(log, first, last)):
        inside = (track.time > first) & (track.time < last)
        time = np.concatenate(([first], track.time[inside], [last]))
        place = np.concatenate(([track.at(first)], track.place[inside], [track.at(last)]))
        heads.append({"axis": track.axis, "pull": float(track.pull[0]), "limits": track.limits, "name": track.name})
        knots |= {f"piston_tick_{k}": _ticks(time, first, last), f"piston_place_{k}": place}
    return heads, knots


def _ticks(time: np.ndarray, first: float, last: float) -> np.ndarray:
    """Return times between `first` and `last` as integers from 0 to TICKS."""
    return np.round((time - first) / (last - first) * TICKS).astype("<u4")


def _events(log: Log, first: float, last: float, start: int, state: LogState) -> dict[str, np.ndarray]:
    """Return the columns of the events in an interval.

    Args:
        log: the log.
        first: start of the interval.
        last: end of the interval.
        start: index of the first event row.
        state: state of all discs at the start.
    """
    names = ("time", "disc", "velocity", *(("position",) if log.has_positions else ()))
    blocks = list(log.chunks((*names, *(("kind",) if log.escapes else ())), start, log.row_at(last, "right")))
    empty = {"velocity": np.empty((0, 2)), "position": np.empty((0, 2))}
    columns = {
        name: np.concatenate([empty.get(name, np.empty(0)), *(getattr(block, name) for block in blocks)])
        for name in names
    }
    tick, disc, velocity = _ticks(columns["time"], first, last), columns["disc"].astype("<u4"), columns["velocity"]
    steps = np.diff(tick, prepend=tick.dtype.type(0))
    data = {
        "event_step": np.minimum(steps, LEAP).astype("<u2"),
        "event_leap": steps[steps >= LEAP],
        "event_disc": disc.astype("<u2") if len(log.discs) <= 2**16 else disc,
        "event_velocity": velocity,
    }
    if log.has_positions:
        time = tick / TICKS * (last - first)
        rows = _unreached(log, state, time, disc, velocity, columns["position"])
        data |= {"place_row": rows.astype("<u4"), "place": columns["position"][rows]}
    if log.escapes:
        left = np.concatenate([block.kind for block in blocks]) == Kind.ESCAPED if blocks else []
        velocity[left] = np.nan
    return data


def _unreached(
    log: Log, state: LogState, time: np.ndarray, disc: np.ndarray, velocity: np.ndarray, position: np.ndarray
) -> np.ndarray:
    """Return the events, in order, for which the page requires the position of the disc.

    The deviations in successive flights of a disc are summed, and the range of the sum is divided into cells of width
    ACCURACY. Whenever the sum enters another cell, the position is stored. The deviation since the last stored position
    is therefore less than the width of a cell.

    Args:
        log: the log.
        state: state of all discs at the start of the player.
        time: (n,), time of each event since the start, as the page computes it.
        disc: (n,), disc of each event.
        velocity: (n, 2), velocity of the disc after the event.
        position: (n, 2), position of the disc.
    """
    ids = np.arange(len(log.discs))
    order = np.argsort(np.concatenate((ids, disc)), kind="stable")  # the start of each disc, followed by its events
    place = np.concatenate((state.position, position))[order]
    speed = np.concatenate((state.velocity, velocity))[order].astype("<f4").astype(float)
    delay = np.diff(np.concatenate((np.zeros(len(ids)), time))[order])[:, None]
    off = np.diff(place, axis=0) - (speed[:-1] + np.array(log.gravity) * delay / 2) * delay
    off -= np.where(log.wrapped_axes, log.box, 0.0) * np.round(off / log.box)
    off[order[1:] < len(ids)] = 0.0  # between the last event of a disc and the start of the next disc
    cell = np.floor(off.cumsum(axis=0) / (ACCURACY * max(log.box)))
    return np.sort(order[1:][np.diff(cell, axis=0, prepend=0.0).any(axis=1)] - len(ids))


def _order_shades() -> np.ndarray:
    """Return the colours for the local order: that of no order, then each angle of ψ₆ at half and full magnitude."""
    turn = np.exp(2j * np.pi * np.arange(SHADES) / SHADES)
    return order_colours(np.concatenate(([0], 0.5 * turn, turn)))


def _order(log: Log, first: float, last: float) -> dict[str, np.ndarray]:
    """Return the shades (F, N) of all discs at F evenly spaced instants, as indices.

    The array is omitted for a dilute gas, and if the neighbours of discs cannot be determined or are too many.
    """
    dilute = log.discs.packing_fraction < DENSE
    if dilute or not log.scene.properties.fixed_walls or log.escapes or len(log.discs) > MOST_NEIGHBOURHOODS:
        return {}
    number = min(max(MOST_NEIGHBOURHOODS // len(log.discs), FEWEST_INSTANTS), MOST_INSTANTS)
    try:
        times = np.linspace(first, last, number)
        order = np.array([bond_order(s.position, log.box, log.periodic).value for s in log.frames(times)])
    except UserError:  # several discs are at the same position
        return {}
    hue = np.round(np.angle(order) / (2 * np.pi) * SHADES).astype(int) % SHADES
    level = np.digitize(np.abs(order), (1 / 3, 2 / 3))
    return {"order": np.where(level == 0, 0, 1 + SHADES * (level - 1) + hue).astype(np.uint8)}


def _packed(array: np.ndarray) -> str:
    """Return an array as base64 text; floats have 32 bits."""
    narrow = array.astype("<f4") if array.dtype.kind == "f" else array
    return base64.b64encode(np.ascontiguousarray(narrow).tobytes()).decode()


def _hex(colours: np.ndarray) -> list[str]:
    return ["#" + bytes(np.round(255 * colour[:3]).astype(np.uint8)).hex() for colour in colours]
