"""Collect the results of a sweep in one table, with a row for each number that an analysis of a point returned."""

import csv
import io
import json
import math
import os
import re
from collections.abc import Iterator, Sequence
from importlib.util import find_spec
from itertools import count
from pathlib import Path
from typing import Annotated, Any

import numpy as np
from pydantic import BaseModel, ConfigDict, Field, TypeAdapter, ValidationError

from idealgas.analysis.caveats import origin_of
from idealgas.analysis.result import Origin
from idealgas.errors import UserError
from idealgas.files import replacing
from idealgas.locks import regular
from idealgas.presentation.quantities import ESTIMATE, rows
from idealgas.scene import Scene, SceneError, parse_scene
from idealgas.sweep.point import points_folder, result_path

MOST_BYTES = 2**26
"""Largest accepted size of the result file of a point, bytes."""

_Count = Annotated[int, Field(ge=0, lt=2**63)]


class _StoredResult(BaseModel):
    """Contents of the result file of a point."""

    model_config = ConfigDict(strict=True, extra="forbid", allow_inf_nan=False)

    point: _Count
    seed: _Count
    combination: _Count
    replicate: _Count
    values: dict[str, Any]
    scene: str
    summary: dict[str, bool | int | float | str | None]
    analyses: dict[str, dict[str, Any]]


class _Caveats(BaseModel):
    """Caveats, which the results of all analyses have in common."""

    caveats: list[str]


_estimate = TypeAdapter(dict[str, float | None], config=ConfigDict(allow_inf_nan=False))

RESULT = ("quantity", "group", *ESTIMATE, "caveats")
"""Columns in results.csv after those that identify the point."""


def read_points(folder: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """Read the result files of a sweep in the order of the points.

    Raises:
        UserError: if there are no results, or if a file cannot be read.
    """
    if points := done_points(folder):
        return points
    raise UserError(f"{folder}: contains no results of a sweep")


def missing_runs(folder: str | os.PathLike[str]) -> tuple[int, int]:
    """Return the number of runs of a sweep without results, and the total number of runs; 0, 0 if unknown."""
    done = sum(path.stem.isdecimal() for path in points_folder(folder).glob("*.json"))
    try:
        with open(plan_path(folder), encoding="utf-8", opener=regular) as file:
            head = re.match(r"# sweep of (\d+) points by idealgas\n", file.readline())
    except (OSError, ValueError):
        return 0, 0
    return (max(int(head[1]) - done, 0), int(head[1])) if head else (0, 0)


def done_points(folder: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """Return the same as `read_points`, or an empty list if the sweep has no results yet."""
    try:
        paths = sorted(path for path in points_folder(folder).glob("*.json") if path.stem.isdecimal())
    except OSError as error:
        raise UserError(f"{folder}: cannot be read: {error.strerror}") from None
    return sorted(map(_read_point, paths), key=lambda contents: contents["point"])


def _read_point(path: Path) -> dict[str, Any]:
    """Return the contents of the result file of a point. Raises UserError if they are damaged."""
    try:
        with open(path, "rb", opener=regular) as file:
            text = file.read(MOST_BYTES + 1)
        if len(text) > MOST_BYTES:
            raise ValueError(f"more than {MOST_BYTES:,} bytes")
        contents = json.loads(text.decode(), parse_constant=_refuse_constant)
        _StoredResult.model_validate(contents)
        for result in contents["analyses"].values():
            _Caveats.model_validate(result)
            for row in rows(result, ""):
                _estimate.validate_python(row.values)
        if path.name != result_path("", contents["point"]).name:
            raise ValueError(f"the file name does not match point {contents['point']}")
    except ValidationError as error:
        first = error.errors(include_url=False)[0]
        where = ".".join(map(str, first["loc"])) or "contents"
        raise UserError(f"{path}: damaged results ({where}: {first['msg']})") from None
    except (OSError, ValueError, OverflowError, RecursionError) as error:
        reason = (error.strerror if isinstance(error, OSError) else None) or str(error).splitlines()[0]
        raise UserError(f"{path}: damaged results ({reason})") from None
    return contents


def _refuse_constant(name: str) -> None:
    raise ValueError(f"{name} is not a JSON number")


def stored_scene(folder: str | os.PathLike[str], result: dict[str, Any]) -> Scene:
    """Return the scene of a stored point. Raises UserError if it is invalid."""
    try:
        return parse_scene(result["scene"], f"{result_path(folder, result['point'])}: scene")
    except SceneError as error:
        raise UserError(error.errors[0]) from None


def stored_results(folder: str | os.PathLike[str], analysis: str) -> Iterator[tuple[dict[str, Any], Origin]]:
    """Yield the stored result of an analysis, and its origin, for each point of a sweep.

    The label of the origin consists of the values on the axes.

    Raises:
        UserError: if the sweep does not include this analysis.
    """
    for point in read_points(folder):
        if analysis not in point["analyses"]:
            raise UserError(f'{folder}: the sweep does not include the analysis "{analysis}"')
        label = ", ".join(f"{key} = {value}" for key, value in point["values"].items()) or "base scene"
        run = origin_of(stored_scene(folder, point), f"{folder}, point {point['point']}", label)
        yield point["analyses"][analysis], run


def result_rows(folder: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """Return the rows of `results.csv`, one for each number at each point, by column name.

    Raises:
        UserError: if there are no results, or if a file cannot be read.
    """
    return [row for point in read_points(folder) for row in rows_of(point)]


def plan_path(folder: str | os.PathLike[str]) -> Path:
    """Return the path of the copy of the sweep file, whose first line states the number of runs."""
    return Path(folder) / "sweep.toml"


def table_paths(folder: str | os.PathLike[str]) -> tuple[Path, Path]:
    """Return the paths of `results.csv` and `results.parquet`."""
    return Path(folder) / "results.csv", Path(folder) / "results.parquet"


def write_tables(folder: str | os.PathLike[str]) -> tuple[list[Path], list[str]]:
    """Write `results.csv` and, if pyarrow is installed, `results.parquet` from all result files.

    If an existing `results.csv` contains a line that is not in the new table, it is kept under another name.

    Returns:
        Paths of the tables, and a sentence about each table that was kept.
    """
    all_rows = result_rows(folder)
    names = list(dict.fromkeys(name for row in all_rows for name in row))
    identify = [name for name in names if name not in RESULT]
    names = [*identify, *(name for name in RESULT if name in names)]
    text = io.StringIO()
    writer = csv.DictWriter(text, names, restval="")
    writer.writeheader()
    writer.writerows(all_rows)
    table, columnar = table_paths(folder)
    tables, notices = [table], list(_set_aside(table, text.getvalue()))
    with replacing(table) as part:
        part.write_bytes(text.getvalue().encode())
    if find_spec("pyarrow"):
        import pyarrow
        from pyarrow import parquet

        tables.append(columnar)
        columns = {name: [row.get(name) for row in all_rows] for name in names}
        with replacing(columnar) as part:
            parquet.write_table(pyarrow.table(columns), part)
    return tables, notices


def _set_aside(table: Path, text: str) -> Iterator[str]:
    """Rename a table if it contains a line that is not in its new text, and yield a sentence about it."""
    try:
        lines = table.read_bytes().splitlines(keepends=True)
    except FileNotFoundError:
        return
    new = set(text.encode().splitlines(keepends=True))
    for number, line in enumerate(lines, 1):
        if line not in new:
            names = (table.with_name(f"{table.stem}.previous-{k}{table.suffix}") for k in count(1))
            kept = next(path for path in names if not os.path.lexists(path))
            table.rename(kept)
            reason = "edited, or from other points"
            yield f"{table}:{number}: not a row of this sweep ({reason}); the file is kept as {kept.name}"
            return


def average(rows: Sequence[dict[str, Any]]) -> tuple[float, float]:
    """Return the average over replicates and its standard error.

    The standard error follows from the errors of the replicates, or from their scatter if the replicates have no
    errors.
    """
    values = np.array([row["value"] for row in rows], float)
    errors = [row.get("standard_error") for row in rows]
    if None not in errors:
        return float(values.mean()), math.hypot(*errors) / len(rows)  # type: ignore[arg-type]
    return float(values.mean()), float(values.std(ddof=1) / math.sqrt(len(rows))) if len(rows) > 1 else 0.0


def rows_of(point: dict[str, Any]) -> Iterator[dict[str, Any]]:
    """Yield the rows of a point, which is given as in `read_points`."""
    labels = {name: point[name] for name in ("point", "replicate", "seed")}
    labels |= {key: json.dumps(v) if isinstance(v, list) else v for key, v in point["values"].items()}
    for name, value in point["summary"].items():
        if isinstance(value, bool | int | float):
            yield {**labels, "quantity": f"run.{name}", "group": "", "value": float(value)}
    for analysis, result in point["analyses"].items():
        caveats = {"caveats": " ".join(result["caveats"])}
        for row in rows(result, analysis.replace("-", "_")):
            if row.entry is None:
                yield {**labels, "quantity": row.quantity, "group": row.group, **row.values, **caveats}
