"""Memory that is asked for before it is needed: prefetch instructions for compiled code."""

from collections.abc import Callable
from typing import Any

from llvmlite import ir
from numba.core import cgutils, types
from numba.extending import lower_builtin, type_callable

from idealgas.jit import CACHE_LINE


def fetch(array: Any, row: Any) -> None:
    """Prefetch the memory of a row, as it will be read soon; does nothing in Python."""


def fetch_next_line(array: Any, row: Any) -> None:
    """Prefetch the memory one cache line after a row, as it will be written soon; does nothing in Python.

    Stores take effect in order: while one waits for memory that is not in a cache, all later ones wait too.
    """


@type_callable(fetch)
@type_callable(fetch_next_line)
def _type_of_fetch(context: Any) -> Callable:
    return lambda array, row: types.none


@lower_builtin(fetch, types.Array, types.Integer)
def _code_of_fetch(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return _prefetch(context, builder, signature, arguments, 0, 0)


@lower_builtin(fetch_next_line, types.Array, types.Integer)
def _code_of_fetch_next_line(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
    return _prefetch(context, builder, signature, arguments, CACHE_LINE, 1)


def _prefetch(context: Any, builder: Any, signature: Any, arguments: Any, distance: int, for_writing: int) -> Any:
    """Code that prefetches what lies at a distance (bytes) from a row of an array."""
    kind, (value, row) = signature.args[0], arguments
    array = context.make_array(kind)(context, builder, value)
    element = cgutils.get_item_pointer(context, builder, kind, array, [row] + [row.type(0)] * (kind.ndim - 1))
    address = builder.gep(builder.bitcast(element, cgutils.voidptr_t), [cgutils.intp_t(distance)])
    i32 = cgutils.int32_t
    prefetch = ir.FunctionType(ir.VoidType(), [address.type, i32, i32, i32])
    function = builder.module.declare_intrinsic("llvm.prefetch", [address.type], prefetch)
    builder.call(function, [address, i32(for_writing), i32(3), i32(1)])  # into all cache levels, data
    return context.get_dummy_value()
