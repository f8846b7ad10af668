"""A Python program that steers a run, killed at a random moment: its log goes on as after the last change in it."""

import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.support import ROOT

from idealgas import open_log, open_run, parse_scene, resume

pytestmark = pytest.mark.slow

SCENE = """
scene.seed = 5
box.size = [10, 10]
species = [{ name = "gas", count = 40, radius = 0.2, temperature = 1 }]
steering = {}
thermostat = { temperature = 1, rate = 0.2 }
run.until = 120
"""
STEP, CHANGES = 0.5, 200


def steer(path: Path | str, changes: int, pause: float = 0.0) -> None:
    """Make a number of changes, one each STEP; prints the number so far if it pauses after each."""
    with open_run(parse_scene(SCENE), path) as run:
        for k in range(changes):
            run.advance(until=(k + 1) * STEP)
            if k % 2:
                run.change(f"thermostat.temperature={1 + k % 5}")
            else:
                discs = [k % 40, 39]
                run.set_velocities(run.state().velocity[discs] * [-1, 0.5], discs)
            if pause:
                print(k + 1, flush=True)
                time.sleep(pause)


@pytest.mark.parametrize("case", [*range(3), *(pytest.param(case, marks=pytest.mark.long) for case in range(3, 20))])
def test_a_killed_program_leaves_a_log_that_goes_on(case, tmp_path):
    """What is in the log is whole: changes up to the last checkpoint, each with the motion after it."""
    killed, expected = tmp_path / "killed.h5", tmp_path / "expected.h5"
    program = (
        f"from pathlib import Path; import test_steered_kill as t; t.steer(Path({str(killed)!r}), {CHANGES}, 0.02)"
    )
    folders = f"{ROOT / 'tests'}:{ROOT / 'tests' / 'stability'}"
    child = subprocess.Popen(
        [sys.executable, "-c", program], stdout=subprocess.PIPE, env={**os.environ, "PYTHONPATH": folders}
    )
    last = int(np.random.default_rng(case).integers(80, CHANGES - 20))
    try:
        assert child.stdout is not None
        made = next(n for n in map(int, child.stdout) if n == last)
    finally:
        child.send_signal(signal.SIGKILL)
        child.communicate()
    with open_log(killed) as log:
        assert (log.unclosed, log.complete) == (True, False)
        done = round(log.checkpoints.times[-1].item() // STEP)
        assert len(log.changes) == done // 2
        log.state_at(log.end_time)
    assert 0 < done <= made + 1
    resume(killed)
    steer(expected, done)
    resume(expected)
    assert differences(killed, expected) == []
