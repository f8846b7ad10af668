"""Number types of different precision: a law written with operators runs on floats and on pairs with twice the digits.

`Pair` is a number type in compiled code too, with the arithmetic of `double_double`. A law that supports all these
types uses `root(x)` for √x, and `number(0.0, x)` instead of 0.0, which would turn a float32 into a float64. A column of
numbers is an array (n,) of floats or an array (n, 2) of pairs.
"""

import math
import operator
from typing import Any

import numpy as np

from idealgas.jit import inline, overload, when_compiling
from idealgas.physics import double_double


class Pair:
    """A number of about 32 digits, stored as the sum of two floats.

    Attributes:
        high: float64 nearest to the number.
        low: the number minus `high`, as a float64.
    """

    __slots__ = ("high", "low")
    __hash__ = None  # type: ignore[assignment]

    def __init__(self, high: float, low: float) -> None:
        """Create the number high + low; `high` must be the float64 nearest to this number."""
        self.high, self.low = high, low

    def __add__(self, other: "Pair") -> "Pair":
        """Sum of two pairs."""
        return Pair(*double_double.add(parts(self), parts(other)))

    def __sub__(self, other: "Pair") -> "Pair":
        """Difference of two pairs."""
        return Pair(*double_double.subtract(parts(self), parts(other)))

    def __mul__(self, other: "Pair") -> "Pair":
        """Product of two pairs."""
        return Pair(*double_double.multiply(parts(self), parts(other)))

    def __truediv__(self, other: "Pair") -> "Pair":
        """Quotient of two pairs."""
        return Pair(*double_double.divide(parts(self), parts(other)))

    def __lt__(self, other: "Pair") -> bool:
        """Whether this number is smaller than the other."""
        return double_double.less(parts(self), parts(other))

    def __le__(self, other: "Pair") -> bool:
        """Whether this number is smaller than or equal to the other."""
        return not double_double.less(parts(other), parts(self))

    def __eq__(self, other: object) -> bool:
        """Whether the other object is a pair with the same two floats."""
        return isinstance(other, Pair) and parts(self) == parts(other)


@inline
def parts(a):
    """The two floats (high, low) of a pair."""
    return a.high, a.low


PAIR: Any = None
"""Type of `Pair` in compiled code."""


@when_compiling
def _declare_pair() -> None:
    """Register `Pair` with numba: its type, its two floats in memory, and `Pair(high, low)`."""
    global PAIR
    from numba import types
    from numba.extending import lower_builtin, make_attribute_wrapper, models, register_model, type_callable

    class PairType(types.Type):
        def __init__(self) -> None:
            super().__init__("Pair")

    PAIR = PairType()

    @register_model(PairType)
    class Model(models.StructModel):
        def __init__(self, manager: Any, kind: Any) -> None:
            super().__init__(manager, kind, [("high", types.float64), ("low", types.float64)])

    make_attribute_wrapper(PairType, "high", "high")
    make_attribute_wrapper(PairType, "low", "low")
    type_callable(Pair)(lambda context: lambda high, low: PAIR)

    @lower_builtin(Pair, types.float64, types.float64)
    def make(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
        pair = context.make_helper(builder, PAIR)
        pair.high, pair.low = arguments
        return pair._getvalue()


def _operate(sign: Any, operation: Any) -> None:
    """Define, for compiled code, an operator that computes a pair from two pairs."""

    @overload(sign)
    def choose(a, b):
        if a is PAIR and b is PAIR:

            def operate(a, b):
                high, low = operation(parts(a), parts(b))
                return Pair(high, low)

            return operate


_operate(operator.add, double_double.add)
_operate(operator.sub, double_double.subtract)
_operate(operator.mul, double_double.multiply)
_operate(operator.truediv, double_double.divide)


def _compare(sign: Any, operate: Any) -> None:
    """Define, for compiled code, an operator that compares two pairs or selects one of them."""
    overload(sign)(lambda a, b: operate if a is PAIR and b is PAIR else None)


_compare(operator.lt, lambda a, b: double_double.less(parts(a), parts(b)))
_compare(operator.gt, lambda a, b: double_double.less(parts(b), parts(a)))
_compare(operator.le, lambda a, b: not double_double.less(parts(b), parts(a)))
_compare(operator.eq, lambda a, b: (a.high == b.high) & (a.low == b.low))
_compare(max, lambda a, b: b if a < b else a)


def root(a):
    """Square root of a float or a pair."""
    return Pair(*double_double.root(parts(a))) if isinstance(a, Pair) else type(a)(math.sqrt(a))


@overload(root)
def _root(a):
    if a is PAIR:

        def operate(a):
            high, low = double_double.root(parts(a))
            return Pair(high, low)

        return operate
    return lambda a: math.sqrt(a)


def number(value, like):
    """Convert a float to the number type of `like`."""
    if isinstance(like, Pair):
        return Pair(value, 0.0)
    return np.float32(value) if isinstance(like, np.float32) else value


@overload(number)
def _number(value, like):
    from numba import types

    if like is PAIR:
        return lambda value, like: Pair(value, 0.0)
    if like == types.float32:
        return lambda value, like: np.float32(value)
    return lambda value, like: value


def rounded(a):
    """The float64 nearest to a number."""
    return a.high if isinstance(a, Pair) else np.float64(a)


@overload(rounded)
def _rounded(a):
    return (lambda a: a.high) if a is PAIR else (lambda a: np.float64(a))


def load(column, i):
    """Number i of a column, which is an array (n,) of floats or an array (n, 2) of pairs."""
    return Pair(column[i, 0], column[i, 1]) if column.ndim == 2 else column[i]


@overload(load)
def _load(column, i):
    return (lambda column, i: Pair(column[i, 0], column[i, 1])) if column.ndim == 2 else (lambda column, i: column[i])


def store(column, i, value):
    """Write a value as number i of a column, which is an array (n,) of floats or an array (n, 2) of pairs."""
    column[i] = parts(value) if isinstance(value, Pair) else value


@overload(store)
def _store(column, i, value):
    if column.ndim == 1:

        def put(column, i, value):
            column[i] = value
    else:

        def put(column, i, value):
            column[i, 0] = value.high
            column[i, 1] = value.low

    return put


ROUNDING = 1e-12
"""Largest relative correction of an impulse; excess energy that would require more is not due to rounding."""


@inline
def correction(excess, work):
    """Relative change of an impulse that removes the energy added by rounding the impulse.

    If |r|², the squared distance of two discs at contact, is always rounded in the same direction, as it is for |r| =
    1, then impulses are too large on average. The excess energy, computed from the changes in velocity, is rounded
    without bias.

    excess: excess energy times a constant. work: derivative of this product with respect to the relative change, > 0.
    """
    zero, bound = number(0.0, work), number(ROUNDING, work) * work
    return (zero - excess) / work if (excess < bound) & (zero - bound < excess) else zero


def changed(value, change, correction):
    """Return value + change (1 + correction) for a small correction; a float is rounded only once."""
    if isinstance(value, Pair):
        return value + (change + change * correction)
    return _changed_float(value, change, correction)


def _changed_float(value, change, correction):
    total, error = double_double.two_sum(value, change)
    return total + (error + change * correction)


@overload(changed)
def _changed(value, change, correction):
    if value is PAIR:
        return lambda value, change, correction: value + (change + change * correction)
    return _changed_float
