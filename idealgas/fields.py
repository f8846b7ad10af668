"""Plain values of dataclasses, ready for JSON, made from their fields.

A field is named as in its dataclass, unless its type contains another name, `Annotated[float, Key("other_name")]`, or a
`Mark` instead of a name. Properties marked with `reported` are plain values too.
"""

import math
from collections.abc import Callable, Iterator, Mapping
from dataclasses import Field, dataclass, fields, is_dataclass
from enum import Enum
from typing import Any, TypeVar

import numpy as np

Function = TypeVar("Function", bound=Callable[..., Any])


@dataclass(frozen=True)
class Key:
    """Name of a field among the plain values."""

    name: str


class Mark(Enum):
    """How a field appears among the plain values."""

    OMITTED = "never"
    OPTIONAL = "unless it is None"
    INLINE = "by its own values, not as a group of them"


OMITTED, OPTIONAL, INLINE = Mark


def reported(function: Function) -> Function:
    """Mark a property, below `@property`, as one of the plain values of its dataclass."""
    function.__dict__["reported"] = True
    return function


def as_dict(instance: Any) -> dict[str, Any]:
    """Return the fields and reported properties of a dataclass by name, as plain values."""
    values: dict[str, Any] = {}
    for field in fields(instance):
        values |= _of_field(field, getattr(instance, field.name))
    return values | {name: plain_value(getattr(instance, name)) for name in reported_properties(type(instance))}


def _of_field(field: "Field[Any]", value: Any) -> dict[str, Any]:
    marks = getattr(field.type, "__metadata__", ())
    if OMITTED in marks or (value is None and (OPTIONAL in marks or INLINE in marks)):
        return {}
    plain = plain_value(value)
    return plain if INLINE in marks else {next((m.name for m in marks if isinstance(m, Key)), field.name): plain}


def reported_properties(kind: type) -> Iterator[str]:
    """Yield the names of the properties of a class that are plain values."""
    for part in reversed(kind.__mro__):
        for name, member in vars(part).items():
            if isinstance(member, property) and getattr(member.fget, "reported", False):
                yield name


def plain_value(value: Any) -> Any:
    """Return a value in terms of dict, list, str, int, float, bool and None; None for numbers that are not finite."""
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
