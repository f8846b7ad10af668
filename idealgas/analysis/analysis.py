"""Base class of all analyses: a subclass declares its options and measures a log.

A module or package of `idealgas.analysis` contains one analysis, a subclass of `Analysis`. The first line of its
docstring is the help of the command `idealgas NAME`. The command with `--json` and `--csv`, the sections of the report,
the key of a sweep and the function `idealgas.NAME` are made from the class.

Results are dataclasses that inherit from `Result`, show themselves in tables and figures, and are restored from the
results of a sweep; their fields are the plain values for JSON (`fields.py`). Each condition of a number that is not met
is a sentence in `caveats` of the result, which tables, reports and JSON contain.
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
        name: a Python identifier.
        kind: type of the value: str, int or float.
        help: text for the command line.
        default: value if the option is not given.
        choices: allowed texts.
        least: smallest allowed number.
        most: largest allowed number.
        positive: whether a number must be greater than 0.
        metavar: word that stands for the value in the help text.
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
        """Raise UserError if the value is not allowed; None is allowed if it is the default."""
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

    Attributes:
        title: heading of the section.
        caption: text below the figure, which screen readers also read.
        options: values of the options of the analysis for this section.
    """

    title: str
    caption: str
    options: Mapping[str, Any] = field(default_factory=dict)


class Analysis:
    """One analysis. The program uses its class attributes and static methods.

    Attributes:
        name: name of its module, a Python identifier.
        key: name of the command and key in the file of a sweep, with hyphens instead of underscores.
        results: classes of its results; the class for several logs follows that for one log.
        sections: sections of the report.
        options: options besides the start and the end of the window; they are arguments of `measure`.
        averages: whether `combine` averages over logs, so that their runs must be independent.
        start: description of the default start of the window.
        end: description of the default end of the window.
        reads: what the progress bar counts, such as events or frames.
        position: position in the report; analyses without one follow in alphabetical order.
        reported_from: packing fraction from which on a report includes the analysis.
        headline: name of its main quantity, which the figure of a sweep shows by default; empty for none.
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

    measure: ClassVar[Callable[..., Any]]
    """Function measure(log, start, end, progress, **options) that returns the result of one log."""

    combine: ClassVar[Callable[..., Any] | None] = None
    """Function combine(results) that returns one result of several logs or of the points of a sweep.

    None if the analysis takes a single log only.
    """

    supports_polydispersity: ClassVar[bool] = True
    """Whether the analysis applies to species whose discs differ in radius or mass."""

    supports_shear: ClassVar[bool] = False
    """Whether the analysis subtracts the mean flow between sheared sides and follows the images that they move."""

    supports_escapes: ClassVar[bool] = False
    """Whether the analysis applies to a gas that discs leave."""

    def __init_subclass__(cls) -> None:
        """Register the analysis under the name of its module."""
        cls.name = cls.__module__.rpartition(".")[2]
        cls.key = cls.name.replace("_", "-")
        FOUND[cls.name] = cls
        for kind in cls.results:
            kind.analysis = cls

    @classmethod
    def is_checked(cls) -> bool:
        """Return whether the result has a method `check()` that compares measurement and theory."""
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
        """Analyse a log, or the log at a path, between the times `start` and `end`, and return the `Result`.

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
            differ = f"but radius or mass differ within {', '.join(unlike)}"
            raise NotApplicableError(f"{log.path}: {cls.key} requires equal discs in each species, {differ}")
        if not cls.supports_shear and log.scene.properties.shear:
            raise NotApplicableError(
                f"{log.path}: {cls.key} requires a gas that does not flow, but sides shear it; use `idealgas shear` or "
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
        """Return `analyse` as a function with the arguments and the docstring of `measure`."""
        arguments = signature(cls.measure)

        @wraps(cls.measure)
        def function(*given: Any, **named: Any) -> Any:
            return cls.analyse(**arguments.bind(*given, **named).arguments)

        function.__name__ = function.__qualname__ = cls.name
        function.__doc__ = cls._docstring()
        return function

    @classmethod
    def _docstring(cls) -> str:
        """Return the docstring of `measure` with the arguments that all analyses take, and its own options."""
        text, *errors = (getdoc(cls.measure) or "").partition("\n\nRaises:")
        arguments = {
            "log": "log to analyse, or its path.",
            "start": f"start of the window, time; by default {cls.start}.",
            "end": f"end of the window, time; by default {cls.end}.",
            "progress": f"called as progress(done, total) with numbers of {cls.reads}.",
        } | {option.name: f"{option.help} Allowed: {option.allowed}." for option in cls.options}
        listed = "".join(f"\n    {name}: {words}" for name, words in arguments.items())
        return f"{text}\n\nArgs:{listed}{''.join(errors)}"

    @classmethod
    def combined(cls, results: Sequence[Any]) -> Any:
        """Combine the results of one or several runs.

        Raises:
            UserError: if the analysis averages and a run is given twice, or if the gases cannot be combined.
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
        """Restore the result of a run from its plain values, which a sweep has stored.

        Raises:
            UserError: if the values are not those of a result.
        """
        try:
            return replace(from_dict(cls.results[0], values), origin=origin, title=origin.title)
        except (LookupError, TypeError, ValueError, AttributeError, ArithmeticError):
            raise UserError(f"{origin.path}: damaged results of the analysis {cls.key}") from None


@contextmanager
def _arithmetic(what: str) -> Iterator[None]:
    """Raise UserError if arithmetic fails, as a log may contain numbers that no run produces."""
    import numpy as np

    from idealgas.jit import INTERPRETED

    try:
        with np.errstate() if INTERPRETED else np.errstate(divide="raise", over="raise", invalid="raise"):
            yield
    except (ArithmeticError, ValueError) as error:
        raise UserError(f"{what}: cannot be computed from these numbers: {error}") from error
