"""Work of a piston: free energy of few discs, works that obey Crooks by construction, and strokes of a log."""

import math
from dataclasses import replace

import numpy as np
import pytest
from helpers.logs import gas, log_of, species
from helpers.support import ROOT

import idealgas
from idealgas import load_scene, simulate
from idealgas.analysis.registry import find
from idealgas.analysis.work import _pairs
from idealgas.analysis.work.processes import crossings, process
from idealgas.columns import Kind
from idealgas.initial.build import make_gas
from idealgas.scene import parse_scene
from idealgas.theory.free_energy import log_configurations
from idealgas.theory.two_discs import configurations
from idealgas.theory.values import Theory

SCENE = ROOT / "configs" / "work.toml"


def discs(number, radius):
    return gas(number, radius, (4, 3), "until = 1")


def configurations_of(text, sides=(4.0, 3.0)):
    return log_configurations(make_gas(parse_scene(text)), sides, (False, False))


def test_room_of_two_discs():
    """Closed form of equal discs between walls, σ ≤ min(a, b), and A(A - πσ²) in a periodic box (theory.two_discs)."""
    a, b, s = 3.2, 2.2, 0.8
    walls = a**2 * b**2 - math.pi * s**2 * a * b + 4 / 3 * s**3 * (a + b) - s**4 / 2
    assert configurations((s / 2, s / 2), (a + s, b + s)) == pytest.approx(walls, rel=1e-12)
    assert configurations((0.4, 0.4), (4.0, 3.0), (True, True)) == pytest.approx(12 * (12 - math.pi * s**2), rel=1e-12)
    assert configurations((0.4, 0.4), (0.7, 3.0)) == 0


@pytest.mark.parametrize(("number", "radius"), [(1, 0.5), (2, 0.4), (3, 0.2), (5, 0.1)])
def test_free_energy_against_random_configurations(number, radius):
    """Fraction of 200 000 random configurations without overlap, k = 4."""
    result = configurations_of(discs(number, radius))
    places = np.random.default_rng(1).random((200_000, number, 2)) * (4 - 2 * radius, 3 - 2 * radius)
    i, j = np.triu_indices(number, 1)
    share = (((places[:, i] - places[:, j]) ** 2).sum(axis=2) > 4 * radius**2).all(axis=1).mean()
    random = math.log(share) + number * math.log((4 - 2 * radius) * (3 - 2 * radius))
    error = math.sqrt((1 - share) / share / 200_000)
    assert (result.error > 0) == (number > 2)
    assert abs(result.value - random) <= 4 * error + result.error


def test_species_of_one_radius_are_equal_discs():
    """Two species of two discs each have the configurations of four discs of one."""
    second = species("b", 2, 0.3)
    assert configurations_of(discs(2, 0.3) + second) == configurations_of(discs(4, 0.3))


def test_discs_that_do_not_fit():
    assert configurations_of(discs(2, 0.5), (0.9, 3.0)) is None
    assert configurations_of(discs(2, 0.5), (1.5, 1.5)) is None


def strokes(draw, number, spread=1.0, free=0.7, temperature=2.0):
    """Works of a process and back: normal with the mean ΔF + σ²/2T obey Crooks' theorem exactly, with variance σ²."""
    work = draw.normal(free + spread**2 / 2 / temperature, spread, number)
    back = draw.normal(-free + spread**2 / 2 / temperature, spread, number)
    energy, theory = np.full(number, 2.0), Theory(free, 0.0, "")
    return (
        process((5.0, 4.0), ((2.0, -0.5),), work, energy, temperature, 1, theory),
        process((4.0, 5.0), ((2.0, 0.5),), back, energy, temperature, 1, theory),
    )


def test_errors_of_free_energy_crossing_and_slope():
    """Rms of 400 deviations scatters by 1/√800 = 3.5 %; k = 3."""
    draw, result = np.random.default_rng(3), []
    for _ in range(400):
        both = strokes(draw, 200)
        (crossing,) = crossings([both[0], replace(both[1], work=both[1].work[:80])], 2.0)  # not halfway
        result.append([each.deviation for each in (both[0].free_energy, crossing.free_energy, crossing.slope)])
    assert np.sqrt(np.square(result).mean(axis=0)) == pytest.approx(1, abs=0.1)
    assert np.abs(np.mean(result, axis=0)).max() < 0.2  # bias in standard errors, of 1/√400 = 0.05 by chance


def test_strokes_that_do_not_overlap_or_are_few():
    draw = np.random.default_rng(4)
    assert crossings(strokes(draw, 9), 2.0) == ()
    assert crossings(strokes(draw, 50)[:1], 2.0) == ()
    assert crossings(strokes(draw, 50, spread=0.01, free=0.7, temperature=1e-3), 1e-3) == ()


def test_strokes_without_work_are_a_value_of_their_own():
    forward, back = np.array([0.0, 0.0, 0.0, 0.1, 0.9]), np.array([0.0, 0.2, 0.2, 0.3, -0.8])
    place, counts = _pairs(forward, back, np.array([-1.0, 0.0, 0.5, 1.0]))
    assert place == pytest.approx([0.0, 0.2])
    assert counts.tolist() == [[3, 1], [1, 3]]


@pytest.fixture(scope="module")
def log():
    return log_of("work")


def test_strokes_of_a_log(log):
    """Ten strokes inwards and outwards; their works are those of all hits of the piston, from the events."""
    result = idealgas.work(log)
    assert [(each.ends, each.protocol, len(each.work)) for each in result.processes] == [
        ((5.0, 4.0), ((2.0, -0.5),), 10),
        ((4.0, 5.0), ((2.0, 0.5),), 10),
    ]
    (crossing,) = result.crossings
    assert crossing.name == "from 5 to 4 in 2"
    (rows,) = log.chunks()
    hits = rows.kind == Kind.PISTON
    for each, first, speed in zip(result.processes, (20, 42), (-0.5, 0.5), strict=True):
        for work, begin in zip(each.work, first + 44 * np.arange(10), strict=True):
            now = hits & (rows.time > begin) & (rows.time < begin + 2)
            after = rows.velocity[now, 0]
            assert work == pytest.approx(((after**2 - (2 * speed - after) ** 2) / 2).sum(), abs=1e-12)
    for each in result.processes:
        assert each.kinetic_energy.standard_error == pytest.approx(math.sqrt(2 / 10))  # variance N T²
        assert abs(each.kinetic_energy.value - 2) < 4 * math.sqrt(2 / 10)
        assert any(each.name in caveat for caveat in find("work").combined([result]).caveats)


def test_results_of_a_sweep_are_those_of_its_logs(log):
    analysis = find("work")
    result = analysis.analyse(log)
    again = analysis.restored(result.as_dict(), result.origin)
    assert again.as_dict() == result.as_dict()
    both = analysis.combine([result, again])
    assert [len(each.work) for each in both.processes] == [20, 20]
    assert both.processes[0].free_energy.theory == result.processes[0].free_energy.theory


def test_theory_of_the_shipped_scene(log):
    """Q of two discs of σ = 1 in a closed form, between 4 by 3 and 3 by 3."""

    def room(a, b):
        return a**2 * b**2 - math.pi * a * b + 4 / 3 * (a + b) - 0.5

    inwards, outwards = (each.free_energy for each in idealgas.work(log).processes)
    assert inwards.theory == pytest.approx(math.log(room(4, 3) / room(3, 3)), rel=1e-12)
    assert outwards.theory == -inwards.theory


@pytest.mark.long
def test_ten_thousand_strokes(tmp_path):
    """Jarzynski's equality and Crooks' theorem with 10 000 strokes in each direction, k = 3; about two minutes."""
    results, analysis = [], find("work")
    for seed in range(1000):
        simulate(load_scene(SCENE, [f"scene.seed={seed}", "log.events=false"]), tmp_path / "run.h5", force=True)
        results.append(analysis.analyse(tmp_path / "run.h5"))
    result = analysis.combined(results)
    (crossing,) = result.crossings
    estimates = [each.free_energy for each in (*result.processes, crossing)] + [crossing.slope]
    estimates += [each.kinetic_energy for each in result.processes]
    print([(each.value, each.standard_error, each.theory, each.deviation) for each in estimates])
    assert max(abs(each.deviation) for each in estimates) < 3
    assert all(
        each.mean_work.value > each.free_energy.theory + 10 * each.mean_work.standard_error for each in result.processes
    )
