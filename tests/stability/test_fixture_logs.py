"""Small logs of each kind in `cases/logs`, which every later version of the program can read and resume.

A fixture is compared with a new run of its scene: all commands must give the same numbers for both, and after a resume
both must hold the same events and checkpoints. The logs are packed (xz), as most of a small log is unused space.

A new format gets fixtures of its own, and those of the previous one stay. Within a format, this makes fixtures that are
missing:

    PYTHONPATH=tests python tests/stability/test_fixture_logs.py
"""

import json
import lzma
import math
import os
import shlex
import signal
import tempfile
import time
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np
import pytest
from helpers.log_compare import differences as unequal
from helpers.log_fuzz.commands import NAME, Form, forms, reading_commands
from helpers.support import ROOT, called, output_of

import idealgas.log.writer as log_writer
from idealgas import load_scene, open_log, parse_scene
from idealgas.log.schema import VERSION
from idealgas.run.logged_run import Progress
from idealgas.run.simulate import simulate
from idealgas.scene import Scene

FOLDER = ROOT / "tests" / "cases" / "logs"
SCENES = ROOT / "tests" / "cases" / "golden"
PACKED = ".h5.xz"
RULES = ("until", "events", "collisions_per_disc", "trials")
"""Keys of [run] that set the end of a run."""


class Fixture(NamedTuple):
    """One kind of log: the golden scene that it is of, what differs in it, and the end to which it is resumed."""

    scene: str
    overrides: tuple[str, ...]
    end: str = ""
    killed: bool = False


FIXTURES = {
    "plain": Fixture(
        "plain", ("species.0.count=16", "run.events=200", "log.pressure=true", "log.snapshot_every=1"), "run.events=300"
    ),
    "effects": Fixture(
        "everything", ("run.events=200", "restitution.normal=0.9", "log.pressure=true"), "run.events=400"
    ),
    "thermal": Fixture(
        "thermostat", ("species.0.count=20", "box.bottom={ thermal = 1 }", "run.events=200"), "run.events=300"
    ),
    "monte-carlo": Fixture("monte-carlo-rising", ("run.trials=1500",), "run.trials=2500"),
    "killed": Fixture("gates", ("species.0.count=12", "species.1.count=4", "run.events=400"), killed=True),
}

PASSING = {"path", "bytes", "created", "command", "runs", "seconds", "compile_seconds", "events_per_second", "versions"}
"""Keys of results that differ between two runs of a scene."""
RELATIVE, ABSOLUTE = 1e-12, 1e-14
"""Bounds on the difference of two results; the second for those that are zero but for rounding."""


def with_end(scene_text: str, end: str) -> Scene:
    """The scene of a log, with another end unless that is empty."""
    return parse_scene(scene_text, "scene", [*(f"run.{rule}=" for rule in RULES), end] if end else [])


def packed(name: str) -> Path:
    """The file of a fixture of the present format."""
    return FOLDER / f"{VERSION}-{name}{PACKED}"


LOGS = sorted(path.name.removesuffix(PACKED) for path in FOLDER.glob(f"*{PACKED}"))
"""Fixtures of all formats, as VERSION-NAME."""


def kind_of(log: str) -> str:
    """Name of a fixture without the version of its format."""
    return log.partition("-")[2]


def result_of(form: Form, folder: Path) -> tuple[int, Any]:
    """Exit code of a command on the log in a folder, and its result."""
    done = called(*form, folder=folder)
    if done.returncode or "--json" not in form:
        files = [folder / form[form.index("-o") + 1]] if "-o" in form and not done.returncode else []
        return done.returncode, [file.read_text() for file in files]
    return 0, json.loads(done.stdout)


def differences(result: Any, expected: Any, place: str = "") -> list[str]:
    """Where two results differ, without the keys in PASSING."""
    if isinstance(result, dict) and isinstance(expected, dict) and result.keys() == expected.keys():
        pairs = ((f"{place}.{key}", result[key], expected[key]) for key in result if key not in PASSING)
    elif isinstance(result, list) and isinstance(expected, list) and len(result) == len(expected):
        pairs = ((f"{place}[{i}]", each, other) for i, (each, other) in enumerate(zip(result, expected, strict=True)))
    elif isinstance(result, float) and isinstance(expected, float):
        same = math.isclose(result, expected, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
        return [] if same else [f"{place}: {result!r} instead of {expected!r}"]
    else:
        return [] if result == expected else [f"{place}: {result!r} instead of {expected!r}"]
    return [line for where, each, other in pairs for line in differences(each, other, where)]


@pytest.fixture(scope="module", params=LOGS)
def pair(request, tmp_path_factory):
    """Name of a fixture, and the folders of its log and of that of a new run."""
    folder = tmp_path_factory.mktemp(request.param)
    old, new = folder / "old", folder / "new"
    old.mkdir()
    new.mkdir()
    (old / NAME).write_bytes(lzma.decompress((FOLDER / f"{request.param}{PACKED}").read_bytes()))
    with open_log(old / NAME) as log:
        simulate(log.scene, new / NAME)
    return kind_of(request.param), old, new


def test_every_kind_has_a_fixture():
    assert {kind_of(log) for log in LOGS} == {*FIXTURES}
    assert all(packed(name).exists() for name in FIXTURES)


@pytest.mark.parametrize("pair", [log for log in LOGS if not FIXTURES[kind_of(log)].killed], indirect=True)
def test_every_command_gives_the_same_numbers(pair):
    """A killed run ends earlier than a new one, so its log is compared once it is resumed."""
    _, old, new = pair
    wanted = [form for command in reading_commands() for form in forms(command) if "--json" in form]
    for form in (*wanted, ("export", NAME, "--format", "csv", "--events", "-o", "events.csv")):
        actual = [list(result_of(form, folder)) for folder in (old, new)]
        assert differences(*actual) == [], shlex.join(form)


def test_states_at_any_time(pair):
    _, old, new = pair
    with open_log(old / NAME) as log, open_log(new / NAME) as whole:
        assert log.discs.species_names == whole.discs.species_names
        assert log.walls == whole.walls
        times = np.linspace(0, log.end_time, 7) if log.has_positions else []
        for each, other in zip(log.frames(times), whole.frames(times), strict=True):
            assert all(np.array_equal(a, b) for a, b in zip(each, other, strict=True) if a is not None)


def test_resumed_to_the_same_log(pair, tmp_path):
    name, old, _ = pair
    path, whole, end = tmp_path / "old.h5", tmp_path / "new.h5", FIXTURES[name].end
    path.write_bytes((old / NAME).read_bytes())
    with open_log(path) as log:
        assert log.unclosed == FIXTURES[name].killed
        assert len(log) > 100
        simulate(with_end(log.scene_text, end), whole)
    output_of("resume", path, *(f"--{end.removeprefix('run.')}",) * bool(end))
    assert unequal(path, whole) == []
    with open_log(path) as log:
        assert log.complete


def test_a_difference_is_found():
    expected = {"a": [1.0, {"b": 2}], "c": "x", "seconds": 1.0}
    assert differences(expected | {"seconds": 2.0}, expected) == []
    result = differences({"a": [1.0 + 1e-11, {"b": 3}], "c": "y", "seconds": 1.0}, expected)
    assert result == [".a[0]: 1.00000000001 instead of 1.0", ".a[1].b: 3 instead of 2", ".c: 'y' instead of 'x'"]
    assert len(differences({"a": [1.0], "c": "x"}, expected)) == 1


def write(fixture: Fixture, path: Path) -> None:
    """Write the log of a fixture; a killed one in a process that kills itself in the middle of the run."""
    scene = load_scene(SCENES / f"{fixture.scene}.toml", [f"run.{rule}=" for rule in RULES] + [*fixture.overrides])
    if not fixture.killed:
        simulate(scene, path)
        return
    log_writer.FLUSH_SECONDS = 0.0

    def kill_at_half(progress: Progress) -> None:
        if progress.share > 0.5:
            time.sleep(1.0)  # until the thread of the log has committed everything
            os.kill(os.getpid(), signal.SIGKILL)

    if not (child := os.fork()):
        simulate(scene, path, on_progress=kill_at_half)
        os._exit(1)
    assert os.waitstatus_to_exitcode(os.waitpid(child, 0)[1]) == -signal.SIGKILL


def write_missing() -> None:
    """Write every fixture that is missing."""
    FOLDER.mkdir(exist_ok=True)
    for name, fixture in FIXTURES.items():
        if not packed(name).exists():
            with tempfile.TemporaryDirectory() as folder:
                write(fixture, Path(folder) / NAME)
                packed(name).write_bytes(lzma.compress((Path(folder) / NAME).read_bytes(), preset=9))
            print(packed(name).relative_to(ROOT), packed(name).stat().st_size)


if __name__ == "__main__":
    write_missing()
