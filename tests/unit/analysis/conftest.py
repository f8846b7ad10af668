"""Logs for the tests of analyses."""

import zlib

import pytest
from helpers.small_gases import GAS, LANES

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


@pytest.fixture(scope="module")
def made(tmp_path_factory):
    """Logs of `small_gases.GAS` with overrides, each made once. Unless given, the seed follows from the overrides."""
    folder, logs = tmp_path_factory.mktemp("caveats"), {}

    def run(*overrides):
        if overrides not in logs:
            path = folder / f"{len(logs)}.h5"
            seed = zlib.crc32("\n".join(overrides).encode())
            simulate(parse_scene(GAS, overrides=(f"scene.seed={seed}", *overrides)), path)
            logs[overrides] = open_log(path)
        return logs[overrides]

    yield run
    for log in logs.values():
        log.close()


@pytest.fixture
def lanes(uncompiled, tmp_path):
    """The log of two discs that meet nothing but walls."""
    simulate(parse_scene(LANES), tmp_path / "lanes.h5")
    with open_log(tmp_path / "lanes.h5") as log:
        yield log
