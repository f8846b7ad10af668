"""Everything works without what only POSIX has: modules, functions of `os`, moving files that are open."""

import os
import subprocess
import sys
import time

import pytest
from helpers.support import ROOT

from idealgas.log import open_log

pytestmark = pytest.mark.needs("Linux")  # emulates another system

START = "from helpers.foreign_system import install; install()"
NOT_WINDOWS = "from idealgas import system; system.MOVES_OPEN_FILES = False"
COMMAND = f"{NOT_WINDOWS}; from idealgas_cli.main import main; main()"

SCENE = """[scene]
seed = 1
[box]
size = [10, 10]
[[species]]
name = "gas"
count = 50
radius = 0.1
temperature = 1.0
[run]
until = 1e6
"""
SWEEP = """[sweep]
analyses = ["pressure"]
[[axis]]
key = "species.temperature"
values = [1, 2]
[base]
box.size = [10, 10]
species = [{ name = "gas", count = 50, radius = 0.1, temperature = 1.0 }]
run.events = 4000
"""


@pytest.fixture
def start(tmp_path):
    """Starts a Python of the other system with a program."""
    (tmp_path / "python").mkdir()
    (tmp_path / "python" / "sitecustomize.py").write_text(START)
    paths = os.pathsep.join(map(str, (tmp_path / "python", ROOT / "tests")))

    def start(*arguments, program=COMMAND):
        return subprocess.Popen(
            [sys.executable, "-c", program, *map(str, arguments)],
            stdin=subprocess.DEVNULL, stdout=subprocess.PIPE, stderr=subprocess.PIPE,
            cwd=tmp_path, env=os.environ | {"PYTHONPATH": paths}, text=True,
        )  # fmt: skip

    return start


@pytest.fixture
def run(start):
    def run(*arguments, code=0, **options):
        process = start(*arguments, **options)
        output, errors = process.communicate()
        assert process.returncode == code, errors
        return output if code == 0 else errors

    return run


def test_the_system_lacks_what_it_should(run):
    program = "import os, sys; sys.modules['idealgas'] = sys; exec('import fcntl', {'__name__': 'idealgas.x'})"
    assert "No module named 'fcntl'" in run(program=program, code=1)
    assert run(program="import os; print(hasattr(os, 'fork'), hasattr(os, 'link'))") == "False False\n"


def test_all_modules_are_imported(run):
    program = """
import importlib, pkgutil, idealgas, idealgas_cli
for package in (idealgas, idealgas_cli):
    for module in pkgutil.walk_packages(package.__path__, package.__name__ + "."):
        if not module.name.endswith("__main__"):
            importlib.import_module(module.name)
from idealgas import system
print(system.fcntl, system.msvcrt is not None)
"""
    assert run(program=program) == "None True\n"


def test_run_kill_resume_info_report(tmp_path, start, run):
    (tmp_path / "gas.toml").write_bytes(SCENE.replace("\n", "\r\n").encode())
    child = start("run", "gas.toml", "-o", "gas.h5")
    path, deadline = tmp_path / "gas.h5", time.monotonic() + 300
    while not (path.exists() and path.stat().st_size > 2**20) and time.monotonic() < deadline and child.poll() is None:
        time.sleep(0.05)
    try:
        for refused in (["resume", "gas.h5"], ["run", "gas.toml", "-o", "gas.h5", "--force"]):
            assert run(*refused, code=2) == "gas.h5: another run is writing this file\n"
        assert "running" in run("info", "gas.h5")
    finally:
        child.kill()
        child.communicate()
    with open_log(path) as log:
        events = len(log)
    run("resume", "gas.h5", "--events", events + 1000)
    with open_log(path) as log:
        assert log.complete
        assert log.summary["events"] == events + 1000
    assert "complete" in run("info", "gas.h5")
    run("run", "gas.toml", "-o", "gas.h5", "--force", "--set", "run.until=", "--set", "run.events=1000")
    run("resume", "gas.h5", "--events", 2000)
    run("report", "gas.h5", "-o", "gas.html")
    assert sorted(path.name for path in tmp_path.iterdir()) == ["gas.h5", "gas.html", "gas.toml", "python"]


def test_sweep(tmp_path, run):
    (tmp_path / "sweep.toml").write_text(SWEEP)
    run("sweep", "sweep.toml", "-o", "out", "--workers", 1)
    assert len(list((tmp_path / "out" / "points").glob("*.json"))) == 2
