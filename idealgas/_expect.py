"""Conditions that are seldom true: compiled code keeps its registers and its straight way for the other case."""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import types
from numba.extending import lower_builtin, type_callable


def seldom(condition: bool) -> bool:
    """A condition that is seldom true, as it is; compiled code of the other case is faster for it."""
    return condition


@type_callable(seldom)
def _type_of_seldom(context: Any) -> Callable:
    return lambda condition: types.boolean


@lower_builtin(seldom, types.Boolean)
def _code_of_seldom(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    bit = ir.IntType(1)
    expect = builder.module.declare_intrinsic("llvm.expect", [bit], ir.FunctionType(bit, [bit, bit]))
    return builder.call(expect, [arguments[0], bit(0)])
