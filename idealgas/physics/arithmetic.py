"""Arithmetic by type: one source of an algorithm serves floats of any length, and pairs of them with twice the digits.

`add(a, b)` and the others are `a + b` for floats and `double_double.add(a, b)` for pairs, decided when the caller is
compiled. A column of numbers is an array (n,) of floats, or (n, 2) of pairs.
"""

import math
from typing import Any

import numpy as np
from numba import types
from numba.extending import overload

from idealgas.physics import double_double as pairs

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "forceinline": True}


def _is_pair(a: Any) -> bool:
    return isinstance(a, tuple | types.BaseTuple)


def add(a, b):
    """a + b."""
    return pairs.add(a, b) if _is_pair(a) else a + b


@overload(add, jit_options=_OPTIONS)
def _add(a, b):
    return (lambda a, b: pairs.add(a, b)) if _is_pair(a) else (lambda a, b: a + b)


def subtract(a, b):
    """a - b."""
    return pairs.subtract(a, b) if _is_pair(a) else a - b


@overload(subtract, jit_options=_OPTIONS)
def _subtract(a, b):
    return (lambda a, b: pairs.subtract(a, b)) if _is_pair(a) else (lambda a, b: a - b)


def multiply(a, b):
    """a * b."""
    return pairs.multiply(a, b) if _is_pair(a) else a * b


@overload(multiply, jit_options=_OPTIONS)
def _multiply(a, b):
    return (lambda a, b: pairs.multiply(a, b)) if _is_pair(a) else (lambda a, b: a * b)


def divide(a, b):
    """a / b."""
    return pairs.divide(a, b) if _is_pair(a) else a / b


@overload(divide, jit_options=_OPTIONS)
def _divide(a, b):
    return (lambda a, b: pairs.divide(a, b)) if _is_pair(a) else (lambda a, b: a / b)


def root(a):
    """√a."""
    return pairs.root(a) if _is_pair(a) else type(a)(math.sqrt(a))


@overload(root, jit_options=_OPTIONS)
def _root(a):
    return (lambda a: pairs.root(a)) if _is_pair(a) else (lambda a: math.sqrt(a))


def less(a, b):
    """a < b."""
    return pairs.less(a, b) if _is_pair(a) else a < b


@overload(less, jit_options=_OPTIONS)
def _less(a, b):
    return (lambda a, b: pairs.less(a, b)) if _is_pair(a) else (lambda a, b: a < b)


def number(value, like):
    """A float as a number of the type of another."""
    return (value, 0.0) if _is_pair(like) else type(like)(value)


@overload(number, jit_options=_OPTIONS)
def _number(value, like):
    if _is_pair(like):
        return lambda value, like: (value, 0.0)
    if like == types.float32:
        return lambda value, like: np.float32(value)
    return lambda value, like: value


def rounded(a):
    """The float64 nearest to a number."""
    return a[0] if _is_pair(a) else np.float64(a)


@overload(rounded, jit_options=_OPTIONS)
def _rounded(a):
    return (lambda a: a[0]) if _is_pair(a) else (lambda a: np.float64(a))


def load(column, i):
    """Number i of a column."""
    return (column[i, 0], column[i, 1]) if column.ndim == 2 else column[i]


@overload(load, jit_options=_OPTIONS)
def _load(column, i):
    return (lambda column, i: (column[i, 0], column[i, 1])) if column.ndim == 2 else (lambda column, i: column[i])


def store(column, i, value):
    """Set number i of a column."""
    column[i] = value


@overload(store, jit_options=_OPTIONS)
def _store(column, i, value):
    if column.ndim == 1:

        def put(column, i, value):
            column[i] = value
    else:

        def put(column, i, value):
            column[i, 0] = value[0]
            column[i, 1] = value[1]

    return put
