"""What several tests need: gases made by hand, whole event logs in memory, and the command `idealgas`."""

import contextlib
import os
import re
import shutil
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from click.testing import CliRunner
from idealgas_cli.main import main

from idealgas.columns import BLOCK, EventBatch, empty_batch
from idealgas.engine.records import UNLIMITED
from idealgas.engine.simulation import Simulation, Stop
from idealgas.jit import EntryPoint
from idealgas.log import Log, LogError, open_log
from idealgas.run.layout import row_columns
from idealgas.run.simulate import simulate
from idealgas.scene import Scene, SceneError, parse_scene
from idealgas.state import Gas

ROOT = Path(__file__).parents[2]
IDEALGAS = shutil.which("idealgas", path=str(Path(sys.executable).parent)) or "idealgas"


def gas_of(box, position, velocity, radius, mass=1.0) -> Gas:
    """A gas of one species from arrays; radius and mass may be one number for all."""
    position = np.array(position, float)
    n = len(position)
    return Gas(
        box=(float(box[0]), float(box[1])),
        position=position,
        velocity=np.array(np.broadcast_to(velocity, (n, 2)), float),
        radius=np.array(np.broadcast_to(radius, n), float),
        mass=np.array(np.broadcast_to(mass, n), float),
        species=np.zeros(n, np.uint16),
        species_names=("gas",),
    )


def batch_for(simulation: Simulation, rows: int) -> EventBatch:
    """An empty batch with the columns that the simulation fills."""
    return empty_batch(rows, row_columns(simulation.effects, simulation.method.has_positions))


def batches(simulation: Simulation, stop: Stop, rows: int = BLOCK, events: int = UNLIMITED) -> Iterator[EventBatch]:
    """Run to the stop and yield the event rows, at most so many rows and events at a time."""
    batch = batch_for(simulation, rows)
    for count in simulation.slices(stop, batch, events):
        yield EventBatch(*(None if column is None else column[:count].copy() for column in batch))


def joined(parts: Iterable[EventBatch]) -> EventBatch:
    """The rows of all parts, one after the other."""
    columns = zip(*parts, strict=True)
    return EventBatch(*(None if column[0] is None else np.concatenate(column) for column in columns))


def record(simulation: Simulation, stop: Stop, rows: int = BLOCK, events: int = UNLIMITED) -> EventBatch:
    """Run to the stop, at most so many rows and events at a time, and return all event rows."""
    return joined(batches(simulation, stop, rows, events))


def same_rows(a: EventBatch, b: EventBatch) -> bool:
    """Whether two logs are equal, float for float."""
    return all(np.array_equal(x, y) for x, y in zip(a, b, strict=True) if x is not None or y is not None)


@contextlib.contextmanager
def uncompiled() -> Iterator[None]:
    """Run the engine in Python, with the same bits: for scenes of so few events that it takes longer to compile it."""
    compiled = EntryPoint.__call__

    def call(self: EntryPoint, *arguments: Any) -> Any:
        if self.py_func.__module__.startswith("idealgas.engine"):
            return self.py_func(*arguments)
        return compiled(self, *arguments)

    with pytest.MonkeyPatch.context() as patch, np.errstate(all="ignore"):
        patch.setattr(EntryPoint, "__call__", call)
        yield


def logged(scene: Scene, path: Path) -> Log:
    """The log of a run of a scene, open."""
    simulate(scene, path)
    return open_log(path)


def refused(text: str, *overrides: str, name: str = "<scene>") -> list[str]:
    """The lines with which a scene is refused."""
    with pytest.raises(SceneError) as caught:
        parse_scene(text, name, overrides)
    return caught.value.errors


def within(what: str, error: float, bound: float) -> None:
    """Assert a bound, and print how near to it an error came; `pytest -s` shows it."""
    print(f"worst | {what} | {error:.2g} | {bound:.2g}")
    assert error <= bound


def idealgas(*arguments: object, folder: Path | None = None, **environment: str) -> subprocess.CompletedProcess[str]:
    """The command, run in a folder to its end."""
    return subprocess.run(
        [IDEALGAS, *map(str, arguments)],
        capture_output=True,
        text=True,
        cwd=folder,
        env=os.environ | environment,
        stdin=subprocess.DEVNULL,
    )


def called(*arguments: object, folder: Path | None = None) -> subprocess.CompletedProcess[str]:
    """The same within this process, which saves the time in which Python and its packages start."""
    words = [str(argument) for argument in arguments]
    with contextlib.chdir(folder or Path.cwd()):
        done = CliRunner().invoke(main, words, prog_name="idealgas")
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        raise done.exception
    return subprocess.CompletedProcess(words, done.exit_code, done.stdout, done.stderr)


def output_of(*arguments: object, folder: Path | None = None) -> str:
    """What the command prints within this process, without errors."""
    done = called(*arguments, folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    return done.stdout


def error_of(*arguments: object, folder: Path | None = None, code: int = 2) -> str:
    """The one line with which the command fails within this process, with nothing else printed."""
    done = called(*arguments, folder=folder)
    assert (done.returncode, done.stdout, done.stderr.count("\n")) == (code, "", 1)
    return done.stderr


@contextlib.contextmanager
def started(*arguments: object, **options: Any) -> Iterator[tuple[subprocess.Popen[str], str]]:
    """Yield a command that serves a page, as a process, and the address that it prints; kill it afterwards."""
    signal.signal(signal.SIGINT, signal.default_int_handler)  # a shell's background jobs ignore it, and their children
    child = subprocess.Popen([IDEALGAS, *map(str, arguments)], stderr=subprocess.PIPE, text=True, **options)
    assert child.stderr is not None
    try:
        addresses = (re.search(r"http://127\.0\.0\.1:\d+/", line) for line in child.stderr)
        yield child, next(address[0] for address in addresses if address)
    finally:
        child.kill()
        child.wait()
        child.stderr.close()


def wait_for_rows(path: Path, rows: int, child: subprocess.Popen[Any]) -> None:
    """Wait until a process has committed so many event rows of a log."""
    deadline = time.monotonic() + 120
    while time.monotonic() < deadline:
        with contextlib.suppress(LogError), open_log(path) as log:
            if len(log) >= rows:
                return
        assert child.poll() is None
        time.sleep(0.02)
    child.kill()
    raise TimeoutError


def ended(child: subprocess.Popen[str]) -> tuple[int, str]:
    """End a process by Ctrl-C, and return its exit code and its further error messages."""
    child.send_signal(signal.SIGINT)
    _, messages = child.communicate(timeout=60)
    return child.returncode, messages


@contextlib.contextmanager
def small_disk(folder: Path, kilobytes: int) -> Iterator[Callable[[int], None]]:
    """Mount a small disk at a new folder, and yield a function that resizes it."""

    def mount(options: str) -> subprocess.CompletedProcess[bytes]:
        return subprocess.run(["mount", "-t", "tmpfs", "-o", options, "tmpfs", folder], capture_output=True)

    folder.mkdir()
    mount(f"size={kilobytes}k").check_returncode()
    try:
        yield lambda size: mount(f"remount,size={size}k").check_returncode()
    finally:
        subprocess.run(["umount", folder], check=True)


MEASURE = """
import os, subprocess, sys
child = subprocess.Popen(sys.argv[1:], stdout=subprocess.DEVNULL)
_, status, usage = os.wait4(child.pid, 0)
print(usage.ru_maxrss)
sys.exit(os.waitstatus_to_exitcode(status))
"""
"""Program that runs a command from a process of its own: Linux counts for a child what its parent has at the fork."""


def code_errors_and_memory(*arguments: object, cwd: Path) -> tuple[int, str, int]:
    """Exit code of a command in a folder, its standard error, and the most memory that it took, bytes."""
    command = [sys.executable, "-c", MEASURE, sys.executable, "-m", "idealgas", *map(str, arguments)]
    done = subprocess.run(command, cwd=cwd, capture_output=True, text=True)
    return done.returncode, done.stderr, int(done.stdout) * 1024
