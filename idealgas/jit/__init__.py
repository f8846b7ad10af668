"""Compilation: `njit` for entry points and decorators for the functions that they call, prefetching, aligned memory.

numba's cache checks only the source file of an entry point and would return outdated code after a function in another
file has changed. This package caches machine code with digests of everything from which it was made; see
`dependencies`.

numba is imported when the first entry point is called, so that commands that compile nothing start quickly. Beyond what
numba documents, this module uses the options `_nrt` and `no_cfunc_wrapper`; a dispatcher's `compile` and `_cache`,
which are replaced, and `overloads`; and `CompileResult._reduce`, `_rebuild` and `serialize.dumps`, as numba's cache
does.
"""

import os
import pickle
import threading
import time
from collections.abc import Callable
from contextlib import suppress
from functools import cache, cached_property, update_wrapper, wraps
from types import FunctionType
from typing import Any

import numpy as np

from idealgas.errors import UserError
from idealgas.jit import files
from idealgas.jit.dependencies import Part, copied, digest, fill, is_ours, names_of, part_of, reached
from idealgas.jit.trial import leave_out

INTERPRETED = os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0")
if INTERPRETED:
    np.seterr(divide="ignore", invalid="ignore", over="ignore")  # compiled code gives no warnings either

CACHE_LINE = 64  # bytes

_OPTIONS: dict[str, Any] = {"error_model": "numpy", "nogil": True, "_nrt": False, "no_cfunc_wrapper": True}
"""Options of entry points. Without numba's runtime (`_nrt`) arrays are not reference-counted, and none can be created.

The caller must keep arrays alive. Reference counting needs an atomic operation wherever LLVM cannot prove that it is
unnecessary, and would make the event loop five times slower.
"""
_PART: dict[str, Any] = {"no_cpython_wrapper": True, **_OPTIONS}
_INLINE: dict[str, Any] = {"forceinline": True, **_PART}

_NEEDLESS = {
    "WithLifting", "InlineClosureLikes", "RewriteDynamicRaises", "MakeFunctionToJitFunction", "InlineInlinables",
    "FindLiterallyCalls", "LiteralUnroll", "LiteralPropagationSubPipelinePass", "InlineOverloads", "AnnotateTypes",
    "DumpParforDiagnostics", "NopythonRewrites",
}  # fmt: skip
"""Passes of numba's compiler for language features that this package does not use; passes dominate the compile time."""

_declared: list[Callable[[], object]] = []
"""Declarations to numba, which must be made before an entry point is compiled or loaded."""
_compiling: list[tuple[str, set[str]]] = []
"""Keys of the functions that are being compiled, callers first, each with the keys of all parts that it uses."""
_lock = threading.RLock()
_seconds = 0.0


def compile_seconds() -> float:
    """Time in seconds that this process has spent on compiling entry points or loading their machine code."""
    return _seconds


class _Function(Part):
    """A function that is compiled when a compiled function calls it.

    Attributes:
        reached: keys of the parts from which its machine code is made, for each set of argument types.
    """

    def __init__(self, function: Any, **options: Any) -> None:
        super().__init__(function, **options)
        self.reached: dict[tuple, set[str]] = {}
        self.is_named(function)

    @cached_property
    def compiled(self) -> Any:
        """Numba's dispatcher of the function."""
        import numba

        with _lock:
            self._copy = copied(self.py_func)
            compiled = numba.njit(self._copy, **self.options, **_pipeline())
            self._compile, compiled.compile = compiled.compile, self.compile
            return compiled

    def compile(self, signature: Any) -> Any:
        """Compile for argument types, unless this has been done before, and record which parts are used.

        numba calls this method for every call of the function in the code of another function.
        """
        from numba import types

        kinds = tuple(map(types.unliteral, signature))  # otherwise there would be machine code for each constant
        with _lock:
            if kinds not in self.reached:
                keys = {self.key}
                _compiling.append((self.key, keys))
                try:
                    self._obtain(kinds)
                finally:
                    _compiling.pop()
                self.reached[kinds] = keys
            if _compiling:
                _compiling[-1][1].update(self.reached[kinds])
            return self._compile(kinds)

    def _obtain(self, kinds: tuple) -> None:
        """Compile the function, unless it does nothing for these argument types."""
        if not isinstance(self, EntryPoint):  # Python calls entry points, so they cannot be left out
            with suppress(Exception):
                _compiling[-1][1].update(leave_out(self, kinds))
                return
        callers = self.mentions.intersection(key for key, _ in _compiling[:-1])
        if callers and not self.calls.isdisjoint(callers):
            raise TypeError(f"{self.key}: functions that call each other in a circle cannot be compiled")
        fill(self._copy, self.names)
        self._compile(kinds)


class EntryPoint(_Function):
    """A function that is compiled at its first call, without fastmath, and cached on disk; it runs without the GIL."""

    def __init__(self, function: Callable) -> None:
        """Make an entry point of a Python function."""
        super().__init__(function, forceinline=False, **_OPTIONS)
        self.is_named(self)
        update_wrapper(self, function)

    def __call__(self, *arguments: Any) -> Any:
        """Call the machine code."""
        return self.compiled(*arguments)

    @cached_property
    def compiled(self) -> Any:
        """Numba's dispatcher of the function."""
        with _lock:
            _declare()
            compiled = super().compiled
            if is_ours(self.key):
                compiled._cache = _Stored(self.name)
            return compiled

    def compile(self, signature: Any) -> Any:
        """Compile for argument types or load the machine code, and measure the time."""
        global _seconds
        with _lock:
            before, started = _seconds, time.perf_counter()
            try:
                _declare()
                return super().compile(signature)
            except (OSError, RuntimeError, ValueError) as error:  # callers would mistake these for errors of a file
                raise UserError(f"compilation failed: {' '.join(str(error).split())}") from error
            finally:
                _seconds = before + time.perf_counter() - started  # includes entry points that this one calls


class _Stored:
    """Machine code of an entry point on disk, with the interface of the cache of a numba dispatcher."""

    cache_path = None

    def __init__(self, name: str) -> None:
        self._name = name

    def load_overload(self, signature: Any, target: Any) -> Any:
        """Return the compiled result for argument types, or None if no result that is up to date can be loaded."""
        from numba.core.compiler import CompileResult

        target.refresh()
        with suppress(Exception):  # damaged files may raise almost any error
            keys, code = files.load(self._name, _described(signature), digest)
            result = CompileResult._rebuild(target, *pickle.loads(code))
            _compiling[-1][1].update(keys)
            return result

    def save_overload(self, signature: Any, result: Any) -> None:
        """Store the compiled result for argument types, if the disk is writable."""
        from numba.core.serialize import dumps

        if not result.library.has_dynamic_globals:
            digests = {key: digest(key) for key in reached(_compiling[-1][1])}
            with suppress(OSError):
                files.save(self._name, _described(signature), digests, dumps(result._reduce()))


def _described(types: Any) -> str:
    """Describe argument types, including the field names of tuples."""
    return " ".join(f"{kind} {getattr(kind, 'fields', '')} {_described(getattr(kind, 'types', ()))}" for kind in types)


@cache
def _pipeline() -> dict[str, Any]:
    """Return the compiler option that selects numba's usual passes except `_NEEDLESS`."""
    from numba.core.compiler import CompilerBase, DefaultPassBuilder

    class Short(CompilerBase):
        def define_pipelines(self) -> list[Any]:
            passes = DefaultPassBuilder.define_nopython_pipeline(self.state)
            passes.passes = [each for each in passes.passes if each[0].__name__ not in _NEEDLESS]
            passes.finalize()
            return [passes]

    return {"pipeline_class": Short}


def _declare() -> None:
    """Make the declarations to numba that were added since the last call."""
    while _declared:
        _declared.pop(0)()


def njit(function: Callable) -> Any:
    """Make a function an entry point of compiled code; see `EntryPoint`."""
    return function if INTERPRETED else EntryPoint(function)


def when_compiling(declare: Callable[[], object]) -> Callable[[], object]:
    """Decorate a function that makes declarations to numba; it is called before the first entry point is compiled."""
    Part(declare, declare.__module__, chooses=True)
    _declared.append(declare)
    return declare


def inline(function: Callable) -> Any:
    """Decorate a small function, which LLVM inlines into the entry points that call it; Python calls it unchanged."""
    _Function(function, **_INLINE)
    return function


def noinline(function: Callable) -> Any:
    """Decorate a long or rarely called function, which is compiled without inlining; Python calls it unchanged."""
    _Function(function, forceinline=False, **_PART)
    return function


def overload(function: Callable) -> Callable:
    """Decorate a function that chooses, by argument types, the code inlined for calls of `function` in compiled code.

    Python calls `function` itself. If `function` belongs to another package, as operators do, the decorated function is
    called only if an argument has a type of this package.
    """
    ours = is_ours(function.__module__)
    target = part_of(function) or Part(function) if ours else None
    if target is not None:
        target.is_named(function)

    def decorate(choose: Callable) -> Callable:
        Part(choose, target.key if target is not None else choose.__module__, chooses=True)

        @wraps(choose)
        def chosen(*types: Any) -> FunctionType | None:
            allowed = ours or any(is_ours(type(each).__module__) for each in types)
            choice = choose(*types) if allowed else None
            return choice and fill(copied(choice), names_of(choice))

        @_declared.append
        def declare() -> None:
            from numba.extending import overload

            overload(function, jit_options={**_INLINE, **_pipeline()})(chosen)

        return choose

    return decorate


class _Intrinsic(Part):
    """A function that generates LLVM instructions, in the form required by numba's `intrinsic`."""

    def __init__(self, function: Callable) -> None:
        super().__init__(function, chooses=True)

    @cached_property
    def compiled(self) -> Any:
        """Numba's intrinsic."""
        from numba.extending import intrinsic

        return intrinsic(self.py_func)


def intrinsic(function: Callable) -> Callable:
    """Decorate the implementation of a numba intrinsic, which only compiled code can call."""

    def declared(*arguments: Any) -> Any:
        raise TypeError(f"{function.__name__} is for compiled code only")

    _Intrinsic(function).is_named(declared)
    return declared


def prefetch(array: Any, row: Any) -> None:
    """Prefetch the memory of a row that will be read soon; does nothing in Python."""


def prefetch_next_line(array: Any, row: Any) -> None:
    """Prefetch the memory one cache line after a row, which will be written soon; does nothing in Python.

    Stores take effect in order: while a store waits for memory that is not in a cache, all later stores wait too.
    """


def _prefetch(distance: int, for_writing: int) -> Callable:
    """Return the implementation of an intrinsic that prefetches memory at a distance (bytes) from a row of an array."""

    def fetch(typing: Any, array: Any, row: Any) -> Any:
        from llvmlite import ir
        from numba import types

        def code(context: Any, builder: Any, signature: Any, arguments: Any) -> Any:
            i32, byte = ir.IntType(32), ir.IntType(8).as_pointer()
            values = context.make_array(array)(context, builder, arguments[0])
            if array.ndim == 1 and array.layout == "C":
                start = builder.bitcast(builder.gep(values.data, [arguments[1]]), byte)
            else:
                offset = builder.mul(builder.extract_value(values.strides, 0), arguments[1])
                start = builder.gep(builder.bitcast(values.data, byte), [offset])
            address = builder.gep(start, [ir.IntType(64)(distance)])
            kind = ir.FunctionType(ir.VoidType(), [byte, i32, i32, i32])
            function = builder.module.declare_intrinsic("llvm.prefetch", [byte], kind)
            builder.call(function, [address, i32(for_writing), i32(3), i32(1)])  # into all cache levels, data
            return context.get_dummy_value()

        return types.void(array, types.intp), code

    return fetch


_Intrinsic(_prefetch(0, 0)).is_named(prefetch)
_Intrinsic(_prefetch(CACHE_LINE, 1)).is_named(prefetch_next_line)


def aligned(n: int, dtype: np.dtype) -> Any:
    """Return an array of n zeros that shares no cache line with other data; a record array if dtype is structured."""
    raw = np.zeros((-(-n * dtype.itemsize // CACHE_LINE) + 1) * CACHE_LINE, np.uint8)
    start = -raw.__array_interface__["data"][0] % CACHE_LINE
    kind: Any = np.recarray if dtype.names else np.ndarray
    return kind(n, dtype, raw, start)
