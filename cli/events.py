"""Command `idealgas events`: print the event rows of a log as lines of JSON."""

import json
import time
from typing import TYPE_CHECKING

import click

from idealgas.errors import OutputError, UserError

from ._analysis import log_argument, open_log
from ._terminal import data

if TYPE_CHECKING:
    from idealgas.columns import EventBatch

KINDS = ("disc", "wall", "wall_end", "piston", "thermostat", "steered", "escaped", "fixed_disc")
LINES = 200  # number of lines per write, few enough that a pipe accepts them as a whole
SECONDS = 0.2  # time between two looks at a log that is being written


@click.command(epilog="Example: idealgas events gas.h5 --disc 0 --follow")
@log_argument
@click.option("--disc", type=click.IntRange(min=0), metavar="ID", help="Only events of this disc.")
@click.option("--kind", type=click.Choice(KINDS), help="Only events of this kind.")
@click.option("--from", "t0", type=float, metavar="T", help="Only events at this time or later.")
@click.option("--to", "t1", type=float, metavar="T", help="Only events before this time.")
@click.option("--follow", is_flag=True, help="Wait for further events while the log is being written.")
def events(path: str, disc: int | None, kind: str | None, t0: float | None, t1: float | None, follow: bool) -> None:
    """Print the event rows of a log as lines of JSON: time, disc, kind, partner, and the state after the event.

    A collision of two discs is printed as two rows. The partner is the id of the other disc, or -1 - k for wall k.
    """
    with open_log(path) as log:
        log.require_events()
        if disc is not None and disc >= len(log.discs):
            raise UserError(f"{path}: no such disc (got {disc}; allowed 0 to {len(log.discs) - 1})")
        row = 0 if t0 is None else log.row_at(t0)
        while True:
            live = follow and log.live  # tested before the rows are read, so that no row is missed
            stop = len(log) if t1 is None else log.row_at(t1)
            for batch in log.chunks(None, row, stop):
                print_events(batch, disc, None if kind is None else KINDS.index(kind))
            row = max(row, stop)
            if not live or (t1 is not None and stop < len(log)):
                return
            time.sleep(SECONDS)
            log.refresh()


class EventStream:
    """Callable that prints event rows as long as the output accepts them.

    Attributes:
        failure: BrokenPipeError if the reader has closed the pipe, OutputError if a write has failed, None otherwise.
    """

    failure: BrokenPipeError | OutputError | None = None

    def __call__(self, batch: "EventBatch") -> None:
        """Print the rows of a batch, waiting while the pipe is full; after a failure, do nothing."""
        if self.failure is not None:
            return
        try:
            print_events(batch)
        except (BrokenPipeError, OutputError) as error:
            self.failure = error


def print_events(batch: "EventBatch", disc: int | None = None, kind: int | None = None) -> None:
    """Print those rows of a batch that belong to a disc and a kind of event; None selects all."""
    import numpy as np

    from idealgas.log.dataframes import flat

    chosen = np.ones(len(batch.disc), bool)
    if disc is not None:
        chosen &= batch.disc == disc
    if kind is not None:
        chosen &= batch.kind == kind
    columns = flat({name: None if column is None else column[chosen] for name, column in batch._asdict().items()})
    columns["kind"] = np.array(KINDS)[columns["kind"]]
    names, rows = list(columns), zip(*(column.tolist() for column in columns.values()), strict=True)
    lines = [json.dumps(dict(zip(names, row, strict=True))) for row in rows]
    for first in range(0, len(lines), LINES):
        data("\n".join(lines[first : first + LINES]))
