"""Errors in a document, including those reported by pydantic: `table.key: what is wrong (got …; allowed …)`."""

import re
from collections.abc import Iterator, Mapping, Sequence
from typing import Any, NamedTuple, get_args

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import ErrorDetails, PydanticCustomError

from idealgas.errors import UserError, did_you_mean
from idealgas.toml.dump import toml_value

Key = tuple[str | int, ...]
"""Path of a key in a document, such as ("species", 0, "radius")."""

LONGEST_VALUE = 60
"""Largest number of characters of a value that a message shows."""

_WORDS = {
    "float_type": ("wrong type", "a number"),
    "int_type": ("wrong type", "a whole number"),
    "string_type": ("wrong type", "text in quotes"),
    "bool_type": ("wrong type", "true or false"),
    "model_type": ("wrong type", "a table"),
    "finite_number": ("not a finite number", "a finite number"),
    "literal_error": ("unknown value", "{expected}"),
    "string_too_long": ("too long", "up to {max_length} characters"),
    "string_pattern_mismatch": ("not a word", "a letter, then letters, digits, - and _"),
    "greater_than": ("out of range", "> {gt:g}"),
    "greater_than_equal": ("out of range", ">= {ge:g}"),
    "steps_from_0": ("steps that do not begin at t = 0", "[[0, value], [t, value], …]"),
    "steps_in_order": ("times not increasing", "[[0, value], [t, value], …] with increasing t"),
    "too_close_to_0": ("too close to 0", "a size >= {smallest:g}"),
    "less_than": ("out of range", "< {lt:g}"),
    "less_than_equal": ("out of range", "<= {le:g}"),
}


class Issue(NamedTuple):
    """An error in a document.

    Attributes:
        keys: the key that the message names, followed by any other keys involved.
        wrong: description of what is wrong.
        got: value in the document.
        allowed: description of what is allowed.
    """

    keys: tuple[Key, ...]
    wrong: str
    got: str
    allowed: str

    def line(self, names: Mapping[Key, str]) -> str:
        """Return the issue as one line of a message, in which `names`, by key, replace the numbers of tables."""
        key = self.keys[0]
        steps = [str(names.get(key[: k + 1], step)) for k, step in enumerate(key)]
        return f"{'.'.join(steps)}: {self.wrong} (got {self.got}; allowed {self.allowed})"

    def __str__(self) -> str:
        return self.line({})


class SceneError(UserError, ValueError):
    """A scene is invalid.

    Attributes:
        errors: one line for each error.
    """

    def __init__(self, errors: Sequence[str]) -> None:
        super().__init__("\n".join(errors))
        self.errors = list(errors)


def issues_error(issues: Sequence[Issue]) -> PydanticCustomError:
    """Return an error for a validator of a model to raise; the keys of the issues are relative to the model."""
    return PydanticCustomError("issues", "{summary}", {"summary": str(issues[0]), "issues": issues})


def as_issues(findings: Sequence[ErrorDetails], model: type[BaseModel]) -> list[Issue]:
    """Convert the errors that pydantic reports for a document to issues.

    An array is not reported as too short if one of its items is invalid, because pydantic does not count this item.

    Args:
        findings: the errors reported by pydantic.
        model: the model of the document.
    """
    above = {finding["loc"][:n] for finding in findings for n in range(len(finding["loc"]))}
    issues: list[Issue] = []
    for finding in findings:
        kind, loc = finding["type"], finding["loc"]
        if kind == "issues":
            issues += [i._replace(keys=tuple((*loc, *key) for key in i.keys)) for i in finding["ctx"]["issues"]]
        elif kind != "too_short" or loc not in above:
            issues.append(_issue(finding, model))
    return issues


def _issue(finding: ErrorDetails, model: type[BaseModel]) -> Issue:
    key = tuple(step for step in finding["loc"] if not str(step).startswith("("))  # omits the tags of unions
    kind, got = finding["type"], finding["input"]
    if kind == "extra_forbidden":
        tables = _tables_at(key[:-1], model)
        for table in tables:
            if refusal := getattr(table, "refused", {}).get(key[-1]):
                return Issue((key,), refusal[0], str(key[-1]), refusal[1])
        known = [name for table in tables for name in _keys(table)]
        wrong = f"unknown {'key' if key[1:] else 'table'}{did_you_mean(str(key[-1]), known)}"
        return Issue((key,), wrong, str(key[-1]), ", ".join(known))
    if kind == "missing" and isinstance(key[-1], int):
        return Issue((key[:-1],), "too short", _shown(got), _described(key, model))
    if kind == "missing":
        return Issue((key,), "missing", "nothing", _described(key, model))
    if kind in ("tuple_type", "too_long", "too_short"):
        wrong = {"too_long": "too long", "too_short": "too short"}.get(kind, "wrong type")
        return Issue((key,), wrong, _shown(got), _described(key, model))
    if key != finding["loc"] and kind == "literal_error":
        return Issue((key,), "unknown value", _shown(got), _described(key, model))
    wrong, allowed = _WORDS.get(kind, ("wrong value", finding["msg"]))
    if kind == "literal_error":
        known = re.findall(r"""['"]([^'"]+)['"]""", finding["ctx"]["expected"])
        wrong += did_you_mean(str(got), known)
    return Issue((key,), wrong, _shown(got), allowed.format(**finding.get("ctx", {})))


def _shown(value: Any) -> str:
    text = toml_value(value)
    return text if len(text) <= LONGEST_VALUE else f"{text[:LONGEST_VALUE]}…"


def _described(key: Key, model: type[BaseModel]) -> str:
    """Return the description of a key in the model; for an item of an array, the description of the array."""
    while isinstance(key[-1], int):
        key = key[:-1]
    name = str(key[-1])
    tables = (_keys(table) for table in _tables_at(key[:-1], model))
    return next((keys[name].description for keys in tables if name in keys), None) or ""


def _keys(table: type[BaseModel]) -> dict[str, FieldInfo]:
    """Return the fields of a table by key."""
    return {field.alias or name: field for name, field in table.model_fields.items()}


def table_at(key: Key, model: type[BaseModel]) -> type[BaseModel]:
    """Return the model of the table at a key; if several kinds of tables are allowed, the first of them."""
    return _tables_at(key, model)[0]


def _tables_at(key: Key, model: type[BaseModel]) -> list[type[BaseModel]]:
    """Return the models of all kinds of tables that are allowed at a key."""
    models = [model]
    for name in key:
        if isinstance(name, str):
            fields = [keys[name] for keys in map(_keys, models) if name in keys]
            models = [t for field in fields for t in _types_in(field.annotation) if issubclass(t, BaseModel)]
    return models


def _types_in(annotation: Any) -> Iterator[type]:
    if isinstance(annotation, type):
        yield annotation
    for part in get_args(annotation):
        yield from _types_in(part)
