"""Atomic operations on words of memory that several threads share.

Loads acquire and stores release: a thread that loads a value also sees everything that was written before the value was
stored.
"""

import platform

from idealgas.jit import CACHE_LINE, inline, intrinsic

LINE = CACHE_LINE // 8
"""Words per cache line. Words that different threads write often are at least this far apart."""

SPINS = 100
"""Rounds of waiting after which a thread yields the processor, because another thread may need it."""

_HINTS = {
    **dict.fromkeys(("x86_64", "AMD64"), ("llvm.x86.sse2.pause", ())),
    **dict.fromkeys(("aarch64", "arm64"), ("llvm.aarch64.hint", (1,))),
}
"""LLVM intrinsic, with its arguments, that hints to the processor that a thread is waiting."""


def _pointer(context, builder, kind, array, index):
    return builder.gep(context.make_array(kind)(context, builder, array).data, [index])


@intrinsic
def load(typingctx, array, index):
    """Return the word array[index]; array: i8 or f8."""

    def code(context, builder, signature, arguments):
        return builder.load_atomic(_pointer(context, builder, signature.args[0], *arguments), "acquire", 8)

    return array.dtype(array, index), code


@intrinsic
def store(typingctx, array, index, value):
    """Set array[index] to a value of the array's type."""
    from numba import types

    def code(context, builder, signature, arguments):
        builder.store_atomic(arguments[2], _pointer(context, builder, signature.args[0], *arguments[:2]), "release", 8)
        return context.get_dummy_value()

    return types.void(array, index, array.dtype), code


@intrinsic
def exchange(typingctx, array, index, value):
    """Set array[index] to a value and return the previous value; array: i8."""

    def code(context, builder, signature, arguments):
        word = _pointer(context, builder, signature.args[0], *arguments[:2])
        return builder.atomic_rmw("xchg", word, arguments[2], "seq_cst")

    return array.dtype(array, index, array.dtype), code


@intrinsic
def add(typingctx, array, index, value):
    """Add a value to array[index] and return the previous value; array: i8."""

    def code(context, builder, signature, arguments):
        word = _pointer(context, builder, signature.args[0], *arguments[:2])
        return builder.atomic_rmw("add", word, arguments[2], "seq_cst")

    return array.dtype(array, index, array.dtype), code


@intrinsic
def pause(typingctx):
    """Hint to the processor that this thread is waiting for a word to change."""
    from llvmlite import ir
    from numba import types

    def code(context, builder, signature, arguments):
        if hint := _HINTS.get(platform.machine()):
            name, numbers = hint
            kind = ir.FunctionType(ir.VoidType(), [ir.IntType(32)] * len(numbers))
            builder.call(builder.module.declare_intrinsic(name, [], kind), [ir.IntType(32)(k) for k in numbers])
        return context.get_dummy_value()

    return types.void(), code


@intrinsic
def yield_cpu(typingctx):
    """Yield the processor to another thread."""
    from llvmlite import ir
    from numba import types

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
    """Wait for one round; return `rounds` + 1."""
    if rounds < SPINS:
        pause()
    else:
        yield_cpu()
    return rounds + 1
