"""Command `idealgas recover`: close the log of a run that was killed."""

import click

from ._analysis import log_argument
from ._options import FILE, force_option, quiet_option
from ._terminal import echo


@click.command(epilog="Example: idealgas recover gas.h5 -o closed.h5")
@log_argument
@click.option(
    "-o", "--output", type=FILE, metavar="OUT.h5", help="Write the closed log to OUT.h5 and leave RUN.h5 unchanged."
)
@force_option
@quiet_option
def recover(path: str, output: str | None, force: bool) -> None:
    """Close the log of a run that was killed, so that any HDF5 program can read its committed rows.

    All idealgas commands can also read a log that was not closed.
    """
    from idealgas.log import recover as close

    rows = close(path, output, force)
    echo(f"{output or path}: {rows:,} event rows kept")
