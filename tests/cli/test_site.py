"""The site: commands of its own pages run, and it is built without a warning."""

import importlib.util
import os
import re
import subprocess
import sys
import textwrap

import pytest
from helpers.readme_pages import FENCE, Block, make_folder, run_python, run_shell
from helpers.support import ROOT

from idealgas.analysis.pressure.measure import pressure
from idealgas.examples import load_example
from idealgas.log import open_log
from idealgas.run.simulate import simulate

SITE = ROOT / ".github" / "site"
OWN_PAGES = sorted(path.name for path in (SITE / "pages").glob("*.md"))


def load_hooks():
    specification = importlib.util.spec_from_file_location("site_hooks", SITE / "hooks.py")
    module = importlib.util.module_from_spec(specification)
    specification.loader.exec_module(module)
    return module


@pytest.mark.slow
@pytest.mark.parametrize("page", OWN_PAGES)
def test_code_of_a_page_runs(tmp_path, monkeypatch, page):
    monkeypatch.chdir(make_folder(tmp_path))
    for block in (Block(*parts) for parts in FENCE.findall((SITE / "pages" / page).read_text(encoding="utf-8"))):
        printed = run_python(block.text, page) if block.language == "python" else [*run_shell(block.text)]
        assert printed


@pytest.mark.slow
def test_mean_free_paths_from_flights_are_those_of_the_pressure(tmp_path, monkeypatch):
    """The page gives the means over flights that one might take instead."""
    monkeypatch.chdir(tmp_path)
    page = (SITE / "pages" / "how-to.md").read_text(encoding="utf-8")
    (program,) = (text for _, text in FENCE.findall(page) if "ends_in_collision" in text)
    simulate(load_example("mixture", ["run.collisions_per_disc=60"]), "gas.h5")
    read = dict(line.split() for line in run_python(program, "how-to.md").splitlines()[1:3])
    with open_log("gas.h5") as log:
        expected = {path.species: path.path.value for path in pressure(log, start=0.0).free_paths}
        flights = log.to_pandas("flights")
    assert {name: float(value) for name, value in read.items()} == pytest.approx(expected, rel=1e-5)
    light = flights[flights["species"] == "light"]
    means = light["path"].mean(), expected["light"], light.loc[light["ends_in_collision"], "path"].mean()
    assert [f"{value:.3f}" for value in means] == re.findall(r"0\.3\d\d", page)


def test_twenty_questions_have_a_command_each():
    _, *answers = (SITE / "pages" / "how-to.md").read_text(encoding="utf-8").split("\n## ")
    assert len(answers) >= 20
    assert all(FENCE.search(answer) for answer in answers)


def test_every_page_of_the_repository_is_on_the_site():
    from helpers.readme_pages import PAGES

    hooks, navigation = load_hooks(), (SITE / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
    assert {*PAGES} <= {*hooks.PAGES}
    for page in (*hooks.PAGES.values(), *OWN_PAGES, "gallery.md"):
        assert re.search(rf"(?<![\w/]){page}\b", navigation), page


@pytest.mark.parametrize("repository", ["https://host/idealgas", ""])
def test_links_lead_to_pages_pictures_or_the_repository(repository):
    hooks = load_hooks()
    own = {f"{hooks.OWN}/{page}": page for page in OWN_PAGES}
    for source, page in (hooks.PAGES | own).items():
        text = hooks.linked((ROOT / source).read_text(encoding="utf-8"), source, repository)
        assert (f"({repository}/blob/main/" in text) <= bool(repository)
        for _, path, _ in hooks.LINK.findall(text):
            target = (SITE / "pages" / page).parent.joinpath(path).resolve().relative_to(SITE / "pages").as_posix()
            assert (
                target in {*hooks.PAGES.values(), *OWN_PAGES}
                or (ROOT / ".readme" / target.removeprefix("pictures/")).is_file()
            )


def test_the_navigation_has_the_analyses_by_the_titles_of_their_pages():
    navigation = (SITE / "mkdocs.yml").read_text(encoding="utf-8").partition("\nnav:\n")[2]
    for path in sorted((ROOT / "idealgas" / "analysis").glob("[a-z]*.md")):
        title = path.read_text(encoding="utf-8").splitlines()[0].removeprefix("# ").partition(":")[0]
        assert f"- {title}: analyses/{path.name}\n" in navigation


def test_no_address_is_made_up():
    """Addresses of the repository follow from pyproject.toml, in which a release fills one in."""
    files = (*(ROOT / ".github").rglob("*.*"), ROOT / "pyproject.toml", ROOT / "README.md")
    texts = {path: path.read_text(encoding="utf-8") for path in files if path.is_file() and path.suffix != ".pyc"}
    assert len(texts) > 20
    assert [path for path, text in texts.items() if re.search(r"github\.(com|io)/idealgas", text)] == []


@pytest.mark.parametrize(
    ("address", "code"),
    [("", 1), ("https://github.com/another/gas", 1), ("https://github.com/owner/gas", 0)],
    ids=["empty", "another", "own"],
)
def test_a_release_requires_the_address_of_its_repository(tmp_path, address, code):
    text = (ROOT / "pyproject.toml").read_text(encoding="utf-8")
    line = f'\nRepository = "{address}"' if address else ""
    filled = re.sub(r"^(\[project\.urls\].*)$", lambda table: table[1] + line, text, flags=re.MULTILINE)
    (tmp_path / "pyproject.toml").write_text(filled, encoding="utf-8")
    workflow = (ROOT / ".github" / "workflows" / "release.yml").read_text(encoding="utf-8")
    (step,) = re.findall(r"<<'PYTHON'\n(.*?)\n +PYTHON\n", workflow, re.DOTALL)
    environment = os.environ | {"GITHUB_REPOSITORY": "owner/gas"}
    command = [sys.executable, "-c", textwrap.dedent(step)]
    done = subprocess.run(command, cwd=tmp_path, env=environment, capture_output=True, text=True)
    assert done.returncode == code
    needed = f'pyproject.toml: [project.urls] needs Repository = "https://github.com/owner/gas" (it is "{address}")\n'
    assert done.stderr == needed * code


@pytest.mark.needs("mkdocs")
@pytest.mark.slow
def test_the_site_is_built_without_a_warning(tmp_path):
    """Its pages load no file of another server, and the theme does not ask one for the stars of a repository."""
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", SITE / "mkdocs.yml", "-d", tmp_path / "site"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert not re.search("^WARNING", done.stderr, re.MULTILINE)
    assert (tmp_path / "site" / "gallery" / "index.html").stat().st_size > 20_000
    assert len([*(tmp_path / "site" / "gallery").glob("*.png")]) >= 46
    for path in (tmp_path / "site").rglob("*.html"):
        text = path.read_text(encoding="utf-8")
        assert not re.search(r'\ssrc="(https?:)?//|<link[^>]*href="(https?:)?//', text), path
        assert 'data-md-component="source"' not in text, path
    page = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert 'role="dialog" aria-label="Search"' in page
    assert "extra.css" in page
