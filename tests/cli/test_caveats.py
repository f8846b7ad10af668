"""Caveats that do not hold, as commands say them: on the terminal, beside CSV, in JSON and in reports."""

import json

import pytest
from helpers.support import ROOT, called, error_of

TWO = """
box.size = [1, 1]
species = [{name = "gas", count = 2, radius = 0.1, temperature = 1}]
run.events = 2000
"""
FLOW = """
box = {size = [10, 10], left = "periodic", right = "periodic", bottom = "periodic", top = "periodic"}
species = [{name = "gas", count = 4, radius = 0.5, velocities = [[3.1, 0], [2.9, 0.1], [3.1, 0], [2.9, -0.1]]}]
run.until = 200
"""
SWEEP = """
[sweep]
analyses = ["pressure"]
[[axis]]
key = "phi"
values = [0.05, 0.1]
[[axis]]
key = "species.count"
values = [100, 400]
[base]
box.size = [40, 40]
species = [{name = "gas", count = 20, radius = 0.3, temperature = 1.0}]
run.events = 20000
"""


@pytest.fixture(scope="module")
def states(tmp_path_factory):
    """A folder with the logs two.h5 and flow.h5."""
    folder = tmp_path_factory.mktemp("caveats")
    for name, text in (("two", TWO), ("flow", FLOW)):
        (folder / f"{name}.toml").write_text(text)
        assert called("run", f"{name}.toml", "-o", f"{name}.h5", folder=folder).returncode == 0
    return folder


def shown(*arguments, folder):
    result = called(*arguments, folder=folder)
    assert result.returncode == 0, result.stderr
    return result


@pytest.mark.slow
def test_two_discs_that_do_not_reach_all_states(states, tmp_path):
    line = "caveat: Two equal discs with zero total momentum between walls do not reach all states"
    for command in (("check", "two.toml"), ("pressure", "two.h5"), ("temperature", "two.h5")):
        said = [each for each in shown(*command, folder=states).stdout.splitlines() if each.startswith("caveat: ")]
        assert len(said) == 1
        assert said[0].startswith(line)
    assert "caveat: Two equal discs" in shown("follow", "two.h5", "--once", folder=states).stdout
    csv = shown("pressure", "two.h5", "--csv", folder=states)
    assert csv.stderr.startswith(line)
    assert "caveat" not in csv.stdout
    for command in (("check", "two.toml", "--json"), ("pressure", "two.h5", "--json")):
        (sentence,) = json.loads(shown(*command, folder=states).stdout)["caveats"]
        assert f"caveat: {sentence}".startswith(line)
    shown("report", "two.h5", "-o", tmp_path / "page.html", folder=states)
    assert f'<p class="note">{line}' in (tmp_path / "page.html").read_text(encoding="utf-8")
    for others in ((ROOT / "configs" / "quickstart.toml",), ("two.toml", "--set", "species.gas.count=3")):
        assert "caveat" not in shown("check", *others, folder=states).stdout


def test_a_flow_is_no_temperature(states):
    """The discs differ from (3, 0) by 0.1 along x, and two of them by 0.1 along y."""
    result = json.loads(shown("check", "flow.toml", "--json", folder=states).stdout)
    assert result["temperature"] == pytest.approx((4 * 0.01 + 2 * 0.01) / 6, rel=1e-9)  # 6 degrees of freedom
    line = "caveat: The gas moves as a whole with velocity (3, 0), 99.8% of its kinetic energy"
    assert line in shown("check", "flow.toml", folder=states).stdout
    said = " ".join(shown("follow", "flow.h5", "--once", folder=states).stdout.split())
    assert line in said
    assert "temperature │ 0.0075 │" in said


def test_a_free_expansion_is_no_effusion(states):
    scene = ROOT / "configs" / "free-expansion.toml"
    shown("run", scene, "-o", "wide.h5", "--set", "run.until=15", folder=states)
    refused = error_of("effusion", "wide.h5", folder=states)
    assert refused.startswith(
        "wide.h5: effusion requires a slit in a wall, but the gate opens the box from side to side"
    )
    shown("run", ROOT / "configs" / "effusion.toml", "-o", "narrow.h5", "--set", "run.until=15", folder=states)
    assert "caveat" not in shown("effusion", "narrow.h5", folder=states).stdout


@pytest.mark.slow
def test_a_sweep_of_few_states_gives_its_table(tmp_path):
    (tmp_path / "sweep.toml").write_text(SWEEP)
    shown("sweep", "sweep.toml", "-o", "out", "--workers", 1, folder=tmp_path)
    said = shown("pressure", "out", "--check", folder=tmp_path).stdout
    assert "No virial coefficients: a fit requires 4 packing fractions or more" in said
    assert sum(f", N = {number} " in line for line in said.splitlines() for number in (100, 400)) == 4
    twice = error_of("pressure", "out", "out", folder=tmp_path)
    assert twice == "out, point 0: given twice\n"
