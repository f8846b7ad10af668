"""Declaration of an analysis: its name, options and sections of the report, without importing its code.

The folder `idealgas/analysis/NAME` of an analysis declares it as `ANALYSIS` and has in

    measure.py   NAME(log, start, end, progress, **options): the result of one log
    tables.py    NAME_tables(result): the tables for the terminal, for CSV and for the report
    figure.py    NAME_figure(result): the picture of the result
    combine.py   with `several`: combine_NAME(results): one result of several logs, for tables and figure;
                 with `folders` too: restore_NAME(found, label): the result that a sweep stored as plain values
    words.py     with `worded`: NAME_words(result): what it found, in sentences for people who see a report first

Results are dataclasses that inherit `Result` and extend its `as_dict()`: plain values, ready for JSON. What must hold
for the numbers and does not, a result says in its `premises`: plain sentences, which `Analysis` brings into tables,
reports and JSON. `core/premises.py` has the premises that all analyses share.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from difflib import get_close_matches
from functools import cached_property, wraps
from importlib import import_module
from inspect import signature
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

from idealgas.errors import UserError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from idealgas.analysis.core.result import Origin
    from idealgas.analysis.core.tables import Table
    from idealgas.log import Log

Progress = Callable[[int, int], None]
"""Function progress(done, total) that an analysis calls while it reads a log: rows or frames read, and their number."""


@dataclass(frozen=True)
class Option:
    """One option of an analysis: `--name` on the command line, a keyword argument in Python.

    name: a Python identifier. kind: type of the value, str, int or float. help: text for the command line. default:
    value if the option is not given. choices: texts that are allowed. least, most: smallest and largest number allowed.
    positive: whether a number must be greater than 0. metavar: word that stands for the value in the help text.
    """

    name: str
    kind: type
    help: str
    default: Any = None
    choices: tuple[str, ...] = ()
    least: float | None = None
    most: float | None = None
    positive: bool = False
    metavar: str | None = None

    @property
    def allowed(self) -> str:
        """Description of the allowed values, for error messages."""
        if self.choices:
            return ", ".join(self.choices)
        words = {int: "a whole number", float: "a number", str: "a text"}[self.kind]
        bounds = [f">= {self.least:g}"] if self.least is not None else []
        bounds += [f"<= {self.most:g}"] if self.most is not None else []
        bounds += ["> 0"] if self.positive else []
        return " ".join([words, " and ".join(bounds)]).strip()

    def check(self, value: Any) -> None:
        """Raise UserError if the value is not allowed; the default value is always allowed."""
        if value is None and self.default is None:
            return
        kind = {int: Integral, float: Real, str: str}[self.kind]
        fits = isinstance(value, kind) and not isinstance(value, bool)
        if fits and self.kind is not str:
            fits = (self.least is None or value >= self.least) and (self.most is None or value <= self.most)
            fits = fits and (value > 0 or not self.positive)
        if not fits or (self.choices and value not in self.choices):
            raise UserError(f"{self.name}: wrong value (got {value!r}; allowed {self.allowed})")


@dataclass(frozen=True)
class Section:
    """One section of the report that an analysis fills.

    title: heading of the section. caption: text below the picture, also read aloud to blind readers. options: values of
    the options of the analysis for this section.
    """

    title: str
    caption: str
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Analysis:
    """Declaration of one analysis.

    package: name of its Python package, `__name__` there. help: help text of the command; its first sentence stands in
    the list of commands. sections: sections of the report. options: options beside the start and end of the window.
    several: whether the analysis combines several logs. averages: whether it then takes averages over them, so that
    their runs must be independent. folders: whether it also takes folders of sweeps. checked: whether results have a
    method `check()` that compares measurement and theory. worded: whether it says in words what it found.
    in_text: whether text.py has NAME_text(result), a picture in characters for the terminal.
    start, end: description of the default start and end of the window. reads: what the progress bar counts, such as
    events or frames.
    """

    package: str
    help: str
    sections: tuple[Section, ...]
    options: tuple[Option, ...] = ()
    several: bool = False
    averages: bool = False
    folders: bool = False
    checked: bool = False
    worded: bool = False
    in_text: bool = False
    start: str = "detected equilibrium"
    end: str = "the log's end"
    reads: str = "events"

    @property
    def name(self) -> str:
        """Name of the analysis: the name of its folder, a Python identifier."""
        return self.package.rpartition(".")[2]

    @property
    def key(self) -> str:
        """Name of the command, also used in the file of a sweep: with hyphens instead of underscores."""
        return self.name.replace("_", "-")

    def measure(
        self,
        log: "Log",
        start: float | None = None,
        end: float | None = None,
        progress: Progress | None = None,
        **options: Any,
    ) -> Any:
        """Analyse one log between the times `start` and `end` and return the result, a `Result`.

        Raises:
            UserError: if an option is unknown or its value not allowed, or if the analysis does not apply to the log.
        """
        known = {option.name: option for option in self.options}
        for name, value in options.items():
            if name not in known:
                raise unknown(f"option of {self.key}", name, ("start", "end", *known))
            known[name].check(value)
        from idealgas.analysis.core import premises

        values = {name: option.default for name, option in known.items()} | options
        found = self._code("measure", self.name)(log, start=start, end=end, progress=progress, **values)
        origin = premises.origin_of(log.scene, str(log.path))
        return replace(found, premises=(*premises.of_log(log), *found.premises), origin=origin, title=origin.title)

    @cached_property
    def function(self) -> Callable[..., Any]:
        """`measure` as a function that has the arguments and the docstring of the one in measure.py."""
        own = self._code("measure", self.name)
        arguments = signature(own)

        @wraps(own)
        def function(*given: Any, **named: Any) -> Any:
            return self.measure(**arguments.bind(*given, **named).arguments)

        return function

    def combine(self, results: Sequence[Any]) -> Any:
        """Combine the results of one log or, with `several`, of more logs into what tables and figure show.

        Raises:
            UserError: if the analysis takes averages and a run is there twice, or if the gases do not go together.
        """
        if not self.several:
            (result,) = results
            return result
        from idealgas.analysis.core import premises

        independent = premises.of_averages(results) if self.averages else ()
        combined = self._code("combine", f"combine_{self.name}")(results)
        if len(results) == 1 and combined is results[0]:
            return combined
        sentences = (*premises.of_several(results), *independent, *combined.premises)
        return replace(combined, premises=sentences, title=premises.title_of(results))

    def restore(self, found: dict[str, Any], label: str, origin: "Origin | None" = None) -> Any:
        """Make a result again from the values of its `as_dict()` that a sweep stored.

        label: name of the point. origin: its run.
        """
        result = self._code("combine", f"restore_{self.name}")(found, label)
        premises = tuple(found.get("premises", ()))
        return replace(result, premises=premises, origin=origin, title=origin.title if origin else label)

    def tables(self, combined: Any) -> "list[Table]":
        """Tables of a combined result; the first one has a note for each premise that does not hold."""
        first, *others = self._code("tables", f"{self.name}_tables")(combined)
        notes = (*(f"premise: {sentence}" for sentence in combined.premises), *first.notes)
        return [replace(first, notes=notes), *others]

    def words(self, combined: Any) -> list[str]:
        """Sentences on what a combined result found; none if the analysis has no words."""
        return self._code("words", f"{self.name}_words")(combined) if self.worded else []

    def text(self, combined: Any) -> str:
        """Picture of a combined result in characters, for the terminal; only with `in_text`."""
        return self._code("text", f"{self.name}_text")(combined)

    def figure(self, combined: Any, titled: bool = True) -> "Figure":
        """Picture of a combined result; titled: whether it names the run and the analysis above it."""
        from idealgas.analysis.core.style import entitle

        figure = self._code("figure", f"{self.name}_figure")(combined)
        return entitle(figure, f"{combined.title}: {self.key}") if titled else figure

    def _code(self, module: str, function: str) -> Callable[..., Any]:
        return getattr(import_module(f"{self.package}.{module}"), function)


def unknown(what: str, got: str, allowed: Sequence[str]) -> UserError:
    """UserError for an unknown name; it suggests the allowed name that is most similar.

    what: kind of the name. got: the unknown name. allowed: all known names.
    """
    close = get_close_matches(got, allowed, n=1)
    mean = f', did you mean "{close[0]}"?' if close else ""
    return UserError(f"unknown {what}{mean} (got {got}; allowed {', '.join(allowed)})")
