"""Error bars are as large as deviations from the truth: `calibration` has the method and the gases.

`tests/tools/calibration.csv` is from 2000 seeds, or as many as it says:

    PYTHONPATH=tests python -m tools.calibration --seeds 2000 --folder FOLDER
"""

import math

import numpy as np
import pytest
from tools.calibration import CASES, collect, kept, rows_of, table

LEAST_KEPT = 0.9
"""Share of a steady log that at least half of all logs keep."""

MOST_RUNS = 0.9
"""Share of runs with a caveat beyond which errors need not be right."""

QUICK = {"closed box"}
"""A gas that takes less than a minute; the others take up to two minutes each, and are run by hand."""


@pytest.mark.parametrize(
    "title", [pytest.param(title, marks=pytest.mark.slow if title in QUICK else pytest.mark.long) for title in CASES]
)
def test_errors_in_200_short_runs(title, tmp_path):
    """The rms of 200 deviations scatters by 1/√400 = 5 %, coverage by √(0.05·0.95/200) = 1.5 %; four of both."""
    collected = collect(tmp_path, 200, only=f"{title}, {CASES[title].runs[0]}")
    rows = rows_of(collected)
    print(table(rows))
    assert rows
    if CASES[title].steady:
        assert np.median(kept(collected)) >= LEAST_KEPT
    for row in (row for row in rows if not row.caveats > MOST_RUNS):
        assert 0.8 < row.rms < 1.2, row
        assert 0.95 - 4 * math.sqrt(0.05 * 0.95 / 200) < row.coverage, row


@pytest.mark.long
def test_errors_in_2000_runs(tmp_path):
    """Both lengths of all gases: hours."""
    rows = rows_of(collect(tmp_path, 2000))
    print(table(rows))
    for row in (row for row in rows if not row.caveats > MOST_RUNS):
        assert 0.9 < row.rms < 1.1, row
        assert 0.93 < row.coverage < 0.97, row
