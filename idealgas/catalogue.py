"""List the names of the analyses, which are the names of their modules, without importing them."""

from pathlib import Path
from pkgutil import iter_modules

FOLDER = Path(__file__).parent / "analysis"
OTHERS = ("analysis", "caveats", "check", "info", "registry", "result", "status")
"""Modules in the folder of the analyses that are not analyses."""


def names() -> tuple[str, ...]:
    """Return the names of the modules of all analyses, in alphabetical order."""
    return tuple(sorted(module.name for module in iter_modules([str(FOLDER)]) if module.name not in OTHERS))


def commands() -> tuple[str, ...]:
    """Return the names of the commands of all analyses, which scenes and sweeps use as well."""
    return tuple(name.replace("_", "-") for name in names())
