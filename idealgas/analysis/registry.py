"""Registry of all analyses: each line gives a command with `--json` and `--csv`, report sections and a sweep key.

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
    "evolution",
    "cooling",
    "profile",
    "histogram",
    "relaxation",
    "transport",
    "order",
    "sound",
    "heat_capacity",
    "effusion",
)
"""Names of the folders of all analyses, in the order of the report."""


def analyses() -> tuple[Analysis, ...]:
    """Declarations of all analyses; the code that computes them is not imported."""
    return tuple(import_module(f"idealgas.analysis.{name}").ANALYSIS for name in NAMES)


def commands() -> tuple[str, ...]:
    """Names of the commands of all analyses, also used in the file of a sweep."""
    return tuple(name.replace("_", "-") for name in NAMES)


def find(name: str) -> Analysis:
    """Declaration of the analysis with a name such as "heat_capacity" or "heat-capacity".

    Raises:
        UserError: for an unknown name; the message lists all known names.
    """
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
    """Analyse a log and return the result, a dataclass with `as_dict()`.

    Args:
        log: the log to analyse.
        name: name of the analysis, such as "pressure".
        start: start of the window, time; None for the default of the analysis.
        end: end of the window, time; None for the default of the analysis.
        progress: called as progress(done, total) while the log is read.
        options: options of the command `idealgas NAME`, as keyword arguments.

    Raises:
        UserError: if the name or an option is unknown, or if the analysis does not apply to the log.
    """
    return find(name).measure(log, start, end, progress, **options)
