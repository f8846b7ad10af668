"""Command `idealgas watch`: show a log in the browser, even while the log is being written."""

import os
import subprocess
import sys
import webbrowser
from collections.abc import Callable, Iterable, Iterator
from contextlib import contextmanager, suppress
from threading import Thread

import click

from ._analysis import log_argument
from ._options import quiet_option
from ._terminal import echo


@click.command(epilog="Example: idealgas watch gas.h5")
@log_argument
@click.option("--port", type=click.IntRange(0, 65535), default=0, help="Port of the page.  [default: any free port]")
@click.option("--no-browser", is_flag=True, help="Only print the address of the page.")
@click.option("--until-eof", is_flag=True, hidden=True, help="End when the standard input ends, as with `run --watch`.")
@quiet_option
def watch(path: str, port: int, no_browser: bool, until_eof: bool) -> None:
    """Show a log in the browser until Ctrl-C, even while the log is being written.

    The page shows the discs, their speeds with the Maxwell-Boltzmann distribution, and the temperature and pressure
    against time. Only browsers on this machine can open it.
    """
    from idealgas.log import open_log
    from idealgas.report.live import serve

    def ready(address: str) -> None:
        echo(f"{address} shows {path} until Ctrl-C", err=True)
        if not no_browser and has_screen():
            webbrowser.open(address)

    if until_eof:
        Thread(target=_end_at_eof, daemon=True).start()
    with open_log(path) as log, suppress(KeyboardInterrupt):
        serve(log, port, ready)


def _end_at_eof() -> None:
    """End this process when its standard input ends, as it does even if the parent process is killed."""
    sys.stdin.buffer.read()
    os._exit(0)


def has_screen() -> bool:
    """Return whether a browser would open in a window; without a screen, it would take over the terminal."""
    return sys.platform != "linux" or bool(os.environ.get("DISPLAY") or os.environ.get("WAYLAND_DISPLAY"))


@contextmanager
def watching(path: str) -> Iterator[Callable[[], None]]:
    """Yield a function whose first call starts `idealgas watch` for a log; the page stays open until Ctrl-C.

    The page is served by a separate process, so that it does not slow down the run.
    """
    pages: list[subprocess.Popen[str]] = []

    def show() -> None:
        if not pages:
            command = [sys.executable, "-m", "idealgas", "watch", "--until-eof", "--", path]
            pages.append(subprocess.Popen(command, stdin=subprocess.PIPE, stderr=subprocess.PIPE, text=True))
            Thread(target=_repeat, args=(pages[0].stderr,), daemon=True).start()

    try:
        yield show
        show()
        with suppress(KeyboardInterrupt):
            pages[0].wait()
    finally:
        for page in pages:
            page.terminate()
            page.wait()


def _repeat(lines: Iterable[str]) -> None:
    for line in lines:
        echo(line.rstrip("\n"), err=True)  # printed above the progress bar
