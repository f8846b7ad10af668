"""Commands whose writes to a file fail: every single one, with ENOSPC, with EIO, and after half of its bytes.

As a program, in a process into which `write_faults.c` is preloaded, it runs each of COMMANDS again and again, in forks
of itself that have everything loaded, and each time another write fails. It prints what was wrong afterwards.
"""

import atexit
import ctypes
import errno
import gc
import json
import os
import shutil
import signal
import sys
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

from idealgas_cli.main import main

from helpers.support import called, output_of
from idealgas.locks import is_locked
from idealgas.log import writer

SHORT, KILL = 0, -1
FAULTS = {"ENOSPC": errno.ENOSPC, "EIO": errno.EIO, "short": SHORT}
SECONDS = 120
"""Time after which a command counts as hanging, and this program ends."""

SCENE = """
scene.seed = 5
box.size = [10, 10]
species = [{{ name = "gas", count = {discs}, radius = 0.2, temperature = 1 }}]
run.events = {events}
"""
LOG = "gas.h5"


class Command(NamedTuple):
    """A command, the log with which it begins, and the file to which writes fail."""

    arguments: Sequence[str]
    start: str = ""
    output: str = LOG


def commands(events: int) -> dict[str, Command]:
    """Commands that write logs and other files, by name. events: number at the later end of a run."""
    resume = ("resume", LOG, "--events", str(events))
    return {
        "run": Command(("run", "gas.toml", "-o", LOG)),
        "resume after a kill": Command(resume, "killed.h5"),
        "resume to a later end": Command(resume, "first.h5"),
        "recover": Command(("recover", LOG), "killed.h5"),
        "recover a copy": Command(("recover", LOG, "-o", "copy.h5"), "killed.h5", "copy.h5"),
        "export": Command(("export", LOG, "-o", "gas.h5md", "--frames", "20"), "first.h5", "gas.h5md"),
        "export a table": Command(("export", LOG, "-o", "gas.csv", "--frames", "20"), "first.h5", "gas.csv"),
        "export events": Command(("export", LOG, "-o", "gas.parquet", "--events"), "first.h5", "gas.parquet"),
    }


class Ended(NamedTuple):
    """How a command ended.

    code: exit code, or minus a signal. messages: lines of standard error. writes: number of writes to the file.
    locked: whether the process still held the lock of the file when it ended.
    """

    code: int
    messages: list[str]
    writes: int
    locked: bool


class Faults:
    """Runs commands in a folder, with the preloaded functions of a library."""

    def __init__(self, library: str, discs: int, events: int) -> None:
        """Write the scene and the logs with which commands begin, and load what the commands need."""
        self._library = ctypes.CDLL(library)
        self.commands = commands(events)
        writer.FLUSH_SECONDS = 0.0  # each checkpoint is committed at once
        Path("gas.toml").write_text(SCENE.format(discs=discs, events=3 * events // 8))
        for name, kept in (("run", "first.h5"), ("resume to a later end", "whole.h5")):
            output_of(*self.commands[name].arguments)
            shutil.copyfile(LOG, kept)
        for name in ("export", "export a table", "export events"):
            output_of(*self.commands[name].arguments)
        self._digest = output_of("digest", "whole.h5")
        Path(LOG).unlink()
        self._call(self.commands["run"], 80, KILL)
        Path(LOG).rename("killed.h5")
        self._kept = {"gas.toml", "whole.h5", "first.h5", "killed.h5"}
        gc.freeze()  # forks share what there is

    def sweep(self, name: str, fault: str, lasting: bool, first: int, every: int) -> tuple[int, list[str]]:
        """Number of faults that were made in a command, and what is wrong after them.

        Args:
            name: name of the command.
            fault: name of one of FAULTS.
            lasting: whether all later writes fail, too.
            first: number of the first write that fails.
            every: number of writes from one that fails to the next.
        """
        command, wrong, made = self.commands[name], [], 0
        while True:
            number = first + made * every
            for path in Path().iterdir():
                if path.name not in self._kept:
                    path.unlink()
            if command.start:
                shutil.copyfile(command.start, LOG)
            ended = self._call(command, number, FAULTS[fault], lasting)
            if 0 < ended.writes < number:
                return made, wrong
            made += 1
            where = f"{name}, write {number}, {fault}{' from then on' * lasting}"
            wrong += [f"{where}: {what}" for what in self._wrong(command, ended, fault == "short")]

    def _call(self, command: Command, at: int, fault: int, lasting: bool = False) -> Ended:
        """Run a command in a fork, which ends as the command would, with all that Python and HDF5 do then."""
        printed, messages, writes = paths = [Path("..", name) for name in ("output", "messages", "writes")]
        for path in paths:
            path.write_text("")
        if not (child := os.fork()):
            for descriptor, path in ((1, printed), (2, messages)):
                os.dup2(os.open(path, os.O_WRONLY), descriptor)
            output = Path(command.output)
            atexit.register(lambda: writes.write_text(f"{self._library.counted()} {is_locked(output):d}"))
            self._library.arm(command.output.encode(), at, fault, lasting)
            sys.argv = ["idealgas", *command.arguments]
            sys.exit(main(prog_name="idealgas"))
        signal.alarm(SECONDS)
        _, status = os.waitpid(child, 0)
        signal.alarm(0)
        lines = messages.read_text().splitlines()
        number, locked = map(int, (writes.read_text() or "0 0").split())
        return Ended(os.waitstatus_to_exitcode(status), lines, number, bool(locked))

    def _wrong(self, command: Command, ended: Ended, half_written: bool) -> list[str]:
        wrong = []
        if ended.code not in (0, 1):
            wrong.append(f"exit code {ended.code}: {ended.messages}")
        if ended.code == 1 and (len(ended.messages) != 1 or ": cannot be written: " not in ended.messages[0]):
            wrong.append(f"printed {ended.messages}")
        if ended.locked:
            wrong.append(f"{command.output} is still locked")
        wrong += [f"left {path}" for path in Path().iterdir() if path.name.startswith(".")]
        if command.output != LOG:
            if (ended.code == 0) != Path(command.output).exists():
                wrong.append(f"exit code {ended.code}, {command.output} exists: {Path(command.output).exists()}")
        elif Path(LOG).exists():
            again = called(*self.commands["resume to a later end"].arguments)
            if half_written and again.returncode == 2 and again.stderr.startswith(f"{LOG}: damaged: "):
                pass  # which is found by the checksum of the block that was cut
            elif again.returncode:
                wrong.append(f"not resumed: {again.stderr.strip()}")
            elif (printed := output_of("digest", LOG)) != self._digest:
                wrong.append(f"resumed to {printed.strip()}")
        elif ended.code == 0:
            wrong.append("no log")
        return wrong


if __name__ == "__main__":
    library, *numbers = sys.argv[1:6]
    discs, events, first, every = map(int, numbers)
    Path("logs").mkdir()
    os.chdir("logs")
    faults = Faults(library, discs, events)
    for name in sys.argv[6:] or faults.commands:
        for fault in FAULTS:
            for lasting in (False, True):
                made = faults.sweep(name, fault, lasting, first, every)
                print(json.dumps([name, fault, lasting, *made]), flush=True)
