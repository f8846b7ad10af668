"""Base class of all analyses: a subclass declares its options and measures a log.

Each module or package of `idealgas.analysis` contains one analysis, a subclass of `Analysis`. The first line of the
module's docstring is the help of the command `idealgas NAME`. The command with its options `--json` and `--csv`, the
sections of the report, the key in sweeps and the function `idealgas.NAME` are generated from the class.

Results are dataclasses that inherit from `Result`. They provide their own tables and figures, their fields are written
to JSON as plain values (`fields.py`), and a result stored by a sweep can be restored. If a condition for a measurement
or a prediction is not met, a sentence in the `caveats` of the result explains this in tables, reports and JSON.
"""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import dataclass, field, replace
from functools import wraps
from inspect import getdoc, signature
from numbers import Integral, Real
from os import PathLike
from typing import TYPE_CHECKING, Any, ClassVar

from idealgas.analysis import caveats
from idealgas.analysis.result import Origin, Result
from idealgas.errors import NotApplicableError, UserError, unknown
from idealgas.fields import from_dict
from idealgas.log import takes_path
from idealgas.tallies.stream import ReadProgress

if TYPE_CHECKING:
    from idealgas.log import Log

FOUND: dict[str, type["Analysis"]] = {}
"""All analyses that have been imported, by name."""


@dataclass(frozen=True)
class Option:
    """One option of an analysis: `--name` on the command line, a keyword argument in Python.

    Attributes:
        name: name of the option, a Python identifier.
        kind: type of the value: str, int or float.
        help: help text on the command line.
        default: value if the option is not given.
        choices: allowed values of a str option; empty if any string is allowed.
        least: smallest allowed number.
        most: largest allowed number.
        positive: whether a number must be greater than 0.
        metavar: placeholder for the value in the help text.
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
        words = {int: "a whole number", float: "a number", str: "text"}[self.kind]
        bounds = [f">= {self.least:g}"] if self.least is not None else []
        bounds += [f"<= {self.most:g}"] if self.most is not None else []
        bounds += ["> 0"] if self.positive else []
        return " ".join([words, " and ".join(bounds)]).strip()

    def check(self, value: Any) -> None:
        """Raise UserError if a value is not allowed; None is allowed if the default is None."""
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
    """One section that an analysis contributes to the report.

    Attributes:
        title: heading of the section.
        caption: text below the figure, also read by screen readers.
        options: option values with which the analysis is run for this section.
    """

    title: str
    caption: str
    options: Mapping[str, Any] = field(default_factory=dict)


class Analysis:
    """Base class of an analysis, whose class attributes and static methods the program uses.

    Attributes:
        name: name of the module that defines the analysis, a Python identifier.
        key: name of the command and key in sweep files: `name` with hyphens instead of underscores.
        results: classes of the results: the class for one log and then, if it differs, the class for several logs.
        sections: sections of the report.
        options: options besides the start and end of the window, passed to `measure` as arguments.
        averages: whether `combine` averages over logs, in which case the runs must be independent.
        start: description of the default start of the window.
        end: description of the default end of the window.
        reads: what the progress bar counts, such as events or frames.
        position: rank in the report, lowest first; analyses with equal ranks are in alphabetical order.
        reported_from: lowest packing fraction at which a report includes the analysis.
        headline: name of the main quantity, plotted by default in the figure of a sweep; empty if there is none.
        on_request: whether a report includes the analysis only if the scene names it in `scene.shows`.
    """

    name: ClassVar[str]
    key: ClassVar[str]
    results: ClassVar[tuple[type[Result], ...]]
    sections: ClassVar[tuple[Section, ...]] = ()
    options: ClassVar[tuple[Option, ...]] = ()
    averages: ClassVar[bool] = False
    start: ClassVar[str] = "detected equilibrium"
    end: ClassVar[str] = "the log's end"
    reads: ClassVar[str] = "events"
    position: ClassVar[int] = 1000
    reported_from: ClassVar[float] = 0.0
    headline: ClassVar[str] = ""
    on_request: ClassVar[bool] = False

    measure: ClassVar[Callable[..., Any]]
    """Function measure(log, start, end, progress, **options) that returns the result for one log."""

    combine: ClassVar[Callable[..., Any] | None] = None
    """Function combine(results) that returns one result for several logs or for the points of a sweep.

    None if the analysis accepts only a single log.
    """

    supports_polydispersity: ClassVar[bool] = True
    """Whether the analysis applies to species whose discs differ in radius or mass."""

    supports_shear: ClassVar[bool] = False
    """Whether the analysis subtracts the mean flow of a sheared gas and follows the images that the shear displaces."""

    supports_escapes: ClassVar[bool] = False
    """Whether the analysis applies to a gas from which discs escape."""

    def __init_subclass__(cls) -> None:
        """Register the analysis under the name of its module."""
        cls.name = cls.__module__.rpartition(".")[2]
        cls.key = cls.name.replace("_", "-")
        FOUND[cls.name] = cls
        for kind in cls.results:
            kind.analysis = cls

    @classmethod
    def is_checked(cls) -> bool:
        """Return whether the result has a method `check()` that compares the measurement with theory."""
        return hasattr(cls.results[0], "check")

    @classmethod
    def analyse(
        cls,
        log: "Log | str | PathLike[str]",
        start: float | None = None,
        end: float | None = None,
        progress: ReadProgress | None = None,
        **options: Any,
    ) -> Any:
        """Analyse a log (or the log at a path) between the times `start` and `end`, and return the `Result`.

        Raises:
            UserError: if an option is unknown or its value is not allowed, or if the analysis does not apply to the
                log.
        """
        known = {option.name: option for option in cls.options}
        for name, value in options.items():
            if name not in known:
                raise unknown(f"option of {cls.key}", name, ("start", "end", *known))
            known[name].check(value)
        values = {name: option.default for name, option in known.items()} | options
        return takes_path(cls._analyse)(log, start, end, progress, values)

    @classmethod
    def _analyse(
        cls, log: "Log", start: float | None, end: float | None, progress: ReadProgress | None, values: dict[str, Any]
    ) -> Any:
        if not cls.supports_polydispersity and (unlike := log.discs.unlike):
            differ = f"but radius or mass varies within {', '.join(unlike)}"
            raise NotApplicableError(f"{log.path}: {cls.key} requires equal discs in each species, {differ}")
        if not cls.supports_shear and log.scene.properties.shear:
            raise NotApplicableError(
                f"{log.path}: {cls.key} requires a gas without flow, but this gas is sheared; use `idealgas shear` or "
                "`idealgas profile`"
            )
        if log.escapes and not cls.supports_escapes:
            raise NotApplicableError(
                f"{log.path}: {cls.key} requires a constant number of discs, but discs leave this gas; use `idealgas "
                "escape` or `idealgas evolution`"
            )
        with _arithmetic(f"{log.path}: {cls.key}"):
            result = cls.measure(log, start=start, end=end, progress=progress, **values)
        slow: tuple[str, ...] = ()
        if hasattr(result, "window"):
            slow = *caveats.path_caveats(log, result.window), *caveats.window_caveats(result.window)
        origin = caveats.origin_of(log.scene, str(log.path))
        return replace(
            result, caveats=(*caveats.log_caveats(log), *slow, *result.caveats), origin=origin, title=origin.title
        )

    @classmethod
    def function(cls) -> Callable[..., Any]:
        """Return `analyse` as a function with the signature of `measure` and a docstring based on it."""
        arguments = signature(cls.measure)

        @wraps(cls.measure)
        def function(*given: Any, **named: Any) -> Any:
            return cls.analyse(**arguments.bind(*given, **named).arguments)

        function.__name__ = function.__qualname__ = cls.name
        function.__doc__ = cls._docstring()
        return function

    @classmethod
    def _docstring(cls) -> str:
        """Return the docstring of `measure`, with descriptions of the common arguments and of the options."""
        text, *errors = (getdoc(cls.measure) or "").partition("\n\nRaises:")
        arguments = {
            "log": "log to analyse, or its path.",
            "start": f"start of the window, time; by default {cls.start}.",
            "end": f"end of the window, time; by default {cls.end}.",
            "progress": f"called as progress(done, total), in numbers of {cls.reads}.",
        } | {option.name: f"{option.help} Allowed: {option.allowed}." for option in cls.options}
        listed = "".join(f"\n    {name}: {words}" for name, words in arguments.items())
        return f"{text}\n\nArgs:{listed}{''.join(errors)}"

    @classmethod
    def combined(cls, results: Sequence[Any]) -> Any:
        """Combine the results of one or more runs.

        Raises:
            UserError: if the analysis averages over runs and a run is given twice, or if the gases cannot be combined.
        """
        if cls.combine is None:
            (result,) = results
            return result
        independent = caveats.averaging_caveats(results) if cls.averages else ()
        combined = cls.combine(results)
        if len(results) == 1 and combined is results[0]:
            return combined
        sentences = (*caveats.combined_caveats(results), *independent, *combined.caveats)
        return replace(combined, caveats=sentences, title=caveats.combined_title(results))

    @classmethod
    def restored(cls, values: dict[str, Any], origin: Origin) -> Any:
        """Restore the result of a run from the plain values stored by a sweep.

        Raises:
            UserError: if the values do not form a valid result.
        """
        try:
            return replace(from_dict(cls.results[0], values), origin=origin, title=origin.title)
        except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError):
            raise UserError(f"{origin.path}: damaged results of the analysis {cls.key}") from None


@contextmanager
def _arithmetic(what: str) -> Iterator[None]:
    """Turn arithmetic errors into a UserError, because a damaged log may contain numbers that no run produces."""
    import numpy as np

    from idealgas.jit import INTERPRETED

    try:
        with np.errstate() if INTERPRETED else np.errstate(divide="raise", over="raise", invalid="raise"):
            yield
    except (ArithmeticError, ValueError) as error:
        raise UserError(f"{what}: cannot be computed from these numbers: {error}") from error
