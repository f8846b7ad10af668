"""The command `idealgas bench`."""

import json

from helpers.support import called

from idealgas.bench.figure import PEERS


def test_a_grid_is_measured_and_drawn(tmp_path):
    short = ("--number", "10,40", "--phi", "0.1", "--collisions", "20", "--repeats", "1")
    rows = json.loads(called("bench", *short, "--json", "--plot", tmp_path / "bench.svg").stdout)["rows"]
    assert [(row["N"], row["threads"], row["log"]) for row in rows] == [(n, 1, log) for n in (10, 40) for log in (0, 1)]
    picture = (tmp_path / "bench.svg").read_text()
    assert picture.startswith("<?xml")
    for words in ("number of discs N", "time per collision", "φ = 0.1, 1 thread", PEERS[0].name):
        assert f"<!-- {words}" in picture
