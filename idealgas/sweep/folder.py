"""Folder of a sweep, in which only one process at a time can run a sweep.

Finished points keep their numbers and seeds when a sweep is continued.
"""

import errno
import json
import os
from collections import Counter
from collections.abc import Iterable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import replace
from itertools import count
from pathlib import Path
from typing import Any, TypeVar

from idealgas.errors import OutputError, UserError
from idealgas.files import LOG, check_output, replacing, storage_error, temporaries
from idealgas.locks import WriteLock, is_locked, open_regular
from idealgas.log import open_log
from idealgas.scene import Scene
from idealgas.sweep.plan import Sweep, seed_of, with_seed
from idealgas.sweep.point import COMMAND, log_path, points_folder, result_path, unfinished_logs
from idealgas.sweep.results import done_points, plan_path, stored_scene, table_paths
from idealgas.toml.dump import dump_document

LOCK = ".lock"
"""Name of the lock file, whose contents mark a folder as that of a sweep."""

MARK = b"idealgas sweep\n"
"""Contents of the lock file."""

Entry = TypeVar("Entry")


@contextmanager
def hold_folder(folder: Path) -> Iterator[None]:
    """Create the folder of a sweep if it is missing, and lock it until the block ends.

    Unfinished files that no process is writing are removed at the beginning and at the end of the block. No file in an
    existing folder is opened for writing unless a lock file marks the folder as that of a sweep.

    Raises:
        UserError: if another process has locked the folder, or if the folder contains other files.
        OutputError: if the folder cannot be written.
    """
    try:
        folder.mkdir(parents=True, exist_ok=True)
        if not _is_marked(folder):
            if any(folder.iterdir()):
                raise UserError(f"{folder}: exists and is not the folder of a sweep")
            with replacing(folder / LOCK, force=False) as part:
                part.write_bytes(MARK)
        points_folder(folder).mkdir(exist_ok=True)
        held = WriteLock(folder / LOCK)
    except BlockingIOError:
        raise UserError(f"{folder}: another sweep is running in this folder") from None
    except OSError as error:
        raise storage_error(folder, error) from error
    with held:
        _remove_unfinished(folder)
        try:
            yield
        finally:
            _remove_unfinished(folder)


def _remove_unfinished(folder: Path) -> None:
    """Remove files that processes left behind when they failed or were killed, if the file system allows it."""
    with suppress(OSError):
        for part in (*temporaries(folder), *temporaries(points_folder(folder)), *unfinished_logs(folder)):
            if not is_locked(part):  # a worker on a cluster may still be writing it
                part.unlink(missing_ok=True)


def _is_marked(folder: Path) -> bool:
    """Return whether a folder has the lock file of a sweep."""
    try:
        with open_regular(folder / LOCK) as file:
            return file.read(len(MARK) + 1) == MARK
    except FileNotFoundError:
        return False


def check_outputs(folder: Path, points: Iterable[int]) -> None:
    """Raise UserError if a file that the sweep would write exists but was not written by this sweep.

    Args:
        folder: folder of the sweep.
        points: numbers of the points that have not finished.
    """
    for path, kind in zip((plan_path(folder), *table_paths(folder)), (".toml", "results.csv", ".parquet"), strict=True):
        if os.path.lexists(path):
            check_output(path, kind, force=True)
    for path in (log_path(folder, index) for index in points):
        if os.path.lexists(path):
            check_output(path, LOG, force=True)
            with open_log(path) as log:
                if log.command != COMMAND:
                    raise OutputError(f"{path}: was not written by this sweep and will not be overwritten")


def resume_numbering(sweep: Sweep, folder: Path) -> Sweep:
    """Return the sweep with the point numbers and seeds of a folder, and write the sweep file to the folder.

    Finished points keep their numbers, even if new values are inserted between old values. All other points are
    assigned the free numbers in order. A new sweep is therefore unchanged, and a stopped sweep resumes with the same
    numbers.

    Raises:
        UserError: if a finished point is not part of this sweep.
        OutputError: if the folder cannot be written.
    """
    done = dict(_labelled((stored["values"], stored["replicate"], stored) for stored in done_points(folder)))
    planned = dict(_labelled((point.values, point.replicate, point) for point in sweep.points))
    numbers = {planned[label].combination: stored["combination"] for label, stored in done.items() if label in planned}
    free, free_indices = _free(numbers.values()), _free(stored["point"] for stored in done.values())
    points = []
    for label, point in planned.items():
        stored = done.pop(label, None)
        if point.combination not in numbers:
            numbers[point.combination] = next(free)
        combination = numbers[point.combination]
        scene = with_seed(point.scene, seed_of(sweep.seed, combination, point.replicate))
        if stored and not _matches(folder, stored, scene, sweep):
            raise _foreign_point(folder, stored)
        index = stored["point"] if stored else next(free_indices)
        points.append(replace(point, index=index, combination=combination, scene=scene))
    for stored in done.values():
        raise _foreign_point(folder, stored)
    check_outputs(folder, (p.index for p in points if not result_path(folder, p.index).exists()))
    with replacing(plan_path(folder)) as part:
        part.write_text(sweep.text, encoding="utf-8", newline="\n")
    return replace(sweep, points=tuple(points))


def check_folder(folder: Path) -> None:
    """Raise OutputError if the folder has been removed since the start."""
    if not points_folder(folder).is_dir():
        raise OutputError(f"{folder}: cannot be written: {os.strerror(errno.ENOENT)}", exit_code=1)


def _labelled(entries: Iterable[tuple[dict[str, Any], int, Entry]]) -> Iterator[tuple[tuple[str, int], Entry]]:
    """Yield entries, each with a label that consists of its values, its replicate and a counter of equal labels."""
    seen: Counter[str] = Counter()
    for values, replicate, entry in entries:
        text = json.dumps([values, replicate], sort_keys=True)
        yield (text, seen[text]), entry
        seen[text] += 1


def _free(taken: Iterable[int]) -> Iterator[int]:
    used = set(taken)
    return (k for k in count() if k not in used)


def _foreign_point(folder: Path, stored: dict[str, Any]) -> UserError:
    where = ", ".join(f"{key} = {value}" for key, value in stored["values"].items()) or "base scene"
    return UserError(
        f"{folder}: contains another sweep: point {stored['point']} ({where}) is not part of this one; "
        "use another folder or remove this one"
    )


def _matches(folder: Path, stored: dict[str, Any], scene: Scene, sweep: Sweep) -> bool:
    """Return whether stored results belong to this scene and include the analyses of the sweep."""
    if set(stored["analyses"]) != set(sweep.analyses):
        return False
    return stored["scene"] == dump_document(scene) or stored_scene(folder, stored) == scene
