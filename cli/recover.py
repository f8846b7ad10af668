"""`idealgas recover`: close the log of a writer that died."""

import click

from ._analysis import log_argument


@click.command()
@log_argument
@click.option("-o", "--output", metavar="OUT.h5", help="Leave the log as it is and make a copy.")
def recover(path: str, output: str | None) -> None:
    """Make the log of a run that was killed open in any HDF5 program again, with every row that was committed.

    No command of idealgas needs this: they read such a log as it is.
    """
    from idealgas.log import recover as close

    rows = close(path, output)
    click.echo(f"{output or path}: {rows:,} event rows kept")
