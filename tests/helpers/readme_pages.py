"""Pages of documentation: their blocks of code, how they are run, and the outputs that they show.

`PYTHONPATH=tests python -m helpers.readme_pages` runs all commands whose output a page shows, and updates the page.
"""

import contextlib
import difflib
import io
import os
import re
import shlex
import shutil
import tempfile
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from click.testing import CliRunner
from idealgas_cli.main import main

from helpers.support import ROOT

PAGES = {
    path.relative_to(ROOT).as_posix(): path.read_text(encoding="utf-8")
    for path in (
        ROOT / "README.md",
        ROOT / "configs" / "README.md",
        *sorted((ROOT / "idealgas").rglob("*.md")),
        ROOT / "tests" / "README.md",
    )
}
"""Text of each page, by its path from the top folder."""

DOCUMENTS = [
    *(ROOT / page for page in PAGES),
    *(ROOT / ".github" / name for name in ("CONTRIBUTING.md", "CHANGELOG.md")),
    *sorted((ROOT / ".github" / "site" / "pages").glob("*.md")),
]

LEFT_OUT = {
    "python3 -m venv": "creates an environment and installs from the network; test_install.py builds the package",
    ".venv/bin/pip": "the same",
    "source .venv/bin/activate": "activates it",
    ".venv/bin/pytest": "runs these tests themselves",
    "NUMBA_DISABLE_JIT=1 .venv/bin/pytest": "the same",
    "idealgas accuracy configs/three-discs.toml": "takes half a minute; test_accuracy.py runs it",
    "cp orbit/orbit.png": "copies its figure",
}
"""First words of commands that are not run here, and why."""

SHORTENED = {
    "idealgas accuracy configs/quickstart.toml": "--repeats 1 --set run.collisions_per_disc=20 --set species.count=50 "
    "--set species.radius=0.2",
    "idealgas bench": "--collisions 1000 --repeats 1",
    "idealgas sweep": "--workers 1",
}
"""First words of commands that take minutes or all cores, and the options with which they are run here."""

SHORTER_SWEEPS = (("collisions_per_disc", 50), ("until", 50))
"""Stop conditions of the shipped sweeps, and their divisors here."""

FENCE = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"!\[[^]]*\]\(([^)]+)\)")
LINK = re.compile(r"(?<!!)\[[^]]*\]\(([^)]+)\)")


class Block(NamedTuple):
    """A fenced block of a page: its language, and its text."""

    language: str
    text: str


def blocks(page: str, language: str | None = None) -> list[Block]:
    """Fenced blocks of a page, of one language or of all."""
    actual = [Block(*parts) for parts in FENCE.findall(PAGES[page])]
    return [block for block in actual if language in (None, block.language)]


def section(page: str, title: str) -> str:
    """Text below a second-level heading."""
    return PAGES[page].split(f"\n## {title}\n")[1].split("\n## ")[0]


def commands(text: str) -> list[str]:
    """Single commands of a shell block."""
    return [command for line in text.splitlines() for command in line.split(" && ")]


def reason_to_leave_out(command: str) -> str | None:
    """Why a command is not run here; None if it is."""
    return next((reason for begin, reason in LEFT_OUT.items() if command.startswith(begin)), None)


def make_folder(folder: Path) -> Path:
    """Copy the parts of a clone that the commands of the pages need, with shorter sweeps."""
    shutil.copytree(ROOT / "configs", folder / "configs", dirs_exist_ok=True)
    (folder / ".readme").mkdir(exist_ok=True)
    for path in (folder / "configs" / "sweeps").rglob("*.toml"):
        text = re.sub(r"^replicates = \d+", "replicates = 1", path.read_text(encoding="utf-8"), flags=re.M)
        for key, factor in SHORTER_SWEEPS:
            text = re.sub(
                rf"^{key} = ([\d_]+)", lambda result, k=key, f=factor: f"{k} = {int(result[1]) // f}", text, flags=re.M
            )
        path.write_text(text, encoding="utf-8")
    return folder


def run_command(command: str) -> str:
    """Run a command `idealgas ...` (or copy a file) in the current folder, and return what it prints."""
    command = command.removeprefix(".venv/bin/")
    extra = next((more for begin, more in SHORTENED.items() if command.startswith(begin)), "")
    program, *arguments = shlex.split(f"{command} {extra}")
    if program == "cp":
        shutil.copy(*arguments)
        return ""
    assert program == "idealgas", command
    result = CliRunner().invoke(main, arguments, prog_name="idealgas")
    assert (result.exit_code, result.stderr) == (0, ""), f"{command}\n{result.output}\n{result.exception!r}"
    return result.stdout


def run_shell(text: str) -> Iterator[tuple[str, str]]:
    """Run the commands of a shell block in the current folder, and yield each with what it prints."""
    for command in commands(text):
        if reason_to_leave_out(command) is None:
            yield command, run_command(command)


def run_python(program: str, page: str) -> str:
    """Run a Python block in the current folder, and return what it prints."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(program, page, "exec"), {"__name__": "__main__"})
    return out.getvalue()


def words(line: str) -> str:
    """A line of output without numbers and the lines of tables."""
    return " ".join(re.sub(r"[-+]?\d[\d.,e+-]*|[│┃|]", " ", line).split())


def shown_outputs(page: str) -> Iterator[tuple[str, str]]:
    """Last command of a shell block, and the output shown below it, for each output of a page."""
    last = ""
    for block in blocks(page):
        if block.language == "bash":
            last = commands(block.text)[-1]
        elif block.language == "text":
            yield last, block.text


def _update(page: str) -> None:
    """Put the present outputs into a page."""
    text, outputs = PAGES[page], dict(shown_outputs(page))
    for block in blocks(page, "bash"):
        last = commands(block.text)[-1]
        if last not in outputs:
            continue
        printed = [line.rstrip() for line in dict(run_shell(block.text))[last].splitlines()]
        lines = [max(printed, key=lambda new, old=old: _likeness(old, new)) for old in outputs[last].splitlines()]
        text = text.replace(outputs[last], "".join(f"{line}\n" for line in lines))
    if text != PAGES[page]:
        (ROOT / page).write_text(text, encoding="utf-8")
        print(page)


def _likeness(old: str, new: str) -> tuple[float, float]:
    """How similar two lines of output are, first in their words."""
    return tuple(difflib.SequenceMatcher(None, *pair).ratio() for pair in ((words(old), words(new)), (old, new)))


if __name__ == "__main__":
    with tempfile.TemporaryDirectory() as folder:
        os.chdir(make_folder(Path(folder)))
        for name in PAGES:
            _update(name)
