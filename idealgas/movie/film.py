"""Make a film of a log: choose the times of the frames, and encode the painted frames."""

import os
import shutil
import subprocess
from collections.abc import Callable, Iterator, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import IO, Unpack

import numpy as np
from PIL import Image

from idealgas.errors import OutputError, UserError, install
from idealgas.files import check_output, written
from idealgas.log import Log, LogState, takes_path
from idealgas.movie.gif import GifWriter
from idealgas.movie.painter import CROSSING, Colouring, Look, Painter
from idealgas.movie.piston_track import piston_tracks
from idealgas.tallies.equilibrium import tends_to_equilibrium
from idealgas.tallies.stream import span
from idealgas.theory.conserved import centre_of_mass_velocity

ENDINGS, FRAME = (".mp4", ".gif"), ".png"
LONGEST = 20.0  # default length of a film, seconds
MOST_FRAMES = 1_000_000
HISTORY = 200  # number of earlier states from which trails and curves in a single frame are drawn
CODEC = ("-c:v", "libx264", "-preset", "veryfast", "-crf", "18", "-pix_fmt", "yuv420p", "-movflags", "+faststart")


@dataclass(frozen=True)
class Film:
    """A finished film: path, number of frames, frames per second, and start and end in simulated time."""

    path: Path
    frames: int
    fps: float
    start: float
    end: float


def ffmpeg() -> str:
    """Return the path of the ffmpeg program, from the system or from the package imageio-ffmpeg.

    Raises:
        UserError: if neither is installed.
    """
    if path := shutil.which("ffmpeg"):
        return path
    try:
        from imageio_ffmpeg import get_ffmpeg_exe
    except ImportError:
        raise UserError(f"an MP4 film, unlike a GIF, requires ffmpeg: {install('film')}") from None
    return get_ffmpeg_exe()


@takes_path
def animate(
    log: Log,
    output: str | os.PathLike[str],
    *,
    start: float | None = None,
    end: float | None = None,
    fps: float = 25.0,
    speed: float | None = None,
    force: bool = False,
    on_frame: Callable[[int, int], None] = lambda done, total: None,
    **look: Unpack[Look],
) -> Film:
    """Make a film of a log between two times, with exact positions in every frame.

    Args:
        log: the log to show, or its path.
        output: path of the film, with extension .mp4 or .gif.
        start: start in simulated time; None for the start of the log.
        end: end in simulated time; None for LONGEST seconds of film.
        fps: frames per second of film.
        speed: simulated time per second of film; if None, a disc of typical speed crosses the box in CROSSING seconds.
        force: whether to replace an existing film.
        on_frame: function that is called with the number of painted frames and the total number of frames.
        look: appearance of the film, see `Look`.

    Raises:
        UserError: if the extension is unknown, if ffmpeg is required for an MP4 but missing, if the log has no
            positions or events, if the time window is empty, if colours by order are requested for a gas with a piston,
            or if a disc with a trail does not exist.
        OutputError: if the film cannot be written.
    """
    path = Path(output)
    kind = path.suffix.lower()
    if kind not in ENDINGS:
        raise UserError(f"{output}: unknown kind of film (allowed: {', '.join(ENDINGS)})")
    check_output(path, kind, force)
    gif = kind == ".gif"
    writer = gif_writer if gif else partial(mp4_writer, ffmpeg())
    check_shown(log, look.get("colouring"))
    first, latest = span(log, start, end)
    states = _sample_states(log, first, latest)
    typical, thermal = speeds(log, states)
    speed = speed or (max(log.box) / CROSSING / typical if typical > 0 else (latest - first) / LONGEST)
    last = latest if end is not None else min(latest, first + LONGEST * speed)
    if gif:
        fps = 100 / max(round(100 / fps), 2)  # delays are multiples of 10 ms, and viewers ignore one of 10 ms
    number = round((last - first) * fps / speed) + 1
    if number > MOST_FRAMES:
        raise UserError(
            f"{number:,} frames are too many (allowed <= {MOST_FRAMES:,}): a shorter window or more --speed"
        )
    if (size := look.get("size")) is not None:
        look["size"] = size[0] // 2 * 2, size[1] // 2 * 2
    painter = _painter(log, thermal, (first, last), states, look)
    times = np.minimum(first + np.arange(number) * (speed / fps), last)
    with written(path, kind, force) as part, writer(part, *painter.size, fps) as write:
        for k, state in enumerate(log.frames(times)):
            write(painter.paint(state))
            on_frame(k + 1, number)
    return Film(path, number, fps, first, last)


def _painter(log: Log, thermal: float, times: tuple[float, float], states: Sequence[LogState], look: Look) -> Painter:
    """Return the painter for states of a log. thermal: the argument `rms_speed` of `Painter`."""
    pistons, maxwell = piston_tracks(log, *times), tends_to_equilibrium(log)
    return Painter(log.scene, log.discs, pistons, thermal, times, states, maxwell, **look)


def paint_frame(
    log: Log, output: str | os.PathLike[str], time: float, *, force: bool = False, **look: Unpack[Look]
) -> Path:
    """Paint the state of a log at one time as a PNG picture.

    Trails and curves begin at the start of the log.

    Args:
        log: the log to show.
        output: path of the picture, with extension .png.
        time: time of the state.
        force: whether to replace an existing picture.
        look: appearance of the picture, see `Look`.

    Returns:
        Path of the picture.

    Raises:
        UserError: if the extension is unknown, if the log does not cover the time, and in the cases listed for
            `animate`.
        OutputError: if the picture cannot be written.
    """
    path = Path(output)
    if path.suffix.lower() != FRAME:
        raise UserError(f"{output}: unknown figure format (allowed {FRAME})")
    check_output(path, FRAME, force)
    check_shown(log, look.get("colouring"))
    if not log.start_time <= time <= log.end_time:
        raise UserError(
            f"{log.path}: no state at t = {time:g}: the log covers t = {log.start_time:g} to {log.end_time:g}"
        )
    times = log.start_time, log.end_time
    states = _sample_states(log, *times)
    _, thermal = speeds(log, states)
    painter = _painter(log, thermal, times, states, look)
    grows = look.get("trails") or look.get("panel") == "left-right"
    for state in log.frames(np.linspace(log.start_time, time, HISTORY) if grows else np.array([time])):
        frame = painter.paint(state)
    with written(path, FRAME, force) as part:
        Image.fromarray(frame[..., :3]).save(part, format="png")
    return path


def check_shown(log: Log, colouring: Colouring | None) -> None:
    """Check that a log can be shown.

    Raises:
        UserError: if the log has no positions, or no events and therefore no motion to show, or if colours by order are
            requested for a gas with a piston or with discs that escape.
    """
    if colouring == "order" and not log.scene.properties.fixed_walls:
        moving = ", ".join(log.scene.lacking("fixed_walls"))
        raise UserError(f"{log.path}: colouring by order requires a box with fixed sides (got a scene with {moving})")
    if colouring == "order" and log.escapes:
        raise UserError(f"{log.path}: colouring by order requires that no disc leaves the gas")
    if not log.has_positions:
        raise UserError(f"{log.path}: has no positions to show ({log.scene.run.method})")
    log.require_events()


def _sample_states(log: Log, first: float, last: float) -> list[LogState]:
    return list(log.frames(np.linspace(first, last, 5)))


def speeds(log: Log, states: Sequence[LogState]) -> tuple[float, float]:
    """Return the largest rms speed of the states, as measured and relative to a conserved motion of the gas."""
    typical, thermal = (
        max(np.sqrt(state.mean(((state.velocity - u) ** 2).sum(axis=1))) for state in states)
        for u in (0.0, centre_of_mass_velocity(log.scene, log.discs))
    )
    return float(typical), float(thermal)


Write = Callable[[np.ndarray], object]


@contextmanager
def gif_writer(path: Path, width: int, height: int, fps: float) -> Iterator[Write]:
    """Yield a function write(frame) that appends frames (height, width, 4) uint8 to a GIF."""
    with path.open("wb") as file:
        gif = GifWriter(file, width, height, round(100 / fps))
        yield gif.write
        gif.close()


@contextmanager
def mp4_writer(program: str, path: Path, width: int, height: int, fps: float) -> Iterator[Write]:
    """Yield a function write(frame) that sends frames to ffmpeg, which encodes them as an H.264 video."""
    raw = ("-f", "rawvideo", "-pix_fmt", "rgba", "-s", f"{width}x{height}", "-r", str(fps), "-i", "-")
    command = [program, "-y", "-loglevel", "error", *raw, "-an", *CODEC, "-f", "mp4", str(path)]
    with subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE) as encoder:
        pipe, messages = _streams(encoder)
        try:
            yield lambda frame: pipe.write(frame.data)
        except BrokenPipeError:
            pass  # the reason is in the error message of ffmpeg, which is read below
        except BaseException:
            encoder.kill()
            raise
        finally:
            _close(pipe)
        lines = messages.read().decode(errors="replace").strip().splitlines()
        if encoder.wait() != 0:
            raise OutputError(f"ffmpeg: {lines[-1] if lines else 'failed'}", exit_code=1)


def _streams(process: subprocess.Popen[bytes]) -> tuple[IO[bytes], IO[bytes]]:
    assert process.stdin is not None
    assert process.stderr is not None
    return process.stdin, process.stderr


def _close(pipe: IO[bytes]) -> None:
    with suppress(BrokenPipeError):
        pipe.close()
