"""A new analysis is one file: commands, report, sweeps and the Python interface then have it.

The package is copied, and the copy gets the file; everything else of it is as it was. Its commands run as for users.
"""

import csv
import json

import pytest
from helpers.fresh_python import COMMAND, package_copy

pytestmark = pytest.mark.slow

MODULE = '''"""Measure the speed of the fastest disc at the end."""

from dataclasses import dataclass

import numpy as np

from idealgas.analysis.analysis import Analysis, Option, Section
from idealgas.analysis.result import Result
from idealgas.statistics.estimates import Estimate
from idealgas.presentation.style import panels
from idealgas.presentation.tables import estimates
from idealgas.errors import UserError


@dataclass(frozen=True)
class Fastest(Result):
    speeds: np.ndarray
    speed: Estimate

    def plain_tables(self):
        return [estimates("Of one disc", [("speed", self.speed)], ["at the end"])]

    def figure(self):
        figure, (ax,) = panels(1)
        ax.plot(self.speeds)
        return figure


class FastestDisc(Analysis):
    results = (Fastest,)
    options = (Option("rank", int, "Which disc, 1 for the fastest.", default=1, least=1, metavar="K"),)
    sections = (
        Section("The fastest disc", "Speeds of all discs"),
        Section("The disc after a thousand", "Speeds of all discs", {"rank": 1000}),
    )

    @staticmethod
    def measure(log, start=None, end=None, progress=None, rank=1):
        speeds = np.sort(np.hypot(*log.state_at(log.end_time if end is None else end).velocity.T))
        if rank > len(speeds):
            raise UserError(f"{log.path}: has {len(speeds)} discs")
        return Fastest(speeds, Estimate(float(speeds[-rank]), 0.0, 1.0))
'''

SCENE = """
# without positions few other analyses apply
scene.seed = 3
run.method = "monte_carlo"
box.size = [10, 10]
species = [{name = "gas", count = 20, radius = 0.3, temperature = 1.0}]
run.events = 500
"""

SWEEP = """
sweep.analyses = ["fastest-disc"]
sweep.scene = "scene.toml"
[[axis]]
key = "species.temperature"
values = [1.0, 4.0]
"""


@pytest.fixture(scope="module")
def idealgas(tmp_path_factory):
    """The command of a copy of the package that has the analysis, in a folder with a scene and its log."""
    copy, folder = tmp_path_factory.mktemp("package"), tmp_path_factory.mktemp("folder")
    python = package_copy(copy, folder)
    (copy / "idealgas" / "analysis" / "fastest_disc.py").write_text(MODULE)

    def run(*arguments, code=0):
        return python(COMMAND, *arguments, code=code)

    run.python = python
    run.folder = folder
    (folder / "scene.toml").write_text(SCENE)
    (folder / "sweep.toml").write_text(SWEEP)
    run("run", "scene.toml", "-o", "run.h5")
    return run


def test_the_command_is_there(idealgas):
    assert "fastest-disc   Measure the speed of the fastest disc at the end." in idealgas("--help")
    shown = idealgas("fastest-disc", "--help")
    for option in ("--rank K", "--from T", "--to T", "--plot FILE.png", "--json", "--csv"):
        assert option in shown


def test_tables_json_csv_and_pictures(idealgas):
    speed = json.loads(idealgas("fastest-disc", "run.h5", "--json"))["speed"]["value"]
    table = idealgas("fastest-disc", "run.h5")
    assert "at the end\nOf one disc" in table
    assert f"{speed:.6g}" in table
    rows = csv.DictReader(idealgas("fastest-disc", "run.h5", "--csv").splitlines())
    assert [float(row["value"]) for row in rows if row["quantity"] == "fastest_disc.speed"] == [speed]
    second = json.loads(idealgas("fastest-disc", "run.h5", "--rank", 2, "--json"))["speed"]["value"]
    assert 0 < second < speed
    idealgas("fastest-disc", "run.h5", "--plot", "speeds.png")
    assert (idealgas.folder / "speeds.png").stat().st_size > 5000
    assert "--rank" in idealgas("fastest-disc", "run.h5", "--rank", 0, code=2)


def test_python_has_its_function(idealgas):
    speed = json.loads(idealgas("fastest-disc", "run.h5", "--rank", 2, "--json"))["speed"]["value"]
    code = """if True:
        import idealgas
        with idealgas.open_log("run.h5") as log:
            found = idealgas.fastest_disc(log, rank=2)
        print(found.speed.value)
        print(found)
    """
    printed = idealgas.python(code).splitlines()
    assert (float(printed[0]), printed[1:3]) == (speed, ["at the end", "Of one disc"])


def test_the_report_has_its_sections_or_says_why_not(idealgas):
    idealgas("report", "run.h5", "-o", "report.html")
    page = (idealgas.folder / "report.html").read_text(encoding="utf-8")
    assert "<h2>The fastest disc</h2>" in page
    assert "<caption>Of one disc</caption>" in page
    assert "<li>The disc after a thousand: has 20 discs</li>" in page


def test_a_sweep_asks_for_it(idealgas):
    idealgas("sweep", "sweep.toml", "-o", "out", "--workers", 1)
    with (idealgas.folder / "out" / "results.csv").open() as file:
        rows = [row for row in csv.DictReader(file) if row["quantity"] == "fastest_disc.speed"]
    assert [row["point"] for row in rows] == ["0", "1"]
    for row in rows:
        log = f"out/points/{int(row['point']):04d}.h5"
        assert float(row["value"]) == json.loads(idealgas("fastest-disc", log, "--json"))["speed"]["value"]
    (idealgas.folder / "wrong.toml").write_text(SWEEP.replace("fastest-disc", "fastest"))
    error = idealgas("sweep", "wrong.toml", "--dry-run", code=2)
    assert error.startswith("wrong.toml:2: sweep.analyses.0: unknown value")
    assert '"fastest-disc", ' in error
