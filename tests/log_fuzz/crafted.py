"""Crafted logs by number: each is made of a sound one by one change or several, the same every time."""

import os
from collections.abc import Sequence
from pathlib import Path
from typing import NamedTuple

import numpy as np

from log_fuzz import structure, texts, values
from log_fuzz.editor import Editor
from log_fuzz.effect import Effect, orderly

FAMILIES = (values.CHANGES, structure.CHANGES, texts.CHANGES)
SHARES = (0.4, 0.42, 0.18)
ALONE = 0.65
"""Share of the logs with one change; the others have two to four."""


class Crafted(NamedTuple):
    """A log and what was done to it."""

    sound: str
    effects: tuple[Effect, ...]


def craft(case: int, path: Path, sound: dict[str, bytes], names: Sequence[str]) -> Crafted:
    """Make crafted log number `case` at a path, in a folder of its own."""
    random = np.random.default_rng([case, 20])
    name = names[case % len(names)]
    path.write_bytes(sound[name])
    if not (path.parent / structure.PIPE).exists():
        os.mkfifo(path.parent / structure.PIPE)
    effects: list[Effect] = []
    with Editor(path) as editor:
        if random.random() < 0.01 and (effect := structure.special_file(editor, random)):
            return Crafted(name, (effect,))
        wanted = 1 if random.random() < ALONE else int(random.integers(2, 5))
        for _ in range(20):
            changes = FAMILIES[random.choice(len(FAMILIES), p=SHARES)]
            change = changes[random.integers(len(changes))]
            try:
                effect = change(editor, random)
            except (KeyError, ValueError, OSError, RuntimeError, TypeError, IndexError, AttributeError, MemoryError):
                if not effects:
                    raise
                effects.append(orderly("and a change that did not come to its end"))  # for what it needs is gone
                break
            if effect is not None:
                effects.append(effect)
            if len(effects) == wanted:
                break
        rows = dict(editor.rows)
    return Crafted(name, tuple(_unseen(effect, rows) for effect in effects))


def _unseen(effect: Effect, rows: dict[str, int]) -> Effect:
    """The effect, which is none on a table that was left without rows."""
    gone = effect.paths and all(rows.get(path.partition("/")[0]) == 0 for path in effect.paths)
    return orderly(effect.what) if gone else effect
