"""A writer killed at a random moment: no row that a reader has seen is lost, and the log can be continued."""

import signal
import time

import numpy as np
import pytest
from helpers.log_samples import check, rows_in, start_writer, write_rows

from idealgas.columns import BLOCK
from idealgas.log import LogWriter, open_log, recover

pytestmark = pytest.mark.slow

IN_CI, BY_HAND = 6, 100


@pytest.mark.parametrize(
    "case", [*range(IN_CI), *(pytest.param(case, marks=pytest.mark.long) for case in range(IN_CI, BY_HAND))]
)
def test_nothing_committed_is_lost(case, tmp_path):
    random = np.random.default_rng(case)
    path = tmp_path / "run.h5"
    batch = [] if case % 3 == 0 else [str(random.integers(1, 20_000))]
    child = start_writer(path, ("gzip", "none")[case % 2], *batch)
    try:
        end = time.monotonic() + random.uniform(0, 1)
        seen = 0
        while time.monotonic() < end:
            seen = rows_in(path)
    finally:
        child.send_signal(signal.SIGKILL)
        child.wait()
    with open_log(path) as log:
        rows = check(log)
        assert rows >= seen
        checkpoints = len(log.checkpoints)
    if case % 2:
        assert recover(path) == rows
        with open_log(path) as log:
            assert check(log) == rows
    with LogWriter.resume(path, int(random.integers(checkpoints))) as writer:
        stop = writer.rows + int(random.integers(2 * BLOCK))
        write_rows(writer, stop)
        writer.close({"end_time": stop * 2.0**-10})
    with open_log(path) as log:
        assert check(log) == stop
        assert log.complete
