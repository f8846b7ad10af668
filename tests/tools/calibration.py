"""Calibration of error bars: many seeds of small gases, and how far their numbers are from the truth in stated errors.

For each estimate of each analysis: the root mean square of (value - truth)/error, and the share of the stated 95 %
intervals that contain the truth. If an error is right and has ν degrees of freedom, the deviation follows Student's
distribution, whose rms is √(ν/(ν - 2)): 1 for many, 1.04 for 25, and 1.10 for 12. The truth is exact theory if
available, else the mean over all seeds or, if their energies differ, a parabola in the energy.

    PYTHONPATH=tests python -m tools.calibration --seeds 2000 --folder FOLDER

continues from what it has stored in the folder, and prints the table of `calibration.csv`.
"""

import argparse
import csv
import io
import math
import tempfile
import time
from pathlib import Path
from typing import NamedTuple

import numpy as np
from scipy import stats
from tools.calibration_cases import CASES, Case
from tools.calibration_estimates import estimates

from idealgas import Log, open_log, parse_scene, simulate
from idealgas.analysis.caveats import window_caveats
from idealgas.errors import NotApplicableError
from idealgas.tallies.equilibration import measure as read_window

PART = 50
"""Number of seeds that are stored together."""

KEPT = "share kept"
"""Name of the share of a log that is used from detected equilibrium on, and whether its results have a caveat."""

Found = dict[str, np.ndarray]


class Row(NamedTuple):
    """One row of the table: name of an estimate, number of runs, rms deviation, and share of intervals that hold.

    caveats: share of the runs whose results have a caveat; nan where that is not looked at.
    """

    case: str
    run: str
    name: str
    runs: int
    rms: float
    coverage: float
    caveats: float = math.nan


def measure(case: Case, run: str, seeds: range, path: Path) -> Found:
    """Values, errors, samples and exact theory of each estimate, by its name: (seeds, 4); of KEPT share and caveat.

    Where energies differ, the energy of the run is in the place of theory; else it is nan if there is none.
    A log in which chance looks like no equilibrium has no estimates, and a share of 0.
    """
    found: dict[str, list[tuple[float, ...]]] = {}
    for seed in seeds:
        text = f"[scene]\nseed = {seed}\n{case.scene}\n[log]\ncompression = 'none'\n{case.more}[run]\n{run}\n"
        simulate(parse_scene(text), path, force=True)
        with open_log(path) as log:
            try:
                taken = [each for measured in case.measured for each in estimates(log, measured)]
                taken += [(name, each, False) for name, each in case.besides(log)]
                window = read_window(log, []) if case.steady else None
                share = window.duration / (log.end_time - log.start_time) if window else None
                said = float(bool(window and (window_caveats(window) or case.caveats(log))))
                energy = energy_of(log)
            except NotApplicableError:
                taken, share, said = [], 0.0, 1.0
        for name, each, exact in taken:
            truth = each.theory if exact and each.theory is not None else math.nan
            truth = energy if case.energies_differ else truth
            found.setdefault(name, []).append((each.value, each.standard_error, each.independent_samples, truth))
        if share is not None:
            found.setdefault(KEPT, []).append((share, said, math.nan, math.nan))
    return {name: np.array(rows) for name, rows in found.items()}


def energy_of(log: Log) -> float:
    """Energy of motion and height of all discs at the start."""
    gas = log.discs
    return float(gas.mass @ ((gas.velocity**2).sum(axis=1) / 2 - gas.position @ np.array(log.gravity)))


def row_of(case: str, run: str, name: str, result: np.ndarray) -> Row:
    """Row of the table from values, errors, samples and theory (runs, 4)."""
    value, error, samples, theory = result.T
    n = len(value)
    if CASES[case].energies_differ:
        truth, scale = np.polyval(np.polyfit(theory, value, 2), theory), math.sqrt(n / (n - 3))
    else:
        truth, scale = (theory, 1.0) if np.isfinite(theory).all() else (value.mean(), math.sqrt(n / (n - 1)))
    deviation = (value - truth) * scale / error
    held = np.abs(deviation) < stats.t.ppf(0.975, np.maximum(samples - 1, 1))
    return Row(case, run, name, n, float(np.sqrt((deviation**2).mean())), float(held.mean()))


def collect(folder: Path, seeds: int, seconds: float = math.inf, only: str = "") -> dict[tuple[str, str], Found]:
    """What was measured of the first seeds, by gas and run; what the folder lacks is simulated, for a limited time."""
    collected, end = {}, time.monotonic() + seconds
    memory = "/dev/shm" if Path("/dev/shm").is_dir() else None
    for title, run in ((title, run) for title, case in CASES.items() for run in case.runs):
        if only not in f"{title}, {run}":
            continue
        parts = []
        for first in range(0, seeds, PART):
            stored = folder / f"{title}-{run.replace(' ', '')}-{first}.npz"
            if not stored.exists() and time.monotonic() < end:
                with tempfile.TemporaryDirectory(dir=memory) as place:
                    result = measure(CASES[title], run, range(first, first + PART), Path(place) / "run.h5")
                np.savez(stored, **result)
            if stored.exists():
                with np.load(stored) as file:
                    parts.append(dict(file))
        if parts:
            collected[title, run] = {name: np.concatenate([part[name] for part in parts]) for name in parts[0]}
    return collected


def rows_of(collected: dict[tuple[str, str], Found]) -> list[Row]:
    """Rows of the table."""
    return [
        row_of(title, run, name, rows)._replace(
            caveats=float(result[KEPT][:, 1].mean()) if KEPT in result else math.nan
        )
        for (title, run), result in collected.items()
        for name, rows in result.items()
        if name != KEPT
    ]


def kept(collected: dict[tuple[str, str], Found]) -> np.ndarray:
    """Shares of all logs of steady gases that are used."""
    return np.concatenate([result[KEPT][:, 0] for result in collected.values() if KEPT in result] or [np.zeros(0)])


def table(rows: list[Row]) -> str:
    """Table in CSV: for each estimate rms deviation, coverage and share with a caveat, in short and in long runs."""
    found: dict[tuple[str, str], list[Row]] = {}
    for row in rows:
        found.setdefault((row.case, row.name), []).append(row)
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    columns = (f"{figure}_{run}" for run in ("short", "long") for figure in ("rms", "coverage", "caveats"))
    writer.writerow(("gas", "estimate", "runs", *columns))
    for (case, name), entries in found.items():
        figures = [
            figure
            for entry in entries
            for figure in (f"{entry.rms:.2f}", f"{entry.coverage:.3f}", f"{entry.caveats:.2f}".replace("nan", ""))
        ]
        figures += [""] * (6 - len(figures))
        writer.writerow((case, name, min(entry.runs for entry in entries), *figures))
    return text.getvalue()


def main() -> None:
    """Print the table."""
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--seeds", type=int, default=2000)
    parser.add_argument("--folder", type=Path, required=True)
    parser.add_argument("--seconds", type=float, default=math.inf, help="go no further after this time")
    parser.add_argument("--only", default="", help="part of the name of a gas and run")
    given = parser.parse_args()
    given.folder.mkdir(parents=True, exist_ok=True)
    collected = collect(given.folder, given.seeds, given.seconds, given.only)
    print(table(rows_of(collected)), end="")
    if not (shares := kept(collected)).size:
        return
    print(f"share of {len(shares)} steady logs that is used: median {np.median(shares):.3f},", end=" ")
    print(f"{100 * (shares < 0.9).mean():.1f} % keep less than 0.9, {100 * (shares < 0.5).mean():.1f} % less than 0.5,")
    print(f"{(shares == 0).sum()} look as if there were no equilibrium, and are left out")


if __name__ == "__main__":
    main()
