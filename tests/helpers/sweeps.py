"""Sweeps as processes: start one, wait for what it does, and find what works for it."""

import contextlib
import json
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path

import psutil

from helpers.support import IDEALGAS


def start(plan: Path, folder: Path, *options: str) -> subprocess.Popen:
    """Start a sweep, with one worker if there are no options, in a process group that a test may kill."""
    command = [IDEALGAS, "sweep", str(plan), "-o", str(folder), *(options or ("--workers", "1"))]
    return subprocess.Popen(
        command, stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True, stdin=subprocess.DEVNULL,
        start_new_session=True,
    )  # fmt: skip


def wait_for(is_ready: Callable[[], object], running: subprocess.Popen) -> None:
    """Wait until something is so; fail if the process ends before."""
    while not is_ready():
        assert running.poll() is None, running.communicate()
        time.sleep(0.002)


def workers_of(running: subprocess.Popen) -> list[psutil.Process]:
    """The processes of a sweep that simulate: those of its children that the nannies spawned."""
    with contextlib.suppress(psutil.Error):
        children = psutil.Process(running.pid).children()
        return [child for child in children if any("spawn_main" in word for word in child.cmdline())]
    return []


@contextlib.contextmanager
def scheduler(folder: Path) -> Iterator[tuple[str, subprocess.Popen]]:
    """Start a scheduler with one worker, and yield its address and its process."""
    file = folder / "scheduler.json"
    file.unlink(missing_ok=True)
    programs = ("scheduler --no-dashboard --port 0 --host 127.0.0.1", "worker --no-dashboard --no-nanny --nthreads 1")
    with contextlib.ExitStack() as stack:
        started = []
        for program in programs:
            command = [sys.executable, "-m", "dask", *program.split(), "--scheduler-file", str(file)]
            started.append(stack.enter_context(subprocess.Popen(command, stdout=-3, stderr=-3, cwd=folder)))
            stack.callback(started[-1].kill)
            wait_for(lambda: file.exists() and file.stat().st_size, started[0])
        yield json.loads(file.read_text())["address"], started[0]
