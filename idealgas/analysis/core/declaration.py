"""What an analysis says of itself, without its code: that is imported when it is called for.

The folder `idealgas/analysis/NAME` of an analysis declares it as `ANALYSIS` and has in

    measure.py   NAME(log, start, end, progress, **options), the result of one log
    tables.py    NAME_tables(result), the rows of the terminal, of CSV and of the report
    figure.py    NAME_figure(result), its picture
    combine.py   with `several`: combine_NAME(results), one result of several logs, which tables and figure then take;
                 with `folders` too: restore_NAME(found, label), the result that a sweep stored as plain values

Results are dataclasses with `as_dict()`: plain values, ready for JSON.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from difflib import get_close_matches
from functools import cached_property, wraps
from importlib import import_module
from inspect import signature
from numbers import Integral, Real
from typing import TYPE_CHECKING, Any

from idealgas.errors import UserError

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from idealgas.analysis.core.tables import Table
    from idealgas.log import Log

Progress = Callable[[int, int], None]
"""progress(done, in all) of what an analysis reads."""


@dataclass(frozen=True)
class Option:
    """An argument of an analysis: `--name` of its command, a keyword in Python. name: an identifier.

    kind: str, int or float. choices: the texts allowed. least, most: the numbers allowed, both included. positive:
    whether a number has to be above 0. metavar: what stands for the value in the command's help.
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
        """The values that it takes, in words."""
        if self.choices:
            return ", ".join(self.choices)
        words = {int: "a whole number", float: "a number", str: "a text"}[self.kind]
        bounds = [f">= {self.least:g}"] if self.least is not None else []
        bounds += [f"<= {self.most:g}"] if self.most is not None else []
        bounds += ["> 0"] if self.positive else []
        return " ".join([words, " and ".join(bounds)]).strip()

    def check(self, value: Any) -> None:
        """Raise UserError for a value that is not allowed; the default always is."""
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
    """A part of a report. caption: of its picture, for those who do not see it too; options: of the analysis."""

    title: str
    caption: str
    options: Mapping[str, Any] = field(default_factory=dict)


@dataclass(frozen=True)
class Analysis:
    """One analysis. package: its folder, `__name__` there. help: of the command, its first sentence in the list of all.

    options: beside start and end, whose defaults `start` and `end` tell in words. sections: what a report has of it.
    several: whether several logs are put together; folders: those of sweeps too. checked: whether results have a
    `check()` of measurement against theory. reads: what takes its time.
    """

    package: str
    help: str
    sections: tuple[Section, ...]
    options: tuple[Option, ...] = ()
    several: bool = False
    folders: bool = False
    checked: bool = False
    start: str = "detected equilibrium"
    end: str = "the log's end"
    reads: str = "events"

    @property
    def name(self) -> str:
        """The folder's name, an identifier."""
        return self.package.rpartition(".")[2]

    @property
    def key(self) -> str:
        """The name of the command, and in the file of a sweep."""
        return self.name.replace("_", "-")

    def measure(
        self,
        log: "Log",
        start: float | None = None,
        end: float | None = None,
        progress: Progress | None = None,
        **options: Any,
    ) -> Any:
        """The result of one log. UserError for options that the analysis does not take, or if it does not apply."""
        known = {option.name: option for option in self.options}
        for name, value in options.items():
            if name not in known:
                raise unknown(f"option of {self.key}", name, ("start", "end", *known))
            known[name].check(value)
        values = {name: option.default for name, option in known.items()} | options
        return self._code("measure", self.name)(log, start=start, end=end, progress=progress, **values)

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
        """What tables and figure show of the results of logs, of one or, with `several`, of more."""
        if self.several:
            return self._code("combine", f"combine_{self.name}")(results)
        (result,) = results
        return result

    def restore(self, found: dict[str, Any], label: str) -> Any:
        """The result of a log whose `as_dict()` a sweep stored. label: of its point."""
        return self._code("combine", f"restore_{self.name}")(found, label)

    def tables(self, combined: Any) -> "list[Table]":
        """What people read of what `combine` gave."""
        return self._code("tables", f"{self.name}_tables")(combined)

    def figure(self, combined: Any) -> "Figure":
        """The picture of what `combine` gave."""
        return self._code("figure", f"{self.name}_figure")(combined)

    def _code(self, module: str, function: str) -> Callable[..., Any]:
        return getattr(import_module(f"{self.package}.{module}"), function)


def unknown(what: str, got: str, allowed: Sequence[str]) -> UserError:
    """The error of a name that is not there, with the nearest one that is."""
    close = get_close_matches(got, allowed, n=1)
    mean = f', did you mean "{close[0]}"?' if close else ""
    return UserError(f"unknown {what}{mean} (got {got}; allowed {', '.join(allowed)})")
