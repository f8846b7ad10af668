"""States between events, compared with the engine's own snapshots; and snapshots as H5MD."""

import subprocess
from pathlib import Path

import h5py
import numpy as np
import pyh5md
import pytest
from helpers.log_compare import scene_of
from helpers.needs import program
from helpers.support import logged

import idealgas
from idealgas.log import LogError
from idealgas.log.replay import Checkpoint, Replay
from idealgas.run.simulate import simulate


@pytest.fixture(scope="module", params=["quickstart", "periodic", "atmosphere", "rough", "mixing"])
def path(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("snapshots") / "run.h5"
    events = {"mixing": "run.events=20000", "atmosphere": "run.events=30000"}.get(request.param, "run.events=12000")
    simulate(scene_of(request.param, "log.snapshot_every=0.37", events), path)
    return path


def test_states_are_those_of_the_engine_at_any_time_and_at_events(path):
    with idealgas.open_log(path) as log, h5py.File(path) as file:
        discs = file["particles/discs"]
        times = log.snapshot_times
        assert np.array_equal(times, 0.37 * np.arange(len(times)))
        for step, state in enumerate(log.frames(times)):
            size = max(log.box)
            wrapped = (state.position - discs["position/value"][step]) / size
            assert np.abs(wrapped - wrapped.round() * log.periodic).max() < 1e-13
            assert np.abs(state.velocity - discs["velocity/value"][step]).max() < 1e-12
            if state.image is not None:
                unwrapped = state.position + state.image * log.box
                expected = discs["position/value"][step] + discs["image/value"][step] * log.box
                assert np.abs(unwrapped - expected).max() < 1e-12 * size
            if state.angular_velocity is not None:
                assert np.array_equal(state.angular_velocity, discs["angular_velocity/value"][step])
        times = np.linspace(0, log.end_time, 7)
        for time, frame in zip(times, log.frames(times), strict=True):
            for each, other in zip(frame, log.state_at(time), strict=True):
                assert np.array_equal(each, other) or each is other is None
        first = len(log) // 2
        for block in log.chunks(None, first, first + 20):
            for row in range(20):
                if row == 19 or block.time[row + 1] > block.time[row]:
                    state = log.state_at(block.time[row])
                    assert np.array_equal(state.position[block.disc[row]], block.position[row])
                    assert np.array_equal(state.velocity[block.disc[row]], block.velocity[row])


def test_snapshots_are_h5md(path):
    with idealgas.open_log(path) as log, pyh5md.File(str(path), "r") as file:
        assert tuple(file["h5md"].attrs["version"]) == (1, 1)
        discs = file.particles_group("discs")
        position, velocity = (pyh5md.element(discs, name) for name in ("position", "velocity"))
        for element in (position, velocity):
            assert element.value.shape == (len(log.snapshot_times), len(log.discs), 2)
            assert np.array_equal(element.time[:], log.snapshot_times)
            assert np.array_equal(element.step[:], np.arange(len(log.snapshot_times)))
        assert discs["box"].attrs["dimension"] == 2
        assert [word == b"periodic" for word in discs["box"].attrs["boundary"]] == list(log.periodic)
        assert discs["box/edges"][:].tolist() == list(log.box)
        for name in ("species", "mass", "radius"):
            assert np.array_equal(pyh5md.element(discs, name).value[:], getattr(log.discs, name))
        assert pyh5md.element(discs, "id").value[:].tolist() == list(range(len(log.discs)))
        energy = pyh5md.element(file["observables"], "kinetic_energy")
        assert len(energy.value) == len(energy.time) == len(energy.step)


def test_without_events_there_are_states_at_checkpoints(tmp_path):
    with logged(scene_of("quickstart", "log.events=false", "run.events=200000"), tmp_path / "run.h5") as log:
        last = log.checkpoints[-1]
        assert np.array_equal(log.state_at(last.time).position, last.position)
        with pytest.raises(LogError, match="a log without events has states only at its checkpoints"):
            log.state_at(last.time / 3)


@pytest.mark.needs("h5dump")
@pytest.mark.parametrize("compression", ["gzip", "none"])
def test_h5dump_reads_it(tmp_path: Path, compression):
    h5dump, path = program("h5dump"), tmp_path / "run.h5"
    simulate(
        scene_of("periodic", "run.events=1000", "log.snapshot_every=0.5", f'log.compression="{compression}"'), path
    )
    said = subprocess.run([h5dump, path], capture_output=True, text=True)
    assert (said.returncode, said.stderr) == (0, "")
    times = subprocess.run([h5dump, "-d", "/events/time", "-y", "-m", "%.17g", path], capture_output=True, text=True)
    numbers = times.stdout.partition("DATA {")[2].partition("}")[0].replace(",", " ").split()
    with h5py.File(path) as file:
        assert [float(number) for number in numbers] == file["events/time"][:].tolist()


def test_a_flight_through_too_many_boxes_is_refused():
    discs = {"position": np.full((1, 2), 0.5), "velocity": np.array([[3e9, 0.0]]), "image": np.zeros((1, 2), np.int32)}
    replay = Replay(Checkpoint(0.0, 0, 0, discs, {}), (), (1.0, 1.0), (True, True), None, False)
    assert replay.at(0.1).image[0, 0] == 3e8
    with pytest.raises(ValueError, match=r"flies through 3e\+09 boxes"):
        replay.at(1.0)
