"""Functions that do nothing for absent effects are not compiled, and give the same results as in Python."""

from typing import NamedTuple

import numba
import numpy as np
import pytest
from numba import types

from idealgas.jit import inline, njit
from idealgas.jit.dependencies import part_of
from idealgas.jit.trial import leave_out

NUMBER = 7


class Effects(NamedTuple):
    """Two effects."""

    gravity: float | None
    piston: float | None


@inline
def nothing(x, effect):
    if effect is not None:
        x[0] = effect


@inline
def number(x, effect):
    return NUMBER if effect is None else x


@inline
def argument(x, effect):
    return x if effect is None else x + effect


@inline
def several(x, effect):
    return (x, 2.5, False) if effect is None else (effect, x, True)


@inline
def behind_another(x, effect):
    nothing(x, effect)
    return argument(x, effect)


@inline
def of_a_bundle(x, effects):
    return several(x, effects.gravity)


IDLE = {
    nothing: (types.none, None),
    number: (types.int64, 7),
    argument: (types.float64, 3.0),
    several: (types.Tuple([types.float64, types.float64, types.boolean]), (3.0, 2.5, False)),
    behind_another: (types.float64, 3.0),
}


@pytest.mark.parametrize("function", IDLE, ids=lambda function: function.__name__)
def test_a_function_that_does_nothing_is_left_out(function):
    """Its type and value are those that numba finds when it compiles the function."""
    part = part_of(function)
    assert part.key in leave_out(part, (types.float64, types.none))
    (signature,) = part.compiled.nopython_signatures
    kind, result = IDLE[function]
    assert signature.return_type == kind
    if function is not behind_another:
        compiled = numba.njit(function)
        assert compiled(3.0, None) == result
        by_numba = compiled.nopython_signatures[0].return_type  # with the values of constants
        if isinstance(by_numba, types.BaseTuple):
            by_numba = types.Tuple([types.unliteral(each) for each in by_numba])
        assert types.unliteral(by_numba) == kind


def test_functions_behind_it_count_and_an_effect_in_a_bundle_is_absent():
    keys = leave_out(part_of(behind_another), (types.int64, types.none))
    assert {key.rpartition(".")[2] for key in keys} == {"behind_another", "nothing", "argument"}
    bundle = numba.typeof(Effects(None, 2.0))
    assert len(leave_out(part_of(of_a_bundle), (types.float64, bundle))) == 2
    with pytest.raises(TypeError):
        leave_out(part_of(of_a_bundle), (types.float64, numba.typeof(Effects(2.0, None))))


def sets_an_attribute(x, effect):
    x.t = 1.0


def sets_an_item(x, effect):
    x[0] = 1.0


def adds_to_an_attribute(x, effect):
    x.t += 1.0


DOING = {
    "setting an attribute": sets_an_attribute,
    "setting an item": sets_an_item,
    "adding to an attribute": adds_to_an_attribute,
    "arithmetic": lambda x, effect: x + 1.0,
    "sign": lambda x, effect: -x,
    "comparison": lambda x, effect: 1 if x > 0.0 else 2,
    "equality": lambda x, effect: 1 if x == 0.0 else 2,
    "inequality": lambda x, effect: 1 if x != 0.0 else 2,
    "truth": lambda x, effect: 1 if x else 2,
    "negation": lambda x, effect: not x,
    "attribute": lambda x, effect: x.t,
    "item": lambda x, effect: x[0],
    "unpacking": lambda x, effect: (lambda a, b: a)(*x),
    "function of numpy": lambda x, effect: np.sqrt(2.0),
    "function that is built in": lambda x, effect: max(1.0, 2.0),
    "class": lambda x, effect: Effects(1.0, 2.0),
    "text": lambda x, effect: "text",
    "effect": lambda x, effect: None,
}


@pytest.mark.parametrize("what", DOING)
def test_a_function_that_does_something_is_compiled(what):
    """Nothing can be done in the trial with an argument of unknown value, and nothing be called that is no part."""
    kinds = (types.float64, types.Optional(types.float64) if what == "effect" else types.none)
    with pytest.raises((TypeError, AttributeError, NameError)):
        leave_out(part_of(inline(DOING[what])), kinds)


@njit
def all_of_them(x, effects, out):
    nothing(x, effects.gravity)
    a, b, c = of_a_bundle(x, effects)
    out[0] = number(x, effects.gravity)
    out[1] = argument(x, effects.gravity)
    out[2] = behind_another(x, effects.gravity)
    out[3] = argument(x, effects.piston)
    out[4] = a + b if not c else 0.0


def test_compiled_code_has_the_results_of_python():
    out, expected = np.zeros(5), np.zeros(5)
    all_of_them(3.0, Effects(None, 2.0), out)
    getattr(all_of_them, "py_func", all_of_them)(3.0, Effects(None, 2.0), expected)
    assert out.tolist() == expected.tolist() == [7.0, 3.0, 3.0, 5.0, 5.5]
