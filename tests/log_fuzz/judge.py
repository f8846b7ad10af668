"""What may come out of a command on a wrong log, and the table of what did."""

import hashlib
import io
import re
import time
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager
from typing import Any, NamedTuple
from unittest.mock import patch

import h5py

from idealgas.log.source import Source
from log_fuzz.commands import Form
from log_fuzz.effect import Effect, Expect
from log_fuzz.workers import Outcome, run_form

NOTICES = re.compile(r"^[^\n]*: (?:is being written|was not closed)[^\n]*\n|^premise: [^\n]*\n", re.MULTILINE)
"""Lines on stderr that a command says of a log that it reads."""
PASSING = re.compile(r'"(?:bytes|seconds|compile_seconds|events_per_second|path)": [^\n]*|^│ bytes .*$', re.MULTILINE)
"""What is another at every run, or in another file with the same contents."""
CONTROL = re.compile(r"[\x00-\x08\x0b-\x1f\x7f]")
MEMORY = re.compile(r"out of memory|[Uu]nable to allocate|can't allocate|allocation failed|Cannot allocate")

FAILURES = (
    "crash", "timeout", "memory", "traceback", "exit code", "lines", "warning", "control characters",
    "written when refused", "wrong numbers", "other numbers",
)  # fmt: skip
FINE = ("same", "numbers", "refused")


class Reference(NamedTuple):
    """A command on the sound log: its outcome, the datasets that it reads, and seconds of the processor's time."""

    outcome: Outcome
    reads: frozenset[str]
    seconds: float = 0.0


class Verdict(NamedTuple):
    """What an outcome is called, and why."""

    name: str
    why: str = ""


@contextmanager
def readings() -> Iterator[set[str]]:
    """Paths of all datasets that are read meanwhile for what they say, and of attributes, as PATH@NAME."""
    seen: set[str] = set()
    chunk, fixed, attribute = Source._chunk, Source.fixed, Source.attribute

    def note_chunk(self: Source, path: str, start: int) -> Any:
        seen.add(path)
        return chunk(self, path, start)

    def note_fixed(self: Source, path: str) -> Any:
        seen.add(path)
        return fixed(self, path)

    def note_attribute(self: Source, path: str, name: str) -> Any:
        seen.add(f"{path}@{name}")
        return attribute(self, path, name)

    with (
        patch.object(Source, "_chunk", note_chunk),
        patch.object(Source, "fixed", note_fixed),
        patch.object(Source, "attribute", note_attribute),
    ):
        yield seen


def reference(form: Form, keep: frozenset[str]) -> Reference:
    """A command on the sound log in the current folder."""
    begun = time.process_time()
    with readings() as seen:
        outcome = run_form(form, keep)
    return Reference(outcome, frozenset(seen), time.process_time() - begun)


def judge(form: Form, outcome: Outcome, effects: Sequence[Effect], sound: Reference) -> Verdict:
    """Whether an outcome is right for what was done to the log."""
    if disorder := _disorder(outcome):
        return disorder
    if outcome.code == 2:
        return Verdict("refused")
    expected = {effect.expect for effect in effects}
    held = [e for e in effects if e.expect is Expect.BROKEN and sound.reads.issuperset(e.paths)]
    if held:
        return Verdict("wrong numbers", f"exit 0 with {held[0].what}")
    if expected <= {Expect.SAME, Expect.SAME_OR_REFUSED}:
        return same_numbers(form, outcome, [sound.outcome])
    return Verdict("numbers")


def judge_damage(form: Form, outcome: Outcome, sounds: Sequence[Outcome]) -> Verdict:
    """Whether an outcome is right for a damaged log: one line, or what one of the whole states of the log gives."""
    if disorder := _disorder(outcome):
        return disorder
    return Verdict("refused") if outcome.code == 2 else same_numbers(form, outcome, sounds)


def same_numbers(form: Form, outcome: Outcome, sounds: Sequence[Outcome]) -> Verdict:
    """Whether the numbers are those of a sound log."""
    found = comparable(outcome)
    if any(found == comparable(sound) for sound in sounds):
        return Verdict("same")
    expected = comparable(sounds[0])
    where = [name for name in {**found, **expected} if found.get(name) != expected.get(name)]
    return Verdict("other numbers", f"{', '.join(where)}: {_first_difference(found, expected, where[0])}")


def comparable(outcome: Outcome) -> dict[str, str]:
    """What of an outcome is the same at every run."""
    files = {name: hashlib.sha256(_lasting(name, data)).hexdigest() for name, data in outcome.written.items()}
    return {"code": str(outcome.code), "stdout": PASSING.sub("", outcome.out), **files}


def _lasting(name: str, data: bytes) -> bytes:
    """Of an HDF5 file, whose bytes are not the same twice, the numbers; of a log, which is a copy, nothing."""
    if name.endswith(".h5"):
        return b""
    if not data.startswith(b"\x89HDF"):
        return data
    found: list[bytes] = []

    def keep(path: str, item: object) -> None:
        if isinstance(item, h5py.Dataset):
            found.extend((path.encode(), item[()].tobytes()))

    with h5py.File(io.BytesIO(data)) as file:
        file.visititems(keep)
    return b"".join(found)


def _first_difference(found: Mapping[str, str], expected: Mapping[str, str], name: str) -> str:
    one, other = found.get(name, "nothing").splitlines(), expected.get(name, "nothing").splitlines()
    pair = next(((a, b) for a, b in zip(one, other, strict=False) if a != b), (len(one), len(other)))
    return f"{pair[0]} instead of {pair[1]}"[:200]


def _disorder(outcome: Outcome) -> Verdict | None:
    """What nothing may do, whatever the log."""
    said = NOTICES.sub("", outcome.err)
    last = outcome.err.strip().splitlines()[-1:] or [""]
    if outcome.end.startswith("SIG"):
        return Verdict("crash", f"{outcome.end} {_place(outcome.err)}")
    if outcome.end == "timeout":
        return Verdict("timeout", _place(outcome.err))
    if MEMORY.search(outcome.err):
        return Verdict("memory", last[0])
    if outcome.end == "traceback":
        return Verdict("traceback", f"{last[0][:200]} {_origin(outcome.err)}")
    if outcome.end != "exit" or outcome.code not in (0, 2):
        return Verdict("exit code", f"{outcome.end} {outcome.code}: {last[0]}")
    if outcome.warnings:
        return Verdict("warning", outcome.warnings[0])
    if CONTROL.search(outcome.out + outcome.err):
        return Verdict("control characters", repr(CONTROL.search(outcome.out + outcome.err)[0]))  # type: ignore[index]
    if outcome.code == 2 and said.count("\n") != 1:
        return Verdict("lines", f"{said.count(chr(10))} lines: {said[:300]!r}")
    if outcome.code == 2 and (outcome.out or outcome.written or outcome.changed):
        return Verdict("written when refused", f"{outcome.out[:80]!r} {list(outcome.written)} {outcome.changed}")
    return None


def _place(words: str) -> str:
    """The innermost frame of the program in what the fault handler said."""
    frames = re.findall(r'File "[^"]*?/(idealgas/[^"]*|cli/[^"]*)", line (\d+) in (\w+)', words)
    return ":".join(frames[0]) if frames else words[-200:].replace("\n", " | ")


def _origin(words: str) -> str:
    """The innermost line of the program in a traceback."""
    frames = re.findall(r'File "[^"]*?/((?:idealgas|cli)/[^"]*)", line (\d+), in (\w+)', words)
    return ":".join(frames[-1]) if frames else ""


class Table:
    """Counts of verdicts by command."""

    def __init__(self) -> None:
        self.counts: Counter[tuple[str, str]] = Counter()
        self.logs: set[int] = set()

    def add(self, number: int, form: Form, verdict: Verdict) -> None:
        """One outcome more."""
        self.logs.add(number)
        self.counts[form[0], verdict.name] += 1

    @property
    def failures(self) -> int:
        """Number of outcomes that are not right."""
        return sum(count for (_, name), count in self.counts.items() if name in FAILURES)

    def __str__(self) -> str:
        """A line for each command, and one for all."""
        seen = [name for name in (*FINE, *FAILURES) if any(verdict == name for _, verdict in self.counts)]
        commands = sorted({command for command, _ in self.counts})
        rows = [["command", *seen, "all"]]
        for command in commands:
            row = [self.counts[command, name] for name in seen]
            rows.append([command, *map(str, row), str(sum(row))])
        totals = [sum(self.counts[command, name] for command in commands) for name in seen]
        rows.append(["all", *map(str, totals), str(sum(totals))])
        widths = [max(map(len, column)) for column in zip(*rows, strict=True)]
        lines = ["  ".join(word.rjust(width) for word, width in zip(row, widths, strict=True)) for row in rows]
        return "\n".join([f"{len(self.logs)} logs", *lines])
