"""What the README pages say is so: all their code runs, and their tables know every command, key, dataset and scene."""

import io
import json
import re
import shutil
import subprocess
import sys
from pathlib import Path
from types import ModuleType
from typing import get_args

import click
import h5py
import pytest
from idealgas_cli.main import main
from pydantic import BaseModel
from readme_pages import (
    LINK,
    PAGES,
    PICTURE,
    blocks,
    commands,
    make_folder,
    run_command,
    run_python,
    run_shell,
    section,
)
from support import ROOT

from idealgas.scene import Scene

README, SCENES, ANALYSES, ENGINE, LOG, STUDY, TESTS = (
    "README.md",
    "configs/README.md",
    "idealgas/analysis/README.md",
    "idealgas/engine/README.md",
    "idealgas/log/README.md",
    "idealgas/accuracy/README.md",
    "tests/README.md",
)
DOCUMENTS = [ROOT / page for page in PAGES] + [ROOT / ".github" / name for name in ("CONTRIBUTING.md", "CHANGELOG.md")]
NOT_RUN = {"toml", "bibtex"}
"""Languages of blocks that are no programs: scenes are run by the commands about them."""


@pytest.fixture
def folder(tmp_path, monkeypatch):
    """The current folder: like the top one of a clone."""
    monkeypatch.chdir(make_folder(tmp_path))
    return tmp_path


def run_blocks(page, found):
    """Run blocks of a page, one after the other in the current folder: each command or program, and what it prints."""
    printed = []
    for language, text in found:
        assert language in NOT_RUN | {"bash", "python"}
        if language == "bash":
            printed += run_shell(text)
        elif language == "python":
            printed.append((text, run_python(text, page)))
    return printed


def pictures_of(page, text):
    """Paths from the top folder of the pictures in a text of a page."""
    return [((ROOT / page).parent / path).resolve().relative_to(ROOT).as_posix() for path in PICTURE.findall(text)]


# ── README.md ──


def test_readme_is_short():
    assert len(PAGES[README].split()) <= 1500


def test_quick_start_is_two_commands():
    first, second = blocks_of_quick_start()
    for command, needs in ((first, "-e ."), (second, '-e ".[test]"')):
        venv, install, *_ = commands(command)
        assert venv == "python3 -m venv --without-pip .venv"
        assert install == f"python3 -m pip --python .venv install -q {needs}"
    assert commands(second)[2:] == [".venv/bin/pytest -n 3 --dist worksteal"]


def blocks_of_quick_start():
    first, second, *_ = re.findall(r"^```bash\n(.*)\n```", section(README, "Quick start"), re.MULTILINE)
    return first, second


def test_continuous_integration_runs_the_test_command():
    _, test_command = blocks_of_quick_start()
    assert f"({test_command})" in (ROOT / ".ci" / "run").read_text(encoding="utf-8").splitlines()
    assert "run: .ci/run" in (ROOT / ".github" / "workflows" / "ci.yml").read_text(encoding="utf-8")


@pytest.mark.slow
def test_the_first_command_as_a_user_runs_it(folder):
    *_, run, check = commands(blocks_of_quick_start()[0])
    (folder / ".venv" / "bin").mkdir(parents=True)
    (folder / ".venv" / "bin" / "idealgas").symlink_to(Path(sys.executable).parent / "idealgas")
    done = subprocess.run(f"{run} && {check}", shell=True, cwd=folder, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert "Z = PA/NT" in done.stdout
    assert done.stdout.endswith(
        "Measurement and theory agree within 4 standard errors in walls, virial; pairs, virial.\n"
    )


def test_code_of_readme_runs(folder):
    (scene,) = blocks(README, "toml")
    assert scene.text.count("\n") <= 15
    (folder / "gas.toml").write_text(scene.text)
    printed = dict(run_blocks(README, blocks(README)))
    assert sum(" gas.toml" in command or " gas.h5" in command for command in printed) == 5
    (python,) = blocks(README, "python")
    assert python.text.count("\n") <= 10
    assert "pairs, virial" in printed[python.text]
    assert {path.name for path in (folder / ".readme").iterdir()} == {"film.gif", "quickstart-speeds.png"}
    assert {"gas.png", "gas.html"} <= {path.name for path in folder.iterdir()}


def test_numbers_of_readme_are_those_of_the_other_pages():
    others = "".join(text for page, text in PAGES.items() if page != README)
    rows = re.findall(r"^\| .* \| (\S.*?) \| \S+ \|$", section(README, "Validation"), re.MULTILINE)
    numbers = [number for measured in rows[1:] for number in measured.split(" ± ")]
    assert len(numbers) > 12
    for number in numbers:
        assert number in others, number
    table = [line for line in section(README, "Speed").splitlines() if line.startswith("| ")]
    assert len(table) == 5
    assert "\n".join([table[0], "|---|---|---|---|---|", *table[1:]]) in section(ENGINE, "Speed")


def test_the_version_to_cite_is_this_one():
    from idealgas import __version__

    assert f"version = {{{__version__}}}" in section(README, "Citing")


# ── scenes ──


@pytest.mark.slow
def test_code_of_scenes_runs(folder):
    printed = run_blocks(SCENES, blocks(SCENES))
    assert len(printed) == 6
    assert all(text for _, text in printed)


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
    rows = re.findall(r"^\| `(\w+\.\w+)` \|(.*?)\|", section(SCENES, "All keys"), re.MULTILINE)
    described = {key: default.strip() for key, default in rows}
    assert described.pop("species.region") == "the box"
    assert described == {key: default for key, default in keys_of_scenes() if key != "species.region"}


def test_every_shipped_scene_is_named():
    named = set(re.findall(r"`([\w/-]+)`", section(SCENES, "Shipped scenes")))
    shipped = [*(ROOT / "configs").glob("*.toml"), *(ROOT / "configs" / "sweeps").glob("*.toml")]
    assert {path.relative_to(ROOT / "configs").with_suffix("").as_posix() for path in shipped} <= named
    assert f"the {len(list((ROOT / 'configs').glob('*.toml')))}\nscenes" in PAGES[README]


# ── the log ──


@pytest.mark.slow
def test_code_of_the_log_runs(folder):
    plain, package, frame = (block.text for block in blocks(LOG, "python"))
    assert max(plain.count("\n"), package.count("\n")) <= 10
    shell = blocks(LOG, "bash")
    printed = run_blocks(LOG, shell)
    assert len(printed) == 6
    assert (folder / "events.csv").stat().st_size > 1e6
    whole_run = float(run_python(plain, LOG).removeprefix("P = "))
    routes = json.loads(run_command("idealgas pressure quickstart.h5 --json"))["routes"]
    (all_walls,) = (r["pressure"]["value"] for r in routes if r["route"] == "all walls")
    assert whole_run == pytest.approx(all_walls, rel=0.02)
    read = run_python(package, LOG)
    assert "1000 discs" in read
    assert read.endswith(" wall hits\n")
    pytest.importorskip("pandas", reason="no pandas: pip install 'idealgas[notebook]'")
    assert "disc" in run_python(frame, LOG)


@pytest.mark.slow
def test_every_dataset_of_a_log_is_named(folder):
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


# ── engine, analyses, studies ──


@pytest.mark.long
def test_code_of_the_engine_runs(folder):
    assert all(printed for _, printed in run_blocks(ENGINE, blocks(ENGINE)))


def analysis_blocks():
    """Blocks of the page of analyses: those that run a sweep, and the others."""
    found = blocks(ANALYSES)
    sweeps = [block for block in found if "idealgas sweep" in block.text]
    return sweeps, [block for block in found if block not in sweeps]


@pytest.mark.slow
def test_code_of_the_analyses_runs(folder):
    printed = run_blocks(ANALYSES, analysis_blocks()[1])
    assert all(text for _, text in printed)
    for name in ("speeds.png", "atmosphere.png", "cooling.png", "report.html", ".readme/relaxation.png"):
        assert (folder / name).stat().st_size > 1000


@pytest.mark.slow
@pytest.mark.parametrize(
    "name",
    [
        "equation-of-state",
        *(
            pytest.param(name, marks=pytest.mark.long)
            for name in ("effusion", "heat-capacity", "phases", "transport", "diffusion")
        ),
    ],
)
def test_shipped_sweeps_give_their_pictures(folder, name):
    (block,) = (block for block in analysis_blocks()[0] if f"sweeps/{name}.toml" in block.text)
    run_blocks(ANALYSES, [block])
    assert [path.name for path in (folder / ".readme").iterdir()] == [f"{name}.png"]


@pytest.mark.slow
def test_code_of_the_studies_runs(folder, monkeypatch):
    """The cluster is one in name only: its queue takes whatever is asked for."""
    asked = []

    class Cluster:
        scheduler_address = "tcp://here:8786"

        def __init__(self, **options):
            asked.append(options)

        def scale(self, **options):
            asked.append(options)

    queue = ModuleType("dask_jobqueue")
    queue.SLURMCluster = Cluster
    monkeypatch.setitem(sys.modules, "dask_jobqueue", queue)
    monkeypatch.setattr(sys, "stdin", io.StringIO("\n"))
    printed = run_blocks(STUDY, blocks(STUDY))
    assert printed[-1][1] == "idealgas sweep SWEEP.toml -o DIR --scheduler tcp://here:8786"
    assert asked[-1] == {"jobs": 200}
    assert (folder / ".readme" / "accuracy.png").stat().st_size > 1000


def test_the_sweep_is_one(folder):
    (sweep,) = blocks(STUDY, "toml")
    shutil.copy(ROOT / "configs" / "quickstart.toml", folder)
    (folder / "sweep.toml").write_text(sweep.text)
    assert "36 points" in run_command("idealgas sweep sweep.toml -o out --dry-run")


# ── tests ──


def test_the_page_of_tests_knows_them():
    (block,) = blocks(TESTS, "bash")
    markers = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    for command in commands(block.text):
        assert ".venv/bin/pytest" in command
        for marker in re.findall(r'-m "?(\w+)', command):
            assert f'"{marker}: ' in markers
        for path in re.findall(r"tests/\w+", command):
            assert (ROOT / path).is_dir()
    listed = set(re.findall(r"^\| `(\w+)` \|", PAGES[TESTS], re.MULTILINE))
    assert listed == {path.name for path in (ROOT / "tests").iterdir() if path.is_dir() and path.name[0] not in "._"}


# ── all pages ──


def test_every_command_is_named_once():
    text = "".join(PAGES.values())
    for name in main.list_commands(click.Context(main)):
        assert text.count(f"| `idealgas {name}") == 1, name


@pytest.mark.parametrize("page", PAGES)
def test_a_command_beneath_each_picture_makes_it(page):
    text = PAGES[page]
    for found in PICTURE.finditer(text):
        (path,) = pictures_of(page, found[0])
        assert (ROOT / path).is_file()
        beneath = re.match(r"\n\n```bash\n(.*)\n```\n", text[found.end() :])
        assert beneath, path
        assert path in commands(beneath[1])[-1].split(), path


def test_every_picture_is_shown():
    shown = [path for page, text in PAGES.items() for path in pictures_of(page, text)]
    assert sorted(shown) == sorted(f".readme/{path.name}" for path in (ROOT / ".readme").iterdir())


@pytest.mark.parametrize("document", DOCUMENTS, ids=lambda path: path.relative_to(ROOT).as_posix())
def test_links_lead_somewhere(document):
    for link in LINK.findall(document.read_text(encoding="utf-8")):
        path, _, heading = link.partition("#")
        if not link.startswith("https://"):
            target = document.parent / path if path else document
            assert target.exists(), link
            if heading:
                headings = re.findall(r"^#+ (.*)", target.read_text(encoding="utf-8"), re.MULTILINE)
                assert heading in [re.sub(r"[^\w -]", "", text).lower().replace(" ", "-") for text in headings], link
