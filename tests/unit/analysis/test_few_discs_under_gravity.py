"""Four discs at fixed energy under gravity are colder the higher one of them is, and denser at the floor."""

import pytest

from idealgas.analysis.profile import ProfileAnalysis

GAS = """
scene.seed = 1
box.size = [2, 12]
gravity.acceleration = [0, -1]
species = [{ name = "gas", count = 4, radius = 0.05, temperature = 1, region = [0, 0, 2, 2] }]
run.until = 20_000
log.compression = "none"
"""


@pytest.mark.parametrize("sides", [(), ("box.left=periodic", "box.right=periodic")], ids=["walls", "periodic"])
def test_a_column_of_four_discs(make, sides):
    """Profiles of eight strips within four standard errors of theory, which falls by more than a third among them."""
    found = ProfileAnalysis.measure(make(*sides), bins=8)
    (gas,) = found.species
    assert found.law.startswith("barometric at fixed energy")
    warm = [warmth for warmth in gas.temperature if warmth.standard_error < 0.1 * warmth.value]
    assert warm[-1].theory < 0.65 * warm[0].theory
    for estimate in (*gas.density[: len(warm)], *warm):
        assert abs(estimate.deviation) < 4
        print(estimate)


def test_there_is_no_theory_of_many_kinds(make):
    """The time of that of fixed energy grows as their square: 16 kinds have one, 17 have none."""
    kinds = "".join(f', {{ name = "k{k}", count = 1, radius = 0.0{k}, temperature = 1 }}' for k in range(10, 26))
    laws = [
        ProfileAnalysis.measure(make("run.until=300", f"species=[{text[2:]}]"), bins=2).law
        for text in (kinds, kinds + ', { name = "x", count = 1, radius = 0.026, temperature = 1 }')
    ]
    assert laws[0].startswith("barometric at fixed energy")
    assert laws[1] is None
