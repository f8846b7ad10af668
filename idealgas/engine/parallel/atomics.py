"""Words of memory that several threads share: loads, stores and exchanges that are seen whole and in order.

A load sees all that its thread had written before it stored what is loaded (acquire and release).
"""

import platform

from llvmlite import ir
from numba import types
from numba.extending import intrinsic

from idealgas.jit import CACHE_LINE, inline

LINE = CACHE_LINE // 8
"""Words of a cache line: no two words that two threads write often are nearer than this."""

PAUSES = 100
"""Rounds of waiting after which a thread gives up its turn on the processor: another one may need it to go on."""

_HINTS = {
    **dict.fromkeys(("x86_64", "AMD64"), ("llvm.x86.sse2.pause", ())),
    **dict.fromkeys(("aarch64", "arm64"), ("llvm.aarch64.hint", (1,))),
}
"""What tells a processor that a thread waits: a function of the compiler, and its arguments."""


def _pointer(context, builder, kind, array, index):
    return builder.gep(context.make_array(kind)(context, builder, array).data, [index])


@intrinsic
def load(typingctx, array, index):
    """The word array[index]; array: i8 or f8."""

    def code(context, builder, signature, arguments):
        return builder.load_atomic(_pointer(context, builder, signature.args[0], *arguments), "acquire", 8)

    return array.dtype(array, index), code


@intrinsic
def store(typingctx, array, index, value):
    """Set array[index] to a value of the array's own type."""

    def code(context, builder, signature, arguments):
        builder.store_atomic(arguments[2], _pointer(context, builder, signature.args[0], *arguments[:2]), "release", 8)
        return context.get_dummy_value()

    return types.void(array, index, array.dtype), code


@intrinsic
def exchange(typingctx, array, index, value):
    """Set array[index] to a value and return what it was; array: i8."""

    def code(context, builder, signature, arguments):
        word = _pointer(context, builder, signature.args[0], *arguments[:2])
        return builder.atomic_rmw("xchg", word, arguments[2], "seq_cst")

    return array.dtype(array, index, array.dtype), code


@intrinsic
def add(typingctx, array, index, value):
    """Add a value to array[index] and return what it was; array: i8."""

    def code(context, builder, signature, arguments):
        word = _pointer(context, builder, signature.args[0], *arguments[:2])
        return builder.atomic_rmw("add", word, arguments[2], "seq_cst")

    return array.dtype(array, index, array.dtype), code


@intrinsic
def pause(typingctx):
    """Tell the processor that this thread waits for a word to change."""

    def code(context, builder, signature, arguments):
        if hint := _HINTS.get(platform.machine()):
            name, numbers = hint
            kind = ir.FunctionType(ir.VoidType(), [ir.IntType(32)] * len(numbers))
            builder.call(builder.module.declare_intrinsic(name, [], kind), [ir.IntType(32)(k) for k in numbers])
        return context.get_dummy_value()

    return types.void(), code


@intrinsic
def give_way(typingctx):
    """Let another thread have the processor."""

    def code(context, builder, signature, arguments):
        name = "sched_yield"
        function = builder.module.globals.get(name) or ir.Function(
            builder.module, ir.FunctionType(ir.IntType(32), []), name
        )
        builder.call(function, [])
        return context.get_dummy_value()

    return types.void(), code


@inline
def wait(rounds):
    """Wait for a moment; return the number of rounds waited, one more than before."""
    if rounds < PAUSES:
        pause()
    else:
        give_way()
    return rounds + 1
