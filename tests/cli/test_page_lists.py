"""Pages of documentation as reference: they list every command, key, scene, analysis and figure, and links work."""

import json
import re
from typing import get_args

import click
import pytest
from helpers.readme_pages import DOCUMENTS, LINK, PAGES, PICTURE, blocks, commands, section
from helpers.support import ROOT
from idealgas_cli.main import main
from pydantic import BaseModel

from idealgas.analysis import registry
from idealgas.scene import Scene

SCENES, TESTS = "configs/README.md", "tests/README.md"


def keys_of_scenes():
    """`table.key` and its default as text."""
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


def test_every_key_of_a_scene_is_listed_with_its_default():
    described = {}
    for cell in re.findall(r"^\| (`\w+\.\w+`.*?) \|", section(SCENES, "All keys"), re.MULTILINE):
        keys, _, default = cell.partition(" (")
        described |= {key.strip("`"): default.removesuffix(")") for key in keys.split(", ")}
    assert described.pop("species.region") == "the box"
    assert described == {key: default for key, default in keys_of_scenes() if key != "species.region"}


def test_every_shipped_scene_is_listed():
    listed = set(re.findall(r"`([\w/-]+)`", section(SCENES, "Shipped scenes")))
    shipped = [*(ROOT / "configs").glob("*.toml"), *(ROOT / "configs" / "sweeps").glob("*.toml")]
    assert {path.relative_to(ROOT / "configs").with_suffix("").as_posix() for path in shipped} <= listed


def test_every_analysis_has_a_page():
    for name in registry.commands():
        page = f"{name.replace('-', '_')}.md"
        assert f"idealgas/analysis/{page}" in PAGES
        assert f"]({page})" in PAGES["idealgas/analysis/README.md"]


def test_folders_and_markers_of_tests_are_listed():
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


def pictures_of(page, text):
    """Paths from the top folder of the figures in a text of a page."""
    return [((ROOT / page).parent / path).resolve().relative_to(ROOT).as_posix() for path in PICTURE.findall(text)]


def test_every_command_is_listed_once():
    text = "".join(PAGES.values())
    for name in main.list_commands(click.Context(main)):
        assert text.count(f"| `idealgas {name}") == 1, name


@pytest.mark.parametrize("page", PAGES)
def test_each_figure_is_followed_by_its_command(page):
    text = PAGES[page]
    for result in PICTURE.finditer(text):
        (path,) = pictures_of(page, result[0])
        assert (ROOT / path).is_file()
        command = re.match(r"\n\n```bash\n(.*)\n```\n", text[result.end() :])
        assert command, path
        assert path in commands(command[1])[-1].split(), path


def test_every_figure_is_shown():
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
