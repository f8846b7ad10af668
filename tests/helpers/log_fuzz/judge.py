"""Whether a command did right on a crafted log: it refused it with one line, or read no dataset that breaks a rule."""

import re
import traceback
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from pathlib import Path
from typing import Any
from unittest.mock import patch

from click.testing import CliRunner, Result
from idealgas_cli.main import main

from helpers.log_fuzz.commands import NAME, Form
from helpers.log_fuzz.editor import Effect
from idealgas.log.log_file import LogFile

NOTICES = re.compile(r"^[^\n]*: (?:is being written|was not closed)[^\n]*\n|^caveat: [^\n]*\n", re.MULTILINE)
"""Lines on stderr that are not errors."""
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")


@contextmanager
def readings() -> Iterator[set[str]]:
    """Paths of all datasets whose values are read meanwhile, and of attributes, as PATH@NAME."""
    seen: set[str] = set()
    chunk, fixed, attribute = LogFile._chunk, LogFile.fixed, LogFile.attribute

    def note_chunk(self: LogFile, path: str, start: int) -> Any:
        seen.add(path)
        return chunk(self, path, start)

    def note_fixed(self: LogFile, path: str) -> Any:
        seen.add(path)
        return fixed(self, path)

    def note_attribute(self: LogFile, path: str, name: str) -> Any:
        seen.add(f"{path}@{name}")
        return attribute(self, path, name)

    with (
        patch.object(LogFile, "_chunk", note_chunk),
        patch.object(LogFile, "fixed", note_fixed),
        patch.object(LogFile, "attribute", note_attribute),
    ):
        yield seen


def fault(form: Form, effects: Sequence[Effect]) -> str:
    """What is wrong with a command on the crafted log in the current folder; empty if nothing is."""
    log, kept = Path(NAME), {*Path.cwd().iterdir()}
    before = log.read_bytes()
    with readings() as seen:
        done = CliRunner().invoke(main, list(form))
    written = {*Path.cwd().iterdir()} - kept
    for path in written:
        path.unlink()
    changed = log.read_bytes() != before
    if changed:
        log.write_bytes(before)
    if problem := _disorder(done):
        return problem
    if done.exit_code == 2:
        left = bool(done.stdout) or bool(written) or changed
        return f"refused, but written: {done.stdout[:80]!r} {[path.name for path in written]} {changed}" if left else ""
    read = [effect for effect in effects if effect.paths and seen.issuperset(effect.paths)]
    return f"exit code 0 with {read[0].what}" if read else ""


def _disorder(done: Result) -> str:
    """Fault that is one on any log; empty if there is none."""
    if done.exception is not None and not isinstance(done.exception, SystemExit):
        return "".join(traceback.format_exception(done.exception)[-3:])
    if done.exit_code not in (0, 2):
        return f"exit code {done.exit_code}: {done.stderr[:300]!r}"
    if result := CONTROL.search(done.stdout + done.stderr):
        return f"control character {result[0]!r}"
    lines = NOTICES.sub("", done.stderr)
    return f"not one line: {lines[:300]!r}" if done.exit_code == 2 and lines.count("\n") != 1 else ""
