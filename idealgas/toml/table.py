"""The base class of all tables of a scene, the types of their numbers, and their JSON Schema."""

import json
from collections.abc import Mapping
from typing import Annotated, Any, ClassVar

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Discriminator, Field, Tag
from pydantic_core import PydanticCustomError

SMALLEST, LARGEST = 1e-60, 1e30
"""Bounds on the absolute value of every nonzero number, within which products of a few numbers are finite and not 0."""

SCHEMA_BOUNDS = {"gt": "exclusiveMinimum", "ge": "minimum", "lt": "exclusiveMaximum", "le": "maximum"}
"""JSON Schema keywords for bounds, by the names that pydantic writes instead if a type has a validator."""


def _not_tiny(number: float) -> float:
    """Return the number. Raises an error if it is too close to 0."""
    if 0 < abs(number) < SMALLEST:
        raise PydanticCustomError("too_close_to_0", "", {"smallest": SMALLEST})
    return number


Real = Annotated[float, AfterValidator(_not_tiny)]


def _whole(number: object) -> object:
    """Convert a float with an integer value, such as 1e6, to an int, and return any other value unchanged."""
    return int(number) if isinstance(number, float) and number.is_integer() else number


Whole = Annotated[int, BeforeValidator(_whole)]
Number = Annotated[Real, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[Real, Field(gt=0, le=LARGEST)]
NotNegative = Annotated[Real, Field(ge=0, le=LARGEST)]
Vector = Annotated[tuple[Number, Number], Field(strict=False)]
Word = Annotated[str, Field(pattern=r"^[^\W\d][\w-]*$", max_length=255)]
Rectangle = tuple[float, float, float, float]
"""Lower left and upper right corners: x0, y0, x1, y1."""


class Table(BaseModel):
    """A TOML table: immutable, strictly typed, and without unknown keys."""

    model_config = ConfigDict(
        frozen=True,
        extra="forbid",
        strict=True,
        allow_inf_nan=False,
        model_title_generator=lambda table: table.__name__.removesuffix("Table"),  # as users of the schema see it
    )

    refused: ClassVar[Mapping[str, tuple[str, str]]] = {}
    """Keys that the table does not have but users may expect: what is wrong, and what is allowed instead."""


def _key_of(table: type[Table]) -> str:
    return next(iter(table.model_fields))


def either(plain: Any, *tables: type[Table]) -> Any:
    """Return the type of a value that is either plain or one of several tables, distinguished by their first keys.

    A table that has none of these keys is validated as the first kind, so that the error message lists the allowed
    keys.
    """

    def tag(value: Any) -> str:
        if not isinstance(value, (dict, *tables)):
            return "(plain)"
        given = (
            candidate
            for candidate in tables
            if isinstance(value, candidate) or (isinstance(value, dict) and _key_of(candidate) in value)
        )
        return f"({_key_of(next(given, tables[0]))})"

    kinds: Any = Annotated[plain, Tag("(plain)")]
    for table in tables:
        kinds |= Annotated[table, Tag(f"({_key_of(table)})")]
    return Annotated[kinds, Discriminator(tag)]


def schema_text(model: type[BaseModel]) -> str:
    """Return the JSON Schema of a model as text; it does not contain the rules that connect several tables."""
    return json.dumps(_standard(model.model_json_schema(by_alias=True)), indent=1, ensure_ascii=False) + "\n"


def _standard(node: Any) -> Any:
    if isinstance(node, dict):
        return {SCHEMA_BOUNDS.get(key, key): _standard(value) for key, value in node.items()}
    return [_standard(entry) for entry in node] if isinstance(node, list) else node
