"""A disk that is full or fails at any write of a log: one line, nothing half-made, and what is left goes on."""

import json
import os
import resource
import shutil
import subprocess
import sys
from pathlib import Path

import pytest
from helpers.log_compare import differences
from helpers.needs import linux, program
from helpers.support import IDEALGAS, ROOT, idealgas, small_disk

from idealgas.run.resume import resume

CORNER = ROOT / "configs" / "corner.toml"


@pytest.fixture(scope="module")
def library(tmp_path_factory):
    """Compiled functions that make writes fail."""
    path = tmp_path_factory.mktemp("library") / "write_faults.so"
    source = ROOT / "tests" / "helpers" / "write_faults.c"
    subprocess.run(
        [program("cc"), "-shared", "-fPIC", "-O1", "-Wall", "-Werror", "-o", path, source, "-ldl"], check=True
    )
    return path


def faults(library: Path, folder: Path, *arguments: object, **environment: str) -> int:
    """Number of faults made. arguments: discs, events, first write that fails, step to the next one, commands."""
    path = os.pathsep.join([str(ROOT / "tests"), os.environ.get("PYTHONPATH", "")])
    done = subprocess.run(
        [sys.executable, "-m", "helpers.write_faults", str(library), *map(str, arguments)],
        cwd=folder,
        env={**os.environ, "LD_PRELOAD": str(library), "PYTHONPATH": path, **environment},
        capture_output=True,
        text=True,
    )
    assert (done.returncode, done.stderr) == (0, "")
    made = 0
    for line in done.stdout.splitlines():
        name, fault, lasting, number, wrong = json.loads(line)
        assert wrong == []
        print(f"{name}, {fault}{' from then on' * lasting}: {number} faults")
        assert number > 0
        made += number
    return made


@linux
@pytest.mark.parametrize(
    ("arguments", "environment", "least"),
    [
        pytest.param((20, 160, 16, 70, "run"), {"NUMBA_DISABLE_JIT": "1"}, 12, id="a few"),
        pytest.param((100, 8000, 1, 12), {}, 301, id="many", marks=pytest.mark.slow),
        pytest.param((100, 8000, 1, 1), {}, 4001, id="every single one", marks=pytest.mark.long),
    ],
)
def test_writes_that_fail(library, tmp_path, arguments, environment, least):
    assert faults(library, tmp_path, *arguments, **environment) >= least


def full_at(folder: Path, kilobytes: int) -> list[str]:
    """What is wrong after a run of `corner` in a folder that has room for so many kB."""
    limit = 1024 * kilobytes
    done = subprocess.run(
        [IDEALGAS, "run", CORNER, "-o", "run.h5"],
        capture_output=True,
        text=True,
        cwd=folder,
        preexec_fn=lambda: resource.setrlimit(resource.RLIMIT_FSIZE, (limit, limit)),
    )
    wrong = []
    if done.returncode not in (0, 1):
        wrong.append(f"exit code {done.returncode}")
    if done.returncode == 1 and done.stderr not in (
        "run.h5: cannot be written: File too large\n",
        "run.h5: cannot be written: No space left on device\n",
    ):
        wrong.append(done.stderr)
    if not {path.name for path in folder.iterdir()} <= {"run.h5"}:
        wrong.append(str(list(folder.iterdir())))
    return [f"{kilobytes} kB: {what}" for what in wrong]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    path = tmp_path_factory.mktemp("undisturbed") / "run.h5"
    assert idealgas("run", CORNER, "-o", path).returncode == 0
    return path


@pytest.mark.slow
@pytest.mark.parametrize("kilobytes", [1, 2, 4, 8, 12, 16, 20, 24, 32, 48, 64, 96, 128, 192, 256])
def test_a_file_that_may_not_grow(kilobytes, undisturbed, tmp_path):
    assert full_at(tmp_path, kilobytes) == []
    go_on(tmp_path.iterdir(), undisturbed)


@pytest.mark.needs("a disk to mount")
@pytest.mark.slow
@pytest.mark.parametrize("kilobytes", [1, 4, 8, 12, 16, 20, 24, 32, 40, 48, 56, 64, 96, 128, 192, 256])
def test_a_small_disk(kilobytes, undisturbed, tmp_path):
    with small_disk(tmp_path / "disk", kilobytes):
        assert full_at(tmp_path / "disk", 1024) == []
        left = [shutil.copy(path, tmp_path) for path in (tmp_path / "disk").iterdir()]
    go_on(left, undisturbed)


def go_on(paths, undisturbed):
    for path in paths:
        resume(path)
        assert differences(path, undisturbed) == []
