"""Names of the analyses, which are the names of their modules, listed without importing the modules."""

from pathlib import Path
from pkgutil import iter_modules

FOLDER = Path(__file__).parent / "analysis"
OTHERS = ("analysis", "caveats", "check", "info", "registry", "result", "status")
"""Modules in the folder of the analyses that are not themselves analyses."""


def names() -> tuple[str, ...]:
    """Return the module names of all analyses, in alphabetical order."""
    return tuple(sorted(module.name for module in iter_modules([str(FOLDER)]) if module.name not in OTHERS))


def commands() -> tuple[str, ...]:
    """Return the command names of all analyses, which scenes and sweeps also use."""
    return tuple(name.replace("_", "-") for name in names())
