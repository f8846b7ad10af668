"""The parts of a study of accuracy, each with its expected result."""

import math

import numpy as np
import pytest
from helpers.support import gas_of

from idealgas.accuracy.bias import BiasLaw, bias_law, rate_biases
from idealgas.accuracy.cases import Case, EquilibratedStart, compared_cases
from idealgas.accuracy.motion import Missed, count_missed, error_on_return, flown_through, positions, rms_distance
from idealgas.accuracy.report import cost_of, flat_row, lost_after, sentences
from idealgas.accuracy.study import Accuracy, AccuracyRow, Timing, check, from_theory, relative
from idealgas.effects.bundle import Effects
from idealgas.engine.event_driven.method import EventDriven
from idealgas.engine.simulation import Stop
from idealgas.errors import UserError
from idealgas.scene import parse_scene
from idealgas.statistics.estimates import Estimate


def some_gas(n=100, seed=1):
    random = np.random.default_rng(seed)
    k = math.isqrt(n)
    place = (np.stack(np.meshgrid(np.arange(k), np.arange(k)), axis=-1).reshape(-1, 2) + 0.5) * 1.0
    return gas_of((k, k), place + random.uniform(-0.2, 0.2, place.shape), random.normal(size=(n, 2)), 0.2)


@pytest.fixture(scope="module")
def start():
    return EquilibratedStart(some_gas(), Effects())


def test_a_simulation_is_followed_to_any_time_without_a_change(start):
    there, steps = start.simulation(EventDriven()), start.simulation(EventDriven())
    for time in (0.3, 0.31, 7.0, 40.0, 123.0):
        steps.run(pause=time)
    assert steps.epoch > 0
    there.run(Stop(time=123.0))
    assert steps.state()[0].position.tolist() == there.state()[0].position.tolist()


def test_the_ladder_goes_down_in_steps_of_two():
    cases = compared_cases(some_gas(), precise=True)
    steps = [case.dt for case in cases if case.dt]
    assert np.allclose(np.divide(steps[:-1], steps[1:]), 2, rtol=0.01)
    assert [case.name for case in cases[-3:]] == ["float32", "float64", "double-double"]
    assert not any(case.precision for case in compared_cases(some_gas(), precise=False))


SCENE = """
box.size = [10, 10]
run.collisions_per_disc = 5
[[species]]
name = "gas"
count = 10
radius = 0.1
temperature = 1
"""


@pytest.mark.parametrize("case", compared_cases(some_gas(), precise=True), ids=lambda case: case.name)
def test_a_case_takes_a_scene_to_a_time(case):
    for before in ([], ['run.method="time_driven"', "run.dt=0.1", "run.events=7"], ['run.method="brute_force"']):
        scene = case.scene(parse_scene(SCENE, overrides=before), 3.25)
        assert (scene.run.method, scene.run.dt, scene.run.precision) == (case.method, case.dt, case.precision)
        assert (scene.run.until, scene.run.events, scene.run.collisions_per_disc) == (3.25, None, None)


@pytest.mark.parametrize(
    ("more", "message"),
    [("[[wall]]\nfrom=[5, 0]\nto=[5, 4]\n", "wall segments"), ('[[piston]]\nside="right"\nvelocity=-0.1\n', "piston")],
)
def test_what_time_steps_cannot_do_is_refused(more, message):
    with pytest.raises(UserError, match=message):
        check(parse_scene(SCENE + more))
    with pytest.raises(UserError, match=r"run\.method"):
        check(parse_scene(SCENE, overrides=['run.method="monte_carlo"']))
    with pytest.raises(UserError, match="a single disc"):
        check(parse_scene(SCENE, overrides=["species.0.count=1", "run.until=1"]))


def test_pairs_that_fly_through_each_other_are_told_from_those_that_meet_others():
    """0-1 is found, 2-3 flown through, 4-5 met others before, 6-7 not yet due, and 8-9 is no pair of first meetings."""
    never = math.inf
    truth = (np.array([1, 1, 2, 2, 3, 3, never, never, 1, 2.0]), np.array([1, 0, 3, 2, 5, 4, -1, -1, 9, 0]))
    actual = (np.array([1.1, 1.1, 9, never, 2, 8, 1, 1, 1, 2.0]), np.array([1, 0, 7, -1, 0, 9, 7, 6, 9, 0]))
    assert flown_through(truth, actual, 0.2) == (2, 1)


def test_steps_miss_less_the_shorter_they_are(start):
    """For a pair alone (w dt/S)²/6 are missed; the event-driven run against itself misses none."""
    cases = [Case("event_driven"), Case("time_driven", dt=0.2), Case("time_driven", dt=0.02)]
    itself, coarse, fine = count_missed(start, cases, 1.0, lambda share: None)
    assert (itself.missed, itself.compared > 100) == (0, True)
    assert coarse.share.value > 0.03
    assert coarse.share.value - 4 * coarse.share.standard_error > fine.share.value
    assert Missed(100, 0).share.standard_error == 0.01


@pytest.mark.slow
def test_the_way_back_shows_the_digits(start):
    """After one or two collisions per disc: 7, 16 and 32 digits; both methods agree in double precision."""
    error = {case.name: error_on_return(start, case, 1.5) for case in compared_cases(start.gas, precise=True)}
    assert error["float64"] == error["event-driven"]
    assert 1e-7 < error["float32"] < 1e-3
    assert 1e-17 < error["float64"] < 1e-12
    assert 1e-33 < error["double-double"] < 1e-28


def test_trajectories_in_double_precision_are_those_of_the_event_driven_run(start):
    times = [1.5, 2.0, 3.0]
    event_driven, double, twice = (
        positions(start.simulation(case.make()), times)
        for case in (
            Case("event_driven"),
            Case("brute_force", precision="float64"),
            compared_cases(start.gas, True)[-1],
        )
    )
    assert event_driven.tolist() == double.tolist()
    apart = rms_distance(event_driven, twice, start.gas)
    assert 0 < apart[0] < apart[-1] < 1e-6


# what is made of the numbers


def row(dt=None, cost=1.0, rate=None, error=0.001, missed=None, trajectory=None, z=None):
    method = "event_driven" if dt is None else "time_driven"
    bias = None if rate is None else Estimate(rate, error, math.inf)
    pairs = None if z is None else Estimate(z, error, math.inf)
    timing = Timing(cost, 0.9 * cost, 1.1 * cost, 100.0)
    return AccuracyRow(Case(method, dt), timing, None, bias, pairs, None, missed, trajectory, None)


def steps():
    """Bias -2 dt, cost 0.5/dt."""
    return [row(dt, 0.5 / dt, -2 * dt, missed=Missed(10_000, round(1e6 * dt**2))) for dt in (0.04, 0.02, 0.01, 0.005)]


def study(rows, law=None):
    return Accuracy("made up", 10, 1.0, 1, np.empty(0), "no reference", law, (row(cost=5.0, z=0.0), *rows))


STEPS = 0.04 / 2 ** np.arange(8)


def rates(random, common=0.0):
    """Rates with the bias -1.4 dt - 78 dt² that 1 000 discs at φ = 0.05 have, known to 0.12 %; event-driven first."""
    dt = np.append(0.0, STEPS)
    actual = 1000 * (1 - 1.4 * dt - 78 * dt**2) + 1.2 * random.normal(size=9)
    actual[0] += common
    return dt, [Estimate(float(value), 1.2, 64) for value in actual]


def test_biases_of_the_rate_against_their_common_limit():
    """Of 400 studies: the law, its error and those of all biases have unit deviations; 4 standard errors, 4/√800."""
    random = np.random.default_rng(1)
    studies = [rate_biases(*rates(random)) for _ in range(400)]
    true = -1.4 * STEPS - 78 * STEPS**2
    deviations = [(law.first + 1.4) / law.error for _, law in studies]
    assert np.std(deviations) == pytest.approx(1, abs=4 / math.sqrt(800))
    for k, bias in enumerate(true, 1):
        deviations = [(biases[k].value - bias) / biases[k].standard_error for biases, _ in studies]
        assert np.sqrt(np.mean(np.square(deviations))) == pytest.approx(1, abs=4 / math.sqrt(800))
    steps = [law.step(0.01) for _, law in studies]
    assert np.mean(steps) == pytest.approx((-1.4 + math.sqrt(1.4**2 + 4 * 78 * 0.01)) / (2 * 78), rel=0.02)
    assert np.std(steps) < 0.1 * np.mean(steps)


def test_an_error_of_the_event_driven_run_is_not_that_of_all_steps():
    """Of 0.36 % of it, biases get less than a third."""
    right, shifted = (rate_biases(*rates(np.random.default_rng(2), common))[0] for common in (0.0, 3.6))
    assert abs(shifted[-1].value - right[-1].value) < 0.0036 / 3


def test_a_bias_is_found_with_its_error():
    value, second, error = bias_law(STEPS, [Estimate(-2 * dt + 5 * dt**2, 0.001, math.inf) for dt in STEPS])
    assert (value, second) == (pytest.approx(-2), pytest.approx(5))
    columns = np.stack((STEPS, STEPS**2))
    assert error == pytest.approx(0.001 * math.sqrt(np.linalg.inv(columns @ columns.T)[0, 0]))
    assert bias_law(STEPS, [Estimate(-0.002, 0.001, math.inf)] * 8) is None
    assert bias_law(STEPS[:0], []) is None
    assert BiasLaw(-2.0, 0.0, 0.1).step(0.01) == pytest.approx(0.005)
    assert BiasLaw(1.0, -100.0, 0.1).step(0.01) == pytest.approx((1 + math.sqrt(5)) / 200)


def test_costs_follow_a_power_law_between_steps_and_beyond():
    for dt in (0.1, 0.04, 0.013, 0.005, 1e-4):
        assert cost_of(dt, steps()) == pytest.approx(0.5 / dt)


def test_sentences_say_what_the_numbers_say_and_nothing_of_what_was_not_seen():
    """1 % takes dt = 0.005 and 100 s per time unit, 20 times the event-driven 5."""
    said = " ".join(sentences(study(steps(), BiasLaw(-2.0, 0.0, 0.1))))
    assert "collision rate to 1%, time steps require dt = 0.005 and 20 times the CPU time of the event-driven" in said
    assert "accuracy costs a factor of 10." in said
    assert "in 16.00% of the collisions, at dt = 0.005 in 0.25%" in said
    assert "dt^2.0" in said
    assert "No trajectories were compared: no reference." in said
    assert "nan" not in said
    said = " ".join(sentences(study([row(0.01, 1.0, 0.0), row(0.005, 2.0, 0.0)])))
    assert "collision rate" not in said
    assert "pressure" in said


def test_ratios_and_their_errors():
    result = relative(Estimate(11.0, 0.3, 1), Estimate(10.0, 0.4, 1))
    assert result.value == pytest.approx(0.1)
    assert result.standard_error == pytest.approx(1.1 * math.hypot(0.3 / 11, 0.04))
    assert from_theory(Estimate(1.1, 0.2, 1, 2.0)).value == pytest.approx(-0.45)
    assert from_theory(Estimate(1.1, 0.2, 1, math.nan)) is None
    assert from_theory(Estimate(1.1, 0.2, 1)) is None


def test_where_a_trajectory_is_lost():
    made = Accuracy(
        "", 1, 1.0, 1, np.array([1.0, 2, 3]), "", None, (row(trajectory=np.array([1e-9, 0.2, 3.0])), *steps())
    )
    assert lost_after(made.rows[0], made) == 2.0
    assert flat_row(made.rows[0], made)["trajectory_error"] == 1e-9
    assert lost_after(row(trajectory=np.array([1e-9, 1e-3, 0.1])), made) is None
