"""The workers and the judge of the log fuzzer see what is wrong: crashes, hangs, too much memory, and wrong numbers."""

import os
import signal
import time
import warnings
from pathlib import Path

import click
import numpy as np
import pytest
from log_fuzz import workers
from log_fuzz.commands import NAME, reading_commands
from log_fuzz.effect import broken, orderly, same
from log_fuzz.judge import Reference, judge, judge_damage
from log_fuzz.workers import Outcome, Task, outcomes

from idealgas.analysis import registry


@click.command()
@click.argument("way")
def misbehaving(way):
    """A command that does what no command may."""
    if way == "crash":
        os.kill(os.getpid(), signal.SIGSEGV)
    elif way == "hang":
        while True:
            pass
    elif way == "wait":
        time.sleep(60)
    elif way == "memory":
        np.ones(3 * 2**27)
    elif way == "traceback":
        raise ZeroDivisionError
    elif way == "warning":
        warnings.warn("odd", RuntimeWarning, stacklevel=1)
    elif way == "lines":
        click.echo("one\ntwo", err=True)
        raise SystemExit(2)
    elif way == "escape":
        print("\x1b[31mred")
    elif way == "leftover":
        Path("left.txt").write_text("x")
        click.echo("one", err=True)
        raise SystemExit(2)
    elif way == "changed":
        Path(NAME).write_text("other")
        click.echo("one", err=True)
        raise SystemExit(2)
    click.echo("42")


EXPECTED = {
    "crash": "crash", "hang": "timeout", "wait": "timeout", "memory": "memory", "traceback": "traceback",
    "warning": "warning", "lines": "lines", "escape": "control characters", "leftover": "written when refused",
    "changed": "written when refused", "nothing": "same",
}  # fmt: skip
RIGHT = Reference(Outcome("exit", 0, "42\n"), frozenset({"events/disc"}))


@pytest.mark.slow
def test_what_goes_wrong_is_seen(monkeypatch):
    """Two logs, so that those of the second are tried after each end of a process too."""
    monkeypatch.setattr(workers, "main", misbehaving)
    monkeypatch.setattr(workers, "SECONDS", 0.5)
    forms = [(way,) for way in EXPECTED]
    tasks = [Task(number, lambda path: path.write_text("log"), forms) for number in range(2)]
    found = [(number, form[0], judge(form, outcome, [], RIGHT).name) for number, _, form, outcome in outcomes(tasks)]
    assert found == [(number, way, name) for number in range(2) for way, name in EXPECTED.items()]


def test_what_takes_long_of_the_sound_log_may_take_long():
    task = Task(0, lambda path: None, [("info",), ("report",)], {("info",): 0.1, ("report",): 8.0})
    assert [task.seconds(form) for form in task.forms] == [10.0, 16.0]


@pytest.mark.parametrize(
    ("effects", "out", "verdict"),
    [
        ([broken("4 in", "events/disc")], "42\n", "wrong numbers"),
        ([broken("4 in", "events/disc", "events/kind")], "42\n", "numbers"),
        ([broken("all")], "42\n", "wrong numbers"),
        ([same("")], "42\n", "same"),
        ([same("")], "43\n", "other numbers"),
        ([same(""), orderly("")], "43\n", "numbers"),
    ],
)
def test_numbers_of_wrong_logs(effects, out, verdict):
    assert judge(("info",), Outcome("exit", 0, out), effects, RIGHT).name == verdict


def test_numbers_of_damaged_logs():
    before = Outcome("exit", 0, "41\n")
    found = [judge_damage(("info",), Outcome("exit", 0, out), [RIGHT.outcome, before]).name for out in ("41\n", "40\n")]
    assert found == ["same", "other numbers"]


def test_every_command_that_reads_a_log_is_tried():
    others = {"animate", "export", "follow", "info", "recover", "report", "resume"}
    assert set(reading_commands()) == {*registry.commands(), *others}
