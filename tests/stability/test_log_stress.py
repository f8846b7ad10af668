"""Random uses of three logs by several threads and processes at once: no log is lost, no lock is freed early."""

import json
import random
import subprocess
import sys
import threading
import time
from pathlib import Path

import pytest
from helpers.support import ROOT

from idealgas.errors import OutputError, UserError
from idealgas.log import LogError, open_log, recover

WORKER = """
import sys
sys.path.insert(0, sys.argv[1])
from stability.test_log_stress import work
work(sys.argv[2], int(sys.argv[3]), int(sys.argv[4]))
"""

LOGS, THREADS, PROCESSES = 3, 3, 3
EVENTS = 3000
KILLED = -9
WANTED = {
    "another run is writing this file",
    "was changed by another run while it was being read",
    "was changed by a run while it was being read",
}
"""Reasons for which an action may be refused."""


def scene(log: int):
    from idealgas.scene import load_scene

    return load_scene(ROOT / "configs" / "quickstart.toml", [f"run.events={EVENTS}", f"scene.seed={log}"])


def act(action: str, path: Path, seed: int) -> None:
    """One action on a log."""
    from idealgas.run.resume import resume
    from idealgas.run.simulate import simulate

    stop = random.Random(seed).randrange(4)
    if action == "simulate":
        reports = iter(range(stop))
        simulate(scene(int(path.stem)), path, force=True, interrupted=lambda: next(reports, None) is None)
    elif action == "resume":
        resume(path)
    elif action == "recover":
        recover(path)
    else:
        with open_log(path) as log:
            if action == "info":
                str(log), log.run_state, log.live
            elif action == "check":
                for _ in log.chunks():
                    pass


def work(folder: str, seed: int, actions: int) -> None:
    """Random actions in several threads; prints those that failed for other reasons than a writer."""
    failures: list[str] = []

    def loop(number: int) -> None:
        choose = random.Random(seed * THREADS + number)
        for _ in range(actions):
            path = Path(folder, f"{choose.randrange(LOGS)}.h5")
            action = choose.choice(["simulate", "resume", "recover", "open", "info", "check", "check"])
            try:
                act(action, path, choose.randrange(1000))
            except (LogError, OutputError) as error:
                if str(error).rpartition(": ")[2] not in WANTED:
                    failures.append(f"{action}: {error}")
            except UserError as error:
                failures.append(f"{action}: {error}")

    threads = [threading.Thread(target=loop, args=[number]) for number in range(THREADS)]
    for thread in threads:
        thread.start()
    for thread in threads:
        thread.join()
    print(json.dumps(failures))


@pytest.mark.slow
@pytest.mark.parametrize("sequences", [18, pytest.param(1000, marks=pytest.mark.long)])
def test_random_uses(tmp_path, sequences):
    """A sequence is that of one thread; a third of the processes is killed at a random moment."""
    from idealgas.run.resume import resume
    from idealgas.run.simulate import simulate

    rounds, choose = -(-sequences // (THREADS * PROCESSES)), random.Random(0)
    for log in range(LOGS):
        simulate(scene(log), tmp_path / f"{log}.h5")
    for number in range(rounds):
        seeds = [number * PROCESSES + k for k in range(PROCESSES)]
        commands = [[sys.executable, "-c", WORKER, ROOT / "tests", tmp_path, str(seed), "8"] for seed in seeds]
        children = [subprocess.Popen(command, stdout=-1, stderr=-1, text=True) for command in commands]
        time.sleep(choose.uniform(0.5, 3.0))
        children[0].kill()
        for child in children:
            output, errors = child.communicate()
            assert child.returncode in (0, KILLED), errors
            assert child.returncode == KILLED or json.loads(output) == []
        for log in range(LOGS):
            with open_log(tmp_path / f"{log}.h5") as opened:
                assert not opened.live
                assert sum(len(block.time) for block in opened.chunks()) == len(opened)
    for log in range(LOGS):
        resume(tmp_path / f"{log}.h5")
        simulate(scene(log), tmp_path / "alone.h5", force=True)
        with open_log(tmp_path / f"{log}.h5") as opened, open_log(tmp_path / "alone.h5") as alone:
            assert opened.summary["events"] == EVENTS
            for ours, expected in zip(opened.chunks(), alone.chunks(), strict=True):
                assert all(a is b is None or (a == b).all() for a, b in zip(ours, expected, strict=True))
