"""Registry of all analyses: the modules and packages beside this file, each of which defines a subclass of `Analysis`.

Names, positions and help texts are read from the source, without importing any analysis.
"""

import ast
import re
from collections.abc import Sequence
from importlib import import_module
from os import PathLike
from typing import TYPE_CHECKING, Any

from idealgas.catalogue import FOLDER, commands, names
from idealgas.errors import UserError, unknown

if TYPE_CHECKING:
    from idealgas.analysis.analysis import Analysis
    from idealgas.analysis.result import Result
    from idealgas.log import Log
    from idealgas.scene import Scene
    from idealgas.tallies.stream import ReadProgress

MAIN = ("pressure", "temperature", "histogram")
"""Analyses at the beginning of the report on a plain gas in equilibrium."""


def _source(name: str) -> str:
    path = FOLDER / f"{name.replace('-', '_')}.py"
    return (path if path.exists() else path.with_suffix("") / "__init__.py").read_text(encoding="utf-8")


def help_of(name: str) -> str:
    """Return the help text of an analysis command: the docstring of its module, read without importing the module."""
    return ast.get_docstring(ast.parse(_source(name))) or ""


def position_of(name: str) -> int:
    """Return the position of an analysis in reports and in lists of commands, read without importing the analysis."""
    match = re.search(r"^    position = (\d+)$", _source(name), re.MULTILINE)
    return int(match[1]) if match else 1000


def analyses() -> "tuple[type[Analysis], ...]":
    """Return all analyses in the order of the report."""
    return tuple(sorted(map(find, names()), key=lambda analysis: (analysis.position, analysis.name)))


def find(name: str) -> "type[Analysis]":
    """Return the analysis of the given name, such as "heat_capacity" or "heat-capacity".

    Raises:
        UserError: for an unknown name; the message lists all known names.
    """
    module = name.replace("-", "_")
    if module not in names():
        raise unknown("analysis", name, commands())
    from idealgas.analysis.analysis import FOUND

    import_module(f"idealgas.analysis.{module}")
    return FOUND[module]


def shown(scene: "Scene") -> tuple[str, ...]:
    """Return the analyses at the beginning of a report: those in `scene.shows`, or else those that suit the scene."""
    if scene.scene.shows:
        return scene.scene.shows
    properties = scene.properties
    if properties.shear:
        return ("shear",)
    if properties.escapes:
        return ("escape", "evolution")
    opened, dissipative = properties.last_wall_removed_at > 0, properties.dissipative
    suitable = {
        "effusion": opened,
        "cooling": dissipative and properties.interacting,
        "evolution": opened or not properties.fixed_walls or dissipative,
        "profile": not properties.straight_flight or len(properties.temperatures) > 1,
        "transport": all(properties.periodic) and properties.collisions_conserve_energy and properties.interacting,
    }
    return tuple(name for name, suits in suitable.items() if suits) or MAIN


def analyse(
    log: "Log | str | PathLike[str]",
    name: str,
    start: float | None = None,
    end: float | None = None,
    progress: "ReadProgress | None" = None,
    **options: Any,
) -> Any:
    """Analyse a log and return the result, a dataclass with `as_dict()`.

    Args:
        log: the log to analyse, or its path.
        name: name of the analysis, such as "pressure".
        start: start of the window, time; None for the default of the analysis.
        end: end of the window, time; None for the default of the analysis.
        progress: called as progress(done, total) while the log is read.
        **options: options of the command `idealgas NAME`, as keyword arguments.

    Raises:
        UserError: if the name or an option is unknown, or if the analysis does not apply to the log.
    """
    return find(name).analyse(log, start, end, progress, **options)


def combine(results: "Sequence[Result]") -> "Result":
    """Combine the results of one analysis for several logs, as a command that is given several logs does.

    For example, the pressures of several gases are combined into the equation of state and its virial coefficients.

    Args:
        results: results of the same analysis.

    Raises:
        UserError: if the analysis does not combine logs, if a run is given twice, or if the gases cannot be combined.
    """
    analysis = results[0].analysis
    if analysis.combine is None and len(results) > 1:
        raise UserError(f"{analysis.key}: does not combine several logs")
    return analysis.combined(results)
