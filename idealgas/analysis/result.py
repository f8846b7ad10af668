"""What the results of all analyses have in common: caveats, the run, tables and a figure."""

from dataclasses import dataclass
from typing import TYPE_CHECKING, Annotated, Any, ClassVar

from idealgas.fields import OMITTED, as_dict

if TYPE_CHECKING:
    from matplotlib.figure import Figure

    from idealgas.presentation.tables import Table


@dataclass(frozen=True)
class Origin:
    """Run that a result comes from.

    Attributes:
        path: path of its log, or name of its point in a sweep.
        run: digest of all that determines the motion, the same for two logs of one run.
        gas: digest of the discs, the box and the effects, the same at another temperature.
        words: the gas in words.
        kind: kind of gas in words, whatever the number of discs and the size of the box.
        mixture: whether radii differ.
        seed: seed of the random numbers of the run; None if it draws none.
        title: title of its scene, or else its path.
    """

    path: str
    run: str
    gas: str
    words: str
    kind: str
    mixture: bool
    seed: int | None
    title: str


@dataclass(frozen=True, kw_only=True)
class Result:
    """Base of the results of all analyses.

    Attributes:
        caveats: one sentence for each condition of the numbers that is not met or is worth knowing. Tables, reports and
            JSON contain them.
        origin: run that the result comes from; None if it comes from several runs, or not from `Analysis.analyse`.
        title: name of the run or runs in figures.
    """

    analysis: ClassVar[Any]
    """The analysis that the result belongs to, a subclass of `Analysis`."""

    caveats: tuple[str, ...] = ()
    origin: Annotated[Origin | None, OMITTED] = None
    title: Annotated[str, OMITTED] = ""

    def as_dict(self) -> dict[str, Any]:
        """Return plain values by name, ready for JSON."""
        return as_dict(self)

    def tables(self) -> "list[Table]":
        """Return the tables that the command of the analysis prints."""
        return self.analysis.shown_tables(self._combined())

    def plot(self) -> "Figure":
        """Return the figure of `--plot`: a figure of matplotlib, which notebooks display and `savefig` writes."""
        return self.analysis.titled_figure(self._combined())

    def summary(self) -> str:
        """Return the headline: the result, and whether it agrees with theory."""
        return self.analysis.summary(self._combined())

    def __str__(self) -> str:
        """Return headline and tables as text."""
        from idealgas.presentation.tables import as_text

        return "\n".join(filter(None, (self.summary(), as_text(self.tables()))))

    def _repr_html_(self) -> str:
        """Return headline and tables as HTML, which notebooks display at the end of a cell."""
        from idealgas.presentation.tables import escape, html_tables

        return f"<p><b>{escape(self.summary())}</b></p>{html_tables(self.tables())}"

    def _combined(self) -> "Result":
        """Return the result in the form for tables and figure; without a single origin it is combined already."""
        return self if self.origin is None else self.analysis.combined([self])
