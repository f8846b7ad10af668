"""The table of the box: its size, and what each side does."""

from typing import TYPE_CHECKING, Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from idealgas.effects import EFFECTS
from idealgas.effects.periodic import PERIODIC
from idealgas.toml.table import Positive, Table

WORDS = ("reflecting", *(effect.side for effect in EFFECTS if isinstance(effect.side, str)))
"""Kinds of sides that are a word."""

TABLES = tuple(effect.side for effect in EFFECTS if isinstance(effect.side, type))
"""Kinds of sides that are a table with one key."""


def _key_of(table: type[Table]) -> str:
    return next(iter(table.model_fields))


def _tag(side: Any) -> str:
    """Which kind of side it is; a table without the key of any kind counts as the first, which then names all keys."""
    if not isinstance(side, (dict, *TABLES)):
        return "(word)"
    kinds = (
        _key_of(table)
        for table in TABLES
        if isinstance(side, table) or (isinstance(side, dict) and _key_of(table) in side)
    )
    return f"({next(kinds, _key_of(TABLES[0]))})"


def _kind_of_side() -> Any:
    kinds: Any = Annotated[Literal[WORDS], Tag("(word)")]
    for table in TABLES:
        kinds |= Annotated[table, Tag(f"({_key_of(table)})")]
    return Annotated[kinds, Discriminator(_tag)]


def _description() -> str:
    *texts, last = ('"reflecting"', *(effect.side_text for effect in EFFECTS if effect.side))
    return f"{', '.join(texts)} or {last}"


if TYPE_CHECKING:
    Side = Any
else:
    Side = _kind_of_side()

_SIDE = _description()


class Box(Table):
    """`[box]`: the corner at the lower left is the origin."""

    size: Annotated[tuple[Positive, Positive], Field(strict=False)] = Field(description="[width, height], length")
    left: Side = Field(default="reflecting", description=_SIDE)
    right: Side = Field(default="reflecting", description=_SIDE)
    bottom: Side = Field(default="reflecting", description=_SIDE)
    top: Side = Field(default="reflecting", description=_SIDE)

    @property
    def sides(self) -> tuple[Side, Side, Side, Side]:
        """Left, right, bottom and top."""
        return self.left, self.right, self.bottom, self.top

    @property
    def periodic(self) -> tuple[bool, bool]:
        """Whether the sides across x, and across y, are periodic."""
        return self.left == PERIODIC, self.bottom == PERIODIC
