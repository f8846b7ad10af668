"""Folder of a sweep: one process at a time runs a sweep in it, and finished points keep their numbers and seeds."""

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
"""Name of the lock file, by whose contents a folder is that of a sweep."""

MARK = b"idealgas sweep\n"
"""Contents of the lock file."""

Entry = TypeVar("Entry")


@contextmanager
def hold_folder(folder: Path) -> Iterator[None]:
    """Create the folder of a sweep if it is missing and lock it until the block ends.

    Unfinished files that no process is writing are removed at the beginning and at the end of the block. Nothing in a
    folder is opened for writing before its lock file shows that it is the folder of a sweep.

    Raises:
        UserError: if another process has locked it, or if it contains other files.
        OutputError: if it cannot be written.
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
    """Remove the files that processes left when they failed or were killed, as far as the file system lets it."""
    with suppress(OSError):
        for part in (*temporaries(folder), *temporaries(points_folder(folder)), *unfinished_logs(folder)):
            if not is_locked(part):  # a worker of a cluster may still be writing it
                part.unlink(missing_ok=True)


def _is_marked(folder: Path) -> bool:
    """Whether a folder has the lock file of a sweep."""
    try:
        with open_regular(folder / LOCK) as file:
            return file.read(len(MARK) + 1) == MARK
    except FileNotFoundError:
        return False


def check_outputs(folder: Path, points: Iterable[int]) -> None:
    """Raise UserError if another file has the name of one that the sweep writes. points: numbers of open points."""
    for path, kind in zip((plan_path(folder), *table_paths(folder)), (".toml", "results.csv", ".parquet"), strict=True):
        if os.path.lexists(path):
            check_output(path, kind, force=True)
    for path in (log_path(folder, index) for index in points):
        if os.path.lexists(path):
            check_output(path, LOG, force=True)
            with open_log(path) as log:
                if log.command != COMMAND:
                    raise OutputError(f"{path}: not a log of this sweep, which does not overwrite it")


def resume_numbering(sweep: Sweep, folder: Path) -> Sweep:
    """The sweep with the point numbers and seeds of a folder; writes the file of the sweep there.

    Finished points keep their numbers, wherever new values are inserted among the old ones; all others get the free
    numbers in order, so a new sweep is unchanged and a stopped one resumes as it began.

    Raises:
        UserError: if a finished point is not part of this sweep.
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
        scene = with_seed(point.scene, seed_of(sweep.seed, combination, point.replicate))
        if found and not _matches(folder, found, scene, sweep):
            raise _foreign_point(folder, found)
        index = found["point"] if found else next(free_indices)
        points.append(replace(point, index=index, combination=combination, scene=scene))
    for found in done.values():
        raise _foreign_point(folder, found)
    check_outputs(folder, (p.index for p in points if not result_path(folder, p.index).exists()))
    with replacing(plan_path(folder)) as part:
        part.write_text(sweep.text, encoding="utf-8", newline="\n")
    return replace(sweep, points=tuple(points))


def check_folder(folder: Path) -> None:
    """Raise OutputError if the folder has been removed in the meantime."""
    if not points_folder(folder).is_dir():
        raise OutputError(f"{folder}: cannot be written: {os.strerror(errno.ENOENT)}", exit_code=1)


def _labelled(entries: Iterable[tuple[dict[str, Any], int, Entry]]) -> Iterator[tuple[tuple[str, int], Entry]]:
    """Label entries by their values, their replicate and a counter of equal labels."""
    seen: Counter[str] = Counter()
    for values, replicate, entry in entries:
        text = json.dumps([values, replicate], sort_keys=True)
        yield (text, seen[text]), entry
        seen[text] += 1


def _free(taken: Iterable[int]) -> Iterator[int]:
    used = set(taken)
    return (k for k in count() if k not in used)


def _foreign_point(folder: Path, found: dict[str, Any]) -> UserError:
    where = ", ".join(f"{key} = {value}" for key, value in found["values"].items()) or "base scene"
    return UserError(
        f"{folder}: holds another sweep: point {found['point']} ({where}) is not part of this one; "
        "use another folder or remove it"
    )


def _matches(folder: Path, found: dict[str, Any], scene: Scene, sweep: Sweep) -> bool:
    """Whether stored results belong to this scene and contain the analyses of the sweep."""
    if set(found["analyses"]) != set(sweep.analyses):
        return False
    return found["scene"] == dump_document(scene) or stored_scene(folder, found) == scene
