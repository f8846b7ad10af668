"""Measure the speed of the engine on this machine, with and without the event log."""

import math
import statistics
import tempfile
import time
from collections.abc import Callable, Iterable
from dataclasses import dataclass
from itertools import product
from pathlib import Path
from typing import NamedTuple

from idealgas.run.simulate import simulate
from idealgas.scene import Box, Header, LogTable, Run, Scene, Species

RADIUS = 0.5


class SpeedRow(NamedTuple):
    """Speed of the engine for one number of discs, packing fraction and number of threads.

    Attributes:
        N: number of discs.
        phi: packing fraction.
        threads: number of threads used.
        log: whether events were logged.
        collisions_per_s: pair collisions per second, median over the repeats.
        slowest: smallest number of pair collisions per second.
        fastest: largest number of pair collisions per second.
        ratio: speed with the log relative to the speed without it, median over pairs of consecutive runs; None for runs
            without the log.
    """

    N: int
    phi: float
    threads: int
    log: bool
    collisions_per_s: float
    slowest: float
    fastest: float
    ratio: float | None


@dataclass(frozen=True)
class Bench:
    """Results of the benchmark.

    Attributes:
        compile_seconds: time for compiling or loading the machine code, s.
        rows: one row for each kind of run.
    """

    compile_seconds: float
    rows: list[SpeedRow]


def bench_scene(n: int, phi: float, collisions: int, log: bool, threads: int = 1) -> Scene:
    """Return a scene of n equal discs on a lattice at temperature 1 in a square box."""
    side = math.sqrt(n * math.pi * RADIUS**2 / phi)
    return Scene(
        scene=Header(title=f"bench, N = {n}, packing fraction {phi:g}"),
        box=Box(size=(side, side)),
        species=(Species(name="gas", count=n, radius=RADIUS, temperature=1.0, placement="lattice"),),
        run=Run(collisions_per_disc=2.0 * collisions / n, threads=threads),
        log=LogTable(events=log),
    )


def bench(
    numbers: Iterable[int],
    fractions: Iterable[float],
    collisions: int = 1_000_000,
    repeats: int = 3,
    on_row: Callable[[SpeedRow], None] = lambda row: None,
    threads: Iterable[int] = (1,),
) -> Bench:
    """Measure the speed of runs, alternating between runs without and with the log.

    Args:
        numbers: numbers of discs.
        fractions: packing fractions.
        collisions: smallest number of pair collisions in a run; it is increased to at least two per disc.
        repeats: number of runs of each kind.
        on_row: function that is called with each row of the result.
        threads: numbers of threads.
    """
    with tempfile.TemporaryDirectory(prefix="idealgas-bench-") as folder:
        path = Path(folder) / "bench.h5"
        started, threads = time.perf_counter(), list(threads)
        for log, number in product((False, True), threads):
            simulate(bench_scene(1_000, 0.5, 10, log, number), path, force=True)
        compile_seconds = time.perf_counter() - started
        rows = []
        for n, phi, number in product(numbers, fractions, threads):
            rates: dict[bool, list[float]] = {False: [], True: []}
            for repeat in range(repeats):
                for log in (False, True) if repeat % 2 else (True, False):
                    summary = simulate(bench_scene(n, phi, max(collisions, 2 * n), log, number), path, force=True)
                    rates[log].append(summary.disc_collisions / summary.seconds)
            pairs = statistics.median(on / off for off, on in zip(*rates.values(), strict=True))
            for log, measured in rates.items():
                ratio, median = pairs if log else None, statistics.median(measured)
                rows.append(SpeedRow(n, phi, summary.threads, log, median, min(measured), max(measured), ratio))
                on_row(rows[-1])
    return Bench(compile_seconds, rows)
