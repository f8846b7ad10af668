"""Dependencies of machine code: the code of the functions in it, and the values of the names that they use.

The functions from which machine code is made are called parts. While an entry point is compiled, the keys of all parts
that it uses are recorded; the machine code is up to date as long as the digests of these keys are unchanged. Comments,
docstrings and line numbers do not affect a digest.
"""

import builtins
import dis
import enum
import hashlib
import sys
from collections.abc import Iterable
from functools import cached_property
from inspect import CO_OPTIMIZED
from types import CellType, CodeType, FunctionType, ModuleType
from typing import Any

import numpy as np

_FIXED = sys.stdlib_module_names | {"numpy", "numba", "llvmlite"}
"""Packages whose versions determine the cache folder; their functions and classes are identified by name."""
_PLAIN = (type(None), type(...), bool, int, float, complex, str, bytes, np.generic, np.dtype)
_HAS_DOCSTRING = 0x4000000  # flag of code objects, from Python 3.13 on

_parts: dict[str, list["Part"]] = {}
_known: dict[int, tuple[Any, "Part"]] = {}


class Part:
    """A function that may be compiled, or that chooses at compile time what is compiled.

    Attributes:
        py_func: the Python function.
        key: its module and name. Parts with the same key, such as closures of one function, change together.
        name: the key, with a number that distinguishes parts with the same key.
        chooses: whether the function runs at compile time. Its result may then depend on every name in its code.
        options: options of the compiler, which are part of the digest.
    """

    def __init__(self, function: Any, key: str = "", chooses: bool = False, **options: Any) -> None:
        self.py_func, self.chooses, self.options = function, chooses, options
        self.key = key or f"{function.__module__}.{function.__qualname__}"
        parts = _parts.setdefault(self.key, [])
        self.name = f"{self.key}-{len(parts)}" if parts else self.key
        parts.append(self)

    def is_named(self, value: Any) -> None:
        """Register a value that stands for this part in the globals or closures of functions."""
        _known[id(value)] = value, self

    @property
    def compiled(self) -> Any:
        """Object that numba receives in place of the function."""
        return self.py_func

    @cached_property
    def names(self) -> tuple[dict[str, Any], dict[str, Any]]:
        """Values of the global names in the code, and of the closure, at the time when they are first needed."""
        return names_of(self.py_func)

    @property
    def calls(self) -> set[str]:
        """Keys of the parts that the function's code loads, not counting attributes of the same name."""
        loads = ("LOAD_GLOBAL", "LOAD_DEREF")
        names = {each.argval for each in dis.get_instructions(self.py_func.__code__) if each.opname in loads}
        parts = [part_of(value) for values in self.names for name, value in values.items() if name in names]
        return {part.key for part in parts if part is not None}

    @cached_property
    def _read(self) -> tuple[str, frozenset[str]]:
        reader = _Reader()
        text = f"{self.chooses} {self.options} {reader.function(self.py_func, self.names)}"
        return hashlib.sha256(text.encode(errors="surrogatepass")).hexdigest(), frozenset(reader.mentions)

    @property
    def digest(self) -> str:
        """Digest of the code and of the values of its names; other parts are represented only by their keys."""
        return self._read[0]

    @property
    def mentions(self) -> frozenset[str]:
        """Keys of the parts that the code names, and of declarations in the modules of the classes that it names."""
        return self._read[1] | {self.py_func.__module__}


def part_of(value: Any) -> Part | None:
    """Return the part for which a value stands, or None."""
    return _known[id(value)][1] if id(value) in _known else None


def digest(key: str) -> str:
    """Return the digest of the parts with a given key."""
    text = " ".join(part.digest for part in _parts.get(key, ()))
    return hashlib.sha256(text.encode()).hexdigest()


def reached(keys: Iterable[str]) -> set[str]:
    """Return the keys of all parts that are in the machine code or that determined at compile time what is in it.

    Args:
        keys: keys of the parts that were compiled.
    """
    done: set[tuple[str, bool]] = set()
    todo = [(key, False) for key in keys]
    while todo:
        if (each := todo.pop()) in done:
            continue
        done.add(each)
        for part in _parts.get(each[0], ()):
            chosen = each[1] or part.chooses
            todo += [
                (key, chosen)
                for key in part.mentions
                if chosen or any(mentioned.chooses for mentioned in _parts.get(key, ()))
            ]
    return {key for key, _ in done if key in _parts}


def _codes(code: CodeType) -> list[CodeType]:
    """Return the code objects of a function and of all functions inside it."""
    return [code, *(each for value in code.co_consts if isinstance(value, CodeType) for each in _codes(value))]


def names_of(function: FunctionType) -> tuple[dict[str, Any], dict[str, Any]]:
    """Return the values of the global names in the code of a function, and of its closure.

    A module of which `is_fixed` is false is reduced to those of its names that the code contains.
    """
    names = sorted({name for code in _codes(function.__code__) for name in code.co_names})

    def limited(value: Any) -> Any:
        if not isinstance(value, ModuleType) or is_fixed(value):
            return value
        module = ModuleType(value.__name__)
        vars(module).update({name: vars(value)[name] for name in names if name in vars(value)})
        return module

    values = {name: limited(function.__globals__[name]) for name in names if name in function.__globals__}
    cells = zip(function.__code__.co_freevars, function.__closure__ or (), strict=True)
    return values, {name: limited(cell.cell_contents) for name, cell in cells}


def is_ours(module: str) -> bool:
    """Whether a module is in this package."""
    return module.partition(".")[0] == __name__.partition(".")[0]


def is_fixed(value: Any) -> bool:
    """Whether a value is identified by its module and name alone, because its package has a fixed version."""
    if isinstance(value, ModuleType):
        return value.__name__.partition(".")[0] in _FIXED
    module = getattr(value, "__module__", None) or type(value).__module__
    return hasattr(value, "__name__") and str(module).partition(".")[0] in _FIXED


def copied(function: FunctionType) -> FunctionType:
    """Return a copy of a function in which global names and the closure have no values yet."""
    names = {"__name__": function.__module__, "__builtins__": builtins}
    closure = tuple(CellType() for _ in function.__code__.co_freevars)
    copy = FunctionType(function.__code__, names, function.__name__, function.__defaults__, closure)
    copy.__qualname__, copy.__kwdefaults__ = function.__qualname__, function.__kwdefaults__
    return copy


def fill(copy: FunctionType, names: tuple[dict[str, Any], dict[str, Any]]) -> FunctionType:
    """Give the names of a copied function their values; parts are replaced with the objects that numba receives."""
    copy.__globals__.update(_replaced(names[0]))
    for cell, value in zip(copy.__closure__ or (), _replaced(names[1]).values(), strict=True):
        cell.cell_contents = value
    return copy


def _replaced(names: dict[str, Any]) -> dict[str, Any]:
    def replacement(value: Any) -> Any:
        if (part := part_of(value)) is not None:
            return part.compiled
        if isinstance(value, ModuleType) and not is_fixed(value):
            module = ModuleType(value.__name__)
            vars(module).update(_replaced(vars(value)))
            return module
        return value

    return {name: replacement(value) for name, value in names.items()}


class _Reader:
    """Describes functions and values as text, and collects the keys of the parts that they mention."""

    def __init__(self) -> None:
        self.mentions: set[str] = set()
        self._seen: list[Any] = []

    def function(self, function: FunctionType, names: tuple[dict[str, Any], dict[str, Any]]) -> str:
        """Describe a function by its code and the values of all its names."""
        self._seen.append(function)
        values = [*names, function.__defaults__, function.__kwdefaults__]
        return f"{self._code(function.__code__)} {[self.value(each) for each in values]}"

    def _code(self, code: CodeType) -> str:
        first = code.co_consts[:1]
        if sys.version_info >= (3, 13):
            documented = bool(code.co_flags & _HAS_DOCSTRING)
        else:  # the first constant of a function is its docstring or None
            documented = bool(code.co_flags & CO_OPTIMIZED) and code.co_name[0] != "<" and isinstance(first[0], str)
        constants = [self.value(each) for each in code.co_consts[documented:]]
        counts = code.co_argcount, code.co_posonlyargcount, code.co_kwonlyargcount, code.co_flags, documented
        names = code.co_name, code.co_names, code.co_varnames, code.co_freevars, code.co_cellvars
        return f"{code.co_code!r} {code.co_exceptiontable!r} {counts} {names} {constants}"

    def value(self, value: Any) -> str:
        """Describe a value; TypeError if it is unclear how machine code depends on the value."""
        if (part := part_of(value)) is not None:
            self.mentions.add(part.key)
            return part.name
        if isinstance(value, _PLAIN):
            return f"{type(value).__name__} {value!r}"
        if isinstance(value, CodeType):
            return self._code(value)
        if isinstance(value, (tuple, list, set, frozenset)):
            items = [self.value(each) for each in value]
            return f"{self.value(type(value))} {sorted(items) if isinstance(value, (set, frozenset)) else items}"
        if isinstance(value, dict):
            return f"dict {[(self.value(key), self.value(each)) for key, each in value.items()]}"
        if is_fixed(value):
            return f"{getattr(value, '__module__', '')}.{value.__name__}"
        if isinstance(value, ModuleType):
            return self.value({name: each for name, each in vars(value).items() if name[:2] != "__"})
        if isinstance(value, (FunctionType, type)):
            if value in self._seen:
                return f"again {self._seen.index(value)}"
            return self._class(value) if isinstance(value, type) else self.function(value, names_of(value))
        return self._numba_type(value)

    def _class(self, kind: type) -> str:
        """Describe a class: numba uses the fields of tuples and the members of enumerations, and may call methods."""
        self._seen.append(kind)
        self.mentions.add(kind.__module__)
        text = f"{kind.__module__}.{kind.__qualname__}"
        if issubclass(kind, BaseException):
            return text
        if issubclass(kind, enum.Enum):
            return f"{text} {[(member.name, self.value(member.value)) for member in kind]}"
        if hasattr(kind, "_fields"):
            return f"{text} {kind._fields} {self.value(kind._field_defaults)}"  # type: ignore[attr-defined]
        names = {name: each for name, each in vars(kind).items() if name[:2] != "__" or isinstance(each, FunctionType)}
        return f"{text} {self.value(kind.__bases__)} {self.value(names)}"

    def _numba_type(self, value: Any) -> str:
        from numba import types

        if isinstance(value, types.Type):
            return f"type {value}"
        raise TypeError(f"compiled code cannot use {value!r}: changes in it cannot be detected")
