"""Coefficients of several logs over Enskog's, averaged over runs of one state, from logs and from sweeps."""

import json
from dataclasses import replace

import pytest
from helpers.logs import gas

from idealgas.analysis import registry

GAS = gas(12, 0.3, (6, 5), "collisions_per_disc = 60", periodic="xy", temperature=1.0)
ANALYSIS = registry.find("transport")


@pytest.fixture(scope="module")
def results(make):
    """Two runs of 12 discs and one of 20."""
    runs = ((1, 12), (2, 20), (3, 12))
    return [registry.analyse(make(f"scene.seed={seed}", f"species.gas.count={n}"), "transport") for seed, n in runs]


def test_states(results):
    states = ANALYSIS.combined(results).states
    assert [(state.number, state.runs) for state in states] == [(12, 2), (20, 1)]
    assert list(states[0].coefficients) == ["D", "η", "λ", "ζ"]
    alone = results[1].collective.coefficients["viscosity"].value
    assert states[1].coefficients["η"].value == pytest.approx(alone.value / alone.theory)
    assert states[1].coefficients["η"].standard_error == pytest.approx(alone.standard_error / alone.theory)
    both = [results[k].diffusion[0].coefficient for k in (0, 2)]
    assert states[0].coefficients["D"].value == pytest.approx(sum(each.value / each.theory for each in both) / 2)
    assert all(each.theory == pytest.approx(1.0) for state in states for each in state.coefficients.values())


def test_what_a_sweep_stores_gives_the_same(results):
    stored = [json.loads(json.dumps(result.as_dict())) for result in results]
    restored = [ANALYSIS.restored(values, run.origin) for values, run in zip(stored, results, strict=True)]
    assert ANALYSIS.combined(restored).states == ANALYSIS.combined(results).states


def test_a_single_log_stays_as_it_is(results):
    assert ANALYSIS.combined(results[:1]) is results[0]


def test_tables_and_figures(results):
    combined = ANALYSIS.combined(results)
    (table,) = combined.plain_tables()
    assert len(table.rows) == 8
    (ax,) = combined.figure().axes
    assert {"D", "η", "λ", "ζ", "Enskog's theory, bands: its errors"} == {
        text.get_text() for text in ax.get_legend().get_texts()
    }
    assert ANALYSIS.combined([results[0], results[2]]).figure().axes[0].get_xlabel().startswith("packing")
    closer = [replace(result, packing_fraction=0.3 + 1e-15 * k) for k, result in enumerate(results)]
    assert ANALYSIS.combined(closer).figure().axes[0].get_xlabel() == "number of discs"
