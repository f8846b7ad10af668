"""The bench of the engine: what its table says of the runs."""

import statistics
from types import SimpleNamespace

from idealgas.bench import bench


def test_the_ratio_is_of_runs_that_followed_each_other(monkeypatch):
    pace, order = iter([1.0, 0.5, 0.25, 0.8, 2.0, 2.0]), []

    def simulate(scene, path, force):
        if len(scene.species) != 1 or scene.species[0].count != 50:
            return None
        order.append(scene.log.events)
        return SimpleNamespace(disc_collisions=100, seconds=next(pace), threads=scene.run.threads)

    monkeypatch.setattr(bench, "simulate", simulate)
    off, on = bench.bench([50], [0.1], collisions=1, repeats=3).rows
    assert order == [True, False, False, True, True, False]
    assert (off.log, on.log, off.ratio) == (False, True, None)
    assert on.ratio == statistics.median([0.5, 0.25 / 0.8, 1.0])
    assert (off.collisions_per_s, off.slowest, off.fastest) == (200, 50, 400)
    assert (on.collisions_per_s, on.slowest, on.fastest) == (100, 50, 125)


def test_there_are_rows_for_each_number_of_threads(monkeypatch):
    monkeypatch.setattr(
        bench,
        "simulate",
        lambda scene, path, force: SimpleNamespace(disc_collisions=1, seconds=1.0, threads=min(scene.run.threads, 3)),
    )
    result = bench.bench([50], [0.1], repeats=1, threads=[1, 2, 7])
    assert [(row.threads, row.log) for row in result.rows] == [(k, log) for k in (1, 2, 3) for log in (False, True)]


def test_every_row_is_measured():
    seen = []
    result = bench.bench([10], [0.1, 0.3], collisions=20, repeats=1, on_row=seen.append)
    assert [(row.N, row.phi, row.log) for row in result.rows] == [
        (10, 0.1, False), (10, 0.1, True), (10, 0.3, False), (10, 0.3, True)
    ]  # fmt: skip
    assert result.rows == seen
    assert all(0 < row.slowest <= row.collisions_per_s <= row.fastest for row in seen)
