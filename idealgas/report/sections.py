"""Sections of a report: tables and figure of each analysis, or the reason why it does not apply to the log."""

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from idealgas.analysis import registry
from idealgas.errors import NotApplicableError, UserError
from idealgas.log import DamageError, Log
from idealgas.presentation.tables import Table


@dataclass(frozen=True)
class ReportSection:
    """A section of the report page.

    Attributes:
        analysis: name of the analysis.
        title: heading of the section.
        picture: figure of the analysis.
        caption: text below the figure, which screen readers read aloud.
        tables: tables of the analysis.
        words: headline with the main result.
        left_out: reason why the analysis does not apply; None if it applies.
    """

    analysis: str
    title: str
    picture: Figure | None = None
    caption: str = ""
    tables: tuple[Table, ...] = ()
    words: str = ""
    left_out: str | None = None


def make_sections(log: Log, on_step: Callable[[int, int], None] = lambda done, total: None) -> list[ReportSection]:
    """Return the sections of all analyses in order; on_step(done, total) is called after each section."""
    made = []
    shown = registry.shown(log.scene)
    analyses = [each for each in registry.analyses() if not each.on_request or each.key in shown]
    parts = [(analysis, section) for analysis in analyses for section in analysis.sections]
    for k, (analysis, section) in enumerate(parts):
        try:
            if log.discs.packing_fraction < analysis.reported_from:
                raise NotApplicableError(f"the packing fraction is below {analysis.reported_from:g}")
            result = analysis.analyse(log, **section.options)
            figure, tables, words = result.figure(), tuple(result.tables()), result.summary()
            made.append(ReportSection(analysis.key, section.title, figure, section.caption, tables, words))
        except DamageError:
            raise
        except UserError as error:
            made.append(ReportSection(analysis.key, section.title, left_out=str(error).removeprefix(f"{log.path}: ")))
        on_step(k + 1, len(parts))
    return made
