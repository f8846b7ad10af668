"""How numba makes machine code here: in the steps that this takes, and of entry points alone.

As it stands, numba goes through steps for what compiled functions here never do, and checks the whole function after
each. It looks up anew what each addition makes of two floats, by trying all that can be added, and takes tuples of
arrays apart and puts them together again at every call. It then optimizes each function with all those that it calls,
and makes machine code of it, though that of a function which only compiled code calls is never run: its intermediate
code becomes part of its callers. Meanwhile Python looks for garbage in all of that again and again. What is left out
here takes half of the time or more; gases move as they did, to the last bit, and as fast.
"""

from collections.abc import Iterable, Mapping
from typing import Any

from numba.core import types
from numba.core.compiler import CompilerBase
from numba.core.types.misc import unliteral
from numba.extending import models, register_model

from idealgas._compiler.code import EntryPoint, Part
from idealgas._compiler.contexts import Target, Typing
from idealgas._compiler.steps import Pipeline


class PartType(types.Dispatcher):
    """Type of a function that becomes part of those that call it.

    It is compiled for types, whatever the values of literals, and for one type of integers that 64 bits can hold.
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
        return super().get_call_type(
            context, tuple(map(_widest, args)), {name: _widest(kind) for name, kind in kws.items()}
        )


def _widest(kind: types.Type) -> types.Type:
    """Type for which a function is compiled that is given an argument of this one."""
    kind = unliteral(kind)
    return types.int64 if isinstance(kind, types.Integer) and kind.bitwidth < 64 else kind  # type: ignore[attr-defined]


register_model(PartType)(models.OpaqueModel)


class Compiler(CompilerBase):
    """numba's compiler with the steps, the contexts and the code of this package."""

    def __init__(self, typing: Any, target: Any, *rest: Any) -> None:
        """Set what a function is compiled with: numba's contexts, and what else numba gives."""
        flags = rest[3]
        self._kind = Part if flags.no_cpython_wrapper else EntryPoint
        if self._kind is EntryPoint:  # once for all its parts
            typing.refresh()
            target.refresh()
        super().__init__(Typing(typing), Target.of(target), *rest)

    def define_pipelines(self) -> list[Pipeline]:
        state = self.state
        library = self._kind(state.targetctx.codegen(), state.func_id.func_qualname)
        library.enable_object_caching()
        state["library"] = library
        return [Pipeline()]
