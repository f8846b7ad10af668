"""One point of a sweep, run by a worker: its log, its analyses, and the file of its results."""

import json
import os
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from idealgas.analysis import registry
from idealgas.files import replacing
from idealgas.scene import parse_scene


@dataclass(frozen=True)
class Task:
    """Task of a worker for one point, as plain values.

    folder: of the sweep. index, combination, replicate: numbers of the point, see `Point`. values: value of each axis,
    by its key. scene: text of the scene. analyses: names of the analyses. keep_log: whether the log is kept.
    """

    folder: str
    index: int
    combination: int
    replicate: int
    values: dict[str, Any]
    scene: str
    analyses: tuple[str, ...]
    keep_log: bool


def points_folder(folder: str | os.PathLike[str]) -> Path:
    """Folder of the files of all points of a sweep."""
    return Path(folder) / "points"


def result_path(folder: str | os.PathLike[str], index: int) -> Path:
    """Path of the result file of a point, which exists when the point is done."""
    return points_folder(folder) / f"{index:04d}.json"


def log_path(folder: str | os.PathLike[str], index: int) -> Path:
    """Path of the log of a point."""
    return points_folder(folder) / f"{index:04d}.h5"


def run_point(task: Task) -> None:
    """Simulate and analyse a point; its files get their names when they are complete, the result file last."""
    from idealgas.log import open_log
    from idealgas.run.simulate import simulate

    done, log = result_path(task.folder, task.index), log_path(task.folder, task.index)
    if done.exists():
        return
    scene = parse_scene(task.scene)
    if not task.keep_log:  # the log is removed, so compression would only cost time
        scene = scene.model_copy(update={"log": scene.log.model_copy(update={"compression": "none"})})
    part = log.with_name(f"{log.name}.part")
    simulate(scene, part, force=True, command="idealgas sweep")
    with open_log(part) as opened:
        summary = {name: value for name, value in opened.summary.items() if not name.endswith("seconds")}
        results = {name: registry.analyse(opened, name).as_dict() for name in task.analyses}
    if task.keep_log:
        part.replace(log)
    else:
        part.unlink()
    labels = {
        "point": task.index,
        "seed": scene.scene.seed,
        "combination": task.combination,
        "replicate": task.replicate,
    }
    found = {**labels, "values": task.values, "scene": task.scene, "summary": summary, "analyses": results}
    text = json.dumps(found, indent=1, allow_nan=False)
    with replacing(done) as unfinished:
        unfinished.write_text(text)
