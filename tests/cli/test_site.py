"""The site: commands of its own pages run, and it is built without a warning."""

import importlib.util
import re
import subprocess
import sys

import pytest
from helpers.readme_pages import FENCE, Block, make_folder, run_python, run_shell
from helpers.support import ROOT

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


def test_links_lead_to_pages_pictures_or_the_repository():
    hooks = load_hooks()
    for source, page in hooks.PAGES.items():
        for _, path, _ in hooks.LINK.findall(hooks._linked(source, "https://host/idealgas")):
            target = (SITE / "pages" / page).parent.joinpath(path).resolve().relative_to(SITE / "pages").as_posix()
            assert target in hooks.PAGES.values() or (ROOT / ".readme" / target.removeprefix("pictures/")).is_file()


@pytest.mark.slow
def test_the_site_is_built_without_a_warning(tmp_path, monkeypatch):
    pytest.importorskip("mkdocstrings_handlers.python", reason="pip install -r .github/site/requirements.txt")
    for name in load_hooks().SCENES:
        (tmp_path / f"{name.stem}.png").write_bytes((ROOT / ".readme" / "speed.png").read_bytes())
    monkeypatch.setenv("GALLERY", str(tmp_path))
    command = [sys.executable, "-m", "mkdocs", "build", "--strict", "-f", SITE / "mkdocs.yml", "-d", tmp_path / "site"]
    done = subprocess.run(command, capture_output=True, text=True)
    assert done.returncode == 0, done.stderr
    assert not re.search("^WARNING", done.stderr, re.MULTILINE)
    assert (tmp_path / "site" / "gallery" / "index.html").stat().st_size > 20_000
    page = (tmp_path / "site" / "index.html").read_text(encoding="utf-8")
    assert 'role="dialog" aria-label="Search"' in page
    assert "extra.css" in page
