"""The README pages: their code, taken out block by block and run, and what of it is shortened or left out, and why."""

import contextlib
import io
import re
import shlex
import shutil
from collections.abc import Iterator
from pathlib import Path
from typing import NamedTuple

from click.testing import CliRunner
from idealgas_cli.main import main
from support import ROOT

PAGES = {
    page: (ROOT / page).read_text(encoding="utf-8")
    for page in (
        "README.md",
        "configs/README.md",
        "idealgas/analysis/README.md",
        "idealgas/engine/README.md",
        "idealgas/log/README.md",
        "idealgas/accuracy/README.md",
        "tests/README.md",
    )
}
"""Text of each page, by its path from the top folder."""

LEFT_OUT = {
    "python3 -m venv": "makes an environment and installs from the network; test_install.py builds the package",
    "python3 -m pip": "the same",
    ".venv/bin/pytest": "is these tests themselves",
    "NUMBA_DISABLE_JIT=1 .venv/bin/pytest": "the same",
    "idealgas accuracy configs/three-discs.toml": "takes half a minute; test_accuracy.py runs it",
    "cp orbit/orbit.png": "copies its picture",
}
"""How commands begin that are not run here, and why."""

SHORTENED = {
    "idealgas accuracy configs/quickstart.toml": "--repeats 1 --set run.collisions_per_disc=20 --set species.count=50 "
    "--set species.radius=0.2",
    "idealgas bench": "--collisions 1000 --repeats 1",
    "idealgas run configs/atmosphere.toml": "--set run.until=20",
    "idealgas sweep": "--workers 1",
}
"""How commands begin that take minutes, or all the cores, and with what they are run here."""

SHORTER_SWEEPS = (("collisions_per_disc", 50), ("until", 50))
"""Stop rules of the shipped sweeps, and by what they are divided here."""

FENCE = re.compile(r"^```(\w+)\n(.*?)^```", re.MULTILINE | re.DOTALL)
PICTURE = re.compile(r"!\[[^]]*\]\(([^)]+)\)")
LINK = re.compile(r"(?<!!)\[[^]]*\]\(([^)]+)\)")


class Block(NamedTuple):
    """A fenced block of a page: its language, and its text."""

    language: str
    text: str


def blocks(page: str, language: str | None = None) -> list[Block]:
    """The fenced blocks of a page, of one language or of all."""
    found = [Block(*parts) for parts in FENCE.findall(PAGES[page])]
    return [block for block in found if language in (None, block.language)]


def section(page: str, title: str) -> str:
    """The text below a heading of second order."""
    return PAGES[page].split(f"\n## {title}\n")[1].split("\n## ")[0]


def commands(text: str) -> list[str]:
    """The single commands of a shell block."""
    return [command for line in text.splitlines() for command in line.split(" && ")]


def reason_to_leave_out(command: str) -> str | None:
    """Why a command is not run here; None if it is."""
    return next((reason for begin, reason in LEFT_OUT.items() if command.startswith(begin)), None)


def make_folder(folder: Path) -> Path:
    """A folder like the top one of a clone, as far as the commands of the pages see it, with shorter sweeps."""
    shutil.copytree(ROOT / "configs", folder / "configs", dirs_exist_ok=True)
    (folder / ".readme").mkdir(exist_ok=True)
    for path in (folder / "configs" / "sweeps").rglob("*.toml"):
        text = re.sub(r"^replicates = \d+", "replicates = 1", path.read_text(encoding="utf-8"), flags=re.M)
        for key, factor in SHORTER_SWEEPS:
            text = re.sub(
                rf"^{key} = ([\d_]+)", lambda found, k=key, f=factor: f"{k} = {int(found[1]) // f}", text, flags=re.M
            )
        path.write_text(text, encoding="utf-8")
    return folder


def run_command(command: str) -> str:
    """Run a command `idealgas ...` (or a copy of a file) in the current folder; what it prints."""
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
    """Run the commands of a shell block in the current folder, but those left out: each, and what it prints."""
    for command in commands(text):
        if reason_to_leave_out(command) is None:
            yield command, run_command(command)


def run_python(program: str, page: str) -> str:
    """Run a Python block in the current folder; what it prints."""
    out = io.StringIO()
    with contextlib.redirect_stdout(out):
        exec(compile(program, page, "exec"), {"__name__": "__main__"})
    return out.getvalue()
