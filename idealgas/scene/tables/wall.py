"""The table of a wall segment, which may be a gate."""

import math

from pydantic import Field

from idealgas.document.table import Positive, Table, Vector


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
    opens_at: Positive | None = Field(default=None, description="time > 0 from which it is not there")
    closes_at: Positive | None = Field(default=None, description="time > 0 from which it is there again")
    name: str | None = Field(
        default=None, pattern=r"^[^\W\d][\w-]*$", description="a word of its own; in the log; if absent its number"
    )

    @property
    def absence(self) -> tuple[float, float]:
        """From when to when it is not there; both infinite for a wall that always is."""
        if self.opens_at is None and self.closes_at is not None:
            return 0.0, self.closes_at
        return self.opens_at or math.inf, self.closes_at or math.inf

    @property
    def there_at_start(self) -> bool:
        """Whether it is there at time 0."""
        return self.absence[0] > 0
