"""Parts of a log as DataFrames: every number is the one in the log."""

import re
import sys

import numpy as np
import pandas
import pytest
from helpers.log_compare import scene_of
from helpers.log_samples import write_log
from helpers.support import logged

from idealgas.columns import Kind
from idealgas.log import LogError, open_log
from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

COMMON = ["time", "disc", "partner", "kind", "x", "y", "vx", "vy"]
FURTHER = {"mixture": [], "rough": ["angular_velocity"], "periodic": ["image_x", "image_y"]}


@pytest.fixture(scope="module", params=FURTHER)
def log(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("pandas") / "run.h5"
    with logged(scene_of(request.param, "run.events=4000"), path) as log:
        log.further = FURTHER[request.param]
        yield log


def check_rows(frame, stored):
    """stored: an EventBatch."""
    for name in ("time", "disc", "partner"):
        assert frame[name].dtype == getattr(stored, name).dtype
        assert np.array_equal(frame[name], getattr(stored, name))
    assert frame["kind"].tolist() == [Kind(kind).name.lower() for kind in stored.kind]
    for axis, letter in enumerate("xy"):
        assert np.array_equal(frame[letter], stored.position[:, axis])
        assert np.array_equal(frame[f"v{letter}"], stored.velocity[:, axis])
        if stored.image is not None:
            assert np.array_equal(frame[f"image_{letter}"], stored.image[:, axis])
    if stored.angular_velocity is not None:
        assert np.array_equal(frame["angular_velocity"], stored.angular_velocity)


def test_events(log):
    (stored,) = log.chunks()
    frame = log.to_pandas()
    assert list(frame.columns) == COMMON + log.further
    kinds = ["disc", "wall", "wall_end", "piston", "thermostat", "steered", "escaped", "fixed_disc"]
    assert list(frame["kind"].cat.categories) == kinds
    check_rows(frame, stored)


def test_events_of_a_disc_and_a_window(log):
    t0, t1 = log.end_time / 3, log.end_time / 2
    (stored,) = log.events(disc=7, t0=t0, t1=t1)
    frame = log.to_pandas("events", disc=7, t0=t0, t1=t1)
    assert len(frame)
    assert set(frame["disc"]) == {7}
    check_rows(frame, stored)
    assert list(log.to_pandas("events", disc=10**6).columns) == COMMON + log.further


def test_events_of_many_blocks(tmp_path):
    with open_log(write_log(tmp_path / "run.h5", 70_000)) as log:
        frame = log.to_pandas()
        assert np.array_equal(frame["time"], np.concatenate([block.time for block in log.chunks()]))
        frame.loc[0, "time"] = 5.0  # is the user's own
        assert next(log.chunks()).time[0] == 0.0


def test_discs(log):
    times = [0.0, log.end_time / 2, log.end_time]
    number = len(log.discs)
    frame, start = log.to_pandas("discs", times=times), log.to_pandas("discs")
    assert np.array_equal(frame["time"], np.repeat(times, number))
    assert np.array_equal(start["x"], log.discs.position[:, 0])
    assert list(start.columns) == list(frame.columns)
    for k, state in enumerate(log.frames(times)):
        part = frame[k * number : (k + 1) * number]
        assert np.array_equal(part["disc"], np.arange(number))
        assert part["species"].tolist() == [log.discs.species_names[s] for s in log.discs.species]
        assert np.array_equal(part["radius"], log.discs.radius)
        assert np.array_equal(part["mass"], log.discs.mass)
        assert np.array_equal(part[["x", "y"]], state.position)
        assert np.array_equal(part[["vx", "vy"]], state.velocity)
    result = log.to_pandas("discs", disc=3, times=times)
    assert np.array_equal(result["vx"], frame[frame["disc"] == 3]["vx"])
    assert len(result) == len(times)


def test_observables(log):
    frame = log.to_pandas("observables")
    for name, (time, values) in log.observables.items():
        assert np.array_equal(frame["time"], time)
        columns = [name] if values.ndim == 1 else ["momentum_x", "momentum_y"]
        assert np.array_equal(frame[columns].to_numpy().reshape(values.shape), values)
    late = log.to_pandas("observables", t0=log.end_time)
    assert late["time"].tolist() == [time for time in frame["time"] if time >= log.end_time]


def test_what_walls_gave_has_their_names(tmp_path):
    with logged(scene_of("heat-bath", "run.events=2000"), tmp_path / "run.h5") as log:
        frame = log.to_pandas("observables")
        _, given = log.observables["wall_energy"]
        for k, wall in enumerate(log.walls):
            assert np.array_equal(frame[f"wall_energy_{wall.name}"], given[:, k])


SMALL = """
box.size = [5, 5]
species = [{{ name = "gas", count = 20, radius = 0.1, temperature = 1.0 }}]
run = {{ {run} }}
log.events = {events}
"""


@pytest.mark.usefixtures("uncompiled")
def test_logs_without_positions_events_or_anything(tmp_path):
    text = SMALL.format(run='method = "monte_carlo", trials = 500', events="true")
    simulate(parse_scene(text), tmp_path / "run.h5", force=True)
    with open_log(tmp_path / "run.h5") as log:
        assert list(log.to_pandas().columns) == ["time", "disc", "partner", "kind", "vx", "vy", "trial"]
        assert list(log.to_pandas("discs").columns) == ["time", "disc", "species", "radius", "mass", "vx", "vy"]
    text = SMALL.format(run="until = 2", events="false") + "rotation = { inertia = 0.5, roughness = 1.0 }\n"
    simulate(parse_scene(text), tmp_path / "run.h5", force=True)
    with open_log(tmp_path / "run.h5") as log:
        with pytest.raises(LogError, match="has no events"):
            log.to_pandas()
        assert "angular_velocity" in log.to_pandas("discs")
        pandas.testing.assert_frame_equal(log.to_pandas("discs"), log.to_pandas("discs", times=[0.0]))
        assert len(log.to_pandas("observables")) >= 2
    simulate(parse_scene(SMALL.format(run="until = 1e-9", events="true")), tmp_path / "run.h5", force=True)
    with open_log(tmp_path / "run.h5") as log:
        frame = log.to_pandas()
        assert (list(frame.columns), len(frame)) == (COMMON, 0)


@pytest.mark.parametrize(
    ("what", "choice", "line"),
    [
        ("walls", {}, r"no table of walls \(allowed: events, flights, discs, observables\)$"),
        ("events", {"times": [1.0]}, r"times does not apply to events \(allowed: disc, t0, t1\)$"),
        ("discs", {"t0": 1.0}, r"t0 does not apply to discs \(allowed: disc, times\)$"),
        ("observables", {"disc": 1}, r"disc does not apply to observables \(allowed: t0, t1\)$"),
        ("discs", {"times": [1e9]}, r"no state at time 1e\+09"),
    ],
)
def test_what_cannot_be_asked_for(log, what, choice, line):
    with pytest.raises(LogError, match=line):
        log.to_pandas(what, **choice)


def test_without_pandas(log, monkeypatch):
    monkeypatch.setitem(sys.modules, "pandas", None)
    line = 'to_pandas requires pandas: .venv/bin/pip install -e ".[notebook]" in the top folder'
    with pytest.raises(LogError, match=f"^{re.escape(line)}$"):
        log.to_pandas()
