"""How numba makes machine code here: in the steps that this takes, and of entry points alone.

As it stands, numba goes through steps for what compiled functions here never do, and checks the whole function after
each. It looks up anew what each addition makes of two floats, by trying all that can be added. It then optimizes each
function with all those that it calls, and makes machine code of it, though that of a function which only compiled code
calls is never run: its intermediate code becomes part of its callers. Meanwhile Python looks for garbage in all of that
again and again. What is left out here takes half of the time; gases move as they did, to the last bit, and as fast.
"""

import gc
from collections.abc import Iterable, Iterator, Mapping
from contextlib import contextmanager
from types import SimpleNamespace
from typing import Any, ClassVar

from numba.core import typed_passes, types, untyped_passes
from numba.core.codegen import JITCodeLibrary
from numba.core.compiler import CompilerBase
from numba.core.compiler_machinery import CompilerPass
from numba.core.types.misc import unliteral
from numba.extending import models, register_model


class PartType(types.Dispatcher):
    """Type of a function that becomes part of those that call it: compiled for types, whatever the values of literals.

    numba's own way to call a plain Python function from compiled code tries several ways to compile it at every call,
    and has clocks that hear of every call of LLVM.
    """

    def __init__(self, dispatcher: Any) -> None:
        super().__init__(dispatcher)
        self._kept = dispatcher  # numba refers to it weakly
        dispatcher.compile = self._compile

    def _compile(self, args: tuple) -> None:
        """Compile the function for these types of arguments, unless it is."""
        if args not in self._kept.overloads:
            self._kept.add_overload(self._kept._compiler.compile(args, None))

    def get_call_type(self, context: Any, args: Iterable, kws: Mapping) -> Any:
        """Signature of a call, by numba's types of the arguments; compiles the function for them."""
        kinds = {name: unliteral(kind) for name, kind in kws.items()}
        return super().get_call_type(context, tuple(map(unliteral, args)), kinds)


register_model(PartType)(models.OpaqueModel)


class _Typing:
    """numba's typing context, where what a function of numba itself makes of some types is looked up only once."""

    _known: ClassVar[dict[tuple, tuple]] = {}

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def resolve_function_type(self, function: Any, args: tuple, kws: Mapping) -> Any:
        """Signature of a call, by numba's types of the arguments; None if there is none."""
        own: Any = function if isinstance(function, types.Type) else self._context._lookup_global(function)
        if not isinstance(own, types.Function):
            return self._context.resolve_function_type(function, args, kws)
        call = own, args, tuple(kws.items())
        if call not in self._known:
            if (found := self._context.resolve_function_type(own, args, kws)) is None:
                return None
            self._known[call] = found, own.get_impl_key(found)
        signature, implementation = self._known[call]
        own._impl_keys[signature.args] = implementation  # type: ignore[attr-defined]  # others may have compiled theirs
        return signature


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
        with _all_kept():
            for step in _STEPS:
                one = step()
                one.analysis = _ANALYSIS
                one.run_pass(state)


@contextmanager
def _all_kept() -> Iterator[None]:
    """Let Python collect no garbage: it would go through all that numba has made, again and again."""
    collects = gc.isenabled()
    gc.disable()
    try:
        yield
    finally:
        if collects:
            gc.enable()


class _Part(JITCodeLibrary):
    """Intermediate code of a function that only compiled code calls: not optimized with what it calls, nor compiled."""

    codegen = SimpleNamespace(set_env=lambda name, environment: None)  # numba would write into that machine code

    def finalize(self) -> None:
        self._finalized = True

    def get_pointer_to_function(self, name: str) -> int:
        return 0


class _EntryPoint(JITCodeLibrary):
    """Code of an entry point, for which the functions below it are linked, optimized and compiled together."""

    def finalize(self) -> None:
        self._linking_libraries: list = _callers_first(self._linking_libraries)
        super().finalize()


def _callers_first(libraries: list) -> list:
    """These and all that they call through parts; LLVM links only what is called by something linked."""
    order: list = []
    seen = set()

    def visit(library: Any) -> None:
        if library not in seen:
            seen.add(library)
            if isinstance(library, _Part):
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
        kind = _Part if state.flags.no_cpython_wrapper else _EntryPoint
        library = kind(state.targetctx.codegen(), state.func_id.func_qualname)
        library.enable_object_caching()
        state["library"] = library
        state["typingctx"] = _Typing(state["typingctx"])
        return [_Pipeline()]
