"""Gases of equal discs as text, logs of scenes, each made once, and refusals of what is done with them."""

import tempfile
import weakref
from collections.abc import Callable
from itertools import count
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from helpers.support import ROOT
from idealgas.columns import SIDES
from idealgas.errors import UserError
from idealgas.log import Log, open_log
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene, parse_scene
from idealgas.tallies.stream import stream

FOLDER = tempfile.TemporaryDirectory(prefix="idealgas-logs-", ignore_cleanup_errors=True)
NUMBER = count()
KEPT: dict[tuple[str | Path, ...], Log] = {}
MOST = 300_000_000
"""Bytes of all logs that are kept; the file of any other goes with its last user."""

PERIODIC = tuple(f"box.{side}='periodic'" for side in SIDES)
"""Overrides that join all sides."""


def species(name: str, number: int, radius: float, **more: Any) -> str:
    """A species as text, at temperature 1 unless given. more: temperature or speed, mass and other keys."""
    keys = {"name": name, "count": number, "radius": radius} | ({} if "speed" in more else {"temperature": 1}) | more
    return "[[species]]\n" + "".join(f"{key} = {value!r}\n" for key, value in keys.items())


def gas(number: int, radius: float, box: tuple[float, float], run: str, *, periodic: str = "", **more: Any) -> str:
    """A scene of equal discs of the species `gas` as text.

    run: a line of [run]. periodic: axes along which the sides are joined. more: the seed, another name, further keys of
    the species, and further lines, `then`.
    """
    then, name, seed = more.pop("then", ""), more.pop("name", "gas"), more.pop("seed", None)
    joined = "".join(f"box.{side} = 'periodic'\n" for side, axis in zip(SIDES, "xxyy", strict=True) if axis in periodic)
    header = "" if seed is None else f"scene.seed = {seed}\n"
    return f"{header}box.size = {list(box)}\n{joined}run.{run}\n{then}\n" + species(name, number, radius, **more)


def log_of(scene: str | Path, *overrides: str) -> Log:
    """The open log of a scene, given as text, by its path, or by the name of a shipped one, with overrides."""
    if (key := (scene, *overrides)) not in KEPT:
        path = Path(FOLDER.name, f"{next(NUMBER)}.h5")
        if isinstance(scene, str) and "=" in scene:
            simulate(parse_scene(scene, overrides=overrides), path)
        else:
            shipped = ROOT / "configs" / f"{scene}.toml"
            simulate(load_scene(scene if isinstance(scene, Path) else shipped, overrides), path)
        log = KEPT[key] = open_log(path)
        weakref.finalize(log, path.unlink, missing_ok=True)
        while len(KEPT) > 1 and sum(kept.path.stat().st_size for kept in KEPT.values()) > MOST:
            del KEPT[next(iter(KEPT))]
    return KEPT[key]


def streamed(log: Log, edges: np.ndarray, *tallies: Any) -> Any:
    """One tally or several, after the events of a log between the first and the last edge."""
    stream(log, edges, list(tallies))
    return tallies if len(tallies) > 1 else tallies[0]


def raised(
    words: str,
    action: Callable[..., Any],
    *arguments: Any,
    error: type[UserError] = UserError,
    code: int = 2,
    **options: Any,
) -> str:
    """The line, with these words, with which an action is refused, and the exit code that it has."""
    with pytest.raises(error, match=words) as caught:
        action(*arguments, **options)
    assert "\n" not in str(caught.value)
    assert caught.value.exit_code == code
    return str(caught.value)
