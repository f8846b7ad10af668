"""Columns of events: declared once, and what a batch, a log and a table of one number a column make of them."""

import numpy as np
import pytest
from helpers.support import logged

from idealgas.columns import (
    EVENT_COLUMNS,
    IMAGES,
    PLAIN_COLUMNS,
    POSITIONS,
    SPINS,
    TRIALS,
    EventBatch,
    columns_named,
    empty_batch,
    event_columns,
)
from idealgas.initial.build import make_gas
from idealgas.run.effects import make_effects
from idealgas.run.layout import row_columns
from idealgas.scene import parse_scene

ALWAYS = ("time", "disc", "partner", "kind", "velocity")


def names(columns):
    return tuple(column.name for column in columns)


def test_a_batch_has_the_declared_columns_in_their_order():
    assert EventBatch._fields == names(EVENT_COLUMNS)


@pytest.mark.parametrize(
    ("has", "more"),
    [
        ((), ()),
        ((POSITIONS,), ("position",)),
        ((POSITIONS, SPINS, IMAGES), ("position", "angular_velocity", "image")),
        ((SPINS, TRIALS), ("angular_velocity", "trial")),
    ],
)
def test_which_columns_there_are(has, more):
    columns = event_columns(*has)
    assert set(names(columns)) == {*ALWAYS, *more}
    assert columns_named(names(columns)) == columns
    batch = empty_batch(7, columns)
    for declared, made in zip(EVENT_COLUMNS, batch, strict=True):
        if declared in columns:
            assert (made.shape, made.dtype, made.flags.c_contiguous) == ((7, *declared.shape), declared.dtype, True)
        else:
            assert made is None


def test_a_plain_gas_has_positions_and_nothing_more():
    assert names(PLAIN_COLUMNS) == ("time", "disc", "partner", "kind", "position", "velocity")
    assert [column is None for column in empty_batch(1)] == [False] * 6 + [True] * 3


GAS = """
box.size = [10, 10]
run.events = 20
species = [{ name = "gas", count = 12, radius = 0.4, temperature = 1 }]
"""
MONTE_CARLO = ("run.method=monte_carlo", "run.trials=200")


@pytest.mark.parametrize(
    ("overrides", "has"),
    [
        ((), (POSITIONS,)),
        (("rotation.roughness=1", "box.left=periodic", "box.right=periodic"), (POSITIONS, SPINS, IMAGES)),
        (("restitution.normal=0.9", "box.left={ thermal = 1 }"), (POSITIONS,)),
        (MONTE_CARLO, (TRIALS,)),
        (("rotation.roughness=1", *MONTE_CARLO), (TRIALS, SPINS)),
    ],
)
def test_a_log_has_the_columns_of_its_discs(overrides, has, tmp_path):
    """By name, type and shape, in the file as in the batch."""
    scene = parse_scene(GAS, overrides=overrides)
    columns = event_columns(*has)
    assert row_columns(make_effects(scene, make_gas(scene)), POSITIONS in has) == columns
    with logged(scene, tmp_path / "run.h5") as log:
        assert set(log.columns) == set(names(columns))
        (block,) = log.chunks()
        assert isinstance(block, EventBatch)
        for column in columns:
            stored = getattr(block, column.name)
            assert (stored.dtype, stored.shape[1:]) == (np.dtype(column.dtype), column.shape)
