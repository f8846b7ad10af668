"""How numba makes machine code here: in the steps that this takes, and of entry points alone.

As it stands, numba goes through steps for what compiled functions here never do, and checks the whole function after
each. It then optimizes each function with all those that it calls, and makes machine code of it, though the machine
code of an inlined function is never run: LLVM inserts its intermediate code into whatever calls it. What is left out
here takes a third of the time; gases move as they did, to the last bit, and as fast.
"""

from types import SimpleNamespace
from typing import Any

from numba.core import typed_passes, untyped_passes
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import CompilerPass

_STEPS: tuple[type[CompilerPass], ...] = (
    untyped_passes.TranslateByteCode,
    untyped_passes.FixupArgs,
    untyped_passes.IRProcessing,
    untyped_passes.RewriteSemanticConstants,
    untyped_passes.DeadBranchPrune,  # what is for absent effects goes
    untyped_passes.GenericRewrites,
    untyped_passes.RewriteDynamicRaises,
    untyped_passes.ReconstructSSA,
    untyped_passes.DeadBranchPrune,
    typed_passes.NopythonTypeInference,
    typed_passes.PreLowerStripPhis,
    typed_passes.NoPythonSupportedFeatureValidation,
    typed_passes.NativeLowering,
    typed_passes.NoPythonBackend,
)
"""numba's own steps, in its order.

Those for closures, array expressions, `with`, literal arguments, unrolled tuples, functions inlined by numba itself,
its threads and its reports are not among them, nor is the one that marks the end of each variable's life: without
numba's runtime, nothing is released there.
"""

_ANALYSIS = dict.fromkeys(_STEPS)
"""What steps may look up of each other: `DeadBranchPrune` does, and uses nothing of it."""


class _Pipeline:
    """The steps, one after the other."""

    pipeline_name = "idealgas"
    exec_times = ()  # nothing is timed

    def run(self, state: Any) -> None:
        """Compile a function."""
        for step in _STEPS:
            one = step()
            one.analysis = _ANALYSIS
            one.run_pass(state)


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
    """numba's compiler with the steps and the code above."""

    def define_pipelines(self) -> list[_Pipeline]:
        state = self.state
        kind = _Inlined if state.flags.forceinline else _EntryPoint
        library = kind(state.targetctx.codegen(), state.func_id.func_qualname)
        library.enable_object_caching()
        state["library"] = library
        return [_Pipeline()]
