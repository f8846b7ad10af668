"""What README says is so: its commands and its program run, and its tables know every command, key and dataset."""

import json
import re
import shlex
import shutil
import subprocess
import sys
from typing import get_args

import click
import h5py
import pytest
from idealgas_cli.main import main
from pydantic import BaseModel
from support import ROOT, idealgas

from idealgas.scene import Scene

README = (ROOT / "README.md").read_text(encoding="utf-8")


def blocks(language, text=README):
    return re.findall(rf"^```{language}\n(.*?)^```", text, re.MULTILINE | re.DOTALL)


def section(title):
    return README.split(f"\n## {title}\n")[1].split("\n## ")[0]


def run_lines(text, folder):
    """Commands `idealgas ...`, one a line, in a folder that has `configs/`."""
    shutil.copytree(ROOT / "configs", folder / "configs", dirs_exist_ok=True)
    for line in text.splitlines():
        program, *arguments = shlex.split(line)
        assert program.removeprefix(".venv/bin/") == "idealgas"
        result = idealgas(*arguments, folder=folder)
        assert (result.returncode, result.stderr) == (0, ""), line
        yield result.stdout


@pytest.fixture(scope="module")
def quickstart(tmp_path_factory):
    """The folder where the first command of the quick start has run, less its set-up, and what it printed."""
    folder = tmp_path_factory.mktemp("quickstart")
    command, _ = blocks("bash", section("Quick start"))
    _, _, run, check = command.strip().split(" && ")
    return folder, list(run_lines(f"{run}\n{check}", folder))


def test_quick_start_is_two_commands():
    first, second = blocks("bash", section("Quick start"))
    assert first.count("\n") == second.count("\n") == 1
    for command, needs in ((first, "-e ."), (second, '-e ".[test]"')):
        venv, install, *_ = command.strip().split(" && ")
        assert venv == "python3 -m venv --without-pip .venv"
        assert install == f"python3 -m pip --python .venv install -q {needs}"
    assert second.endswith(" && .venv/bin/pytest -n 2\n")


def test_quick_start_shows_the_check(quickstart):
    _, (_, printed) = quickstart
    assert "Z = PA/NT" in printed
    assert "Measurement and theory agree within 4 standard errors." in printed


def test_the_programs_read_the_log(quickstart):
    folder, (_, printed) = quickstart
    plain, package = (run_program(program, folder) for program in blocks("python", section("The log")))
    whole_run = float(plain.removeprefix("P = "))
    all_walls = float(re.search(r"all walls.*?P = ([\d.]+)", printed)[1])
    assert whole_run == pytest.approx(all_walls, rel=0.02)
    assert "1000 discs" in package
    assert package.endswith(" wall hits\n")


def run_program(program, folder):
    assert program.count("\n") <= 10
    result = subprocess.run([sys.executable, "-c", program], cwd=folder, capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, "")
    return result.stdout


def test_commands_run(tmp_path):
    (text,) = blocks("bash", section("Commands"))
    printed = list(run_lines(text, tmp_path))
    assert len(printed) == 12
    assert all(printed)
    assert (tmp_path / "speeds.png").exists()


def test_the_sweep_is_one(tmp_path):
    (text,) = blocks("toml", section("Sweeps"))
    shutil.copytree(ROOT / "configs", tmp_path, dirs_exist_ok=True)
    (tmp_path / "sweep.toml").write_text(text)
    shown = idealgas("sweep", "sweep.toml", "-o", "out", "--dry-run", folder=tmp_path)
    assert (shown.returncode, shown.stderr) == (0, "")
    assert "36 points" in shown.stdout


def test_every_command_is_named():
    for name in main.list_commands(click.Context(main)):
        assert f"| `idealgas {name}" in README


def keys_of_scenes():
    """`table.key` and what is in a cell for its default."""
    for table, field in Scene.model_fields.items():
        annotations = (field.annotation, *get_args(field.annotation))
        (model,) = (a for a in annotations if isinstance(a, type) and issubclass(a, BaseModel))
        for key, entry in model.model_fields.items():
            yield (
                f"{table}.{entry.alias or key}",
                "" if entry.is_required() or entry.default is None else f"`{toml(entry.default)}`",
            )


def toml(value):
    if isinstance(value, tuple):
        return f"[{', '.join(map(toml, value))}]"
    return json.dumps(value) if isinstance(value, (bool, str)) else f"{value:g}"


def test_every_key_of_a_scene_is_named_with_its_default():
    rows = re.findall(r"^\| `(\w+\.\w+)` \|(.*?)\|", section("Scenes"), re.MULTILINE)
    described = {key: default.strip() for key, default in rows}
    assert described.pop("species.region") == "the box"
    assert described == {key: default for key, default in keys_of_scenes() if key != "species.region"}


def test_every_dataset_of_a_log_is_named(quickstart):
    folder, _ = quickstart
    described = re.findall(r"`([\w/]+)`", section("The log"))
    names = []
    with h5py.File(folder / "quickstart.h5") as log:
        log.visititems(lambda name, item: names.append(name) if isinstance(item, h5py.Dataset) else None)
    for name in names:
        observable = re.fullmatch(r"observables/(\w+)/(\w+)", name)
        if observable:
            assert observable[1] in described
            name = f"observables/NAME/{observable[2]}"
        assert name in described


def test_the_pictures_are_there():
    for path in re.findall(r"!\[[^]]*\]\(([^)]+)\)", README):
        assert (ROOT / path).is_file()
