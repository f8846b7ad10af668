"""Run a sweep with one dask.distributed task per point, on this machine or on a cluster.

A point is done when its result file exists. If a process is killed, only the points that were running are lost; when
the sweep is started again, it continues from the files. The files of a point do not depend on the worker that ran it.
"""

import asyncio
import logging
import os
import time
from collections.abc import Callable, Iterable, Iterator, Sequence
from concurrent.futures import CancelledError
from contextlib import ExitStack, contextmanager, suppress
from dataclasses import dataclass, replace
from functools import partial
from hashlib import sha256
from importlib.util import find_spec
from pathlib import Path
from typing import TYPE_CHECKING, Any

from idealgas.errors import OutputError, UserError, install
from idealgas.scene import Scene
from idealgas.sweep.cost import Trial, estimate_cost, total_seconds
from idealgas.sweep.folder import check_folder, hold_folder, resume_numbering
from idealgas.sweep.plan import Point, Sweep
from idealgas.sweep.point import result_path, run_point
from idealgas.sweep.results import write_tables
from idealgas.toml.dump import dump_document

if TYPE_CHECKING:
    from distributed import Client

RETRIES = 2
"""Number of additional attempts for a point that failed or whose worker died."""

IGNORE_SIGINT = "import signal; signal.signal(signal.SIGINT, signal.SIG_IGN)"
"""First statement of a local worker: ignore Ctrl-C, which is handled by the main process."""

LOCAL = {
    "distributed.scheduler.allowed-failures": RETRIES,
    "distributed.worker.profile.enabled": False,
    "distributed.admin.tick.interval": "1s",
    "distributed.nanny.pre-spawn-environ.MALLOC_TRIM_THRESHOLD_": None,
}
"""Settings of the local cluster: no profiling, and memory is reused by the workers."""

CONTINUE = "; run the same command again to continue"

TIMEOUT = 10.0  # time limit for a reply from a scheduler, s


@dataclass(frozen=True)
class SweepProgress:
    """Progress of a sweep: number of finished points, number of points that failed permanently, and total number."""

    done: int
    failed: int
    total: int


@dataclass(frozen=True)
class Outcome:
    """Outcome of a sweep.

    Attributes:
        ran: number of points that were run this time.
        before: number of points that were already done.
        failures: reason for each failure, by the index of the point.
        seconds: time taken, s.
        estimated: estimated time, s; None if the machines are unknown or the cost of a point could not be estimated.
        files: paths of the tables of all results; empty if no point is done.
        notices: sentences for the user.
    """

    ran: int
    before: int
    failures: dict[int, str]
    seconds: float = 0.0
    estimated: float | None = None
    files: tuple[str, ...] = ()
    notices: tuple[str, ...] = ()


def require_dask() -> None:
    """Raise UserError if dask.distributed, with which the points are run, is not installed."""
    if find_spec("distributed") is None:
        raise UserError(f"a sweep requires dask.distributed: {install('sweep')}")


def run_sweep(
    sweep: Sweep,
    folder: str | os.PathLike[str],
    *,
    workers: int | None = None,
    scheduler: str | None = None,
    on_progress: Callable[[SweepProgress], None] = lambda progress: None,
    on_estimate: Callable[[int, int], None] = lambda done, total: None,
) -> Outcome:
    """Run the points of a sweep that are not done yet, and write the tables of all results.

    Args:
        sweep: the sweep to run.
        folder: folder for logs and results; it is created if missing. An existing sweep is resumed, even if its axes
            have new values.
        workers: number of processes on this machine; None for one per core.
        scheduler: address of a dask scheduler to be used in place of local workers; its workers must see the folder at
            the same path.
        on_progress: function that is called when a point has finished or failed.
        on_estimate: function that is called before the points are run, with the number of finished steps of the cost
            estimate and the total number of steps.

    Raises:
        UserError: if the sweep cannot be run, or cannot continue for a reason that concerns all points.
    """
    require_dask()
    given, folder = folder, Path(folder).absolute()
    with hold_folder(folder):
        sweep = resume_numbering(sweep, folder)
        open_points = [point for point in sweep.points if not result_path(folder, point.index).exists()]
        before = len(sweep.points) - len(open_points)
        remaining = replace(sweep, points=tuple(open_points))
        failures: dict[int, str] = {}
        workers = min(workers or os.cpu_count() or 1, max(len(open_points), 1))
        estimated, started = None, time.monotonic()
        on_progress(SweepProgress(before, 0, len(sweep.points)))
        if open_points:
            with _client(workers, scheduler) as client:
                if not scheduler:
                    estimated = _estimate(client, remaining, folder, workers, on_estimate)
                    on_progress(SweepProgress(before, 0, len(sweep.points)))  # the estimate is complete
                for k, (index, failure) in enumerate(_run(client, remaining, folder)):
                    if failure is not None:
                        check_folder(folder)
                        failures[index] = failure
                    on_progress(SweepProgress(before + k + 1 - len(failures), len(failures), len(sweep.points)))
        failures |= _lost(folder, (point.index for point in open_points if point.index not in failures))
        seconds = time.monotonic() - started
        done = len(sweep.points) - len(failures)
        tables, notices = write_tables(given) if done else ([], [])
    files = tuple(map(str, tables))
    return Outcome(done - before, before, dict(sorted(failures.items())), seconds, estimated, files, tuple(notices))


def _estimate(
    client: "Client", sweep: Sweep, folder: Path, workers: int, on_estimate: Callable[[int, int], None]
) -> float | None:
    """Return the estimated time that a sweep takes on a number of workers, s; None if a point cannot be run."""
    from distributed.scheduler import KilledWorker

    def execute(run: Callable[[Scene], Trial], scenes: Sequence[Scene]) -> Iterator[Trial]:
        for future in client.map(run, scenes, pure=False):
            yield future.result()

    with suppress(UserError, KilledWorker, CancelledError):
        return total_seconds(estimate_cost(sweep, on_estimate, folder=folder, execute=execute), workers)
    return None


def _lost(folder: Path, points: Iterable[int]) -> dict[int, str]:
    """Return a reason for each point that ended without an error but has no result file in the folder."""
    lost, deadline = [*points], time.monotonic() + TIMEOUT  # a network file system may show new files with a delay
    while lost := [index for index in lost if not result_path(folder, index).exists()]:
        check_folder(folder)
        if time.monotonic() > deadline:
            break
        time.sleep(0.1)
    reason = f"its worker left no result in {folder} (workers must see this folder at the same path)"
    return dict.fromkeys(lost, reason)


def _run(client: "Client", sweep: Sweep, folder: Path) -> Iterator[tuple[int, str | None]]:
    """Yield the index of each point when it ends, with the reason if it failed, or None if it succeeded."""
    from distributed import as_completed

    run = partial(run_point, folder=folder, analyses=sweep.analyses, keep_log=sweep.keep_logs)
    keys = [_key(point, sweep, folder) for point in sweep.points]
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


def _key(point: Point, sweep: Sweep, folder: Path) -> str:
    """Return the key of a point's task: a digest of everything that determines what the task does.

    Two sweeps that run on a scheduler at the same time therefore have no task in common, even if they are the same
    sweep in two folders. A sweep that is started again takes over its tasks that are still running, because a file must
    not have two writers.
    """
    what = str(folder), point.index, point.scene.scene.seed, dump_document(point.scene), sweep.analyses, sweep.keep_logs
    return f"point-{point.index}-{sha256(repr(what).encode()).hexdigest()[:32]}"


def _reason(error: Any) -> str:
    """Return the reason why a point failed, on one line."""
    from distributed.scheduler import KilledWorker

    if isinstance(error, KilledWorker):
        return f"its worker died {error.allowed_failures + 1} times"
    lines = str(error).strip().splitlines() or [""]
    return lines[0] if isinstance(error, UserError) else f"{type(error).__name__}: {lines[0]}"


@contextmanager
def _client(workers: int, scheduler: str | None) -> Iterator["Client"]:
    """Yield a client of the scheduler at the given address, or of a local cluster with `workers` processes."""
    import dask
    from distributed import Client, LocalCluster
    from distributed.utils import silence_logging_cmgr

    if scheduler is not None:
        with silence_logging_cmgr(logging.CRITICAL):
            asyncio.run(_check_scheduler(scheduler))  # a client without a scheduler could not be closed cleanly
            with Client(scheduler, timeout=TIMEOUT, set_as_default=False) as client:
                yield client
        return
    with ExitStack() as stack:
        stack.enter_context(dask.config.set(LOCAL))
        try:
            cluster = LocalCluster(
                n_workers=workers,
                threads_per_worker=1,
                dashboard_address=":0",  # any free port for the HTTP server, which runs even without a dashboard
                scheduler_kwargs={"dashboard": False},
                memory_limit=0,
                silence_logs=logging.CRITICAL,
                preload=IGNORE_SIGINT,
            )
            client = stack.enter_context(Client(stack.enter_context(cluster), set_as_default=False))
        except (OSError, RuntimeError) as error:
            reason = str(error).rstrip(".")
            raise OutputError(f"no worker starts on this machine ({reason}){CONTINUE}", exit_code=1) from error
        yield client


async def _check_scheduler(address: str) -> None:
    """Raise UserError if there is no scheduler at an address, or if this process cannot communicate with it."""
    from distributed import rpc
    from distributed.security import Security

    try:
        arguments = Security().get_connection_args("client")
    except OSError as error:
        raise UserError(f"{address}: the certificates of dask's configuration cannot be read ({error})") from None
    try:
        async with rpc(address, timeout=TIMEOUT, connection_args=arguments) as remote:
            identity = await asyncio.wait_for(remote.identity(), TIMEOUT)
    except (ValueError, TypeError) as error:
        reason = str(error)
        if "ssl_context" in reason:
            reason = "TLS needs certificates, distributed.comm.tls in dask's configuration"
        raise UserError(f"{address}: not the address of a scheduler ({reason})") from None
    except OSError:
        raise UserError(f"{address}: no scheduler answered within {TIMEOUT:g} s") from None
    if identity.get("type") != "Scheduler":
        raise UserError(f"{address}: the address of a dask {identity.get('type')}, not of a scheduler")
