"""What of a scene can be checked while other parts of it are not valid."""

from collections.abc import Sequence
from typing import TypeVar

Item = TypeVar("Item")


def valid(items: Sequence[Item | None]) -> list[tuple[int, Item]]:
    """The tables of an array that are valid, with their numbers; None stands in the place of the others."""
    return [(i, item) for i, item in enumerate(items) if item is not None]
