"""Functions shared by commands that simulate: Ctrl-C, progress bar and summary."""

import json
import os
import shlex
import sys
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from typing import TYPE_CHECKING

from idealgas.errors import OutputError

from ._progress import progress_bar
from ._tables import facts, print_tables
from ._terminal import data, echo

if TYPE_CHECKING:
    from idealgas.log.summary import Summary
    from idealgas.run.logged_run import Progress

    from .events import EventStream


def run_with_progress(
    simulate: "Callable[..., Summary]",
    path: str,
    as_json: bool,
    from_start: bool = True,
    on_start: Callable[[], None] = lambda: None,
    stream: "EventStream | None" = None,
    shows: Sequence[str] = (),
) -> None:
    """Call `simulate` with a progress bar, stop it on Ctrl-C or SIGTERM, and print the summary of its log.

    Args:
        simulate: function that runs a scene.
        path: path of the log.
        as_json: whether to print JSON.
        from_start: whether this run writes all events in the log; False for a resumed run.
        on_start: function to call once the log contains its first events.
        stream: stream that prints the events instead of the summary; the run ends if the stream fails.
        shows: names of the main analyses of the scene; their commands are suggested at the end.
    """
    from ._interrupt import stop_signals

    with stop_signals(raises=False) as interrupted:
        with progress_bar("loading machine code, or compiling it once for these effects") as show:
            command = shlex.join(["idealgas", *sys.argv[1:]])
            started = time.perf_counter()
            first: list[int] = []  # number of events at the first call, which is not 0 for a resumed run

            def on_progress(progress: "Progress") -> None:
                if not first:
                    first.append(progress.events)
                    on_start()
                rate = (progress.events - first[0]) / (time.perf_counter() - started)
                description = f"{rate:,.0f} events/s, simulated time {progress.time:.6g}"
                show(progress.share, description=description, notice=progress.notice)

            def stopped() -> bool:
                return bool(interrupted()) or (stream is not None and stream.failure is not None)

            summary = simulate(command=command, on_progress=on_progress, interrupted=stopped)
        if stream is not None:
            pass
        elif as_json:
            data(json.dumps(summary.as_dict(), indent=2))
        else:
            _print(summary, path, from_start, shows)
        failure = stream and stream.failure
        hint = "" if summary.completed else f"; `idealgas resume {shlex.quote(path)}` continues it"
        if isinstance(failure, OutputError):
            raise OutputError(f"{failure}{hint}", failure.exit_code)
        if stopped() and hint:
            echo(f"interrupted{hint}", err=True)
        if interrupted():
            raise SystemExit(interrupted())
        if failure:
            raise failure


def _print(summary: "Summary", output: str, from_start: bool, shows: Sequence[str]) -> None:
    from rich.filesize import decimal

    rows = {
        "events": f"{summary.events:,}",
        "  disc collisions": f"{summary.disc_collisions:,}",
        "  wall hits": f"{summary.wall_hits:,}",
    }
    if summary.thermostat_collisions:
        rows["  thermostat collisions"] = f"{summary.thermostat_collisions:,}"
    if summary.escaped:
        rows["  discs that left"] = f"{summary.escaped:,}"
    if summary.steered:
        rows["  discs steered"] = f"{summary.steered:,}"
    if summary.trials:
        rows |= {"trials": f"{summary.trials:,}", "  accepted": f"{summary.disc_collisions / summary.trials:.4f}"}
    rows["simulated time"] = f"{summary.end_time:.6g}"
    rows["energy drift"] = f"{summary.energy_drift:.1e}"
    rows["deepest overlap"] = f"{summary.deepest_overlap:.1e} of the sum of the radii"
    rows["wall time"] = f"{summary.seconds:.2f} s"
    if summary.compile_seconds > 1:
        rows["compiling or loading machine code"] = f"{summary.compile_seconds:.1f} s"
    if from_start:
        rows["events per second"] = f"{summary.events / summary.seconds:,.0f}"
    with suppress(FileNotFoundError):  # the file was moved during the run
        rows["file size"] = decimal(os.path.getsize(output))
    print_tables([facts(output if summary.completed else f"{output} (interrupted)", rows)])
    if shows:
        echo("suggested analyses: " + ", ".join(f"`idealgas {name} {shlex.quote(output)}`" for name in shows))
