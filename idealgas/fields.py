"""Conversion of dataclasses to plain values, ready for JSON, and back.

The plain value of a field has the name of the field, unless its type contains another name, `Annotated[float,
Key("other_name")]`, or a `Mark`. Properties marked with `reported` are also plain values.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import Field, dataclass, fields, is_dataclass
from enum import Enum
from types import UnionType
from typing import Annotated, Any, TypeVar, get_args, get_origin

import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])
Instance = TypeVar("Instance")


@dataclass(frozen=True)
class Key:
    """Name under which a field appears among the plain values."""

    name: str


class Mark(Enum):
    """Way in which a field appears among the plain values."""

    OMITTED = "never"
    OPTIONAL = "unless it is None"
    INLINE = "by its own values, not as a group of them"


OMITTED, OPTIONAL, INLINE = Mark


def reported(function: Function) -> Function:
    """Mark a property, below `@property`, as a plain value of its dataclass."""
    function.__dict__["reported"] = True
    return function


def as_dict(instance: Any) -> dict[str, Any]:
    """Return the fields and reported properties of a dataclass as plain values by name."""
    values: dict[str, Any] = {}
    for field in fields(instance):
        values |= _of_field(field, getattr(instance, field.name))
    return values | {name: plain_value(getattr(instance, name)) for name in reported_properties(type(instance))}


def _of_field(field: "Field[Any]", value: Any) -> dict[str, Any]:
    marks = getattr(field.type, "__metadata__", ())
    if OMITTED in marks or (value is None and (OPTIONAL in marks or INLINE in marks)):
        return {}
    plain = plain_value(value)
    return plain if INLINE in marks else {_key(field): plain}


def _key(field: "Field[Any]") -> str:
    marks = getattr(field.type, "__metadata__", ())
    return next((mark.name for mark in marks if isinstance(mark, Key)), field.name)


def reported_properties(kind: type) -> Iterator[str]:
    """Yield the names of the properties of a class that are plain values."""
    for part in reversed(kind.__mro__):
        for name, member in vars(part).items():
            if isinstance(member, property) and getattr(member.fget, "reported", False):
                yield name


def plain_value(value: Any) -> Any:
    """Return a value as dict, list, str, int, float, bool or None; numbers that are not finite become None."""
    if value is None or isinstance(value, bool | int | str):
        return value
    if isinstance(value, float):
        return float(value) if math.isfinite(value) else None
    if isinstance(value, np.ndarray | np.generic):
        return plain_value(value.tolist())
    if isinstance(value, Mapping):
        return {name: plain_value(item) for name, item in value.items()}
    if isinstance(value, list | tuple):
        return [plain_value(item) for item in value]
    if hasattr(value, "as_dict"):
        return value.as_dict()
    if is_dataclass(value):
        return as_dict(value)
    raise TypeError(f"no plain value of {value!r}")


def from_dict(kind: type[Instance], values: Mapping[str, Any]) -> Instance:
    """Return a dataclass from its plain values, as returned by `as_dict`.

    Omitted fields have their default values. Numbers that were not finite become nan.

    Raises:
        LookupError, TypeError, ValueError: if the values do not match the dataclass.
    """
    arguments: dict[str, Any] = {}
    for field in fields(kind):  # type: ignore[arg-type]
        marks, key = getattr(field.type, "__metadata__", ()), _key(field)
        if INLINE in marks:
            arguments[field.name] = _inline(kind, field, values)
        elif OMITTED not in marks and key in values:
            arguments[field.name] = _restored(field.type, values[key])
    return kind(**arguments)


def _inline(kind: type, field: "Field[Any]", values: Mapping[str, Any]) -> Any:
    """Return the value of a field whose plain values are stored directly among those of its dataclass."""
    (inner, *optional), group = _alternatives(field.type), values
    if get_origin(inner) is dict:
        others = {_key(other) for other in fields(kind) if other is not field} | set(reported_properties(kind))
        group = {key: value for key, value in values.items() if key not in others}
    elif optional and not all(_key(part) in values for part in fields(inner)):
        return None
    return _restored(inner, group)


def _alternatives(kind: Any) -> tuple[Any, ...]:
    """Return the types of a field without its marks: a single type, or a type and None."""
    kind = get_args(kind)[0] if get_origin(kind) is Annotated else kind
    return get_args(kind) if get_origin(kind) is UnionType else (kind,)


def _restored(kind: Any, value: Any) -> Any:
    """Return a value of the given type from its plain value; see `from_dict`."""
    kind, *optional = _alternatives(kind)
    if optional and value is None:
        return None
    if hasattr(kind, "from_dict"):
        return kind.from_dict(value)
    if isinstance(kind, type) and is_dataclass(kind):
        return from_dict(kind, value)
    if kind is np.ndarray:
        return np.array(value, float)
    if kind is float and value is None:
        return math.nan
    outer, inner = get_origin(kind), get_args(kind)
    if outer is dict:
        return {name: _restored(inner[1], item) for name, item in value.items()}
    if outer is tuple and isinstance(value, list | tuple):
        kinds = inner[:1] * len(value) if inner[1:] == (...,) else inner
        return tuple(_restored(part, item) for part, item in zip(kinds, value, strict=True))
    if type(value) is not kind and not (kind is float and type(value) is int):
        raise TypeError(f"{value!r} is not of type {kind}")
    return float(value) if kind is float else value
