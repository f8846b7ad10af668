"""Functions that do nothing if effects are absent: a trial in Python detects them, and they are not compiled.

Compiling a function takes about 40 ms, whatever its size, and half of the functions for a plain gas return at once,
because their argument for an effect is None. In a trial all arguments except None are stand-ins on which every
operation fails. A function that nevertheless returns has only checked which arguments are None; its calls are then
replaced by its result.
"""

from collections.abc import Callable
from types import CellType, FunctionType, SimpleNamespace
from typing import Any

from idealgas.jit.dependencies import Part, part_of


class _StandIn:
    """An argument of unknown value: it has no attributes, and even its truth value and equality raise an error."""

    __slots__ = ()

    def _refuse(self, *_: Any) -> Any:
        raise TypeError

    __bool__ = __eq__ = __ne__ = __hash__ = _refuse  # type: ignore[assignment]


class _Argument(int):
    """Number of the argument that a function returns."""


def leave_out(part: Part, kinds: tuple) -> set[str]:
    """Replace calls of a function with its result if the function does nothing for these argument types.

    Returns:
        The keys of the functions that were run in the trial.

    Raises:
        Exception: the function does something; the exception can be of any type.
    """
    from numba.extending import lower_builtin

    keys: set[str] = set()
    arguments = [_stand_in(kind) for kind in kinds]
    result = _written(_in_trial(part, keys)(*arguments), arguments)
    kind = _type(result, kinds)
    place = object()
    lower_builtin(place, *kinds)(lambda context, builder, _, values: _value(context, builder, result, kind, values))
    part.compiled.overloads[kinds] = SimpleNamespace(signature=kind(*kinds), entry_point=place, objectmode=False)
    return keys


def _stand_in(kind: Any) -> Any:
    """Return None, a named tuple of stand-ins, or a stand-in; TypeError for an argument that may or may not be None."""
    from numba import types

    if isinstance(kind, types.NoneType):
        return None
    if isinstance(kind, types.BaseNamedTuple):
        return kind.instance_class(*map(_stand_in, kind.types))
    if isinstance(kind, (types.Optional, types.Omitted)):
        raise TypeError
    return _StandIn()


def _in_trial(part: Part, keys: set[str]) -> Callable:
    """Return a copy of a function for the trial, and record its key.

    In the copy, all global values except numbers and other parts are stand-ins.
    """
    if part.chooses:
        raise TypeError

    def value(each: Any) -> Any:
        if (callee := part_of(each)) is not None:
            return lambda *arguments, **named: _in_trial(callee, keys)(*arguments, **named)
        return each if _is_plain(each) else _StandIn()

    keys.add(part.key)
    names, cells = ({name: value(each) for name, each in values.items()} for values in part.names)
    function, closure = part.py_func, tuple(map(CellType, cells.values()))
    copy = FunctionType(function.__code__, {"__builtins__": {}, **names}, "", function.__defaults__, closure)
    copy.__kwdefaults__ = function.__kwdefaults__
    return copy


def _is_plain(value: Any) -> bool:
    return type(value) in (type(None), bool, int, float) or (type(value) is tuple and all(map(_is_plain, value)))


def _written(result: Any, arguments: list[Any]) -> Any:
    """Return a result with arguments replaced by their numbers; TypeError if it contains anything but plain values."""
    for number, argument in enumerate(arguments):
        if result is argument and isinstance(argument, _StandIn):
            return _Argument(number)
    if type(result) is tuple:
        return tuple(_written(each, arguments) for each in result)
    if not _is_plain(result):
        raise TypeError
    return result


def _type(result: Any, kinds: tuple) -> Any:
    """Return the type that numba infers for a function with this result."""
    from numba import typeof, types

    if isinstance(result, tuple):
        return types.Tuple([_type(each, kinds) for each in result])
    if not isinstance(result, _Argument):
        return typeof(result)
    if not isinstance(kinds[result], (types.Number, types.Boolean)):
        raise TypeError
    return kinds[result]


def _value(context: Any, builder: Any, result: Any, kind: Any, values: Any) -> Any:
    """Generate the LLVM instructions for a result."""
    if isinstance(result, tuple):
        items = [_value(context, builder, *each, values) for each in zip(result, kind, strict=True)]
        return context.make_tuple(builder, kind, items)
    if isinstance(result, _Argument):
        return values[result]
    return context.get_constant_generic(builder, kind, result)
