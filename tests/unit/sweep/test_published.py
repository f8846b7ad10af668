"""Values of papers in the file of a sweep: checked with its points, and set beside what the sweep finds."""

import json
import math

import pytest
from helpers.support import ROOT, error_of, output_of

from idealgas.errors import UserError
from idealgas.scene import SceneError
from idealgas.sweep.plan import load_sweep
from idealgas.sweep.published import PublishedComparison, published_tables
from idealgas.sweep.run import run_sweep

CLASSICS = sorted((ROOT / "configs" / "classics").glob("*.toml"))
TOO_LOW = {
    ("metropolis-1953", "phi = 0.60829"),
    ("metropolis-1953", "phi = 0.68722"),
    ("novak-bortz-1970", "base scene"),
}
"""Published values that later papers, or the paper's own rule, do not confirm: see the file of the sweep."""

SWEEP = """
[sweep]
replicates = 2
analyses = ["pressure"]
keep_logs = false
[[axis]]
key = "phi"
values = [0.1, 0.2]
[base]
box = { size = [10, 10], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic" }
species = [{ name = "gas", count = 20, radius = 0.5, temperature = 1 }]
run.events = 2000
[[published]]
source = "A paper"
quantity = "pressure.routes.pairs_virial.compressibility_factor"
values = [1.2, 1.5]
errors = [0.1, 0.0]
note = "Low."
"""


@pytest.fixture
def plan(tmp_path):
    path = tmp_path / "sweep.toml"
    path.write_text(SWEEP)
    return path


def test_averages_beside_the_paper(plan, tmp_path):
    output_of("sweep", plan, "-o", tmp_path / "out", "--workers", 1)
    rows = json.loads(output_of("sweep", plan, "-o", tmp_path / "out", "--json"))["results"]
    (table,) = published_tables(load_sweep(plan), tmp_path / "out")
    assert (table.title, table.notes[1:]) == ("A paper", ("Low.",))
    for row, phi, paper, error in zip(table.rows, (0.1, 0.2), (1.2, 1.5), (0.1, 0.0), strict=True):
        of = [r for r in rows if r["phi"] == phi and r["quantity"] == table.notes[0]]
        mean = sum(r["value"] for r in of) / 2
        standard_error = sum(r["standard_error"] ** 2 for r in of) ** 0.5 / 2
        numbers = [cell.value for cell in row[1:]]
        assert row[0] == f"phi = {phi}"
        assert numbers[:4] == pytest.approx([mean, standard_error, paper, error])
        assert numbers[4] == pytest.approx((mean - paper) / (standard_error**2 + error**2) ** 0.5)


def test_one_value_for_each_point_and_exact_values_agree_or_do_not(plan):
    plan.write_text(SWEEP.replace("[1.2, 1.5]", "[1.2]"))
    with pytest.raises(SceneError) as caught:
        load_sweep(plan)
    (line,) = caught.value.errors
    assert line == f"{plan}:16: published.0.values: not one for each point (got 1 numbers; allowed 2)"
    assert PublishedComparison("", 3.0, 0.0, 3.0, 0.0).deviation == 0
    assert PublishedComparison("", 3.0, 0.0, 4.0, 0.0).deviation == -math.inf
    assert PublishedComparison("", 3.0, 0.3, 4.0, 0.4).deviation == pytest.approx(-2)


def test_an_unknown_quantity_is_said(plan, tmp_path):
    plan.write_text(SWEEP.replace("pairs_virial.comp", "pairs.comp"))
    output_of("sweep", ROOT / "configs" / "classics" / "galperin-2003.toml", "-o", tmp_path / "out", "--workers", 1)
    with pytest.raises(UserError, match=r"unknown quantity .*run\.events"):
        list(published_tables(load_sweep(plan), tmp_path / "out"))


def test_several_sweeps_have_one_figure(plan, tmp_path):
    """A folder for each, one list as JSON, and one figure of all deviations, a row for each paper."""
    pi = ROOT / "configs" / "classics" / "galperin-2003.toml"
    drawn = tmp_path / "classics.svg"
    result = json.loads(
        output_of("sweep", plan, pi, "-o", tmp_path / "out", "--workers", 1, "--json", "--plot", drawn, "-q")
    )
    assert [each["ran"] for each in result] == [4, 4]
    assert [each["files"][0] for each in result] == [
        str(tmp_path / "out" / name / "results.csv") for name in ("sweep", "galperin-2003")
    ]
    text = drawn.read_text()
    assert all(part in text for part in ("A paper (2)", "Chaotic Dyn. 8, 375 (2003) (4)", "±3σ"))
    assert "two sweeps have this name, and so" in error_of("sweep", plan, plan, "-o", tmp_path / "twice")
    plan.write_text(SWEEP.partition("[[published]]")[0])
    line = error_of("sweep", plan, pi, "-o", tmp_path / "out", "--plot", tmp_path / "y.png")
    assert line == "--plot: several sweeps can only be plotted together against published values\n"


def test_python_writes_the_tables_as_the_command(plan, tmp_path):
    outcome = run_sweep(load_sweep(plan), tmp_path / "out", workers=1)
    assert outcome.files[0] == str(tmp_path / "out" / "results.csv")
    written = (tmp_path / "out" / "results.csv").read_bytes()
    output_of("sweep", plan, "-o", tmp_path / "out")
    assert (tmp_path / "out" / "results.csv").read_bytes() == written


def test_digits_of_pi(tmp_path):
    """Galperin, Regul. Chaotic Dyn. 8, 375 (2003): exact."""
    plan = ROOT / "configs" / "classics" / "galperin-2003.toml"
    shown = output_of("sweep", plan, "-o", tmp_path / "out", "--workers", 1)
    assert [line.split("│")[2].strip() for line in shown.splitlines() if "disc.1.mass =" in line] == [
        "3", "31", "314", "3141"
    ]  # fmt: skip


@pytest.mark.parametrize("path", CLASSICS, ids=lambda path: path.stem)
def test_classics_are_valid(path):
    assert load_sweep(path).published


@pytest.mark.long
@pytest.mark.parametrize("path", CLASSICS, ids=lambda path: path.stem)
def test_classics(path, tmp_path):
    """Each within 3 standard errors of the paper's value and of its own together."""
    plan = load_sweep(path)
    output_of("sweep", path, "-o", tmp_path / "out")
    for table in published_tables(plan, tmp_path / "out"):
        for name, *_, off in table.rows:
            assert abs(off.value) < 3 or (path.stem, name) in TOO_LOW, (table.title, name)
