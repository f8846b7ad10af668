"""JSON Schema of a document, for editors that complete and check TOML."""

import json
from typing import Any

from pydantic import BaseModel

BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
"""Bounds of numbers as pydantic has them behind a check of its own, and as JSON Schema has them."""


def schema_text(model: type[BaseModel]) -> str:
    """JSON Schema of the documents of a model, as text; what is asked across tables is not in it."""
    return json.dumps(_standard(model.model_json_schema(by_alias=True)), indent=1, ensure_ascii=False) + "\n"


def _standard(node: Any) -> Any:
    if isinstance(node, dict):
        return {BOUNDS.get(key, key): _standard(value) for key, value in node.items()}
    return [_standard(entry) for entry in node] if isinstance(node, list) else node
