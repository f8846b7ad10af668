"""Start a new scene from a state in a log: read the discs of the state, or write a scene that continues from it."""

from collections import Counter
from pathlib import Path
from typing import Any, Literal

import numpy as np

from idealgas.errors import UserError
from idealgas.log.reader import Log, open_log
from idealgas.scene.changes import Later, effects_at
from idealgas.scene.checks.overlaps import deepest_overlap
from idealgas.scene.discs import make_discs
from idealgas.scene.start import StartError
from idealgas.scene.tables import StartTable
from idealgas.toml.dump import dump_document


def read_state(path: Path, time: float | Literal["end"]) -> tuple[dict[str, Any], float]:
    """Return the columns of the discs in a log at a time, and their deepest overlap beyond rounding, length.

    Raises:
        StartError: if the log cannot be read or has no positions at this time.
    """
    try:
        with open_log(path) as log:
            return _columns(log, _instant(log, time))
    except UserError as error:
        raise StartError("log", "cannot be started from", str(error), "a log with a state at this time") from None


def _instant(log: Log, time: float | Literal["end"]) -> float:
    return log.end_time if time == "end" else time


def _columns(log: Log, time: float) -> tuple[dict[str, Any], float]:
    if not log.has_positions:
        raise UserError(f"{log.path}: its discs have no positions")
    state, discs, scene = log.state_at(time), log.discs, log.scene
    if (rate := scene.properties.shear) and not _in_step(time, rate, scene.box.size):
        width, height = scene.box.size
        allowed = f"multiples of {width / (rate * height):.6g}, at which the periodic images are aligned"
        raise UserError(f"{log.path}: with sheared sides, cannot start from t = {time:g} (allowed {allowed})")
    spin = np.zeros(len(discs)) if state.angular_velocity is None else state.angular_velocity
    here = state.inside
    if not here.any():
        raise UserError(f"{log.path}: all discs have left the gas by t = {time:g}")
    columns: dict[str, Any] = {
        "position": state.position[here],
        "velocity": state.velocity[here],
        "radius": discs.radius[here],
        "mass": discs.mass[here],
        "angular_velocity": spin[here],
        "species": [discs.species_names[k] for k in discs.species[here].tolist()],
    }
    walls = [wall for wall in scene.segments if wall.is_present(time)]
    placed, interacting = make_discs(columns, columns["species"]), scene.properties.interacting
    return columns, deepest_overlap(placed, scene.box, walls, interacting)


def _in_step(time: float, rate: float, size: tuple[float, float]) -> bool:
    """Return whether the periodic image above a sheared box is shifted by a whole number of box widths."""
    widths = rate * size[1] * time / size[0]
    return abs(widths - round(widths)) <= 1e-12 * max(widths, 1.0)


def continued_scene(log: Log, time: float | Literal["end"], source: str) -> str:
    """Return the TOML text of a scene that starts from a state in a log.

    Pistons, and values that change with time, continue from their state at this time.

    Args:
        log: the log.
        time: time of the state.
        source: path of the log, as it is to be written into the scene.

    Raises:
        UserError: if the log does not contain the positions of the discs or pistons at this time.
    """
    time, scene = _instant(log, time), log.scene
    columns, _ = _columns(log, time)
    numbers = Counter(columns["species"])
    update: dict[str, Any] = {
        "start": StartTable(log=source, time=time),
        "disc": tuple(disc for disc in scene.disc if disc.fixed),
        "box": scene.box.after(time),
        "species": tuple(
            s.model_copy(update={"count": numbers[s.name], "region": None}) for s in scene.species if numbers[s.name]
        ),
    }
    later = Later(time, numbers, lambda column: _sampled(log, column, time))
    return dump_document(scene.model_copy(update=update | effects_at(scene, later)))


def _sampled(log: Log, column: str, time: float) -> np.ndarray:
    """Return the value of a column of the samples at a time. Raises UserError if there is no sample at this time."""
    times, values = log.observables[column]
    k = int(np.abs(times - time).argmin()) if len(times) else 0
    if not len(times) or times[k] != time:
        nearest = f"; the nearest is t = {float(times[k])!r}" if len(times) else ""
        raise UserError(
            f"{log.path}: the position of the piston is stored only at samples, not at t = {time:g}{nearest}"
        )
    return values[k]
