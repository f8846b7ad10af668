"""Base class of the results of all analyses: caveats, the run they come from, headline, tables and figures."""

from abc import ABC, abstractmethod
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from idealgas.errors import UserError
from idealgas.fields import OMITTED, as_dict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from idealgas.presentation.tables import Table


@dataclass(frozen=True)
class Origin:
    """Run that a result comes from.

    Attributes:
        path: path of the log, or name of the point in a sweep.
        run: digest of everything that determines the motion; it is the same for two logs of one run.
        gas: digest of the discs, the box and the effects; it does not depend on the temperature.
        words: description of the gas in words.
        kind: kind of gas in words, regardless of the number of discs and the size of the box.
        mixture: whether the discs have different radii.
        seed: seed of the random numbers of the run; None if the run draws none.
        title: title of the scene, or the path if the scene has no title.
        label: name of the run among several runs: the path of its log, or the values of the axes of a sweep.
    """

    path: str
    run: str
    gas: str
    words: str
    kind: str
    mixture: bool
    seed: int | None
    title: str
    label: str = ""


@dataclass(frozen=True, kw_only=True)
class Result(ABC):
    """Base class of the results of all analyses.

    Attributes:
        caveats: one sentence for each condition on the numbers that is not met or that the reader should know. Tables,
            reports and JSON contain these sentences.
        origin: run that the result comes from; None if the result combines several runs, or if it was not returned by
            `Analysis.analyse`.
        title: name of the run or runs in figures.
    """

    analysis: ClassVar[Any]
    """The analysis that the result belongs to, a subclass of `Analysis`."""

    caveats: tuple[str, ...] = ()
    origin: Annotated[Origin | None, OMITTED] = None
    title: Annotated[str, OMITTED] = ""

    @abstractmethod
    def plain_tables(self) -> "list[Table]":
        """Return the tables of the result, without its caveats."""

    @abstractmethod
    def figure(self) -> "Figure":
        """Draw the result, without a title."""

    def summary(self) -> str:
        """Return the headline, which gives the result and whether it agrees with theory."""
        return ""

    def text(self) -> str:
        """Return a figure drawn with characters for the terminal; empty if there is none."""
        return ""

    def as_dict(self) -> dict[str, Any]:
        """Return the result as plain values by name, ready for JSON."""
        return as_dict(self)

    def tables(self) -> "list[Table]":
        """Return the tables that the command of the analysis prints; the first table has a note for each caveat."""
        first, *remaining = self.plain_tables()
        notes = (*(f"caveat: {sentence}" for sentence in self.caveats), *first.notes)
        return [replace(first, notes=notes), *remaining]

    def plot(self) -> "Figure":
        """Return the matplotlib figure of `--plot`; notebooks display it, and `savefig` writes it to a file."""
        return self._titled(self.figure())

    def plot_errors(self) -> "Figure":
        """Return the figure of `--plot-errors`: the error of each estimate against the length of the blocks of time.

        Raises:
            UserError: if no error was estimated from blocks of time.
        """
        from idealgas.presentation.style import block_figure

        names: dict[tuple[tuple[float, float], ...], str] = {}
        for table in self.tables():
            for row, estimate in zip(table.rows, table.estimates, strict=False):
                names.setdefault(estimate.blocks, str(row[0]))
        names.pop((), None)
        if not names:
            raise UserError(f"{self.analysis.key}: no error bar was estimated from blocks of time")
        window = getattr(self, "window", None)
        length = (window.duration, "time") if window else (1.0, "share of the window")
        return self._titled(block_figure(names, *length))

    def _titled(self, figure: "Figure") -> "Figure":
        """Return the figure with the names of the run and of the analysis as its title."""
        from idealgas.presentation.style import add_title

        return add_title(figure, f"{self.title}: {self.analysis.key}")

    def __str__(self) -> str:
        """Return the headline and the tables as text."""
        from idealgas.presentation.tables import as_text

        return "\n".join(filter(None, (self.summary(), as_text(self.tables()))))

    def _repr_html_(self) -> str:
        """Return the headline and the tables as HTML, which a notebook displays for the last expression of a cell."""
        from idealgas.presentation.tables import escape, html_tables

        return f"<p><b>{escape(self.summary())}</b></p>{html_tables(self.tables())}"


class RunResult(Result):
    """Base class of results of single runs that are displayed in the same form as a combination of several runs."""

    def plain_tables(self) -> "list[Table]":
        """Return the tables of this run alone, without caveats."""
        return self._alone().plain_tables()

    def tables(self) -> "list[Table]":
        """Return the tables of this run alone, with the caveats of its combination."""
        return self._alone().tables()

    def figure(self) -> "Figure":
        """Draw this run alone."""
        return self._alone().figure()

    def summary(self) -> str:
        """Return the headline of this run alone."""
        return self._alone().summary()

    def _alone(self) -> Result:
        return self.analysis.combined([self])
