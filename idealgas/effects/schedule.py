"""Values that may change with time: a number or vector, or steps [[t, value], …] that begin at time 0.

All changes of a scene form a single list, the schedule. An epoch ends at each change, so that every method applies the
changes exactly at their times.
"""

from bisect import bisect_right
from collections.abc import Callable, Iterator, Sequence
from itertools import pairwise
from typing import TYPE_CHECKING, Annotated, Any, ClassVar, Literal, NamedTuple, Self, TypeAlias

import numpy as np
from pydantic import AfterValidator, Discriminator, Field, Tag
from pydantic_core import PydanticCustomError

from idealgas.toml.table import NotNegative, Number, Positive, Table, Vector

REFLECTING = "reflecting"
"""Value of a step during which a thermal wall reflects."""


class Change(NamedTuple):
    """A value in the state of an effect that changes at a given time.

    Attributes:
        time: time of the change since the start of the run.
        item: index of the value in the state of the effect.
        value: the new value.
    """

    time: float
    item: int
    value: float


def _in_order(steps: tuple[Any, ...]) -> tuple[Any, ...]:
    """Return the steps; raise an error if they do not begin at time 0, or their times do not increase."""
    times = [time for time, _ in steps]
    if not times or times[0] != 0:
        raise PydanticCustomError("steps_from_0", "")
    if any(later <= earlier for earlier, later in pairwise(times)):
        raise PydanticCustomError("steps_in_order", "")
    return steps


def _is_list(value: Any) -> str:
    return "(steps)" if isinstance(value, (list, tuple)) else "(number)"


def _is_list_of_lists(value: Any) -> str:
    return _is_list(value[0] if isinstance(value, (list, tuple)) and value else None)


def _in_steps(number: Any, value: Any = None, kind: Callable[[Any], str] = _is_list) -> Any:
    """Type of a value that may change with time.

    number: type of a constant value. value: type of a value in a step; the same as `number` if None. kind: function
    that distinguishes steps from a constant value.
    """
    value = value or number
    step: Any = Annotated[tuple[NotNegative, value], Field(strict=False)]
    kinds: Any = Annotated[tuple[step, ...], Field(strict=False), AfterValidator(_in_order), Tag("(steps)")]
    kinds |= Annotated[number, Tag("(number)")]
    return Annotated[kinds, Discriminator(kind)]


_POSITIVE_OR_WORD = Annotated[
    Annotated[Positive, Tag("(number)")] | Annotated[Literal["reflecting"], Tag("(word)")],
    Discriminator(lambda value: "(word)" if isinstance(value, str) else "(number)"),
]

Times = Annotated[
    Annotated[Positive, Tag("(number)")]
    | Annotated[tuple[NotNegative, ...], Field(strict=False, min_length=1), Tag("(times)")],
    Discriminator(lambda value: "(times)" if isinstance(value, (list, tuple)) else "(number)"),
]
"""A time > 0, or a list of times."""


def as_times(times: Any) -> tuple[float, ...]:
    """Convert the value of a key to a tuple of times; empty for None."""
    return () if times is None else tuple(times) if isinstance(times, (list, tuple)) else (times,)


def times_key(times: Sequence[float]) -> Any:
    """Convert times to the value of a key; None if there are none."""
    return tuple(times) if len(times) > 1 else next(iter(times), None)


def without_past(times: Any, time: float) -> Any:
    """Return the value of a key of times for a scene whose clock starts at a later time.

    Times count from the start of the new clock; past times are removed. The result is None if all times are past.
    """
    return times_key([t - time for t in as_times(times) if t > time])


if TYPE_CHECKING:
    NumberInSteps: TypeAlias = Any
    VectorInSteps: TypeAlias = Any
    PositiveInSteps: TypeAlias = Any
    NotNegativeInSteps: TypeAlias = Any
    WallTemperature: TypeAlias = Any
else:
    NumberInSteps, PositiveInSteps, NotNegativeInSteps = map(_in_steps, (Number, Positive, NotNegative))
    VectorInSteps = _in_steps(Vector, kind=_is_list_of_lists)
    WallTemperature = _in_steps(Positive, _POSITIVE_OR_WORD)


def steps_of(value: Any) -> tuple[tuple[float, Any], ...]:
    """Pairs of a time and the value that holds from this time on; a constant value holds from time 0 on."""
    return value if _is_list_of_lists(value) == "(steps)" else ((0.0, value),)


def value_at(value: Any, time: Any) -> Any:
    """Value that holds at a time, or array of the values that hold at an array of times."""
    times, values = zip(*steps_of(value), strict=True)
    if np.ndim(time):
        return np.array(values)[np.searchsorted(times, time, "right") - 1]
    return values[bisect_right(times, time) - 1]


def changes_of(value: Any, item: int) -> Iterator[Change]:
    """Return the changes, after time 0, of a value that may have steps.

    item: index of the value in the state of the effect.
    """
    return (Change(time, item, value) for time, value in steps_of(value)[1:])


def description(value: Any) -> str:
    """Describe in words the values of steps and the times from which they hold."""
    texts = [x if isinstance(x, str) else f"{x:g}" for _, x in steps_of(value)]
    later = (f"{text} from t = {time:g}" for text, (time, _) in zip(texts[1:], steps_of(value)[1:], strict=True))
    return ", ".join((texts[0], *later))


class SteppedTable(Table):
    """A table with values that may have steps."""

    in_steps: ClassVar[tuple[str, ...]]
    """Keys of the values that may have steps."""

    def after(self, time: float) -> Self:
        """Return the table for a scene whose clock starts at a later time."""
        return self.model_copy(update={key: _after(getattr(self, key), time) for key in self.in_steps})


def _after(value: Any, time: float) -> Any:
    now, later = value_at(value, time), [(t - time, x) for t, x in steps_of(value) if t > time]
    return ((0.0, now), *later) if later or now == REFLECTING else now
