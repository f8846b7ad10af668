"""Progress bar of a run, shown on a terminal only."""

import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ._terminal import terminal

if TYPE_CHECKING:
    from idealgas.run.simulate import Progress


@contextmanager
def progress_bar() -> Iterator[Callable[["Progress"], None]]:
    """Yield a function that shows the progress of a run: fraction done, simulated time, events per second, time left.

    Notices of the run are printed to stderr, also if it is not a terminal.
    """
    from rich.progress import BarColumn, TaskProgressColumn, TextColumn, TimeRemainingColumn
    from rich.progress import Progress as Bars

    columns = (
        BarColumn(),
        TaskProgressColumn(),
        TextColumn("{task.description}"),
        TimeRemainingColumn(),
    )
    console = terminal(err=True)
    started = time.perf_counter()
    first: list[int] = []  # number of events at the first call, not 0 for a resumed run
    with Bars(*columns, console=console, disable=not console.is_terminal, transient=True) as bar:
        task = bar.add_task("loading machine code, or compiling it once for these effects; remaining", total=1.0)

        def show(progress: "Progress") -> None:
            if not first:
                first.append(progress.events)
            rate = (progress.events - first[0]) / (time.perf_counter() - started)
            doing = f"{rate:,.0f} events/s, simulated time {progress.time:.6g}, remaining"
            if progress.notice:
                bar.console.print(progress.notice, highlight=False, soft_wrap=True)
            bar.update(task, completed=progress.share, description=doing)

        yield show
