"""Runs of scenes."""

import pytest
from helpers.support import ROOT

from idealgas.log import open_log
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene


@pytest.fixture
def run(tmp_path):
    """Run a scene, or a shipped one by its name, with overrides; its log, open until the test ends or the next run."""
    logs = []

    def make(scene, *overrides):
        for log in logs:
            log.close()
        if isinstance(scene, str):
            scene = load_scene(ROOT / "configs" / f"{scene}.toml", overrides)
        simulate(scene, tmp_path / "run.h5", force=True)
        logs.append(open_log(tmp_path / "run.h5"))
        return logs[-1]

    yield make
    for log in logs:
        log.close()
