"""The table of the box: its size, and what each side does."""

from typing import Annotated, Any, Literal

from pydantic import Discriminator, Field, Tag

from idealgas.scene.tables.periodic import PERIODIC
from idealgas.scene.tables.thermal import ThermalSide
from idealgas.toml.table import Positive, Table


def _tag(side: Any) -> str:
    return "(table)" if isinstance(side, (dict, ThermalSide)) else "(word)"


Side = Annotated[
    Annotated[Literal["reflecting", "periodic"], Tag("(word)")] | Annotated[ThermalSide, Tag("(table)")],
    Discriminator(_tag),
]


_SIDE = '"reflecting", "periodic" or { thermal = T }'


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
