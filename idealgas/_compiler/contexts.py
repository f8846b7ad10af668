"""What numba looks up while it compiles, found once; and how functions here pass their arguments."""

import copy
import operator
from collections.abc import Mapping
from functools import cache
from typing import Any, ClassVar, Self

from numba.core import types
from numba.core.callconv import CPUCallConv
from numba.core.cpu import CPUContext
from numba.core.datamodel import ArgPacker
from numba.core.types.containers import NamedTuple


class Typing:
    """numba's typing context, where what a function of numba itself makes of some types is looked up only once."""

    _known: ClassVar[dict[tuple, tuple]] = {}

    def __init__(self, context: Any) -> None:
        self._context = context

    def __getattr__(self, name: str) -> Any:
        return getattr(self._context, name)

    def refresh(self) -> None:
        """Do nothing: the context has been refreshed for the entry point."""

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


class _Operator:
    """An operator as lowering asks it: what it makes of some types is what typing has found."""

    def __init__(self, function: types.Function, typing: Typing) -> None:
        self.function, self._typing = function, typing

    def get_call_type(self, context: Any, args: tuple, kws: Mapping) -> Any:
        """Signature of a call, by numba's types of the operands."""
        return self._typing.resolve_function_type(self.function, args, kws)


_OPERATORS = frozenset(filter(callable, vars(operator).values())) - {operator.pow, operator.ipow}
"""Those of Python, but for powers, which numba lowers by the value of a constant exponent."""


class _TypingOfOperators(Typing):
    """The typing context of numba's lowering, which asks operators themselves."""

    @property
    def of_numba(self) -> Any:
        """The context that numba made."""
        return self._context

    def resolve_value_type(self, value: Any) -> Any:
        """Type of a value, as numba has it, or what stands for it."""
        kind = self._context.resolve_value_type(value)
        return _Operator(kind, self) if isinstance(kind, types.Function) and value in _OPERATORS else kind


class _WholeTuple:
    """numba's model of a named tuple, but for the argument, which is one value of LLVM."""

    def __init__(self, model: Any) -> None:
        self.get_argument_type = model.get_value_type

    def as_argument(self, builder: Any, value: Any) -> Any:
        """The argument that is passed for a value."""
        return value

    def from_argument(self, builder: Any, value: Any) -> Any:
        """The value that an argument stands for."""
        return value


class _Models:
    """numba's models of types, for arguments."""

    def __init__(self, models: Any) -> None:
        self._models = models

    def lookup(self, kind: types.Type) -> Any:
        """Model of a type."""
        model = self._models.lookup(kind)
        return _WholeTuple(model) if isinstance(kind, NamedTuple) else model


class _Convention(CPUCallConv):
    """numba's calling convention, where named tuples are passed whole."""

    def _get_arg_packer(self, kinds: tuple) -> ArgPacker:
        return ArgPacker(_Models(self.context.data_model_manager), kinds)


class Target(CPUContext):
    """numba's target context of functions here, which looks nothing up twice and passes named tuples whole.

    numba itself passes each number in a tuple as an argument of its own: hundreds for the arrays of a gas, to be taken
    apart at each call and put together again in what is called. So a function compiled by numba's own means must not
    call with a named tuple what is compiled here.
    """

    @classmethod
    @cache
    def of(cls, context: CPUContext) -> Self:
        """That of a context of numba."""
        own: Any = copy.copy(context)
        own.__class__ = cls
        own.typing_context = _TypingOfOperators(context.typing_context)
        own.cached_internal_func = {}
        return own

    @property
    def call_conv(self) -> _Convention:
        """How functions are called."""
        return _Convention(self)

    def refresh(self) -> None:
        """Learn of implementations that typing has just brought; all modules that have any are loaded before."""
        for registry in tuple(self._registries):
            self.install_registry(registry)

    def get_function(self, function: Any, signature: Any, _firstcall: bool = True) -> Any:
        """Implementation of a function or operator."""
        own = function.function if isinstance(function, _Operator) else function
        return super().get_function(own, signature, _firstcall)

    def _compile_subroutine_no_cache(self, *args: Any, **options: Any) -> Any:
        """Compile a function of numba's, in all of numba's steps."""
        typing = self.typing_context
        if isinstance(typing, _TypingOfOperators):
            return self.subtarget(typing_context=typing.of_numba)._compile_subroutine_no_cache(*args, **options)
        return super()._compile_subroutine_no_cache(*args, **options)
