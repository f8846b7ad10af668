"""All analyses, one line each: a command, its `--json` and `--csv`, sections of the report and a key of sweeps.

NAME is a folder beside this file; `idealgas.analysis.core.declaration` tells what is in it.
"""

from importlib import import_module
from typing import TYPE_CHECKING, Any

from idealgas.analysis.core.declaration import Analysis, Progress, unknown

if TYPE_CHECKING:
    from idealgas.log import Log

NAMES: tuple[str, ...] = (
    "pressure",
    "temperature",
    "histogram",
    "relaxation",
    "transport",
    "profile",
    "evolution",
    "heat_capacity",
    "effusion",
)
"""Folders of the analyses, in the order of a report."""


def analyses() -> tuple[Analysis, ...]:
    """What every analysis says of itself; nothing of its code is imported."""
    return tuple(import_module(f"idealgas.analysis.{name}").ANALYSIS for name in NAMES)


def commands() -> tuple[str, ...]:
    """The names of their commands, which are those in the file of a sweep."""
    return tuple(name.replace("_", "-") for name in NAMES)


def find(name: str) -> Analysis:
    """The analysis of a name, heat_capacity or heat-capacity. UserError with the names there are for any other."""
    folder = name.replace("-", "_")
    if folder not in NAMES:
        raise unknown("analysis", name, commands())
    return import_module(f"idealgas.analysis.{folder}").ANALYSIS


def analyse(
    log: "Log",
    name: str,
    start: float | None = None,
    end: float | None = None,
    progress: Progress | None = None,
    **options: Any,
) -> Any:
    """Result of an analysis of a log between two times: a dataclass with `as_dict()`.

    options: those of the command `idealgas NAME`, as keywords. progress(done, in all) is called as the log is read.
    UserError for an unknown name or option, or if the analysis does not apply to the log.
    """
    return find(name).measure(log, start, end, progress, **options)
