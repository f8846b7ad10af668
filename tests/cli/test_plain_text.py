"""Titles, names, commands and paths are shown as they are: by the terminal, in pictures and in pages."""

import io
import json
import re
import shlex
import shutil
from html.parser import HTMLParser

import pytest
from helpers.support import ROOT, called, error_of
from idealgas_cli._tables import print_tables
from idealgas_cli._terminal import echo, terminal

from idealgas.errors import plain
from idealgas.presentation.style import disable_mathtext, name_rows, panels, save
from idealgas.presentation.tables import Number, Table
from idealgas.report.page import escape

NASTY = "[/red] $\\frac{$ :smile: </script><b> \x1b]0;owned\x07\x9b31m \u202e\udcff"
SHOWN = "[/red] $\\frac{$ :smile: </script><b> \\u001b]0;owned\\u0007\\u009b31m \\u202e\\udcff"
CONTROL = re.compile("[\x00-\x08\x0b-\x1f\x7f-\x9f\u202a-\u202e\ud800-\udfff]")


def test_control_characters_are_written_out():
    assert plain(NASTY) == SHOWN
    assert plain("Gas à 2 °C,\tφ = ½, 氩\n") == "Gas à 2 °C,\tφ = ½, 氩\n"
    toml = plain('"\x1b\u202e"')
    assert json.loads(toml) == "\x1b\u202e"


def test_tables_and_lines_on_a_terminal(capsys, monkeypatch):
    monkeypatch.setenv("COLUMNS", "400")
    print_tables([Table(NASTY, (NASTY, "n"), [(NASTY, "[bold]1")], [f"caveat: {NASTY}"])])
    echo(NASTY)
    terminal().print(NASTY)
    said = capsys.readouterr().out
    assert said.count(SHOWN) == 6
    assert "[bold]1" in said
    assert not CONTROL.search(said)


def test_lines_of_a_table(capsys, monkeypatch):
    """Numbers at the right of their column; in a narrow terminal text is broken between words."""
    monkeypatch.setenv("COLUMNS", "34")
    print_tables(
        [Table("Mixture", ("", "φ"), [("one", Number(0.5, "g")), ("many long words of text", Number(12, "g"))])]
    )
    assert capsys.readouterr().out.splitlines() == [
        "Mixture",
        "┏━━━━━━━━━━━━━━━━━━━━━━━━━┳━━━━━┓",
        "┃                         ┃   φ ┃",
        "┡━━━━━━━━━━━━━━━━━━━━━━━━━╇━━━━━┩",
        "│ one                     │ 0.5 │",
        "│ many long words of text │  12 │",
        "└─────────────────────────┴─────┘",
    ]
    monkeypatch.setenv("COLUMNS", "30")
    print_tables([Table("", ("", "φ"), [("many long words of text", Number(12, "g"))])])
    assert "│ many long words of    │ 12 │\n│ text                  │    │" in capsys.readouterr().out


def test_names_in_a_picture(tmp_path):
    """Powers of ten at the ticks are still powers."""
    figure, (ax,) = panels(1)
    ax.plot([1, 1e6], [0, 1], label=NASTY)
    ax.set_xscale("log")
    name_rows(ax, ["$\\frac{$ \x1b", "[/x]"])
    ax.set_xlabel(NASTY)
    ax.legend()
    save(figure, tmp_path / "picture.png")
    disable_mathtext(figure)
    file = io.StringIO()
    figure.savefig(file, format="svg")
    assert file.getvalue().count(r"10^{6}") == 1
    assert ax.get_xlabel() == SHOWN


class Page(HTMLParser):
    """The elements of a page, and its text."""

    def __init__(self):
        super().__init__()
        self.elements, self.text = [], ""

    def handle_starttag(self, tag, attrs):
        self.elements.append((tag, tuple(attrs)))

    def handle_data(self, data):
        self.text += data


def test_names_in_html():
    page = Page()
    page.feed(f'<p title="{escape(NASTY)}">{escape(NASTY)}</p>')
    assert page.elements == [("p", (("title", SHOWN),))]
    assert page.text == SHOWN


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """A folder with a log whose path is markup, as its title is."""
    folder = tmp_path_factory.mktemp("plain")
    (folder / "[").mkdir()
    shutil.copy(ROOT / "configs" / "corner.toml", folder)
    title = json.dumps(NASTY[:-1], ensure_ascii=False).replace("\x9b", "\\u009b")
    ran = called(
        "run", "corner.toml", "-o", "[/red]$_^.h5", "--set", f"scene.title={title}", "--set", "run.events=200",
        "--set", "run.until=", folder=folder,
    )  # fmt: skip
    assert (ran.returncode, ran.stderr) == (0, "")
    assert "[/red]$_^.h5" in ran.stdout
    return folder


@pytest.mark.parametrize("command", ["info", "follow --once", "temperature --plot t.png", "report -o page.html"])
def test_a_run_with_such_names(folder, command, monkeypatch):
    monkeypatch.setattr("idealgas.report.page.make_sections", lambda *_: [])  # which take long
    name, *options = shlex.split(command)
    done = called(name, "[/red]$_^.h5", *options, folder=folder)
    assert (done.returncode, done.stderr) == (0, "")
    assert not CONTROL.search(done.stdout)
    if name == "info":
        assert "[/red] $\\frac{$ :smile: </script><b> \\u001b]0;owned" in done.stdout
    if name == "report":
        text = (folder / "page.html").read_text(encoding="utf-8")
        assert not CONTROL.search(text)
        page = Page()
        page.feed(text)
        assert ("b", ()) not in page.elements
        assert SHOWN[:-6] in page.text


def test_a_file_that_is_not_there(folder):
    line = error_of("info", "[/red]\x1b[31m.h5", folder=folder)
    assert line == "[/red]\\u001b[31m.h5: cannot be read: No such file or directory\n"
