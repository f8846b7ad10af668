"""Progress bar of a command, shown only on a terminal."""

from collections.abc import Iterator
from contextlib import contextmanager
from typing import Protocol

from ._terminal import terminal


class Show(Protocol):
    """Function that shows the progress."""

    def __call__(self, done: float, total: float = 1.0, description: str | None = None, notice: str = "") -> None:
        """Update the bar. A description replaces the previous one; a notice is printed above the bar."""


@contextmanager
def progress_bar(description: str) -> Iterator[Show]:
    """Yield a function that shows the completed fraction, a description and the remaining time.

    Notices are printed to stderr even if it is not a terminal.
    """
    from rich.progress import BarColumn, Progress, TaskProgressColumn, TextColumn, TimeRemainingColumn

    columns = BarColumn(), TaskProgressColumn(), TextColumn("{task.description}, remaining"), TimeRemainingColumn()
    console = terminal(err=True)
    with Progress(
        *columns, console=console, disable=not console.is_terminal, transient=True, redirect_stdout=False
    ) as bar:
        task = bar.add_task(description, total=None)

        def show(done: float, total: float = 1.0, description: str | None = None, notice: str = "") -> None:
            if notice:
                console.print(notice, highlight=False, soft_wrap=True)
            bar.update(task, completed=done, total=total, description=description)

        yield show
