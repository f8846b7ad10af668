"""Example scenes that are installed with the package."""

import re
from collections.abc import Sequence
from importlib import import_module
from pathlib import Path
from typing import TYPE_CHECKING

from idealgas.errors import unknown

if TYPE_CHECKING:
    from idealgas.scene import Scene

SCENE = ".toml"

TEMPLATE = "template"
"""Name of the commented scene that `idealgas new` copies; it is not an example of a gas."""


def path_of(name: str) -> Path:
    """Return the path of an installed file."""
    return Path(next(iter(import_module("idealgas_scenes").__path__))) / name


def paths() -> list[Path]:
    """Return the paths of all scenes, in alphabetical order of name."""
    return sorted(path_of("").glob(f"*{SCENE}"), key=lambda path: path.stem)


def names() -> list[str]:
    """Return the names of the scenes, in alphabetical order."""
    return [path.stem for path in paths()]


def first_sentence(description: str) -> tuple[str, str]:
    """Return the first sentence of a scene description on one line, and the rest of the text."""
    paragraph, *following = description.strip("\n").split("\n\n", maxsplit=1)
    sentence, *remainder = re.split(r"(?<=\.)\s+", paragraph, maxsplit=1)
    return " ".join(sentence.split()), "\n\n".join((*remainder, *following))


def load_example(name: str, overrides: Sequence[str] = ()) -> "Scene":
    """Load one of the example scenes that are installed with the package.

    Args:
        name: name of the example; `idealgas examples` lists all names.
        overrides: changes to keys, as for `load_scene`.

    Raises:
        UserError: if there is no such example or the changes are invalid.
    """
    from idealgas.scene import load_scene

    if name not in names():
        raise unknown("example", name, names())
    return load_scene(path_of(name + SCENE), overrides)
