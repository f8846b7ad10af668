"""Ranges of columns: the last number that is accepted and the first that is refused."""

import math

import numpy as np
import pytest

from idealgas.columns import Kind
from idealgas.log.check_parts import box_of, check_images, check_sizes, check_species
from idealgas.log.rules import LEAST, LONGEST, MOST, SLOWEST, Rules

pytestmark = pytest.mark.interpreted


def rules():
    """Of a box of 10 by 8 with three discs of two species and five walls, of which one absorbs discs."""
    return Rules((10.0, 8.0), 3, 2, 5, (Kind.ESCAPED,), 1)


@pytest.mark.parametrize(
    ("path", "data", "wrong"),
    [
        ("discs/velocity", [[1.0, SLOWEST / 10]], None),
        ("discs/velocity", [[SLOWEST / 10, 0.0]], "largest component 1e-62"),
        ("discs/velocity", [[0.0, 0.0]], None),
        ("discs/velocity", [[MOST, -MOST]], None),
        ("discs/velocity", [[0.0, -1.01 * MOST]], "-1.01e[+]50 in row 0"),
        ("discs/position", [[10.0, 8.0]], None),
        ("discs/position", [[8.0, 8.01]], "8.01 in row 0 .allowed 0 to 8."),
        ("discs/position", [[10.01, 8.0]], "10.01 in row 0 .allowed 0 to 10."),
        ("discs/position", [[math.nan, 1.0]], "nan in row 0"),
        ("checkpoints/position", [[math.nan, math.nan]], None),  # of a disc that has left
        ("events/position", [[math.nan, 1.0]], "nan"),
        ("events/disc", [0, 2], None),
        ("events/disc", [0, 3], "3 in row 8 .allowed 0 to 2."),
        ("events/partner", [-5, 2], None),
        ("events/partner", [-6], "-6 in row 7"),
        ("events/kind", [int(Kind.ESCAPED)], None),
        ("events/kind", [int(Kind.THERMOSTAT)], "THERMOSTAT in row 7, which this log cannot have"),
        ("events/time", [1.0, 1.0, 2.0], None),
        ("events/time", [1.0, 1.0, 2.0, 1.5], "decreases in row 10"),
        ("events/time", [0.0, LEAST / 2], "in row 8 .allowed 0 or >= 1e-100"),
        ("events/time", [LONGEST * 2], "2e[+]150"),
        ("discs/species", [0, 1], None),
        ("discs/species", [2], "2 in row 7 .allowed 0 to 1."),
        ("discs/mass", [LEAST, MOST], None),
        ("discs/mass", [0.0], "0 in row 7"),
        ("checkpoints/piston_position", [[10.0]], None),
        ("checkpoints/piston_position", [[10.1]], "10.1"),
        ("observables/energy/value", [-LONGEST], None),
        ("observables/energy/value", [math.inf], "inf in row 7"),
        ("checkpoints/last_collision", [-math.inf], None),
    ],
)
def test_ranges(path, data, wrong):
    start = 0 if path.startswith("discs/") and np.ndim(data) > 1 else 7
    if wrong is None:
        rules().check(path, np.array(data), start)
    else:
        with pytest.raises(ValueError, match=wrong):
            rules().check(path, np.array(data), start)


def test_chunks_follow_one_another():
    order = rules()
    order.check("events/time", np.array([3.0, 4.0]), 2)
    order.check("events/time", np.array([1.0, 3.0]), 0)
    with pytest.raises(ValueError, match="decreases from one chunk to the next"):
        order.check("events/time", np.array([3.9]), 4)
    order.check("events/time", np.array([4.0]), 4)


@pytest.mark.parametrize(
    ("check", "arguments", "wrong"),
    [
        (check_sizes, (5, 5, 4, 5), None),
        (check_sizes, (0, 1, 4, 5), "0 discs"),
        (check_sizes, (6, 1, 4, 5), "6 discs"),
        (check_sizes, (5, 6, 4, 9), "6 names for 5 discs"),
        (check_sizes, (5, 1, 3, 9), "3 walls"),
        (check_species, (np.array([0, 1, 1]), ["a", "b"]), None),
        (check_species, (np.array([0, 0]), ["a", "b"]), "no disc of species 1"),
        (check_species, (np.array([0, 1]), ["a", "a"]), "two species with the same name"),
        (check_species, (np.array([0, 1]), ["a", ""]), "without a name"),
        (check_images, (True, ["image"]), None),
        (check_images, (True, []), "missing, with periodic sides"),
        (check_images, (False, ["image"]), "present, without periodic sides"),
        (box_of, (np.array([3.0, MOST]),), None),
        (box_of, (np.array([3.0, 2 * MOST]),), "invalid width and height"),
    ],
)
def test_checks(check, arguments, wrong):
    if wrong is None:
        check(*arguments)
    else:
        with pytest.raises(ValueError, match=wrong):
            check(*arguments)
