"""Machine code of entry points alone: what only compiled code calls is intermediate code that becomes part of them."""

from types import SimpleNamespace
from typing import Any

from numba.core.codegen import JITCodeLibrary


class Part(JITCodeLibrary):
    """Intermediate code of a function that only compiled code calls: not optimized with what it calls, nor compiled."""

    codegen = SimpleNamespace(set_env=lambda name, environment: None)  # numba would write into that machine code

    def finalize(self) -> None:
        """Leave it as it is."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function's machine code, which none has."""
        return 0


class EntryPoint(JITCodeLibrary):
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
