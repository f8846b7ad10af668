"""Apply changes to a document before it is checked, such as `--set table.key=value`."""

import re
import tomllib
from collections.abc import Mapping
from typing import Any

from idealgas.errors import did_you_mean
from idealgas.toml.issues import Key

_WORD = re.compile(r"[^\W\d][\w-]*")


class OverrideError(ValueError):
    """An override does not fit the document."""


def apply(override: str, document: dict[str, Any]) -> Key:
    """Set a key of a document, or remove it if the value is empty, and return the key.

    A table in an array is selected by index or name (`species.0.count=10`, `species.argon.count=10`). If the array has
    only one table, the index or name may be omitted (`species.count=10`).

    Raises:
        OverrideError: if the override is not an assignment, has no value where one is required, or names a key that
            cannot exist.
    """
    key, node, text = find(override, document, missing=True)
    if text:
        node[key[-1]] = value_of(text)
    elif isinstance(node, dict):
        node.pop(key[-1], None)
    else:
        raise OverrideError("no value (allowed a TOML value; only a key of a table can be removed)")
    return key


def find(override: str, document: dict[str, Any], missing: bool = False) -> tuple[Key, Any, str]:
    """Return the key that an override sets, the table or array that contains the key, and the text of the value.

    Args:
        override: assignment "table.key=value".
        document: the document.
        missing: whether to create tables that the document does not have.

    Raises:
        OverrideError: if the override is not an assignment or names a key that cannot exist.
    """
    path, equals, text = override.partition("=")
    names = [name.strip() for name in path.split(".")]
    if not equals or not all(names):
        raise OverrideError("not an assignment (allowed table.key=value)")
    node: Any = document
    key: Key = ()
    for depth, name in enumerate(names):
        if isinstance(node, list) and (index := _index(node, name)) is not None:
            step: str | int = index
        elif isinstance(node, list) and [*map(type, node)] == [dict] and name == names[-1] and not name.isdigit():
            key, node, step = (*key, 0), node[0], name
        elif isinstance(node, dict):
            step = name
        else:
            close = did_you_mean(name, _names(node))
            raise OverrideError(f"no such key or table{close} (got {name}; allowed {_choices(node)})")
        key = (*key, step)
        if depth == len(names) - 1:
            break
        if isinstance(node, dict) and step not in node and not missing:
            raise OverrideError(f"no {step} in the scene")
        node = node.setdefault(step, {}) if isinstance(node, dict) else node[int(step)]
    return key, node, text.strip()


def _index(items: list[Any], name: str) -> int | None:
    if name.isascii() and name.isdigit():
        return int(name) if int(name) < len(items) else None
    return next((i for i, item in enumerate(items) if isinstance(item, dict) and item.get("name") == name), None)


def _choices(node: Any) -> str:
    if not isinstance(node, list):
        return "no key below a value"
    return ", ".join([f"0 to {len(node) - 1}", *_names(node)]) if node else "none: the array is empty"


def _names(node: Any) -> dict[str, int]:
    """Return the index of the first table with each name in an array of tables."""
    names: dict[str, int] = {}
    for k, item in enumerate(node if isinstance(node, list) else ()):
        if isinstance(item, dict) and isinstance(name := item.get("name"), str) and _WORD.fullmatch(name):
            names.setdefault(name, k)
    return names


def names_of(document: Mapping[str, Any]) -> dict[Key, str]:
    """Return the names with which `--set` can select tables in arrays, by key: {("species", 1): "heavy"}."""
    return {(array, k): name for array, node in document.items() for name, k in _names(node).items()}


def value_of(text: str) -> Any:
    """Return the value that a text represents in TOML, or the text itself if it is not a TOML value."""
    try:
        document = tomllib.loads(f"value = {text}")
    except (ValueError, RecursionError):
        return text.strip()
    return document["value"] if len(document) == 1 else text.strip()
