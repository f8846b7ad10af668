"""Scenes with effects from end to end: what is conserved, what the log holds, how paths unwrap."""

import math

import numpy as np
import pytest
from helpers.log_compare import differences
from helpers.support import ROOT, code_errors_and_memory

from idealgas.engine.parallel.autotuner import ThreadAutotuner
from idealgas.log import LogWriter, open_log
from idealgas.run.logged_run import ONE_WAS_FASTER
from idealgas.run.simulate import simulate
from idealgas.scene import load_scene, parse_scene

CONFIGS = ROOT / "configs"


def run(path, scene):
    """Summary of a run and its log, open."""
    summary = simulate(scene, path)
    return summary, open_log(path)


@pytest.mark.parametrize("events", ["true", "false"])
def test_an_interrupted_log_ends_where_its_run_did(tmp_path, events):
    """Also without event rows, where the last checkpoint lies before."""
    scene = load_scene(CONFIGS / "quickstart.toml", [f"log.events={events}"])
    summary = simulate(scene, tmp_path / "run.h5", interrupted=lambda: True)
    with open_log(tmp_path / "run.h5") as log:
        assert not log.complete
        assert log.checkpoints.times[-1] < summary.end_time
        counts = {"events": summary.events, "disc_collisions": summary.disc_collisions, "trials": 0}
        assert (log.end_time, log.counts) == (summary.end_time, counts)


@pytest.mark.slow
def test_one_thread_goes_on_while_the_log_is_behind(tmp_path, monkeypatch):
    """It leaves a core to the log; what the log holds is the same."""
    monkeypatch.setattr("idealgas.engine.parallel.slabs.cores", lambda: 2)
    monkeypatch.setattr(ThreadAutotuner, "use_threads", lambda autotuner: True)
    scene = load_scene(CONFIGS / "dilute.toml", ["run.events=200_000", "run.threads=2"])
    paths = [tmp_path / "behind.h5", tmp_path / "never.h5"]
    for path, behind in zip(paths, (True, False), strict=True):
        monkeypatch.setattr(LogWriter, "behind", behind)
        summary = simulate(scene, path)
        assert (summary.threads, summary.shared_slices > 0) == ((1, False) if behind else (2, True))
        assert summary.threads_reason == (ONE_WAS_FASTER if behind else "as run.threads says")
    assert not differences(*paths)


@pytest.mark.interpreted
@pytest.mark.usefixtures("uncompiled")
def test_a_summary_has_the_largest_overlaps_of_the_whole_run(tmp_path):
    """Discs that begin as far beyond a side and in one another as rounding allows, and part: 2⁻⁴⁰ of a diameter."""
    gap = 2.0**-40
    scene = f"""
        box.size = [10, 10]
        run.until = 2
        log.snapshot_every = 0.5
        disc = [
            {{ position = [{0.5 - gap}, 5], velocity = [1, 0], radius = 0.5 }},
            {{ position = [5, 2], velocity = [-1, 0], radius = 0.5 }},
            {{ position = [{6 - 2 * gap}, 2], velocity = [1, 0], radius = 0.5 }},
        ]
    """
    summary, log = run(tmp_path / "run.h5", parse_scene(scene))
    with log:
        beyond, overlap = (log.observables[name][1] for name in ("outside", "overlap"))
        assert (beyond[0], beyond[-1]) == (gap, 0.0)
        assert (overlap[0], overlap[-1]) == (2 * gap, 0.0)
    assert (summary.max_wall_penetration, summary.deepest_overlap) == (gap, 2 * gap)


def test_walls_are_in_the_log_by_their_numbers_and_a_gate_opens_on_time(tmp_path):
    _, log = run(tmp_path / "run.h5", load_scene(CONFIGS / "effusion.toml", ["run.until=6"]))
    with log:
        assert [wall.name for wall in log.walls] == ["left", "right", "bottom", "top", "wall 4", "wall 5", "gate"]
        assert (log.walls[6].start, log.walls[6].end) == ((10.0, 4.9), (10.0, 5.1))
        partners = np.unique(np.concatenate([block.partner for block in log.chunks(("partner",))]))
        assert {-1, -3, -4, -5, -6, -7} <= set(partners.tolist())
    _, log = run(tmp_path / "gate.h5", load_scene(CONFIGS / "free-expansion.toml", ["run.until=12"]))
    with log:
        hits = np.concatenate([b.time[b.partner == -5] for b in log.chunks()])
        right = [int((state.position[:, 0] > 10).sum()) for state in log.frames([10.0, 12.0])]
    assert 9.9 < hits.max() < 10
    assert right[0] == 0 < right[1]


@pytest.mark.slow
def test_an_effect_adds_its_columns_and_no_others(tmp_path):
    plain = {"time", "disc", "partner", "kind", "position", "velocity"}
    bath = {"next_thermostat_collision", "thermostat_collision_number", "bath_energy_sum"}
    for name, event, arrays, values in (
        ("quickstart", set(), set(), set()),
        ("rough", {"angular_velocity"}, {"angular_velocity"}, set()),
        ("periodic", {"image"}, {"image"}, set()),
        ("cooling", {"image"}, {"image", "last_collision", "dissipated_energy_sum"}, set()),
        ("heat-bath", set(), {"emissions", "wall_energy_sum"}, set()),
        ("thermostat", {"image"}, {"image", *bath}, {"thermostat_collisions"}),
        ("piston", set(), {"wall_energy_sum", "piston_position", "piston_velocity"}, set()),
    ):
        _, log = run(tmp_path / f"{name}.h5", load_scene(CONFIGS / f"{name}.toml", ["run.events=10"]))
        with log:
            checkpoint = log.checkpoints[0]
            assert set(log.columns) == plain | event
            assert set(checkpoint.arrays) == {"position", "velocity"} | arrays
            assert values <= set(checkpoint.values)


def test_images_unwrap_the_path_of_a_disc(tmp_path):
    """Between two of its events a disc flies straight: the unwrapped positions differ by velocity times time."""
    _, log = run(tmp_path / "run.h5", load_scene(CONFIGS / "periodic.toml", ["species.count=100", "run.events=5000"]))
    with log:
        assert all((b.position >= 0).all() and (b.position < log.box).all() for b in log.chunks())
        crossings = 0
        for disc in range(100):
            rows = list(log.events(disc=disc))
            time, position, velocity, image = (
                np.concatenate([getattr(b, name) for b in rows]) for name in ("time", "position", "velocity", "image")
            )
            flight = np.diff(position + image * log.box, axis=0)
            assert np.abs(flight - velocity[:-1] * np.diff(time)[:, None]).max() < 1e-12
            crossings += np.abs(np.diff(image, axis=0)).sum()
        assert crossings > 100


def test_what_the_walls_gave_is_what_the_discs_have_won(tmp_path):
    """The account against the energies themselves: heat on the left and right, nothing above and below."""
    overrides = ["box.bottom=reflecting", "box.top=reflecting", "run.until=200"]
    summary, log = run(tmp_path / "run.h5", load_scene(CONFIGS / "conduction.toml", overrides))
    with log:
        given, energy = log.observables["wall_energy"][1], log.observables["energy"][1]
        assert given.sum(axis=1) == pytest.approx(energy - energy[0], abs=1e-10 * energy[0])
        assert (given[:, 2:] == 0).all()
        assert given[-1, 0] > 0 > given[-1, 1]
        assert summary.energy_change == energy[-1] - energy[0]


def test_the_work_of_a_piston_is_pressure_times_area(tmp_path):
    """A piston at a given velocity does work u * Σ|Δp|: the momenta of its hits, from the log, against the account."""
    scene = load_scene(CONFIGS / "compression.toml", ["run.until=100"])
    _, log = run(tmp_path / "run.h5", scene)
    with log:
        work = log.observables["wall_energy"][1][-1, 1]
        speed = scene.piston[0].velocity
        after = np.concatenate([b.velocity[b.kind == 3, 0] for b in log.chunks()])
        before = 2 * speed - after
        assert len(after) > 100
        assert work == pytest.approx(((after**2 - before**2) / 2).sum(), rel=1e-12)


GAS = """
box.size = [10, 10]
run.events = 300
species = [{ name = "gas", count = 12, radius = 0.4, temperature = 1, region = [0, 0, 7, 10] }]
"""


@pytest.mark.parametrize("override", ["rotation.wall_roughness=0", "restitution.wall=0.8"])
@pytest.mark.slow
def test_what_is_lost_at_walls_is_accounted_for(override, tmp_path):
    scene = parse_scene(GAS, overrides=[override, "run.method=brute_force"])
    summary, log = run(tmp_path / "run.h5", scene)
    with log:
        assert log.observables["wall_energy"][1][-1].sum() == pytest.approx(summary.energy_change, rel=1e-12)
    assert summary.energy_change < -0.1
    assert abs(summary.energy_drift) < 1e-12


def test_a_bouncing_disc(tmp_path):
    """As the comment of the scene tells it; sums of powers of two, exact to the last bit."""
    summary, log = run(tmp_path / "run.h5", load_scene(CONFIGS / "bounce.toml"))
    with log:
        (block,) = log.chunks()
        assert block.time.tolist() == [4, 12, 15, 20, 28]
        assert block.partner.tolist() == [-3, -3, -2, -3, -3]
        assert block.position.tolist() == [[4, 0.5], [8, 0.5], [9.5, 8], [7, 0.5], [3, 0.5]]
        assert block.velocity.tolist() == [[0.5, 4], [0.5, 4], [-0.5, 1], [-0.5, 4], [-0.5, 4]]
        assert log.observables["kinetic_energy"][1].tolist() == [0.125, 0.125]
        assert log.observables["potential_energy"][1].tolist() == [8.5, 8.5]
    assert summary.energy_drift == 0


@pytest.mark.slow
def test_a_disc_in_a_wedge_bounces_on_each_wall_as_if_there_were_no_other(tmp_path):
    _, log = run(tmp_path / "run.h5", load_scene(CONFIGS / "wedge.toml"))
    with log:
        (block,) = log.chunks()
    left, right = (block.time[block.partner == -1 - wall] for wall in (4, 5))
    assert (len(left), len(right)) == (17, 35)
    assert np.diff(left) == pytest.approx(np.full(16, 4 * math.sqrt(2)), abs=1e-12)
    assert np.diff(right) == pytest.approx(np.full(34, 2 * math.sqrt(2)), abs=1e-12)


@pytest.mark.slow
def test_two_million_discs_take_less_than_a_gigabyte(tmp_path):
    """The state, its checkpoint and the check of the last state at once; compiling, done before, takes 0.1 GB more."""
    for side, count in (("400", 20_000), ("4000", 2_000_000)):
        path = tmp_path / f"{count}.toml"
        path.write_text(f"""
box.size = [{side}, {side}]
species = [{{name = "gas", count = {count}, radius = 0.5, temperature = 1}}]
run.events = 20_000
run.threads = 1
""")
        code, errors, memory = code_errors_and_memory("run", path.name, "-o", "run.h5", "--force", cwd=tmp_path)
        assert code == 0, errors
    assert 0.5e9 < memory < 1e9
