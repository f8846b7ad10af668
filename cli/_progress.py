"""Progress bar of a run, shown on a terminal only."""

from collections.abc import Callable, Iterator
from contextlib import contextmanager
from typing import TYPE_CHECKING

from ._terminal import terminal

if TYPE_CHECKING:
    from idealgas.run.simulate import Progress


@contextmanager
def progress_bar() -> Iterator[Callable[["Progress"], None]]:
    """Yield the function that shows a run's progress: share done, simulated time, events per second, remaining time.

    Notices of the run are printed to stderr, be it a terminal or not.
    """
    import time

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
