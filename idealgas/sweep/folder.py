"""Folder of a sweep: one process at a time runs a sweep in it, and what is done there is part of the sweep."""

import errno
import json
import os
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any, TypeVar

from idealgas.errors import OutputError, UserError
from idealgas.files import is_of_kind, lock, replacing, storage_error
from idealgas.scene import Scene, parse_scene
from idealgas.sweep.plan import Sweep, seed_of
from idealgas.sweep.point import points_folder
from idealgas.sweep.results import done_points
from idealgas.toml.dump import dump_document

LOCK, PLAN = ".lock", "sweep.toml"
"""Files beside the results: which a running sweep holds, and the file of the sweep."""


Entry = TypeVar("Entry")


@contextmanager
def held(folder: Path) -> Iterator[None]:
    """Make the folder of a sweep if it is not there, and hold it as long as the process lives.

    Raises:
        UserError: if another process holds it, or if it has other files.
        OutputError: if it cannot be written.
    """
    try:
        plan = folder / PLAN
        ours = (folder / LOCK).exists() or (plan.exists() and is_of_kind(plan, ".toml"))
        if not ours and folder.exists() and any(folder.iterdir()):
            raise UserError(f"{folder}: exists and is no sweep's folder")
        points_folder(folder).mkdir(parents=True, exist_ok=True)
        file = (folder / LOCK).open("w")
    except OSError as error:
        raise storage_error(folder, error) from error
    with file:
        try:
            lock(file)
        except BlockingIOError:
            raise UserError(f"{folder}: another sweep is running in this folder") from None
        yield


def continued(sweep: Sweep, folder: Path) -> Sweep:
    """The sweep with the numbers and seeds that its points have in a folder, into which its file is written.

    What is done keeps its numbers, wherever new values stand among the old ones; all else has the free numbers in
    order, so that a new sweep is as it is, and one that was stopped goes on as it began.

    Raises:
        UserError: if something that is done is not of this sweep.
        OutputError: if the folder cannot be written.
    """
    done = dict(_labelled((found["values"], found["replicate"], found) for found in done_points(folder)))
    planned = dict(_labelled((point.values, point.replicate, point) for point in sweep.points))
    numbers = {planned[label].combination: found["combination"] for label, found in done.items() if label in planned}
    free, free_indices = _free(numbers.values()), _free(found["point"] for found in done.values())
    points = []
    for label, point in planned.items():
        found = done.pop(label, None)
        if point.combination not in numbers:
            numbers[point.combination] = next(free)
        combination = numbers[point.combination]
        scene = _with_seed(point.scene, seed_of(sweep.seed, combination, point.replicate))
        if found and not _is_of(found, scene, sweep):
            raise _another(folder, found)
        index = found["point"] if found else next(free_indices)
        points.append(replace(point, index=index, combination=combination, scene=scene))
    for found in done.values():
        raise _another(folder, found)
    with replacing(folder / PLAN) as part:
        part.write_text(sweep.text, encoding="utf-8")
    return replace(sweep, points=tuple(points))


def check_folder(folder: Path) -> None:
    """Raise OutputError if the folder has been removed meanwhile."""
    if not points_folder(folder).is_dir():
        raise OutputError(f"{folder}: cannot be written: {os.strerror(errno.ENOENT)}", exit_code=1)


def _labelled(entries: Iterable[tuple[dict[str, Any], int, Entry]]) -> Iterator[tuple[tuple[str, int], Entry]]:
    """What comes with values and a replicate, by these, and by which of the same it is."""
    seen: Counter[str] = Counter()
    for values, replicate, entry in entries:
        text = json.dumps([values, replicate], sort_keys=True)
        yield (text, seen[text]), entry
        seen[text] += 1


def _free(taken: Iterable[int]) -> Iterator[int]:
    used = set(taken)
    return (k for k in count() if k not in used)


def _with_seed(scene: Scene, seed: int) -> Scene:
    return scene.model_copy(update={"scene": scene.scene.model_copy(update={"seed": seed})})


def _another(folder: Path, found: dict[str, Any]) -> UserError:
    where = ", ".join(f"{key} = {value}" for key, value in found["values"].items()) or "base scene"
    return UserError(
        f"{folder}: holds another sweep, its point {found['point']} ({where}) is none of this one: "
        "give another folder, or remove it"
    )


def _is_of(found: dict[str, Any], scene: Scene, sweep: Sweep) -> bool:
    """Whether the results of a point are those of a scene, with the analyses of the sweep."""
    if set(found["analyses"]) != set(sweep.analyses):
        return False
    return found["scene"] == dump_document(scene) or parse_scene(found["scene"]) == scene
