import subprocess
import sys

import click
import pytest
from click.testing import CliRunner
from idealgas_cli.main import Commands, main

from idealgas import __version__
from idealgas.errors import UserError


def test_help_lists_the_commands():
    for flag in ("-h", "--help"):
        result = CliRunner().invoke(main, [flag])
        assert result.exit_code == 0
        assert "check" in result.output
        assert "_options" not in result.output


def test_help_imports_nothing_heavy():
    heavy = ("numpy", "numba", "scipy", "h5py", "matplotlib", "pydantic", "rich")
    program = (
        "import sys\nfrom idealgas_cli.main import main\n"
        "try: main(['--help'])\nexcept SystemExit: pass\n"
        f"print(*(name for name in {heavy} if name in sys.modules), file=sys.stderr, end='')"
    )
    result = subprocess.run([sys.executable, "-c", program], capture_output=True, text=True)
    assert (result.returncode, result.stderr) == (0, "")


def test_every_command_has_help():
    context = click.Context(main)
    for name in main.list_commands(context):
        command = main.get_command(context, name)
        assert command.name == name
        assert command.get_short_help_str()
        assert CliRunner().invoke(main, [name, "--help"]).exit_code == 0


def test_version():
    result = CliRunner().invoke(main, ["--version"])
    assert result.output == f"idealgas, version {__version__}\n"


def test_an_unknown_command():
    result = CliRunner().invoke(main, ["chek"])
    assert result.exit_code == 2
    assert "No such command" in result.output


class DiskFull(UserError):
    exit_code = 1


@pytest.mark.parametrize(
    ("error", "code", "line"),
    [
        (UserError("a.toml:1: wrong"), 2, "a.toml:1: wrong\n"),
        (DiskFull("out.h5: no space left"), 1, "out.h5: no space left\n"),
        (MemoryError(), 1, "out of memory: the scene is too large for this machine\n"),
    ],
)
def test_errors_of_the_user_are_plain_lines(error, code, line):
    @click.command()
    def fail():
        raise error

    class One(Commands):
        def get_command(self, ctx, name):
            return fail

    result = CliRunner().invoke(One(), ["fail"])
    assert (result.exit_code, result.stderr, result.stdout) == (code, line, "")
