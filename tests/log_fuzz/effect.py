"""What a change does to a log: whether a stated rule is broken, and for whom."""

from enum import Enum
from typing import NamedTuple


class Expect(Enum):
    """What a command may do with a log.

    BROKEN: a stated rule is broken, so whoever reads the datasets says so. SAME: the numbers are those of the sound
    log. SAME_OR_REFUSED: those, or one line. ORDERLY: no rule is broken, but other numbers are there; whatever comes
    out comes out in order.
    """

    BROKEN = "broken"
    SAME = "same"
    SAME_OR_REFUSED = "same or refused"
    ORDERLY = "orderly"


class Effect(NamedTuple):
    """Of one change. what: in words. paths: datasets of which a command must read all to be held to `BROKEN`."""

    expect: Expect
    what: str
    paths: tuple[str, ...] = ()


def broken(what: str, *paths: str) -> Effect:
    """A stated rule about these datasets is broken."""
    return Effect(Expect.BROKEN, f"{what} {' '.join(paths)}".strip(), paths)


def orderly(what: str) -> Effect:
    """Other numbers, which are as good as any."""
    return Effect(Expect.ORDERLY, what)


def same(what: str) -> Effect:
    """Nothing that counts."""
    return Effect(Expect.SAME, what)


def doubtful(what: str) -> Effect:
    """The same numbers, stored in another way than the program does."""
    return Effect(Expect.SAME_OR_REFUSED, what)
