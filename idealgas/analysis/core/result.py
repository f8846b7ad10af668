"""What the results of all analyses have in common: the premises that do not hold, and the run they come from."""

from dataclasses import dataclass
from typing import Any


@dataclass(frozen=True)
class Origin:
    """Run that a result comes from.

    path: of its log, or name of its point in a sweep. run: digest of all that determines the motion, the same for two
    logs of one run. gas: digest of the discs, the box and the effects, the same at another temperature. words: the gas
    in words. kind: kind of gas in words, whatever the number of discs and the size of the box. mixture: whether radii
    differ. seed: of the random numbers of the run; None if it draws none.
    """

    path: str
    run: str
    gas: str
    words: str
    kind: str
    mixture: bool
    seed: int | None


@dataclass(frozen=True, kw_only=True)
class Result:
    """Base of the results of all analyses.

    premises: one sentence for each premise of the numbers that does not hold, or that people should know of; empty if
    none was found. Tables, reports and JSON show them. origin: run that the result comes from; None if it comes from
    several runs, or if the analysis was not called by `Analysis.measure`.
    """

    premises: tuple[str, ...] = ()
    origin: Origin | None = None

    def as_dict(self) -> dict[str, Any]:
        """Plain values by name, ready for JSON."""
        return {"premises": list(self.premises)}
