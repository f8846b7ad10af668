"""Run a point of a sweep on a worker: write its log, analyse the log, and write the result file."""

import json
import os
from collections.abc import Iterator
from pathlib import Path

from idealgas.analysis import registry
from idealgas.files import replacing
from idealgas.sweep.plan import Point
from idealgas.toml.dump import dump_document

COMMAND = "idealgas sweep"
"""Command that is recorded in the logs of all points."""


def points_folder(folder: str | os.PathLike[str]) -> Path:
    """Return the folder that contains the files of all points of a sweep."""
    return Path(folder) / "points"


def result_path(folder: str | os.PathLike[str], index: int) -> Path:
    """Return the path of the result file of a point, which exists once the point is done."""
    return points_folder(folder) / f"{index:04d}.json"


def log_path(folder: str | os.PathLike[str], index: int) -> Path:
    """Return the path of the log of a point."""
    return points_folder(folder) / f"{index:04d}.h5"


def unfinished_log(folder: str | os.PathLike[str], index: int) -> Path:
    """Return the path of the log of a point before it is complete."""
    return points_folder(folder) / f"{index:04d}.h5.part"


def unfinished_logs(folder: str | os.PathLike[str]) -> Iterator[Path]:
    """Yield the paths of all incomplete logs."""
    for path in points_folder(folder).glob("*.h5.part"):
        if path.name.partition(".")[0].isdecimal():
            yield path


def run_point(point: Point, folder: Path, analyses: tuple[str, ...], keep_log: bool) -> None:
    """Simulate and analyse a point.

    Each file is given its name once it is complete; the result file comes last.
    """
    from idealgas.log import open_log
    from idealgas.run.simulate import simulate

    done, log = result_path(folder, point.index), log_path(folder, point.index)
    if done.exists():
        return
    scene = point.scene
    if not keep_log:  # compressing a log that will be removed would only cost time
        scene = scene.model_copy(update={"log": scene.log.model_copy(update={"compression": "none"})})
    part = unfinished_log(folder, point.index)
    simulate(scene, part, force=True, command=COMMAND)
    with open_log(part) as opened:
        summary = {name: value for name, value in opened.summary.items() if not name.endswith("seconds")}
        results = {name: registry.analyse(opened, name).as_dict() for name in analyses}
    if keep_log:
        part.replace(log)
    else:
        part.unlink()
    contents = {
        "point": point.index,
        "seed": scene.scene.seed,
        "combination": point.combination,
        "replicate": point.replicate,
        "values": point.values,
        "scene": dump_document(point.scene),
        "summary": summary,
        "analyses": results,
    }
    text = json.dumps(contents, indent=1, allow_nan=False)
    with replacing(done) as unfinished:
        unfinished.write_text(text, encoding="utf-8", newline="\n")
