"""Numbers in results as rows of one table, each named by an identifier with dots, such as pressure.temperature."""

import csv
import io
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import fields, is_dataclass
from types import UnionType
from typing import Annotated, Any, NamedTuple, Union, get_args, get_origin, get_type_hints

from idealgas.fields import INLINE, OMITTED, Key, reported_properties
from idealgas.statistics.estimates import Estimate

ESTIMATE = ("value", "standard_error", "independent_samples", "theory", "theory_error", "deviation")
"""Numbers of which an estimate consists; other quantities have only a value."""

ANY = "*"
"""Placeholder for the name of a group, such as a species, a wall or a route, in the name of a quantity."""


class QuantityRow(NamedTuple):
    """A number in a result.

    Attributes:
        quantity: name of the quantity.
        group: group to which the number belongs, in words; empty if the result has only one group.
        entry: index in a series; None for a single number.
        values: values by the names in ESTIMATE.
    """

    quantity: str
    group: str
    entry: int | None
    values: Mapping[str, float | None]


def rows(values: Any, name: str) -> Iterator[QuantityRow]:
    """Yield the numbers in a result that was converted to plain values; name: name of the analysis."""
    return _rows(values, (name,), (), None)


def _rows(part: Any, path: tuple[str, ...], group: tuple[str, ...], index: int | None) -> Iterator[QuantityRow]:
    if isinstance(part, dict) and set(ESTIMATE) <= part.keys():
        yield QuantityRow(".".join(path), ", ".join(group), index, {name: part[name] for name in ESTIMATE})
    elif isinstance(part, dict):
        for name, value in part.items():
            word = identifier(name)
            yield from _rows(value, (*path, word), group if word == name else (*group, name), index)
    elif isinstance(part, list):
        for k, entry in enumerate(part):
            if isinstance(entry, dict):
                words = [entry["name"]] if "name" in entry else entry.values()
                label = ", ".join(value for value in words if isinstance(value, str)) or str(k)
                yield from _rows(entry, (*path, identifier(label)), (*group, label), index)
            elif index is None:
                yield from _rows(entry, path, group, k)
            else:
                yield from _rows(entry, (*path, str(k)), group, index)
    elif isinstance(part, int | float):
        yield QuantityRow(".".join(path), ", ".join(group), index, {"value": float(part)})


def identifier(text: str) -> str:
    """Return text as a component of the name of a quantity."""
    return re.sub(r"\W+", "_", text).strip("_")


def as_csv(values: Any, name: str) -> str:
    """Return the numbers in a result that was converted to plain values as CSV text: one row each, with all digits.

    name: name of the analysis.
    """
    file = io.StringIO()
    writer = csv.DictWriter(file, ("quantity", "group", "index", *ESTIMATE), restval="", lineterminator="\n")
    writer.writeheader()
    for row in rows(values, name):
        writer.writerow({"quantity": row.quantity, "group": row.group, "index": row.entry, **row.values})
    return file.getvalue()


def names(kind: Any, path: tuple[str, ...]) -> Iterator[str]:
    """Yield the names of the single numbers that results of a class contain; ANY stands for a group."""
    origin, parameters = get_origin(kind), get_args(kind)
    if kind is Estimate or kind in (int, float, bool):
        yield ".".join(path)
    elif origin is Annotated:
        yield from names(parameters[0], path)
    elif origin in (Union, UnionType):
        for parameter in parameters:
            yield from names(parameter, path)
    elif origin is not None and issubclass(origin, Mapping):
        yield from names(parameters[1], (*path, ANY))
    elif origin is not None and issubclass(origin, Sequence) and is_dataclass(parameters[0]):
        yield from names(parameters[0], (*path, ANY))
    elif isinstance(kind, type) and is_dataclass(kind):
        hints = get_type_hints(kind, include_extras=True)
        for field in fields(kind):
            marks = getattr(hints[field.name], "__metadata__", ())
            key = next((mark.name for mark in marks if isinstance(mark, Key)), field.name)
            if OMITTED not in marks:
                yield from names(hints[field.name], path if INLINE in marks else (*path, key))
        for name in reported_properties(kind):
            yield from names(get_type_hints(getattr(kind, name).fget)["return"], (*path, name))
