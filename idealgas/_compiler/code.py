"""Machine code of entry points alone: what only compiled code calls is intermediate code that becomes part of them."""

from types import SimpleNamespace
from typing import Any

from numba.core.codegen import JITCodeLibrary


class _Definitions:
    """A module of LLVM that shows the functions that it defines; numba optimizes those that it calls as well."""

    def __init__(self, module: Any) -> None:
        vars(self)["_module"] = module

    def __getattr__(self, name: str) -> Any:
        return getattr(self._module, name)

    def __setattr__(self, name: str, value: Any) -> None:
        setattr(self._module, name, value)

    @property
    def functions(self) -> list:
        """Those that it defines."""
        return [function for function in self._module.functions if not function.is_declaration]


class _Code(JITCodeLibrary):
    """numba's code of a function, where what is only declared is not optimized."""

    def _optimize_functions(self, module: Any) -> None:
        super()._optimize_functions(_Definitions(module))


class Part(_Code):
    """Intermediate code of a function that only compiled code calls: not optimized with what it calls, nor compiled."""

    codegen = SimpleNamespace(set_env=lambda name, environment: None)  # numba would write into that machine code

    def finalize(self) -> None:
        """Leave it as it is."""
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        """Address of a function's machine code, which none has."""
        return 0


class EntryPoint(_Code):
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
