"""Command `idealgas animate`: make a film of a log."""

import re
from typing import Any

import click

from ._analysis import log_argument, open_log
from ._options import FILE, force_option, quiet_option
from ._progress import progress_bar
from ._terminal import echo


def _pixels(_: click.Context, __: click.Parameter, text: str | None) -> tuple[int, int] | None:
    if text is None:
        return None
    match = re.fullmatch(r"(\d+)x(\d+)", text)
    if not match or not all(240 <= int(side) <= 8192 for side in match.groups()):
        raise click.BadParameter(f"not WIDTHxHEIGHT in pixels, 240 to 8192 each (got {text!r})")
    return int(match[1]), int(match[2])


@click.command(epilog="Example: idealgas animate gas.h5 -o gas.mp4 --to 10")
@log_argument
@click.option(
    "-o",
    "--output",
    type=FILE,
    required=True,
    metavar="FILM.mp4",
    help="File of the film, .mp4 or .gif; with --frame, .png.",
)
@click.option(
    "--from", "start", type=float, metavar="T", help="Start of the film, in simulated time.  [default: the log's start]"
)
@click.option(
    "--to", "end", type=float, metavar="T", help="End of the film, in simulated time.  [default: 20 seconds of film]"
)
@click.option(
    "--fps", default=25.0, show_default=True, type=click.FloatRange(1, 120), help="Frames per second of film."
)
@click.option(
    "--speed", type=click.FloatRange(min=0, min_open=True), metavar="X",
    help="Simulated time per second of film.  [default: a disc crosses the box in 5 s]",
)  # fmt: skip
@click.option(
    "--size",
    callback=_pixels,
    metavar="WIDTHxHEIGHT",
    help="Size of a frame in pixels.  [default: 960x540, 720x720 or 540x960, depending on the shape of the box]",
)
@click.option(
    "--colour", default="speed", show_default=True, type=click.Choice(["speed", "species", "order"]),
    help="Property shown by the colours of the discs; order is the angle of the local order parameter ψ₆.",
)  # fmt: skip
@click.option(
    "--panel", default="speeds", show_default=True, type=click.Choice(["speeds", "density", "left-right", "none"]),
    help="Panel beside the discs; left-right is the fraction of discs to the right of the first gate or of the middle.",
)  # fmt: skip
@click.option(
    "--trail", "trails", type=click.IntRange(0), multiple=True, metavar="ID",
    help="Draw the path of the disc with this id.",
)  # fmt: skip
@click.option(
    "--background", default="light", show_default=True, type=click.Choice(["light", "dark"]), help="Background."
)
@click.option("--frame", type=float, metavar="T", help="Write a single frame at this simulated time instead of a film.")
@force_option
@quiet_option
def animate(
    path: str,
    output: str,
    start: float | None,
    end: float | None,
    fps: float,
    speed: float | None,
    size: tuple[int, int] | None,
    colour: str,
    panel: str,
    trails: tuple[int, ...],
    background: str,
    frame: float | None,
    force: bool,
) -> None:
    """Make a film of a log: the discs at their exact positions, beside the distribution of their speeds.

    An MP4 film requires ffmpeg, installed on the system or with .venv/bin/pip install -e ".[film]"; a GIF does not.
    """
    from idealgas.movie.film import animate as make
    from idealgas.movie.film import paint_frame

    look: dict[str, Any] = {"size": size, "colouring": colour, "panel": panel, "trails": trails, "force": force}
    look["dark"] = background == "dark"
    if frame is not None:
        with open_log(path) as log:
            echo(f"{paint_frame(log, output, frame, **look)}: t = {frame:.6g}")
        return
    with open_log(path) as log, progress_bar("reading frames") as progress:
        film = make(log, output, start=start, end=end, fps=fps, speed=speed, **look, on_frame=progress)
    window = f"t = {film.start:.6g} to {film.end:.6g}"
    echo(f"{film.path}: {film.frames} frames, {window}, {film.fps:g} frames per second")
