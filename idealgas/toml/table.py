"""What all tables of a scene share: how strict they are, and the kinds of numbers in them."""

from typing import Annotated

from pydantic import AfterValidator, BaseModel, BeforeValidator, ConfigDict, Field
from pydantic_core import PydanticCustomError

SMALLEST, LARGEST = 1e-60, 1e30
"""Bounds on the size of every number but 0, so that no product of a few of them underflows or overflows."""


def _not_tiny(number: float) -> float:
    """The number, if it is 0 or not too small."""
    if 0 < abs(number) < SMALLEST:
        raise PydanticCustomError("too_close_to_0", "", {"smallest": SMALLEST})
    return number


Real = Annotated[float, AfterValidator(_not_tiny)]


def _whole(number: object) -> object:
    """A number without a fraction as a whole one, however it is written, as 1e6 is; anything else as it is."""
    return int(number) if isinstance(number, float) and number.is_integer() else number


Whole = Annotated[int, BeforeValidator(_whole)]
Number = Annotated[Real, Field(ge=-LARGEST, le=LARGEST)]
Positive = Annotated[Real, Field(gt=0, le=LARGEST)]
NotNegative = Annotated[Real, Field(ge=0, le=LARGEST)]
Vector = Annotated[tuple[Number, Number], Field(strict=False)]
Word = Annotated[str, Field(pattern=r"^[^\W\d][\w-]*$", max_length=255)]
Rectangle = tuple[float, float, float, float]
"""x0, y0, x1, y1."""


class Table(BaseModel):
    """A TOML table: no key beyond its own, no value of another type, nothing changed later."""

    model_config = ConfigDict(frozen=True, extra="forbid", strict=True, allow_inf_nan=False)
