import json
import os
import re
import shlex
import subprocess
import sys

import click
import pytest
from click.testing import CliRunner
from helpers.commands import SCENE
from helpers.support import IDEALGAS, ROOT, called, output_of
from idealgas_cli.main import EXAMPLES, Commands, first_sentence, main

from idealgas import __version__
from idealgas.analysis import registry
from idealgas.errors import UserError
from idealgas.log import open_log


@pytest.fixture
def log(folder):
    return folder / "run.h5"


def numbers(text):
    """The numbers of a text in order, and whether something of it is cut off."""
    assert "…" not in text
    return sorted(re.findall(r"[-+]?\d+\.?\d*(?:e[-+]\d+)?", text))


@pytest.mark.parametrize("command", ["pressure", "transport", "temperature"])
def test_a_narrow_terminal_shows_every_digit(log, command, monkeypatch):
    """The same numbers as a pipe has at full width; the names of the rows are repeated in each part of a table."""
    monkeypatch.delenv("COLUMNS", raising=False)
    whole = called(command, log).stdout
    assert command != "transport" or max(map(len, whole.splitlines())) > 100
    for columns in (20, 40, 79, 100):
        monkeypatch.setenv("COLUMNS", str(columns))
        shown = called(command, log).stdout
        assert set(numbers(whole)) == set(numbers(shown))
        tables = [line for line in shown.splitlines() if line[:1] in "│┃"]
        assert tables
        assert columns < 40 or max(map(len, tables)) <= columns


def test_what_is_written_is_named_but_for_a_quiet_command(log, tmp_path):
    picture = tmp_path / "t.png"
    for options, stream in (((), "stdout"), (("--json",), "stderr"), (("--csv",), "stderr")):
        done = called("temperature", log, "--plot", picture, "--force", *options)
        assert f"{picture}: written\n" in getattr(done, stream)
        assert done.stdout.count(": written") == (not options)
    assert output_of("temperature", log, "--plot", picture, "--force", "--quiet") == ""
    assert called("temperature", log, "-q", "--json").stdout.startswith("{")
    assert called("temperature", log, "-q", "--csv").stdout.startswith("quantity,group,index,value,")


def test_numbers_have_all_digits_and_may_have_an_exponent(log):
    end = json.loads(called("info", log, "--json").stdout)["run"]["end_time"]
    beyond = end * (1 + 1e-15)
    done = called("pressure", log, "--from", repr(beyond))
    assert done.stderr == f"{log}: empty time window t = {beyond!r} to {end!r}: the log covers t = 0 to {end!r}\n"
    done = called("check", "scene.toml", "--set", "species.count=5e1", "--json", folder=log.parent)
    assert json.loads(done.stdout)["scene"]["species"][0]["count"] == 50


def test_a_histogram_is_printed_with_its_law(log):
    lines = called("histogram", log).stdout.splitlines()
    first = lines.index("gas: speed (length/time); │ Maxwell-Boltzmann") + 1
    bars = lines[first:]
    assert len(bars) == 24
    assert all("│" in bar for bar in bars)
    assert max(bar.count("█") for bar in bars) > 40
    assert "█" not in bars[-1]


def test_a_scene_from_a_pipe():
    command = [IDEALGAS, "check", "-", "--json"]
    done = subprocess.run(command, input=SCENE, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")
    assert json.loads(done.stdout)["number"] == 60
    wrong = subprocess.run(command, input=SCENE.replace("60", "-1"), capture_output=True, text=True)
    assert (wrong.returncode, wrong.stderr.split(": ")[0]) == (2, "/dev/stdin:3")


@pytest.mark.parametrize("shell", ["bash", "zsh", "fish"])
def test_completion(shell):
    """The answers that the script of each shell asks for."""
    for words, answer in (
        ("idealgas pres", "pressure"),
        ("idealgas pressure --pl", "--plot"),
        ("idealgas info ga", "file"),
        ("idealgas check ga", "file"),
        ("idealgas run gas.toml -o ga", "file"),
        ("idealgas pressure gas.h5 --plot ga", "file"),
        ("idealgas examples pis", "piston"),
        ("idealgas run gas.toml --set run.unt", "run.until="),
    ):
        last = words.split()[-1]
        asked = {"COMP_WORDS": words, "COMP_CWORD": last if shell == "fish" else str(words.count(" "))}
        environment = {"_IDEALGAS_COMPLETE": f"{shell}_complete", **asked}
        assert answer in CliRunner().invoke(main, env=environment, prog_name="idealgas").stdout


@pytest.mark.parametrize(
    ("command", "unused"),
    [
        ("--help", ("numpy", "numba", "scipy", "h5py", "matplotlib", "pydantic", "rich")),
        ("info run.h5", ("numba", "scipy", "matplotlib", "pandas")),
        ("check scene.toml", ("numba", "scipy.stats", "matplotlib", "pandas")),
        ("histogram run.h5", ("scipy.stats", "scipy.optimize", "matplotlib", "pandas")),
    ],
)
def test_a_command_imports_only_what_it_needs(log, command, unused):
    program = (
        "import sys\nfrom idealgas_cli.main import main\n"
        f"try: main({command.split()})\nexcept SystemExit: pass\n"
        f"print(*(name for name in {unused} if name in sys.modules), file=sys.stderr, end='')"
    )
    done = subprocess.run([sys.executable, "-c", program], cwd=log.parent, capture_output=True, text=True)
    assert (done.returncode, done.stderr) == (0, "")


def test_version():
    assert called("--version").stdout == called("-V").stdout == f"idealgas, version {__version__}\n"


def test_every_command_is_a_module_with_help():
    listed = main.list_commands(click.Context(main))
    modules = {path.stem for path in (ROOT / "cli").glob("[!_]*.py")} - {"main"}
    assert sorted(listed) == sorted([*(name.replace("_", "-") for name in modules), *registry.commands()])
    context = click.Context(main)
    for name in main.list_commands(context):
        command = main.get_command(context, name)
        assert command.name == name
        assert command.get_short_help_str()
        assert CliRunner().invoke(main, [name, "--help"]).exit_code == 0
    for name in registry.commands():
        command = main.get_command(None, name)
        options = {option for param in command.get_params(click.Context(command)) for option in param.opts}
        assert {"--json", "--csv", "--plot", "--quiet"} <= options


def test_help_shows_every_group_with_an_example_and_no_summary_cut_off():
    said = called("--help").stdout
    lines = " ".join(said.split())
    for group, example in EXAMPLES.items():
        assert f"{group}, as in `{example}`:" in said
    for name in main.list_commands(click.Context(main)):
        assert first_sentence(main.get_command(None, name)).replace("- ", "-") in lines.replace("- ", "-")
    assert not re.search(r"\w\.\.\.", said)
    assert "_options" not in said
    assert called("-h").stdout == called("help").stdout == said
    assert called("help", "run").stdout == called("run", "--help").stdout


def examples():
    """All examples that the program gives, as words."""
    of_commands = (main.get_command(None, name).epilog for name in main.list_commands(click.Context(main)))
    texts = [*EXAMPLES.values(), *(text.rpartition("Example: ")[2] for text in of_commands)]
    return [shlex.split(text) for text in texts]


@pytest.mark.parametrize("words", examples(), ids=" ".join)
def test_examples_are_command_lines(words):
    program, name, *arguments = words
    assert program == "idealgas"
    assert main.get_command(None, name).make_context(name, arguments, parent=click.Context(main)).args == []


@pytest.mark.parametrize("arguments", [("--help",), ("help", "run"), ("pressure", "run.h5"), ("info", "run.h5")])
def test_a_reader_that_goes_ends_the_program_quietly(arguments, log):
    """141 is 128 + SIGPIPE, what a shell says of a program that the signal has ended."""
    reader, writer = os.pipe()
    os.close(reader)
    done = subprocess.run([IDEALGAS, *arguments], stdout=writer, stderr=subprocess.PIPE, cwd=log.parent, text=True)
    os.close(writer)
    assert (done.returncode, done.stderr) == (141, "")


FULL = "standard output: cannot be written: No space left on device"


@pytest.mark.needs("/dev/full")
@pytest.mark.parametrize("unbuffered", ["", "1"])
@pytest.mark.parametrize(
    "arguments",
    [
        ("--help",),
        ("schema", "scene"),
        ("info", "run.h5"),
        ("events", "run.h5"),
        ("export", "run.h5", "--events", "--format", "csv", "-o", "-"),
        ("pressure", "run.h5"),
        ("pressure", "run.h5", "--csv"),
    ],
    ids=" ".join,
)
def test_output_to_a_full_disk_is_one_line(arguments, unbuffered, log):
    with open("/dev/full", "w") as full:
        done = subprocess.run(
            [IDEALGAS, *arguments], stdout=full, stderr=subprocess.PIPE, cwd=log.parent, text=True,
            env=os.environ | {"PYTHONUNBUFFERED": unbuffered},
        )  # fmt: skip
    assert (done.returncode, done.stderr) == (1, f"{FULL}\n")


@pytest.mark.needs("/dev/full")
def test_a_stream_to_a_full_disk_ends_the_run_which_can_be_resumed(log):
    run = ("run", "scene.toml", "-o", "full.h5", "--stream", "--set", "run.collisions_per_disc=20000")
    with open("/dev/full", "w") as full:
        done = subprocess.run([IDEALGAS, *run], stdout=full, stderr=subprocess.PIPE, cwd=log.parent, text=True)
    assert (done.returncode, done.stderr) == (1, f"{FULL}; `idealgas resume full.h5` continues it\n")
    with open_log(log.parent / "full.h5") as opened:
        assert not opened.complete
        assert not opened.unclosed
        assert 0 < len(opened) < 60 * 20_000


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
