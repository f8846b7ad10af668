"""What all tables of a scene share: how strict they are, and the kinds of numbers in them."""

from typing import Annotated

from pydantic import BaseModel, ConfigDict, Field

LARGEST = 1e30
"""Bound on every number, so that no product of a few of them overflows."""

Number = Annotated[float, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[float, Field(gt=0, le=LARGEST)]
NotNegative = Annotated[float, Field(ge=0, le=LARGEST)]
Vector = Annotated[tuple[Number, Number], Field(strict=False)]
Rectangle = tuple[float, float, float, float]
"""x0, y0, x1, y1."""


class Table(BaseModel):
    """A TOML table: no key beyond its own, no value of another type, nothing changed later."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)
