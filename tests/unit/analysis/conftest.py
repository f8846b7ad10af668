"""Logs for the tests of analyses."""

import pytest

from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene


@pytest.fixture
def make(request, tmp_path):
    """The log of the module's GAS with overrides."""
    logs = []

    def run(*overrides):
        simulate(parse_scene(request.module.GAS, overrides=overrides), tmp_path / "run.h5", force=True)
        logs.append(open_log(tmp_path / "run.h5"))
        return logs[-1]

    yield run
    for log in logs:
        log.close()
