"""Command `idealgas export`: convert a log to files for other programs."""

import sys
from pathlib import Path
from typing import TYPE_CHECKING

import click

from idealgas.errors import UserError

from ._analysis import log_argument, open_log
from ._options import FILE, force_option, quiet_option
from ._terminal import echo

if TYPE_CHECKING:
    from idealgas.log.export.export import Kind

KINDS: "tuple[Kind, ...]" = ("csv", "parquet", "gsd", "extxyz", "h5md3d")


@click.command(epilog="Example: idealgas export gas.h5 --frames 100 -o gas.extxyz")
@log_argument
@click.option(
    "--format", "kind", type=click.Choice(KINDS), help="Format of the file.  [default: from the ending of OUT]"
)
@click.option("--events", is_flag=True, help="Write all events (csv, parquet).")
@click.option("--flights", is_flag=True, help="Write the flights of all discs from event to event (csv, parquet).")
@click.option("--parts", type=click.IntRange(1), help="Write a folder with this many parquet files, divided by time.")
@click.option(
    "--frames",
    metavar="N|every=DT",
    help="Write all discs at N times from start to end, or at intervals of DT in simulated time.",
)
@click.option(
    "-o",
    "--output",
    type=FILE,
    metavar="OUT",
    help="File to write; - for standard output (csv, extxyz).  [default: RUN with the ending of the format]",
)
@force_option
@quiet_option
def export(
    path: str,
    kind: "Kind | None",
    events: bool,
    flights: bool,
    parts: int | None,
    frames: str | None,
    output: str | None,
    force: bool,
) -> None:
    """Write the events or flights of a log, or frames of all discs, to a file for other programs.

    gsd (HOOMD, OVITO) stores positions as float32; extxyz (OVITO, ASE) and csv keep all digits; h5md3d (MDAnalysis) is
    H5MD with a third coordinate equal to zero.
    """
    if events + flights + (frames is not None) != 1:
        raise click.UsageError("one of --events, --flights and --frames is required")
    from idealgas.log.export.export import FORMATS, frame_times
    from idealgas.log.export.export import export as write

    if parts and output == "-":
        raise UserError("--parts: a folder cannot be written to standard output (allowed -o FOLDER)")
    kind = kind or ("parquet" if parts else _kind_of(output))
    with open_log(path) as log:
        times = None if frames is None else frame_times(log, frames).tolist()
        target = output or str(Path(path).with_suffix("" if parts else FORMATS[kind].ending))
        file = sys.stdout.buffer if target == "-" else target
        number = write(log, kind, file, times, force, "flights" if flights else "events", parts)
    what = "event rows" if events else "flights" if flights else "frames"
    echo(f"{target}: {number:,} {what}", err=target == "-")


def _kind_of(output: str | None) -> "Kind":
    """Return the export format that the ending of a path stands for; raise UserError if there is none."""
    from idealgas.log.export.export import FORMATS

    ending = Path(output or "").suffix.lower()
    kind = next((kind for kind, file_format in FORMATS.items() if file_format.ending == ending), None)
    if kind is None:
        raise UserError(
            f"--format: missing (allowed {', '.join(KINDS)}), or give OUT the ending of one of these formats"
        )
    return kind
