"""Results of a study of accuracy as rows for tables and files, and as sentences."""

import csv
import json
import math
import os
from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib.figure import Figure

from idealgas.accuracy.bias import BiasLaw, bias_law
from idealgas.accuracy.study import Accuracy, AccuracyRow
from idealgas.files import check_output, storage_error, written
from idealgas.presentation.style import save
from idealgas.statistics.estimates import Estimate

TARGET = 0.01  # relative error whose cost is stated in a sentence
LOST = 0.1  # rms distance beyond which a trajectory is considered lost, diameters


def flat_row(row: AccuracyRow, study: Accuracy) -> dict[str, Any]:
    """Return the row of the CSV file for a case; numbers that were not measured are None."""
    averages, at = row.averages, nearest(study.collisions, 1.0)
    return {
        "case": row.case.name,
        "method": row.case.method,
        "dt": row.case.dt,
        "precision": row.case.precision,
        "cpu_s_per_time": row.timing.median,
        "cpu_s_per_time_least": row.timing.least,
        "cpu_s_per_time_most": row.timing.most,
        "cpu_s_per_collision": number(row.timing.per_collision),
        **with_error("rate_bias", row.rate),
        **with_error("missed_share", row.missed.share if row.missed else None),
        "missed": row.missed.missed if row.missed else None,
        "missed_of": row.missed.compared if row.missed else None,
        **with_error("z_pairs_bias", row.z_pairs),
        **with_error("z_walls_bias", row.z_walls),
        "ks_distance": averages.distance if averages else None,
        "ks_chance": averages.noise if averages else None,
        "energy_drift": averages.drift if averages else None,
        "deepest_overlap": averages.overlap if averages else None,
        "trajectory_error": None if row.trajectory is None else number(row.trajectory[at]),
        "trajectory_lost_after": lost_after(row, study),
        "way_back_error": row.way_back,
    }


def with_error(name: str, estimate: Estimate | None) -> dict[str, float | None]:
    """Return the columns of an estimate: value and standard error."""
    if estimate is None:
        return {name: None, f"{name}_error": None}
    return {name: number(estimate.value), f"{name}_error": number(estimate.standard_error)}


def number(value: float) -> float | None:
    """Return the value, or None if it is not finite."""
    return float(value) if math.isfinite(value) else None


def nearest(values: np.ndarray, target: float) -> int:
    """Return the index of the value nearest to `target`; 0 if there are no values."""
    return int(np.abs(values - target).argmin()) if len(values) else 0


def lost_after(row: AccuracyRow, study: Accuracy) -> float | None:
    """Return the collisions per disc after which the rms error of the positions exceeds LOST; None if it never does."""
    if row.trajectory is None or not (gone := row.trajectory > LOST).any():
        return None
    return float(study.collisions[int(gone.argmax())])


# sentences


def sentences(study: Accuracy) -> list[str]:
    """Return the results in sentences."""
    rate = price(study, "the collision rate", study.rate_law)
    results = [rate, _pressure(study), _missed(study), *_motion(study)]
    if study.left_out:
        results.append(f"No trajectories were compared: {study.left_out}.")
    return [sentence for sentence in results if sentence]


def cost_of(dt: float, rows: list[AccuracyRow]) -> float:
    """Return the CPU seconds per unit of simulated time for a time step, interpolated between measured time steps.

    The cost is assumed to follow a power law between neighbouring time steps.
    """
    steps = np.log([row.case.dt or 0.0 for row in rows][::-1])
    costs = np.log([row.timing.median for row in rows][::-1])
    k = int(np.clip(np.searchsorted(steps, math.log(dt)), 1, len(steps) - 1))
    slope = (costs[k] - costs[k - 1]) / (steps[k] - steps[k - 1])
    return float(math.exp(costs[k] + slope * (math.log(dt) - steps[k])))


def price(study: Accuracy, quantity: str, law: BiasLaw | None) -> str:
    """Return a sentence on the cost of a bias of TARGET with time steps; empty if no bias was significant."""
    if law is None:
        return ""
    dt = law.step(TARGET)
    cost, finer = cost_of(dt, study.steps), cost_of(law.step(TARGET / 10), study.steps)
    times = cost / study.event_driven.timing.median
    return (
        f"To compute {quantity} to {TARGET:.0%}, time steps require dt = {dt:.2g} and {times:.2g} times the CPU time "
        f"of the event-driven run, which has no such error (bias = ({law.first:+.2g} ± {law.error:.1g}) dt "
        f"{law.second:+.2g} dt²); a further factor of 10 in accuracy costs a factor of {finer / cost:.2g}."
    )


def _pressure(study: Accuracy) -> str:
    exact = study.event_driven.z_pairs
    if exact is None:
        return ""
    sentence = (
        f"The event-driven pressure deviates by {exact.value:+.2%} ± {exact.standard_error:.2%} from theory. "
        if exact.standard_error > 0
        else ""
    )
    measured = [row for row in study.steps if row.z_pairs]
    law = bias_law(np.array([row.case.dt for row in measured]), [row.z_pairs for row in measured if row.z_pairs])
    return (sentence + price(study, "the pressure of the pairs", law)).rstrip()


def _missed(study: Accuracy) -> str:
    counts = [(row.case.dt or 0.0, row.missed) for row in study.steps if row.missed and row.missed.compared]
    if not counts:
        return ""
    (coarse, most), (fine, least) = counts[0], counts[-1]
    steps, shares = np.array([(dt, m.share.value) for dt, m in counts if m.missed >= 10]).reshape(-1, 2).T
    law = ""
    if len(steps) > 1:
        slope = float(np.polyfit(np.log(steps), np.log(shares), 1)[0])
        law = f", proportional to dt^{slope:.1f} (theory for a single pair: dt^2)"
    return (
        f"At dt = {coarse:.2g} discs pass through each other in {most.share.value:.2%} of the collisions, at "
        f"dt = {fine:.2g} in {least.share.value:.2%} ± {least.share.standard_error:.2%}{law}."
    )


def _motion(study: Accuracy) -> list[str]:
    if not len(study.collisions):
        return []
    last = study.collisions[-1]
    finest = study.steps[-1]

    def life(row: AccuracyRow) -> str:
        lost = lost_after(row, study)
        return f"{lost:.2g}" if lost is not None else f"more than {last:.2g}"

    single, double, twice = study.precisions
    return [
        f"The rms path error is {LOST} diameters after {life(study.event_driven)} collisions per disc "
        f"with the 16 digits of the event-driven run, after {life(single)} with 7 digits, and after {life(finest)} "
        f"with dt = {finest.case.dt:.2g}. The reference is the double-double motion of the whole gas over "
        f"{last:.2g} collisions per disc, which takes "
        f"{twice.timing.median / study.event_driven.timing.median:.2g} times the CPU time of the event-driven run.",
        f"Double-double arithmetic takes {twice.timing.median / double.timing.median:.2g} times the time of double "
        "precision with the same method.",
    ]


# files


def accuracy_dict(study: Accuracy) -> dict[str, Any]:
    """Return plain values, ready for JSON: the rows of the CSV file, the trajectories and the sentences."""
    rows = []
    for row in study.rows:
        error = None if row.trajectory is None else [number(value) for value in row.trajectory]
        rows.append(flat_row(row, study) | {"trajectory": error})
    return {
        "title": study.title,
        "number": study.number,
        "until": study.until,
        "repeats": study.repeats,
        "collisions_per_disc": study.collisions.tolist(),
        "rows": rows,
        "sentences": sentences(study),
    }


def outputs(
    path: str | os.PathLike[str], name: str, pictures: Sequence[str] = ("",), force: bool = False
) -> list[Path]:
    """Return the paths of the output files, and create their folder if it is missing.

    Args:
        path: path of the folder.
        name: name of the files without extension.
        pictures: suffix of the name of each figure file.
        force: whether existing files may be overwritten.

    Returns:
        NAME.csv, NAME.json and a figure NAME….png for each entry in `pictures`.

    Raises:
        OutputError: if the folder cannot be created or a file cannot be written.
    """
    folder = Path(path)
    try:
        folder.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        raise storage_error(folder, error) from error
    paths = [folder / f"{name}{end}" for end in (".csv", ".json", *(f"{ending}.png" for ending in pictures))]
    for file in paths:
        check_output(file, file.suffix, force)
    return paths


def write_files(
    paths: Sequence[Path],
    result: dict[str, Any],
    rows: list[dict[str, Any]],
    figures: Sequence[Figure],
    force: bool = False,
) -> None:
    """Write the output files of a study.

    Args:
        paths: paths from `outputs`.
        result: plain values for the JSON file.
        rows: rows of the CSV file.
        figures: figures, in the order of `pictures` in `outputs`.
        force: whether to replace existing files.

    Raises:
        OutputError: if a file cannot be written.
    """
    table, numbers, *pictures = paths
    with written(table, ".csv", force) as part, part.open("w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, list(rows[0]), restval="")
        writer.writeheader()
        writer.writerows(rows)
    with written(numbers, ".json", force) as part:
        part.write_text(json.dumps(result, indent=2, allow_nan=False) + "\n", encoding="utf-8", newline="\n")
    for figure, picture in zip(figures, pictures, strict=True):
        save(figure, picture, force)
