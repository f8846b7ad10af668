"""The command `idealgas bench`."""

import json

import pytest
from click.testing import CliRunner
from idealgas_cli.main import main

from idealgas.bench.figure import PEERS

SHORT = ("bench", "--number", "10,40", "--phi", "0.1", "--collisions", "20", "--repeats", "1")


def bench(*options):
    return CliRunner().invoke(main, [*SHORT, *map(str, options)])


def test_a_grid_is_measured_and_drawn(tmp_path):
    done = bench("--json", "--plot", tmp_path / "bench.svg")
    assert done.exit_code == 0, done.output
    rows = json.loads(done.stdout)["rows"]
    assert [(row["N"], row["threads"], row["log"]) for row in rows] == [(n, 1, log) for n in (10, 40) for log in (0, 1)]
    picture = (tmp_path / "bench.svg").read_text()
    assert picture.startswith("<?xml")
    for words in ("number of discs N", "time per collision", "φ = 0.1, 1 thread", PEERS[0].name):
        assert f"<!-- {words}" in picture


@pytest.mark.parametrize(
    ("options", "complaint"),
    [
        (("--plot", "bench.txt"), "bench.txt: unknown figure format"),
        (("--plot", "bench.png", "--effects"), "--plot cannot be combined with --effects"),
        (("--threads", "0"), "the number of threads must be 1 to 256"),
        (("--number", "many"), "not numbers separated by commas"),
    ],
)
def test_what_makes_no_sense_is_refused(options, complaint):
    done = bench(*options)
    assert done.exit_code == 2
    assert complaint in done.stderr
