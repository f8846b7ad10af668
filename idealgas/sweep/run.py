"""Run of a sweep: one task for each point on dask.distributed, on this machine or on a cluster.

A point is done when its result file exists. If a process is killed, at most the points that were running are lost, and
the next start continues from the files. The files of a point do not depend on the worker that ran it.
"""

import asyncio
import logging
import os
import time
from collections.abc import Callable, Iterator
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from idealgas.errors import OutputError, UserError, install
from idealgas.sweep.cost import estimate_cost, total_seconds
from idealgas.sweep.folder import check_folder, hold_folder, resume_numbering
from idealgas.sweep.plan import Sweep
from idealgas.sweep.point import result_path, run_point
from idealgas.sweep.results import write_tables

if TYPE_CHECKING:
    from distributed import Client

RETRIES = 2
"""Number of further attempts for a point that failed, or whose worker died."""

IGNORE_SIGINT = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
"""First command of a local worker: ignore Ctrl-C, which the main process handles."""

LOCAL = {
    "distributed.scheduler.allowed-failures": RETRIES,
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,
}
"""Settings of the local cluster: no profiling, and workers reuse their memory."""

CONTINUE = "; run the same command again to continue"

TIMEOUT = 10.0  # seconds in which a scheduler must answer


@dataclass(frozen=True)
class Progress:
    """Progress of a sweep: numbers of finished points, of points that failed for good, and of all points."""

    done: int
    failed: int
    total: int


@dataclass(frozen=True)
class Outcome:
    """Outcome of a sweep.

    ran: number of points run now. before: number of points that were done before. failures: reasons by point index.
    seconds: time taken. estimated: estimated time, seconds; None where the machines are unknown or a point cannot be
    estimated. files: paths of the tables of all results; none if no point is done.
    """

    ran: int
    before: int
    failures: dict[int, str]
    seconds: float = 0.0
    estimated: float | None = None
    files: tuple[str, ...] = ()


def run_sweep(
    sweep: Sweep,
    folder: str | os.PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    on_progress: Callable[[Progress], None] = lambda progress: None,
) -> Outcome:
    """Run the points of a sweep that are not done yet, and write the tables of all results.

    Args:
        sweep: the sweep to run.
        folder: folder of logs and results; created, or resumed even if axes have new values.
        workers: number of processes on this machine; None for one per core.
        scheduler: address of a dask scheduler, instead of local workers; its workers see the folder at the same path.
        on_progress: called when a point has finished or failed.

    Raises:
        UserError: if the sweep cannot be run, or cannot continue for a reason that concerns all points.
    """
    if find_spec("distributed") is None:
        raise UserError(f"a sweep requires dask.distributed: {install('sweep')}")
    given, folder = folder, Path(folder).absolute()
    with hold_folder(folder):
        sweep = resume_numbering(sweep, folder)
        open_points = [point for point in sweep.points if not result_path(folder, point.index).exists()]
        before = len(sweep.points) - len(open_points)
        remaining = replace(sweep, points=tuple(open_points))
        failures: dict[int, str] = {}
        workers = min(workers or os.cpu_count() or 1, max(len(open_points), 1))
        estimated = None if scheduler or not open_points else _estimate(remaining, workers)
        started = time.monotonic()
        on_progress(Progress(before, 0, len(sweep.points)))
        if open_points:
            with _client(workers, scheduler) as client:
                for k, (index, failure) in enumerate(_run(client, remaining, folder)):
                    if failure is not None:
                        check_folder(folder)
                        failures[index] = failure
                    on_progress(Progress(before + k + 1 - len(failures), len(failures), len(sweep.points)))
        seconds = time.monotonic() - started
        done = len(sweep.points) - len(failures)
        tables = tuple(map(str, write_tables(given))) if done else ()
    return Outcome(done - before, before, dict(sorted(failures.items())), seconds, estimated, tables)


def _estimate(sweep: Sweep, workers: int) -> float | None:
    """Estimated time of a sweep on a number of workers, seconds; None if one of its points cannot be run."""
    with suppress(UserError):
        return total_seconds(estimate_cost(sweep), workers)
    return None


def _run(client: "Client", sweep: Sweep, folder: Path) -> Iterator[tuple[int, str | None]]:
    """Yield the index of each point when it ends, with the reason of its failure or None."""
    from distributed import as_completed

    run = partial(run_point, folder=folder, analyses=sweep.analyses, keep_log=sweep.keep_logs)
    keys = [f"point-{point.index}" for point in sweep.points]
    futures = client.map(run, sweep.points, pure=False, retries=RETRIES, key=keys)
    index = {future.key: point.index for future, point in zip(futures, sweep.points, strict=True)}
    try:
        for future in as_completed(futures, loop=client.loop):
            if future.status == "cancelled":
                raise CancelledError
            error = None if future.status == "finished" else future.exception()
            if isinstance(error, OutputError) and error.exit_code == 1:
                raise OutputError(f"{error}{CONTINUE}", exit_code=1)
            yield index[future.key], error and _reason(error)
    except (CancelledError, asyncio.CancelledError):
        raise UserError(f"lost the connection to the scheduler{CONTINUE}") from None


def _reason(error: Any) -> str:
    """Reason why a point failed, in one line."""
    from distributed.scheduler import KilledWorker

    if isinstance(error, KilledWorker):
        return f"its worker died {RETRIES + 1} times"
    lines = str(error).strip().splitlines() or [""]
    return lines[0] if isinstance(error, UserError) else f"{type(error).__name__}: {lines[0]}"


@contextmanager
def _client(workers: int, scheduler: str | None) -> Iterator["Client"]:
    """Yield a client of the scheduler at an address, or of a local cluster with `workers` processes."""
    import dask
    from distributed import Client, LocalCluster
    from distributed.comm import parse_address, parse_host_port
    from distributed.utils import silence_logging_cmgr

    if scheduler is not None:
        try:
            parse_host_port(parse_address(scheduler)[1])  # a client of an invalid address cannot be closed cleanly
            client = Client(scheduler, timeout=TIMEOUT, set_as_default=False)
        except ValueError as error:
            raise UserError(f"{scheduler}: not the address of a scheduler ({error})") from None
        except OSError:
            raise UserError(f"{scheduler}: no answer from a scheduler within {TIMEOUT:g} s") from None
        with silence_logging_cmgr(logging.CRITICAL), client:
            yield client
        return
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(LOCAL))
        try:
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=":0",  # no fixed port for the HTTP server, which runs also without a dashboard
                scheduler_kwargs={"dashboard": False},
                memory_limit=0,
                silence_logs=logging.CRITICAL,
                preload=IGNORE_SIGINT,
            )
            client = stack.enter_context(Client(stack.enter_context(cluster), set_as_default=False))
        except (OSError, RuntimeError) as error:
            raise OutputError(f"no worker can be started on this machine: {error}", exit_code=1) from error
        yield client
