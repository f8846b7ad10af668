"""`idealgas run` killed at a random moment and gone on with: the log is that of a run that nobody disturbed."""

import json
import signal
import subprocess
import time
import urllib.request
from functools import cache
from pathlib import Path

import numpy as np
import psutil
import pytest
from helpers.log_compare import NO_END, differences, scene_of
from helpers.support import IDEALGAS, ROOT, ended, idealgas, started

from idealgas.log import open_log
from idealgas.report.live import Live
from idealgas.run.resume import resume
from idealgas.run.simulate import simulate

pytestmark = pytest.mark.slow

EFFECTS = (
    "box.left={thermal = 1}",
    "restitution.normal=0.95",
    "log.pressure=true",
    "log.fsync=true",
    "log.snapshot_every=40",
    "run.events=300000",
)
SCENES = {
    "fast": ("configs/quickstart", "run.events=1000000", "log.snapshot_every=5"),
    "slow": ("configs/mixing", "run.method=brute_force", "run.events=6000", 'log.compression="none"'),
    "every effect": ("tests/cases/golden/everything", *EFFECTS),
    "every effect, plain": ("tests/cases/golden/everything", *EFFECTS, 'log.compression="none"'),
    "shared": ("configs/dense", "run.events=2000000", "log.snapshot_every=0.5", "run.threads=2"),
}
IN_CI = [(0, "fast")]
BY_HAND = [(case, list(SCENES)[case % len(SCENES)]) for case in range(1, 83)]
TEN = 10
WATCHED = 20


def command(kind: str, *more: str) -> list[str]:
    """Arguments of the run of a kind, with more overrides."""
    name, *overrides = SCENES[kind]
    settings = [argument for override in (*NO_END, *overrides, *more) for argument in ("--set", override)]
    return ["run", str(ROOT / f"{name}.toml"), *settings]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Log and duration of the run of a kind, by one thread."""
    folder = tmp_path_factory.mktemp("undisturbed")
    actual = "run.threads=1"

    @cache
    def of(kind: str) -> tuple[Path, float]:
        idealgas(*command(kind, actual), "-o", folder / f"{kind}-first.h5")  # compiles
        started = time.monotonic()
        result = idealgas(*command(kind, actual), "-o", folder / f"{kind}.h5")
        assert result.returncode == 0, result.stderr
        return folder / f"{kind}.h5", time.monotonic() - started

    return of


def rows_in(path: Path) -> int:
    """Rows committed now, 0 before the file is there. Once it is there it opens."""
    if not path.exists():
        return 0
    with open_log(path) as log:
        return len(log)


def state_of(path: Path) -> str:
    """State of a run, none before its log is there."""
    if not path.exists():
        return ""
    with open_log(path) as log:
        return log.run_state


def kill(arguments: list[str], path: Path, seconds: float) -> int:
    """Start a command, kill it after a time, and return the most rows seen in its log until then."""
    child = subprocess.Popen([IDEALGAS, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
    seen, end = 0, time.monotonic() + seconds
    try:
        while time.monotonic() < end and child.poll() is None:
            seen = max(seen, rows_in(path))
            time.sleep(0.02)
    finally:
        child.send_signal(signal.SIGKILL)
        child.communicate()
    return seen


def resumed(path: Path) -> None:
    """Go on with a killed run to its end."""
    done = idealgas("resume", path)
    assert (done.returncode, done.stderr) == (0, "")


@pytest.mark.parametrize(("case", "kind"), [*IN_CI, *(pytest.param(*case, marks=pytest.mark.long) for case in BY_HAND)])
def test_killed_and_resumed(case, kind, undisturbed, tmp_path):
    expected, duration = undisturbed(kind)
    path = tmp_path / "run.h5"
    random = np.random.default_rng(case)
    for arguments in ([*command(kind), "-o", str(path)], ["resume", str(path)]):  # the second one is killed too
        seen = kill(arguments, path, random.uniform(0.1, 1.0) * duration)
        if not path.exists():
            assert idealgas(*command(kind), "-o", path).returncode == 0
        assert rows_in(path) >= seen or arguments[0] == "resume"  # which first cuts off what it replaces
    with open_log(path) as log:
        unclosed = log.unclosed
    said = idealgas("info", path)
    assert (said.returncode, "was not closed" in said.stderr) == (0, unclosed)
    resumed(path)
    assert differences(path, expected) == []


@pytest.mark.long
@pytest.mark.parametrize("kind", SCENES)
def test_killed_ten_times(kind, undisturbed, tmp_path):
    """Each run is killed before long, so that all of them together do not come to the end."""
    expected, duration = undisturbed(kind)
    path = tmp_path / "run.h5"
    random = np.random.default_rng(TEN)
    for n in range(TEN):
        arguments = ["resume", str(path)] if path.exists() else [*command(kind), "-o", str(path)]
        kill(arguments, path, random.uniform(0.2, 0.9) * duration if n == 0 else random.uniform(0.1, 0.4) * duration)
    resumed(path)
    assert differences(path, expected) == []


@pytest.mark.parametrize("case", [0, *(pytest.param(case, marks=pytest.mark.long) for case in range(1, 20))])
def test_a_killed_run_that_is_watched(case, undisturbed, tmp_path):
    """Its page ends with it, the page of another process shows that it was killed, and the run goes on."""
    expected, duration = undisturbed("fast")
    path = tmp_path / "run.h5"
    seconds = duration + np.random.default_rng(case).uniform(0.1, 1.0) * duration  # watched, it takes longer
    arguments = [*command("fast"), "-o", str(path)]
    child = subprocess.Popen([IDEALGAS, *arguments, "--watch"], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while not path.exists() and child.poll() is None:
            time.sleep(0.02)
        watched = open_log(path)
        end = time.monotonic() + seconds
        while time.monotonic() < end and child.poll() is None:
            watched.refresh()
            time.sleep(0.02)
        pages = psutil.Process(child.pid).children()
    finally:
        child.send_signal(signal.SIGKILL)
        child.wait()
    psutil.wait_procs(pages, timeout=60)
    assert not any(page.is_running() for page in pages)
    with watched:
        watched.refresh()
        shown = Live(watched)
        assert not shown.running
        assert shown.curves(0)["state"].startswith(("not closed (crash?): ", "complete: "))
    resumed(path)
    assert differences(path, expected) == []


def page_of(address: str) -> tuple[str, bool]:
    """State of a run by the page at an address, and whether it shows a part of the motion."""

    def get(query: str) -> bytes:
        with urllib.request.urlopen(address + query, timeout=60) as answer:
            return answer.read()

    assert b"<title>" in get("")
    motion = json.loads(get("part?after=0&newest=1"))["motion"]
    return json.loads(get("curves?points=0"))["state"], motion is not None


@pytest.mark.parametrize("case", range(WATCHED))
def test_a_run_killed_while_another_process_shows_it(case, tmp_path):
    """The page of `idealgas watch` answers while the run goes on, after it was killed, and after it was resumed."""
    path, expected = tmp_path / "run.h5", tmp_path / "expected.h5"
    arguments = [*command("fast", "run.events=100_000_000"), "-o", str(path)]
    run = subprocess.Popen([IDEALGAS, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
    try:
        while state_of(path) != "running":
            assert run.poll() is None
            time.sleep(0.01)
        run.send_signal(signal.SIGSTOP)  # until there is a page
        with started("watch", path, "--no-browser") as (page, address):
            assert page_of(address)[0].startswith("running: ")
            run.send_signal(signal.SIGCONT)
            end = time.monotonic() + np.random.default_rng(case).uniform(0, 1)
            while time.monotonic() < end:
                assert page_of(address)[0].startswith("running: ")
            run.kill()
            run.wait()
            assert page_of(address)[0].startswith("not closed (crash?): ")
            later = f"run.events={rows_in(path) + 10_000}"
            resume(path, [later])
            state, moves = page_of(address)
            assert (state.startswith("complete: "), moves) == (True, True)
            assert ended(page) == (0, "")
    finally:
        run.kill()
        run.wait()
    simulate(scene_of("quickstart", *SCENES["fast"][1:], later), expected)
    assert differences(path, expected) == []
