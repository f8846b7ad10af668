"""What is wrong with a scene, as data."""

from typing import NamedTuple

Key = tuple[str | int, ...]
"""Path of a key in the document: ("species", 0, "radius")."""


class Issue(NamedTuple):
    """Something wrong: the key to show first, then the others that have a part in it."""

    keys: tuple[Key, ...]
    wrong: str
    got: str
    allowed: str

    def __str__(self) -> str:
        return f"{dotted(self.keys[0])}: {self.wrong} (got {self.got}; allowed {self.allowed})"


def dotted(key: Key) -> str:
    """A key as it is written in messages and in --set."""
    return ".".join(map(str, key))
