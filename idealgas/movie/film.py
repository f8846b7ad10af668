"""Film of a log: times of the frames, and how painted frames become a file."""

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from pathlib import Path
from typing import IO

import numpy as np
from PIL import Image

from idealgas.analysis.core.ensemble import centre_of_mass_velocity
from idealgas.analysis.core.stream import span
from idealgas.errors import OutputError, UserError
from idealgas.files import check_output, written
from idealgas.log import Log
from idealgas.movie.gif import GifWriter
from idealgas.movie.painter import CROSSING, Colouring, Painter
from idealgas.movie.piston_track import piston_track

ENDINGS, FRAME = (".mp4", ".gif"), ".png"
LONGEST = 20.0  # default length of a film, seconds
MOST_FRAMES = 1_000_000
CODEC = ("-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart")


@dataclass(frozen=True)
class Film:
    """A film that was made: path, number of frames, frames per second, and start and end in simulated time."""

    path: Path
    frames: int
    fps: float
    start: float
    end: float


def film_path(output: str | os.PathLike[str]) -> Path:
    """Path of the film to write: `output`, or a .gif instead of an .mp4 if ffmpeg is not installed.

    Raises:
        UserError: for another ending than .mp4 or .gif.
    """
    path = Path(output)
    if path.suffix.lower() not in ENDINGS:
        raise UserError(f"{output}: unknown kind of film (allowed: {', '.join(ENDINGS)})")
    if path.suffix.lower() == ".mp4" and shutil.which("ffmpeg") is None:
        return path.with_suffix(".gif")
    return path


def animate(
    log: Log,
    output: str | os.PathLike[str],
    *,
    start: float | None = None,
    end: float | None = None,
    fps: float = 25.0,
    speed: float | None = None,
    size: tuple[int, int] = (960, 540),
    colouring: Colouring = "speed",
    dark: bool = False,
    force: bool = False,
    on_frame: Callable[[int, int], None] = lambda done, total: None,
) -> Film:
    """Make a film of a log between two times, with exact positions in every frame.

    Args:
        log: the log to show.
        output: path of the film, see `film_path`.
        start: start in simulated time; None for the start of the log.
        end: end in simulated time; None for LONGEST seconds of film.
        fps: frames per second of film.
        speed: simulated time per second of film; None for a disc of typical speed to cross the box in CROSSING seconds.
        size: width and height of a frame in pixels, made even.
        colouring: what the colours of discs show.
        dark: whether the background is dark.
        force: whether to replace an existing film.
        on_frame: called with the number of painted frames and the number of all frames.

    Raises:
        UserError: if the log has no positions or no events, or the window is empty, or for order beside a piston.
        OutputError: if the film cannot be written.
    """
    path = film_path(output)
    kind = path.suffix.lower()
    check_output(path, kind, force)
    check_shown(log, colouring)
    first, latest = span(log, start, end)
    typical, thermal = speeds(log, first, latest)
    speed = speed or (max(log.box) / CROSSING / typical if typical > 0 else (latest - first) / LONGEST)
    last = latest if end is not None else min(latest, first + LONGEST * speed)
    gif = kind == ".gif"
    if gif:
        fps = 100 / max(round(100 / fps), 2)  # delays are in hundredths of a second; viewers ignore a delay of 1
    number = round((last - first) * fps / speed) + 1
    if number > MOST_FRAMES:
        raise UserError(
            f"{number:,} frames are too many (allowed <= {MOST_FRAMES:,}): a shorter window or more --speed"
        )
    width, height = (pixels // 2 * 2 for pixels in size)
    piston = piston_track(log, first, last)
    painter = Painter(log.scene, log.discs, piston, (width, height), thermal, colouring, dark)
    times = np.minimum(first + np.arange(number) * (speed / fps), last)
    with written(path, kind, force) as part, (gif_writer if gif else mp4_writer)(part, width, height, fps) as write:
        for k, state in enumerate(log.frames(times)):
            write(painter.paint(state))
            on_frame(k + 1, number)
    return Film(path, number, fps, first, last)


def paint_frame(
    log: Log,
    output: str | os.PathLike[str],
    time: float,
    *,
    size: tuple[int, int] = (960, 540),
    colouring: Colouring = "speed",
    dark: bool = False,
    force: bool = False,
) -> Path:
    """Paint the state of a log at one time as a picture, a .png, and return its path; arguments as for `animate`.

    Raises:
        UserError: for another ending, or a log that has no such state or no positions or events, as for `animate`.
        OutputError: if the picture cannot be written.
    """
    path = Path(output)
    if path.suffix.lower() != FRAME:
        raise UserError(f"{output}: unknown figure format (allowed {FRAME})")
    check_output(path, FRAME, force)
    check_shown(log, colouring)
    if not log.start_time <= time <= log.end_time:
        raise UserError(
            f"{log.path}: no state at t = {time:g}: the log covers t = {log.start_time:g} to {log.end_time:g}"
        )
    _, thermal = speeds(log, log.start_time, log.end_time)
    piston = piston_track(log, log.start_time, log.end_time)
    frame = Painter(log.scene, log.discs, piston, size, thermal, colouring, dark).paint(log.state_at(time))
    with written(path, FRAME, force) as part:
        Image.fromarray(frame[..., :3]).save(part, format="png")
    return path


def check_shown(log: Log, colouring: Colouring) -> None:
    """Refuse a log without positions or without events, as nothing moves in its pictures, and order beside a piston.

    Raises:
        UserError: in these cases.
    """
    if colouring == "order" and not log.scene.properties.fixed_walls:
        raise UserError(f"{log.path}: has a piston, and neighbours are only found in a box with fixed sides")
    if not log.has_positions:
        raise UserError(f"{log.path}: has no positions to show ({log.scene.run.method})")
    if not log.has_events:
        raise UserError(f"{log.path}: has no events to show (made with log.events = false)")


def speeds(log: Log, first: float, last: float) -> tuple[float, float]:
    """Largest root-mean-square speed at some times, and the same relative to a conserved motion of the whole gas."""
    some = [state.velocity for state in log.frames(np.linspace(first, last, 5))]
    typical, thermal = (
        max(np.sqrt(((v - u) ** 2).sum(axis=1).mean()) for v in some) for u in (0.0, centre_of_mass_velocity(log))
    )
    return float(typical), float(thermal)


Write = Callable[[np.ndarray], object]


@contextmanager
def gif_writer(path: Path, width: int, height: int, fps: float) -> Iterator[Write]:
    """Yield the function write(frame) of a GIF for frames of shape (height, width, 4) and type uint8."""
    with path.open("wb") as file:
        gif = GifWriter(file, width, height, round(100 / fps))
        yield gif.write
        gif.close()


@contextmanager
def mp4_writer(path: Path, width: int, height: int, fps: float) -> Iterator[Write]:
    """Yield the function write(frame) of an H.264 video, which ffmpeg makes from the frames."""
    raw = ("-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-")
    command = ["ffmpeg", "-y", "-loglevel", "error", *raw, "-an", *CODEC, "-f", "mp4", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as ffmpeg:
        pipe, messages = _streams(ffmpeg)
        try:
            yield lambda frame: pipe.write(frame.data)
        except BrokenPipeError:
            pass  # its error message says why
        except BaseException:
            ffmpeg.kill()
            raise
        finally:
            _close(pipe)
        said = messages.read().decode(errors="replace").strip().splitlines()
        if ffmpeg.wait() != 0:
            raise OutputError(f"ffmpeg: {said[-1] if said else 'failed'}", exit_code=1)


def _streams(process: subprocess.Popen[bytes]) -> tuple[IO[bytes], IO[bytes]]:
    assert process.stdin is not None
    assert process.stderr is not None
    return process.stdin, process.stderr


def _close(pipe: IO[bytes]) -> None:
    with suppress(BrokenPipeError):
        pipe.close()
