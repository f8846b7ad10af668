"""Commands on logs in a forked process with everything imported, within limits of time and memory.

A process goes through many commands, and is replaced after a crash or a hang, which is then known to be that of the
command it was at; only memory that one command spoils may end a later one.
"""

import faulthandler
import os
import resource
import shutil
import signal
import subprocess
import tempfile
import time
import traceback
import warnings
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from multiprocessing.connection import Connection, Pipe
from pathlib import Path
from types import MappingProxyType
from typing import Any, NamedTuple

from click.testing import CliRunner
from idealgas_cli.main import main
from support import IDEALGAS

from log_fuzz.commands import NAME, Form

MEMORY = 2**30
"""Bytes that a command may map beyond what is mapped before it."""
ALL_MEMORY = 3 * 2**30
"""Bytes that a process of its own may map: a third of it are the libraries."""
SECONDS = 10.0
"""Of the processor's time for a command; a command that waits has three times as many by the clock.

Where the sound log takes more than half of them, as on a slow machine, a command has twice what the sound log takes.
"""
COMMANDS_A_PROCESS = 400
UNSEEN = (DeprecationWarning, PendingDeprecationWarning, ImportWarning, ResourceWarning)
"""Warnings that users are not shown."""


class Outcome(NamedTuple):
    """What a command did. end: "exit", or how it came to an end otherwise. written: contents of its files by name.

    changed: whether the log is another than before.
    """

    end: str
    code: int = 0
    out: str = ""
    err: str = ""
    warnings: tuple[str, ...] = ()
    written: Mapping[str, bytes] = MappingProxyType({})
    changed: bool = False


class Task(NamedTuple):
    """A log that `make` puts at a path, which returns what it did, and commands for it.

    sound: seconds of the processor's time that each command takes on the sound log, with its imports.
    """

    number: int
    make: Callable[[Path], Any]
    forms: Sequence[Form]
    sound: Mapping[Form, float] = MappingProxyType({})

    def seconds(self, form: Form) -> float:
        """Of the processor's time for a command."""
        return max(SECONDS, 2 * self.sound.get(form, 0.0))


def run_form(form: Form, keep: frozenset[str]) -> Outcome:
    """A command on the log in the current folder. keep: names of files there that are not of its making."""
    log = Path(NAME)
    before = _signature(log)
    with warnings.catch_warnings(record=True) as caught:
        warnings.simplefilter("always")
        for kind in UNSEEN:
            warnings.simplefilter("ignore", kind)
        done = CliRunner().invoke(main, list(form))
    written = {path.name: path for path in Path.cwd().iterdir() if path.name not in keep}
    contents = {name: path.read_bytes() for name, path in written.items() if path.is_file()}
    for path in written.values():
        path.unlink()
    seen = tuple(f"{each.category.__name__}: {each.message} ({each.filename}:{each.lineno})" for each in caught)
    changed = _signature(log) != before
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        lines = traceback.format_exception(done.exception)
        return Outcome("traceback", 1, done.stdout, "".join(lines), seen, contents, changed)
    return Outcome("exit", done.exit_code, done.stdout, done.stderr, seen, contents, changed)


def outcomes(tasks: Iterable[Task]) -> Iterator[tuple[int, Any, Form, Outcome]]:
    """The outcome of every command of every task, with the task's number and what its `make` said."""
    waiting = [(task, 0) for task in tasks]
    while waiting:
        batch, count = [], 0
        while waiting and count < COMMANDS_A_PROCESS:
            count += len(waiting[0][0].forms) - waiting[0][1]
            batch.append(waiting.pop(0))
        yield from _one_process(batch, waiting)


def _one_process(batch: list[tuple[Task, int]], waiting: list) -> Iterator[tuple[int, Any, Form, Outcome]]:
    """A batch of tasks, each from one of its commands on; what is left after a crash goes to `waiting`."""
    folder = Path(tempfile.mkdtemp(prefix="log-fuzz-"))
    here, there = Pipe(duplex=False)
    child = os.fork()
    if not child:
        here.close()
        _work(there, batch, folder)
    there.close()
    try:
        last: tuple[int, Any, Form] | None = None
        for place, (task, first) in enumerate(batch):
            end, made = _answer(here, child, SECONDS)
            if end != "exit":
                if last is None or not end.startswith("SIG"):
                    raise RuntimeError(f"log {task.number} could not be made: {end}\n{_last_words(folder)}")
                yield *last, Outcome(end, err=f"some time after this command\n{_last_words(folder)}")
                waiting[:0] = [(task, first), *batch[place + 1 :]]
                return
            for at in range(first, len(task.forms)):
                form = task.forms[at]
                end, answer = _answer(here, child, task.seconds(form))
                last = task.number, made, form
                yield *last, answer if end == "exit" else Outcome(end, err=_last_words(folder))
                if end != "exit":
                    waiting[:0] = [*([(task, at + 1)] if at + 1 < len(task.forms) else []), *batch[place + 1 :]]
                    return
    finally:
        os.kill(child, signal.SIGKILL)
        os.waitpid(child, 0)
        here.close()
        shutil.rmtree(folder, ignore_errors=True)


def _answer(pipe: Connection, child: int, seconds: float) -> tuple[str, Any]:
    """How the child's present work ended, and what came out; seconds: of the processor's time that it has for it."""
    begun, (used, _) = time.monotonic(), _processor_time(child)
    while not pipe.poll(0.5):
        busy, waits = _processor_time(child)
        if busy - used > seconds or (waits and time.monotonic() - begun > 3 * seconds):
            os.kill(child, signal.SIGABRT)  # its fault handler says where it is
            pipe.poll(1)
            return "timeout", None
    try:
        return "exit", pipe.recv()
    except EOFError:
        status = os.waitid(os.P_PID, child, os.WEXITED | os.WNOWAIT)
        number = status.si_status if status else 0
        return (signal.Signals(number).name if status and status.si_code != os.CLD_EXITED else f"exit {number}"), None


def _processor_time(process: int) -> tuple[float, bool]:
    """Seconds that a process has worked, and whether it waits for something else than the processor."""
    fields = Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()
    return (int(fields[11]) + int(fields[12])) / os.sysconf("SC_CLK_TCK"), fields[0] != "R"


def _last_words(folder: Path) -> str:
    """What the C library or Python's fault handler said."""
    return (folder / "stderr").read_text(errors="replace")[-20_000:]


def _work(pipe: Connection, batch: Sequence[tuple[Task, int]], folder: Path) -> None:
    """The child: makes each log, runs its commands, and tells of each what came out. Does not return."""
    with (folder / "stderr").open("wb") as words:
        os.dup2(words.fileno(), 2)
        faulthandler.enable(words, all_threads=False)
        try:
            resource.setrlimit(resource.RLIMIT_CORE, (0, 0))
            for task, first in batch:
                place = folder / "case"
                place.mkdir()
                os.chdir(place)
                log = place / NAME
                pipe.send(task.make(log))
                whole = log.read_bytes() if log.is_file() and not log.is_symlink() else None
                keep = frozenset(path.name for path in place.iterdir())
                for form in task.forms[first:]:
                    _limit_memory()
                    outcome = run_form(form, keep)
                    if outcome.changed and whole is not None:
                        log.write_bytes(whole)
                    _limit_memory(lifted=True)
                    pipe.send(outcome)
                os.chdir(folder)
                shutil.rmtree(place)
        except BaseException:
            words.write(traceback.format_exc().encode())
            words.flush()
            os._exit(70)
        os._exit(0)


def _limit_memory(lifted: bool = False) -> None:
    mapped = int(Path("/proc/self/statm").read_text().split()[0]) * resource.getpagesize()
    _, hard = resource.getrlimit(resource.RLIMIT_AS)
    resource.setrlimit(resource.RLIMIT_AS, (hard if lifted else mapped + MEMORY, hard))


def _signature(path: Path) -> tuple[int, ...]:
    """What changes with a file."""
    try:
        status = path.lstat()
    except FileNotFoundError:
        return ()
    return status.st_ino, status.st_size, status.st_mtime_ns


def run_command(form: Form, folder: Path) -> Outcome:
    """The real command in a folder, as `run_form` has it; what it warns of is among its lines."""
    keep, before = {path.name for path in folder.iterdir()}, _signature(folder / NAME)
    try:
        done = subprocess.run(
            [IDEALGAS, *form], cwd=folder, capture_output=True, text=True, stdin=subprocess.DEVNULL,
            timeout=6 * SECONDS, preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_AS, (ALL_MEMORY, ALL_MEMORY)),
        )  # fmt: skip
    except subprocess.TimeoutExpired:
        return Outcome("timeout")
    new = [path for path in folder.iterdir() if path.name not in keep]
    written = {path.name: path.read_bytes() for path in new if path.is_file()}
    end = "exit" if done.returncode >= 0 else signal.Signals(-done.returncode).name
    end = "traceback" if "Traceback (most recent call last)" in done.stderr else end
    changed = _signature(folder / NAME) != before
    return Outcome(end, done.returncode, done.stdout, done.stderr, (), written, changed)
