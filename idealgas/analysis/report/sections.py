"""The analyses of a report: what each of them shows of a log, or why it does not apply to it."""

from collections.abc import Callable
from dataclasses import dataclass

from matplotlib.figure import Figure

from idealgas.analysis import registry
from idealgas.analysis.core.tables import Table
from idealgas.errors import UserError
from idealgas.log import Log


@dataclass(frozen=True)
class Section:
    """A part of the page. caption: of the picture, for those who do not see it too. left_out: why it does not apply."""

    title: str
    picture: Figure | None = None
    caption: str = ""
    tables: tuple[Table, ...] = ()
    left_out: str | None = None


def make_sections(log: Log, on_step: Callable[[int, int], None] = lambda done, total: None) -> list[Section]:
    """Every section of every analysis, in order; on_step(done, total) after each."""
    found = []
    parts = [(analysis, section) for analysis in registry.analyses() for section in analysis.sections]
    for k, (analysis, section) in enumerate(parts):
        try:
            result = analysis.combine([analysis.measure(log, **section.options)])
            tables = tuple(analysis.tables(result))
            found.append(Section(section.title, analysis.figure(result), section.caption, tables))
        except UserError as error:
            found.append(Section(section.title, left_out=str(error).removeprefix(f"{log.path}: ")))
        on_step(k + 1, len(parts))
    return found
