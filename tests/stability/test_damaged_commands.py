"""The commands on logs with changed, zeroed or missing bytes: right numbers or one clear line."""

import json

import numpy as np
import pytest
from click.testing import CliRunner
from idealgas_cli.main import main
from log_compare import scene_of

from idealgas.run.simulate import simulate

CASES = 100


def measured(path) -> tuple[int, str, str]:
    result = CliRunner().invoke(main, ["pressure", str(path), "--from", "0", "--json"])
    if result.exception is not None:
        assert isinstance(result.exception, SystemExit), result.exception
    return result.exit_code, result.stdout, result.stderr


@pytest.mark.parametrize("compression", ["gzip", "none"])
def test_pressure_of_damaged_logs(compression, tmp_path):
    path = tmp_path / "run.h5"
    simulate(scene_of("quickstart", "run.events=40000", f'log.compression="{compression}"'), path)
    code, expected, _ = measured(path)
    assert (code, json.loads(expected)["number"]) == (0, 1000)
    data = path.read_bytes()
    random = np.random.default_rng(17)
    found = 0
    for case in range(CASES):
        damaged = bytearray(data)
        place = int(random.integers(len(data) if case % 2 else 30_000))
        if case % 4 == 3:
            del damaged[place:]
        elif case % 4 == 2:
            damaged[place : place + 700] = bytes(len(damaged[place : place + 700]))
        else:
            damaged[place] ^= int(random.integers(1, 256))
        path.write_bytes(damaged)
        code, printed, said = measured(path)
        if code == 0:
            assert printed == expected
        else:
            found += 1
            assert (code, printed) == (2, "")
            assert said.startswith(f"{path}: ")
            assert said.count("\n") == 1
    assert found >= CASES // 2
