"""Logs with changed, zeroed or missing bytes: a clear error or the same data, never anything else.

A log of a killed writer may also have fewer rows: damage can hide its last commit, and the previous one is then read.
"""

import os
from contextlib import suppress
from pathlib import Path

import numpy as np
import pytest
from helpers.log_samples import check, start_writer, write_log

from idealgas.log import LogError, open_log, recover

ROWS = 70_000


@pytest.fixture(scope="module", params=["gzip closed", "none closed", "gzip dead", "none dead"])
def whole(request, tmp_path_factory):
    compression, state = request.param.split()
    path = tmp_path_factory.mktemp("log") / "run.h5"
    if state == "closed":
        write_log(path, ROWS, compression=compression)
    else:
        child = start_writer(path, compression, "20000", rows=ROWS)
        child.kill()
        child.wait()
    with open_log(path) as log:
        return path.read_bytes(), len(log), state == "dead"


def read(path: Path) -> int:
    with open_log(path) as log:
        rows = check(log)
        log.state_at(log.end_time / 2)
        assert log.summary == ({"end_time": rows * 2.0**-10, "rows": rows} if log.complete else {})
        return rows


def damages(data: bytes, cases: int):
    """Bytes changed anywhere, or near the start, where most of the structure is; blocks lost; the file cut off."""
    random = np.random.default_rng(11)
    for case in range(cases):
        damaged = bytearray(data)
        place = int(random.integers(len(data) if case % 2 else min(len(data), 20_000)))
        if case % 5 == 4:
            del damaged[place:]
        elif case % 5 == 3:
            damaged[place : place + 512] = bytes(len(damaged[place : place + 512]))
        else:
            damaged[place] ^= int(random.integers(1, 256))
        yield bytes(damaged)


def assert_found_or_harmless(path: Path, rows: int, dead: bool) -> bool:
    """Whether the damage was found."""
    try:
        got = read(path)
    except LogError as error:
        message = str(error)
    else:
        assert got == rows or (dead and got < rows)
        return False
    assert message.startswith(f"{path}: ")
    assert "\n" not in message
    return True


@pytest.mark.slow
def test_damage_anywhere(whole, tmp_path):
    data, rows, dead = whole
    path = tmp_path / "run.h5"
    actual = 0
    for damaged in damages(data, 60):
        path.write_bytes(damaged)
        actual += assert_found_or_harmless(path, rows, dead)
        if dead:
            try:
                recover(path)
            except LogError:
                continue
            assert_found_or_harmless(path, rows, dead)
    assert actual >= 30


def test_cut_anywhere_near_its_ends(whole, tmp_path):
    data, rows, dead = whole
    path = tmp_path / "run.h5"
    for size in [
        *range(0, 200, 7),
        *range(200, 20_000, 997),
        *range(len(data) - 20_000, len(data), 997),
        len(data) - 1,
    ]:
        path.write_bytes(data[:size])
        result = assert_found_or_harmless(path, rows, dead)
        assert result or (dead and size > 20_000)  # what was written last may not have been committed


def test_nothing_is_left_open(whole, tmp_path):
    data, _, _ = whole
    path = tmp_path / "run.h5"
    for place in (20, 500, 5000, len(data) // 2):
        path.write_bytes(data[:place])
        with pytest.raises(LogError):
            open_log(path)
    for descriptor in os.listdir("/dev/fd"):
        with suppress(OSError):  # that of the listing is closed by now
            assert not os.path.samestat(os.fstat(int(descriptor)), path.stat())
