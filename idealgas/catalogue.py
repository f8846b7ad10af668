"""Names of the analyses, which are those of their modules, read from their folder without importing any."""

from pathlib import Path
from pkgutil import iter_modules

FOLDER = Path(__file__).parent / "analysis"
OTHERS = ("core", "info", "registry", "status", "theory")
"""Modules in the folder that are not analyses."""


def names() -> tuple[str, ...]:
    """Return the names of the modules of all analyses, in alphabetical order."""
    return tuple(sorted(module.name for module in iter_modules([str(FOLDER)]) if module.name not in OTHERS))


def commands() -> tuple[str, ...]:
    """Return the names of the commands of all analyses, also used in scenes and sweeps."""
    return tuple(name.replace("_", "-") for name in names())
