"""Pages of documentation: their code runs and prints what they show."""

import io
import json
import os
import re
import shutil
import subprocess
import sys
import tomllib
from pathlib import Path
from types import ModuleType

import h5py
import numpy as np
import pytest
from helpers.readme_pages import (
    LINK,
    PAGES,
    blocks,
    commands,
    make_folder,
    run_command,
    run_python,
    run_shell,
    section,
    shown_outputs,
    words,
)
from helpers.support import ROOT

from idealgas.errors import install
from idealgas.log import open_log
from idealgas.sweep.plan import load_sweep

README, SCENES, ENGINE, LOG, RUN, ACCURACY, SWEEP = (
    "README.md",
    "configs/README.md",
    "idealgas/engine/README.md",
    "idealgas/log/README.md",
    "idealgas/run/README.md",
    "idealgas/accuracy/README.md",
    "idealgas/sweep/README.md",
)
ANALYSES = [page for page in PAGES if page.startswith("idealgas/analysis/")]
NOT_RUN = {"toml", "bibtex", "sql", "text"}
"""Languages of blocks that are not run: scenes are run by the commands about them, queries by another program."""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder, with the parts of a clone that commands need."""
    monkeypatch.chdir(make_folder(tmp_path))
    return tmp_path


def run_blocks(page, result):
    """Run blocks of a page in turn in the current folder, and return each command or program with what it prints."""
    printed = []
    for language, text in result:
        assert language in NOT_RUN | {"bash", "python"}
        if language == "bash":
            printed += run_shell(text)
        elif language == "python":
            printed.append((text, run_python(text, page)))
    return printed


def assert_outputs_are_shown(page, printed):
    """The words of each line that a page shows are printed; numbers may differ in their last digits."""
    for command, shown in shown_outputs(page):
        lines = {words(line) for line in dict(printed)[command].splitlines()}
        for line in shown.splitlines():
            assert words(line) in lines, (command, line)


# ── README.md ──


def test_the_first_blocks_install_and_run_and_install_and_test():
    first, second, *others = (block.text.strip() for block in blocks(README))
    assert commands(first)[:2] == ["python3 -m venv .venv", ".venv/bin/pip install -q -e ."]
    assert commands(second)[:2] == ["python3 -m venv .venv", '.venv/bin/pip install -q -e ".[test]"']
    assert commands(second)[2:] == [".venv/bin/pytest -n 3 --dist worksteal"]
    assert f"({second})" in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert "run: .ci/run" in (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")
    assert "pip install" not in "".join(others)


def test_readme_leads_to_the_first_pages():
    links = LINK.findall(PAGES[README])
    assert {f".github/site/pages/{name}.md" for name in ("first-steps", "how-to", "coming-from")} <= {*links}


def recipes():
    """Installations of optional packages in pages, notebooks, messages and help, by their groups."""
    suffixes = {".md", ".py", ".ipynb"}
    folders = (ROOT / name for name in (".github", "cli", "configs", "idealgas"))
    files = [ROOT / "README.md", *(path for folder in folders for path in folder.rglob("*") if path.suffix in suffixes)]
    for path in files:
        for line in path.read_text(encoding="utf-8").replace('\\"', '"').splitlines():
            if "pip install" in line and not line.startswith(("python3 -m venv", "#")):
                yield path.relative_to(ROOT).as_posix(), line


def test_optional_packages_are_installed_in_one_way():
    groups = tomllib.loads((ROOT / "pyproject.toml").read_text(encoding="utf-8"))["project"]["optional-dependencies"]
    pages = []
    for page, line in recipes():
        (named,) = re.findall(r'\.venv/bin/pip install -e "\.\[([\w,{}]+)\]"', line)
        assert {*named.split(",")} <= {*groups, "{extra}"}, (page, line)
        pages.append(page)
    for name in ("sweep", "export", "notebook", "film"):
        assert install(name) == f'.venv/bin/pip install -e ".[{name}]" in the top folder'
    assert {"README.md", "configs/README.md", "idealgas/errors.py", "configs/notebooks/first-steps.ipynb"} <= {*pages}


@pytest.mark.slow
def test_the_first_command_as_a_newcomer_runs_it(tmp_path):
    """In a copy of the repository; also an installation of optional packages, with the environment active and without.

    The packages that it requires are lent by the present environment, so that no index of packages is needed.
    """
    for name in ("idealgas", "cli", "configs", ".readme"):
        shutil.copytree(ROOT / name, tmp_path / name, ignore=shutil.ignore_patterns("__pycache__"))
    for name in ("pyproject.toml", "README.md"):
        shutil.copy(ROOT / name, tmp_path)
    lent = os.pathsep.join(path for path in sys.path if Path(path).name in ("site-packages", "dist-packages"))
    offline = {"PIP_NO_INDEX": "1", "PIP_NO_BUILD_ISOLATION": "0", "PIP_DISABLE_PIP_VERSION_CHECK": "1"}
    environment = os.environ | {"PYTHONPATH": lent} | offline

    def run(command):
        done = subprocess.run(["bash", "-ec", command], cwd=tmp_path, env=environment, capture_output=True, text=True)
        assert (done.returncode, done.stderr) == (0, ""), done.stdout
        return done.stdout

    first, *_ = blocks(README)
    printed = run(first.text)
    assert "Z = PA/NT" in printed
    assert printed.splitlines()[-1].startswith("Measurement and theory agree. ")
    where = run(".venv/bin/python -c 'import idealgas; print(idealgas.__file__)'")
    assert Path(where.strip()).is_relative_to(tmp_path)
    command = install("sweep,notebook").removesuffix(" in the top folder")
    assert "Successfully installed idealgas-md" in run(command)
    assert "Successfully installed idealgas-md" in run(f"source .venv/bin/activate && {command}")


@pytest.mark.slow
def test_code_of_readme_runs(folder):
    (scene,) = blocks(README, "toml")
    assert scene.text.count("\n") <= 15
    (folder / "gas.toml").write_text(scene.text)
    printed = run_blocks(README, blocks(README))
    assert_outputs_are_shown(README, printed)
    (python,) = blocks(README, "python")
    assert python.text.count("\n") <= 10
    assert "pairs, virial" in dict(printed)[python.text]
    assert [path.name for path in (folder / ".readme").iterdir()] == ["film.gif"]
    assert {"speeds.png", "quickstart.html", "gas.gif"} <= {path.name for path in folder.iterdir()}


def test_the_version_to_cite_is_this_one():
    from idealgas import __version__

    (entry,) = blocks(README, "bibtex")
    assert f"version = {{{__version__}}}" in entry.text


# ── scenes ──


@pytest.mark.slow
def test_code_of_scenes_runs(folder):
    printed = run_blocks(SCENES, blocks(SCENES))
    assert len(printed) == 15
    assert all(text for _, text in printed)
    (area,) = (text for program, text in printed if "pi * a * b" in program)
    assert [round(float(number), 5) for number in area.split()] == [25.13286, 25.13274]  # as the comment shows


# ── the log ──


@pytest.mark.slow
def test_code_of_the_log_runs(folder):
    plain, package, flights, frame = (block.text for block in blocks(LOG, "python"))
    assert max(program.count("\n") for program in (plain, package, flights)) <= 10
    printed = run_blocks(LOG, blocks(LOG, "bash"))
    assert len(printed) == 6
    assert (folder / "events.csv").stat().st_size > 1e6
    whole_run = float(run_python(plain, LOG).removeprefix("P = "))
    routes = json.loads(run_command("idealgas pressure quickstart.h5 --json"))["routes"]
    (all_walls,) = (r["pressure"]["value"] for r in routes if r["route"] == "all walls")
    assert whole_run == pytest.approx(all_walls, rel=0.02)
    read = run_python(package, LOG)
    assert "1,000 discs" in read
    assert read.endswith(" wall hits\n")
    assert "mean kinetic energy" in run_python(flights, LOG)
    assert "disc" in run_python(frame, LOG)


@pytest.mark.slow
def test_every_dataset_of_a_log_is_listed(folder):
    run_command("idealgas run configs/quickstart.toml -o log.h5 --set run.events=100")
    described = re.findall(r"`([\w/]+)`", section(LOG, "Format"))
    names = []
    with h5py.File("log.h5") as log:
        log.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    for name in names:
        observable = re.fullmatch(r"observables/(\w+)/(\w+)", name)
        if observable:
            assert observable[1] in described
            name = f"observables/NAME/{observable[2]}"
        assert name in described


@pytest.mark.slow
def test_code_of_steering_runs(folder):
    """The gas returns as far as the page says; the demon has sorted the discs by speed."""
    run_blocks(RUN, blocks(RUN, "bash"))
    with open_log("loschmidt.h5") as log:
        out, back = log.state_at(1.0), log.state_at(21.0)
    assert f"{np.sqrt(((out.position - back.position) ** 2).sum(axis=1).mean()):.3f}" == "0.013"
    assert (back.position[:, 0] < 10).all()
    (demon,) = blocks(RUN, "python")
    assert demon.text.count("\n") <= 20
    assert re.findall(r"temperature (\S+)", run_python(demon.text, RUN)) == ["0.285", "0.707"]


# ── engine, analyses, accuracy, sweeps ──


@pytest.mark.long
def test_code_of_the_engine_runs(folder):
    assert all(printed for _, printed in run_blocks(ENGINE, blocks(ENGINE)))


def is_sweep(block):
    return "idealgas sweep" in block.text


@pytest.mark.slow
@pytest.mark.parametrize("page", ANALYSES)
def test_code_of_an_analysis_runs(folder, page):
    printed = run_blocks(page, [block for block in blocks(page) if not is_sweep(block)])
    assert all(text for _, text in printed)
    assert_outputs_are_shown(page, printed)


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "equation-of-state",
        *(
            pytest.param(name, marks=pytest.mark.long)
            for name in ("effusion", "heat-capacity", "phases", "transport", "diffusion", "work")
        ),
    ],
)
def test_shipped_sweeps_make_their_figures(folder, name):
    ((page, block),) = (
        (page, block) for page in ANALYSES for block in blocks(page) if f"sweeps/{name}.toml" in block.text
    )
    run_blocks(page, [block])
    assert [path.name for path in (folder / ".readme").iterdir()] == [f"{name}.png"]


@pytest.mark.slow
def test_code_of_accuracy_runs(folder):
    run_blocks(ACCURACY, blocks(ACCURACY))
    assert (folder / ".readme" / "accuracy.png").stat().st_size > 1000


@pytest.mark.slow
def test_code_of_sweeps_runs(folder, monkeypatch):
    """The cluster is a stub: its queue accepts every request."""
    requests = []

    class Cluster:
        scheduler_address = "tcp://here:8786"

        def __init__(self, **options):
            requests.append(options)

        def scale(self, **options):
            requests.append(options)

    queue = ModuleType("dask_jobqueue")
    queue.SLURMCluster = Cluster
    monkeypatch.setitem(sys.modules, "dask_jobqueue", queue)
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n"))
    printed = run_blocks(SWEEP, blocks(SWEEP))
    assert printed[-1][1] == "idealgas sweep SWEEP.toml -o DIR --scheduler tcp://here:8786"
    assert requests[-1] == {"jobs": 200}


def test_the_sweep_is_valid(folder):
    (sweep,) = blocks(SWEEP, "toml")
    shutil.copy(ROOT / "configs" / "quickstart.toml", folder)
    (folder / "sweep.toml").write_text(sweep.text)
    assert len(load_sweep("sweep.toml").points) == 36
