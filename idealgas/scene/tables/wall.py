"""The table of a wall segment, which may be a gate."""

import math
from collections.abc import Sequence

from pydantic import Field

from idealgas.scene.properties import Effect, Properties
from idealgas.toml.table import Positive, Table, Vector, Word

NAME = "wall segments"


class Wall(Table):
    """`[[wall]]`: a segment whose body and ends are solid, at rest. One that opens or closes is a gate.

    It is there until `opens_at`, and again from `closes_at` on; with `closes_at` alone it is absent until then. A disc
    in the way of a closing gate stays on the side of its centre: it may leave, and bounces where it comes nearer. One
    that cannot rise out against gravity bounces as deep in the gate as it is.
    """

    start: Vector = Field(alias="from", description="[x, y] of one end, length")
    end: Vector = Field(alias="to", description="[x, y] of the other end, length")
    temperature: Positive | None = Field(
        default=None, description="temperature > 0, energy, at which it emits discs; it reflects if absent"
    )
    opens_at: Positive | None = Field(default=None, description="time > 0 at which it is removed")
    closes_at: Positive | None = Field(default=None, description="time > 0 from which it is there again")
    name: Word | None = Field(default=None, description="a word of its own; in the log; if absent its number")

    @property
    def absence(self) -> tuple[float, float]:
        """Times from and until which it is absent; both infinite for a wall that is always present."""
        if self.opens_at is None and self.closes_at is not None:
            return 0.0, self.closes_at
        return self.opens_at or math.inf, self.closes_at or math.inf

    @property
    def action(self) -> str:
        """What it does, in words."""
        action = "reflecting" if self.temperature is None else f"emits at temperature {self.temperature:g}"
        opens, closes = self.absence
        if math.isinf(opens):
            return action
        return f"{action}, open from {opens:g}" + ("" if math.isinf(closes) else f" to {closes:g}")

    @property
    def there_at_start(self) -> bool:
        """Whether it is there at time 0."""
        return self.absence[0] > 0


def effect(walls: Sequence[Wall | None]) -> Effect | None:
    """What wall segments change, if there are any; None in the place of those that are not valid."""
    present = [(i, wall) for i, wall in enumerate(walls) if wall is not None]
    if not present:
        return None
    gone = (opens if math.isinf(closes) else math.inf for opens, closes in (wall.absence for _, wall in present))
    properties = Properties(
        uniform=False,
        allows_monte_carlo=False,
        allows_time_steps=False,
        is_scalable=False,
        last_wall_removed_at=max(gone),
    )
    return Effect(NAME, tuple(("wall", i) for i, _ in present), properties)
