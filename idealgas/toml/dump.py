"""Write values and scenes as TOML."""

import json
from collections.abc import Mapping
from typing import Any

from pydantic import BaseModel


def dump_document(document: BaseModel) -> str:
    """Return a scene with all defaults as TOML text. Loading the text gives an equal scene with identical floats."""
    tables = []
    for name, value in document.model_dump(by_alias=True, exclude_none=True).items():
        if isinstance(value, Mapping):
            tables.append(_table(f"[{name}]", value))
        else:
            tables.extend(_table(f"[[{name}]]", item) for item in value)
    return "\n\n".join(tables) + "\n"


def toml_value(value: Any) -> str:
    """Return a value as TOML text on one line."""
    match value:
        case bool():
            return str(value).lower()
        case str():
            return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")
        case Mapping():
            return "{" + ", ".join(f"{key} = {toml_value(item)}" for key, item in value.items()) + "}"
        case list() | tuple():
            return "[" + ", ".join(map(toml_value, value)) + "]"
        case _:
            return str(value)


def _table(head: str, table: Mapping[str, Any]) -> str:
    return "\n".join([head, *(f"{key} = {toml_value(value)}" for key, value in table.items())])
