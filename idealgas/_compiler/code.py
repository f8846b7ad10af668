"""Machine code of entry points alone: what only compiled code calls is intermediate code that becomes part of them."""

from functools import cache
from types import SimpleNamespace
from typing import Any

from numba.core.codegen import JITCodeLibrary


@cache
def _simplification(codegen: Any) -> tuple[Any, Any]:
    """Passes of LLVM that simplify a function, and what they need."""
    builder = codegen._pass_builder(opt=1)
    return builder.getFunctionPassManager(), builder


class _Library(JITCodeLibrary):
    """Intermediate code of functions."""

    def _optimize_functions(self, module: Any) -> None:
        """Simplify functions; what takes LLVM longer is done once, for an entry point with all its parts."""
        if not hasattr(self._codegen, "_pass_builder"):  # numba 0.61
            super()._optimize_functions(module)
            return
        module.data_layout = self._codegen._data_layout
        passes, builder = _simplification(self._codegen)
        for function in module.functions:
            if not function.is_declaration:
                passes.run(function, builder)


class Part(_Library):
    """Intermediate code of a function that only compiled code calls: not optimized with what it calls, nor compiled."""

    codegen = SimpleNamespace(set_env=lambda name, environment: None)  # numba would write into that machine code

    def finalize(self) -> None:
        """Leave it as it is."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function's machine code, which none has."""
        return 0


class EntryPoint(_Library):
    """Code of an entry point, for which the functions below it are linked, optimized and compiled together."""

    def finalize(self) -> None:
        """Make the machine code."""
        self._linking_libraries: list = _callers_first(self._linking_libraries)
        super().finalize()


def _callers_first(libraries: list) -> list:
    """These and all that they call through parts; LLVM links only what is called by something linked."""
    order: list = []
    seen = set()

    def visit(library: Any) -> None:
        if library not in seen:
            seen.add(library)
            if isinstance(library, Part):
                for called in library._linking_libraries:
                    visit(called)
            order.append(library)

    for library in libraries:
        visit(library)
    return order[::-1]
