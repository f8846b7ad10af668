"""`idealgas run` killed at a random moment and gone on with: the log is that of a run that nobody disturbed."""

import signal
import subprocess
import time
from pathlib import Path

import numpy as np
import pytest
from log_compare import NO_END, differences
from support import IDEALGAS, ROOT, idealgas

from idealgas.log import open_log

pytestmark = pytest.mark.slow

IN_CI, BY_HAND = 2, 40
SCENES = {
    "fast": ("quickstart", "run.events=1000000", "log.snapshot_every=5"),
    "slow": ("mixing", "run.method=brute_force", "run.events=6000", 'log.compression="none"'),
}


def command(kind: str) -> list[str]:
    name, *overrides = SCENES[kind]
    settings = [argument for override in (*NO_END, *overrides) for argument in ("--set", override)]
    return ["run", str(ROOT / "configs" / f"{name}.toml"), *settings]


@pytest.fixture(scope="module")
def undisturbed(tmp_path_factory):
    """Log and duration of the run of each kind."""
    folder = tmp_path_factory.mktemp("undisturbed")
    made = {}
    for kind in SCENES:
        idealgas(*command(kind), "-o", folder / f"{kind}-first.h5")  # compiles
        started = time.monotonic()
        result = idealgas(*command(kind), "-o", folder / f"{kind}.h5")
        assert result.returncode == 0, result.stderr
        made[kind] = folder / f"{kind}.h5", time.monotonic() - started
    return made


def rows_in(path: Path) -> int:
    """Rows committed now, 0 before the file is there. Once it is there it opens."""
    if not path.exists():
        return 0
    with open_log(path) as log:
        return len(log)


@pytest.mark.parametrize(
    "case", [*range(IN_CI), *(pytest.param(case, marks=pytest.mark.long) for case in range(IN_CI, BY_HAND))]
)
def test_killed_and_resumed(case, undisturbed, tmp_path):
    kind = list(SCENES)[case % len(SCENES)]
    expected, duration = undisturbed[kind]
    path = tmp_path / "run.h5"
    random = np.random.default_rng(case)
    for arguments in ([*command(kind), "-o", str(path)], ["resume", str(path)]):  # the second one is killed too
        child = subprocess.Popen([IDEALGAS, *arguments], stdout=subprocess.DEVNULL, stderr=subprocess.PIPE)
        seen, end = 0, time.monotonic() + random.uniform(0.1, 1.0) * duration
        try:
            while time.monotonic() < end and child.poll() is None:
                seen = max(seen, rows_in(path))
                time.sleep(0.02)
        finally:
            child.send_signal(signal.SIGKILL)
            child.communicate()
        if not path.exists():
            assert idealgas(*command(kind), "-o", path).returncode == 0
        assert rows_in(path) >= seen or arguments[0] == "resume"  # which first cuts off what it replaces
    with open_log(path) as log:
        unclosed = log.unclosed
    said = idealgas("info", path)
    assert (said.returncode, "its writer died" in said.stderr) == (0, unclosed)
    resumed = idealgas("resume", path)
    assert (resumed.returncode, resumed.stderr) == (0, "")
    assert differences(path, expected) == []
