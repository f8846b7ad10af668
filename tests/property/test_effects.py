"""Every allowed pair of effects, and all at once: the event-driven log is that of brute force, float for float."""

from itertools import combinations

import numpy as np
import pytest
from helpers.effect_samples import NAMES, allowed, log_of, make_effects, make_gas

from idealgas.engine.brute_force import BruteForce
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Stop

SETS = [set(), *({name} for name in NAMES)]
SETS += [pair for pair in map(set, combinations(NAMES, 2)) if allowed(pair)]
LOCAL = tuple(name for name in NAMES if name not in ("thermostat", "noninteracting"))
"""A thermostat collision concerns one disc and nothing that it meets: pairs with the thermostat are enough.

So are pairs with discs that do not interact, as these only lack events.
"""
SETS += [set(triple) for triple in combinations(LOCAL, 3) if allowed(set(triple))]
ALL = set(NAMES) - {"periodic", "inner", "shear", "noninteracting"}
ALL_PERIODIC = set(NAMES) - {"piston", "inner", "shear", "noninteracting"}
ALL_PISTONS = set(NAMES) - {"periodic", "shear", "noninteracting"}
ALL_ALONE = set(NAMES) - {"periodic", "shear"}
SETS += [ALL, ALL_PERIODIC, ALL_PISTONS, ALL_ALONE]


def assert_same_log(names: set[str], seed: int, events: int, shape=(4, 3)) -> None:
    gas = make_gas(seed, *shape)
    oracle = log_of(gas, make_effects(names, gas), BruteForce(), Stop(events=events), 65_536)
    for filling, rows in ((None, 65_536), (0.2, 7), (1e9, 65_536)):
        columns = log_of(gas, make_effects(names, gas), EventDriven(filling), Stop(events=events), rows)
        assert all(np.array_equal(a, b) for a, b in zip(columns, oracle, strict=True)), (filling, rows)


@pytest.mark.interpreted
@pytest.mark.needs("an interpreted engine")  # would compile for each set
@pytest.mark.parametrize("names", SETS, ids=lambda names: "+".join(sorted(names)) or "plain")
def test_same_log_as_the_oracle(names):
    assert_same_log(names, 1, 25)


@pytest.mark.parametrize(
    "names",
    [
        pytest.param(ALL, id="all but periodic sides", marks=pytest.mark.long),
        pytest.param(ALL_PERIODIC, id="all but the piston", marks=pytest.mark.long),
        pytest.param(ALL_PISTONS, id="all with two pistons", marks=pytest.mark.long),
    ],
)
@pytest.mark.parametrize("seed", range(3))
@pytest.mark.slow
def test_same_log_as_the_oracle_with_everything(names, seed):
    assert_same_log(names, seed, 5_000)
