"""Results of a sweep as one table, with a row for each number from an analysis of a point."""

import csv
import json
import os
from collections.abc import Iterator
from importlib.util import find_spec
from pathlib import Path
from typing import Any

from idealgas.analysis.core.caveats import origin_of
from idealgas.analysis.core.result import Origin
from idealgas.errors import UserError
from idealgas.files import replacing
from idealgas.scene import parse_scene
from idealgas.sweep.point import points_folder

KEYS = {"point", "seed", "combination", "replicate", "values", "scene", "summary", "analyses"}
"""Keys of the result file of a point."""

ESTIMATE = ("value", "standard_error", "independent_samples", "theory", "theory_error", "deviation")


RESULT = ("analysis", "quantity", *ESTIMATE, "caveats")
"""Columns of results.csv after those that identify the point."""


def read_points(folder: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """Read the result files of a sweep in the order of its points.

    Raises:
        UserError: if there are none, or if one cannot be read.
    """
    if found := done_points(folder):
        return found
    raise UserError(f"{folder}: holds no results of a sweep")


def done_points(folder: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """Like `read_points`, but an empty list if the sweep has no results yet."""
    paths = sorted(points_folder(folder).glob("[0-9]*.json"), key=lambda path: int(path.stem))
    try:
        found = [json.loads(path.read_text()) for path in paths]
    except (OSError, ValueError) as error:
        raise UserError(f"{folder}: damaged results ({error})") from None
    for path, point in zip(paths, found, strict=True):
        if not isinstance(point, dict) or set(point) != KEYS:
            raise UserError(f"{path}: damaged results (allowed {', '.join(sorted(KEYS))})")
    return found


def stored_results(folder: str | os.PathLike[str], analysis: str) -> Iterator[tuple[str, dict[str, Any], Origin]]:
    """Yield the label (the values of the axes), the stored result of an analysis and the run of each point of a sweep.

    Raises:
        UserError: if the sweep does not have this analysis.
    """
    for point in read_points(folder):
        if analysis not in point["analyses"]:
            raise UserError(f'{folder}: the sweep does not include the analysis "{analysis}"')
        label = ", ".join(f"{key} = {value}" for key, value in point["values"].items()) or "base scene"
        run = origin_of(parse_scene(point["scene"]), f"{folder}, point {point['point']}")
        yield label, point["analyses"][analysis], run


def result_rows(folder: str | os.PathLike[str]) -> list[dict[str, Any]]:
    """The rows of `results.csv`: one for each number of each point, by the names of the columns.

    Raises:
        UserError: if there are no results, or if one cannot be read.
    """
    return [row for point in read_points(folder) for row in _rows(point)]


def write_tables(folder: str | os.PathLike[str]) -> list[Path]:
    """Write `results.csv` and, if pyarrow is installed, `results.parquet` from all result files; return their paths."""
    rows = result_rows(folder)
    names = list(dict.fromkeys(name for row in rows for name in row))
    identify = [name for name in names if name not in RESULT]
    names = [*identify, *(name for name in RESULT if name in names)]
    tables = [Path(folder) / "results.csv"]
    with replacing(tables[0]) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, names, restval="")
        writer.writeheader()
        writer.writerows(rows)
    if find_spec("pyarrow"):
        import pyarrow
        from pyarrow import parquet

        tables.append(Path(folder) / "results.parquet")
        columns = {name: [row.get(name) for row in rows] for name in names}
        with replacing(tables[-1]) as part:
            parquet.write_table(pyarrow.table(columns), part)
    return tables


def _rows(point: dict[str, Any]) -> Iterator[dict[str, Any]]:
    labels = {name: point[name] for name in ("point", "replicate", "seed")}
    labels |= {key: json.dumps(v) if isinstance(v, list) else v for key, v in point["values"].items()}
    for name, value in point["summary"].items():
        if isinstance(value, bool | int | float):
            yield {**labels, "analysis": "run", "quantity": name, "value": float(value)}
    for analysis, found in point["analyses"].items():
        caveats = {"caveats": " ".join(found["caveats"])}
        for quantity, estimate in _estimates(found):
            yield {**labels, "analysis": analysis, "quantity": quantity, **estimate, **caveats}


def _estimates(found: Any, path: tuple[str, ...] = ()) -> Iterator[tuple[str, dict[str, float | None]]]:
    """Numbers in a result by their path in it; series are left out.

    An entry of a list is named by its texts or, without texts, by its index.
    """
    if isinstance(found, dict):
        if set(ESTIMATE) <= found.keys():
            yield "/".join(path), {name: found[name] for name in ESTIMATE}
            return
        for name, value in found.items():
            yield from _estimates(value, (*path, name))
    elif isinstance(found, list):
        for k, entry in enumerate(found):
            if isinstance(entry, dict):
                label = ", ".join(value for value in entry.values() if isinstance(value, str)) or str(k)
                yield from _estimates(entry, (*path, label))
    elif isinstance(found, int | float):
        yield "/".join(path), {"value": float(found)}
