"""Every analysis of gases at the edges of what `check` accepts: right numbers, or one clear line."""

import json
import math

import pytest
from helpers.small_gases import PERIODIC
from helpers.support import called, output_of

from idealgas.analysis import registry
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

GAS = "[box]\nsize = [8, 8]\n[[species]]\nname = 'gas'\ncount = 40\nradius = 0.2\n[run]\ncollisions_per_disc = 40\n"
LARGE = ("species.gas.radius=2e27", "species.gas.mass=1e30", "species.gas.speed=1e29")
HOT, HOTTER = (
    ("species.gas.temperature=1", f"box={{size=[8, 8], left={{thermal=1}}, right={{thermal={t}}}}}")
    for t in ("1e8", "1e14")
)
EXTREMES = {
    "large, heavy and fast": ("box.size=[8e28, 8e28]", *LARGE),
    "periodic": (PERIODIC.replace("[8, 8]", "[8e28, 8e28]"), *LARGE),
    "hot wall": HOT,
    "hotter wall": HOTTER,
}
OTHERS = {
    "large box": ("box.size=[8e28, 8e28]", "species.gas.radius=2e27", "species.gas.temperature=1"),
    "fast": ("species.gas.speed=1e29",),
}


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    """The log of one of these gases, made once."""
    folder = tmp_path_factory.mktemp("extremes")

    def make(name):
        path = folder / f"{name}.h5"
        if not path.exists():
            simulate(parse_scene(GAS, overrides=(EXTREMES | OTHERS)[name]), path)
        return path

    return make


@pytest.mark.parametrize("name", EXTREMES)
def test_numbers_or_one_line(name, log, tmp_path):
    """Of every command; the report with all pictures is written without a warning."""
    path = log(name)
    for command in registry.commands():
        done = called(command, path)
        lines = done.stderr.strip().splitlines()
        assert (done.returncode, len(lines)) in ((0, 0), (2, 1)), (command, done.stderr)
    output_of("report", path, "-o", tmp_path / "report.html")


def test_numbers_of_a_large_box(log):
    """P = N T/A = 40/(8e28)² without collisions, and Henderson's Z = (1 + φ²/8)/(1 - φ)² = 1.1786 for many discs."""
    result = json.loads(output_of("pressure", log("large box"), "--json"))
    filling = 40 * math.pi * 2e27**2 / 8e28**2
    henderson = (1 + filling**2 / 8) / (1 - filling) ** 2
    pairs = next(route for route in result["routes"] if route["route"] == "pairs, virial")
    z = pairs["compressibility_factor"]
    assert abs(z["value"] - henderson) < 4 * z["standard_error"]
    assert pairs["pressure"]["value"] / z["value"] == pytest.approx(40 / 8e28**2)


def test_numbers_of_fast_discs(log):
    """⟨v⟩ of N = 40 discs with ⟨v²⟩ = v₀² at fixed energy: v₀ √π/2 Γ(N)/Γ(N + 1/2) √N = 0.8890 v₀."""
    (result,) = json.loads(output_of("histogram", log("fast"), "--json"))["distributions"]
    expected = 1e29 * math.sqrt(math.pi * 40) / 2 * math.exp(math.lgamma(40) - math.lgamma(40.5))
    assert result["mean"]["theory"] == pytest.approx(expected)
    assert abs(result["mean"]["value"] - expected) < 4 * result["mean"]["standard_error"]
