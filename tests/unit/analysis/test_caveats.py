"""Caveats of analyses: for each a log that violates it and one that does not; and where its sentence is shown."""

import json
import math
import re
from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from helpers.logs import raised
from helpers.small_gases import GAS, PERIODIC, SLIT, TWO, analysed, made, only, silent

from idealgas.analysis import caveats, registry
from idealgas.analysis.info import info
from idealgas.analysis.status import status
from idealgas.initial.build import make_gas
from idealgas.presentation.tables import estimates
from idealgas.report.sections import make_sections
from idealgas.scene import parse_scene
from idealgas.statistics.estimates import Estimate
from idealgas.theory.forecast import forecast


def combined(name, *logs):
    return registry.combine([registry.analyse(log, name) for log in logs])


# ── runs of one state ──


def test_runs_are_grouped_by_state_in_order_of_density():
    """By φ to nine digits, the number of discs and the kind of gas; runs of one state in the order given."""

    def sample(phi, number, kind, seed):
        return SimpleNamespace(packing_fraction=phi, number=number, origin=SimpleNamespace(kind=kind, seed=seed))

    alone = SimpleNamespace(packing_fraction=0.2, number=9, origin=None)
    runs = [sample(*run) for run in ((0.3, 9, "b", 4), (0.3, 9, "a", 7), (0.1, 9, "a", 1), (0.3 + 1e-10, 9, "a", 2))]
    more = sample(0.3, 10, "a", None)
    assert caveats.by_state([*runs, alone, more]) == [
        ("a", [runs[2]]), ("", [alone]), ("a", [runs[1], runs[3]]), ("b", [runs[0]]), ("a", [more])
    ]  # fmt: skip
    assert caveats.seeds_of([*runs, more, runs[0], alone]) == (1, 2, 4, 7)
    assert caveats.name_of_state(0.3, 9, "a", (1, 2, 4, 7)) == "φ = 0.3, N = 9, seeds 1 to 7, a"
    assert caveats.name_of_state(0.3, 9, "", (1, 2)) == "φ = 0.3, N = 9, seeds 1, 2"
    assert caveats.name_of_state(0.3, 9, "", (5,)) == "φ = 0.3, N = 9, seed 5"
    assert caveats.name_of_state(0.3, 9, "", ()) == "φ = 0.3, N = 9"


# ── where sentences are shown ──


def test_a_sentence_is_in_tables_json_and_the_report():
    log = made(TWO)
    result = combined("pressure", log)
    sentence = only(result, "do not reach all states")
    assert result.tables()[0].notes[0] == f"caveat: {sentence}"
    assert sentence in json.loads(json.dumps(result.as_dict()))["caveats"]
    shown = [section.tables for section in make_sections(log) if section.title == "Pressure"]
    assert shown[0][0].notes[0] == f"caveat: {sentence}"
    fine = combined("pressure", made())
    assert (fine.caveats, fine.as_dict()["caveats"]) == ((), [])
    assert not any(note.startswith("caveat") for note in fine.tables()[0].notes)


def test_sentences_of_many_logs_have_their_paths_and_are_bounded():
    results = [replace(combined("temperature", made()), caveats=("a.", f"b{k}.")) for k in range(9)]
    said = caveats.combined_caveats(results)
    assert said[0].endswith(" and 6 more: a.")  # once, though all logs have it
    assert said[1].endswith(".h5: b0.")
    assert len(said) == caveats.MOST + 1
    assert said[-1].startswith(f"{10 - caveats.MOST} more caveats")
    assert caveats.combined_caveats(results[:1]) == ("a.", "b0.")


def test_discs_that_order_may_keep_an_arrangement():
    """At φ = 0.72 72 discs keep one orientation for 30 000 collisions each: Z is 0.15 % off, four standard errors."""
    for radius, said in ((0.44, 0), (0.45, 1)):
        discs = f"species=[{{name='gas', count=72, radius={radius}, temperature=1, placement='lattice'}}]"
        result = analysed("pressure", PERIODIC, discs)
        assert sum("single arrangement" in sentence for sentence in result.caveats) == said


# ── motion of the gas as a whole ──


def test_common_motion_is_no_temperature():
    discs = [f"[{3 + 0.1 * math.cos(k)}, {0.1 * math.sin(k)}]" for k in range(16)]
    flow = f"species=[{{name='gas', count=16, radius=0.3, velocities=[{', '.join(discs)}]}}]"
    log = made(PERIODIC, flow)
    seen, said = status(log), info(log)["gas"]
    velocity = log.discs.velocity
    thermal = ((velocity - velocity.mean(axis=0)) ** 2).sum(axis=1).mean() / 2
    assert log.discs.temperature > 4
    assert [seen.temperature, said["temperature"]] == pytest.approx([thermal, thermal], rel=1e-9)
    assert said["common_motion"] == pytest.approx(velocity.mean(axis=0))
    assert seen.ks_distance < 0.5
    assert "moves as a whole" in seen.caveats[0]
    result = registry.analyse(log, "temperature")
    only(result, "moves as a whole")
    assert result.species[-1].both.value == pytest.approx(thermal, rel=1e-9)
    still = made(PERIODIC)
    assert status(still).caveats == ()
    assert info(still)["gas"]["common_motion"] == [0, 0]
    assert registry.analyse(still, "temperature").caveats == ()


# ── runs that count once ──


def test_time_steps_are_said():
    """By analyses, as the displacement of two discs in a step; and before a run, by the speeds that a scene has."""
    by_steps = (PERIODIC, "run.method='time_driven'", "run.dt=0.01")
    steps = made(*by_steps)
    far = r"0\.0[89]\d* diameters relative to each other per step: Z - 1 is too small"
    assert re.search(far, only(registry.analyse(steps, "pressure"), "time steps"))
    assert "time steps" in "".join(status(steps).caveats)
    assert silent(analysed("pressure", PERIODIC), "time steps")
    velocities = np.random.default_rng(3).normal((50, 0), 1, (40, 2)).tolist()
    for motion, words in ((f"velocities={velocities}", far.split()[0]), ("temperature=0", "detected late or missed")):
        discs = f"species=[{{name='gas', count=40, radius=0.1, {motion}}}]"
        scene = parse_scene(GAS, overrides=(*by_steps, "run.until=10", discs))
        assert re.search(words, forecast(scene, make_gas(scene)).caveats[-1])


@pytest.mark.parametrize("name", ["pressure", "heat-capacity", "effusion"])
def test_a_run_counts_once(name):
    scene = SLIT if name == "effusion" else ()
    log = made(*scene)
    raised(r"\.h5: given twice$", combined, name, log, log)
    again = made(*scene, f"scene.seed={log.scene.scene.seed}", "log.compression=none")
    raised(r"\d\.h5: the same run as .*\d\.h5 \(same scene and seed\)", combined, name, log, again)
    assert silent(combined(name, log, made(*scene, "scene.seed=7")), "seed")


def test_one_seed_in_different_scenes_is_said():
    logs = made("scene.seed=1"), made("scene.seed=1", "species.gas.temperature=2")
    sentence = only(combined("heat-capacity", *logs), "the same seed (1)")
    assert all(str(log.path) in sentence for log in logs)


def test_one_log_in_one_picture_twice_is_no_average():
    log = made("species.gas.temperature=", "species.gas.speed=1")
    assert len(combined("relaxation", log, log).logs) == 2


def test_a_sweep_counts_once():
    """Points of a sweep know their runs from their scenes."""
    analysis, log = registry.find("heat-capacity"), made()
    result = analysis.analyse(log)
    origin = caveats.origin_of(log.scene, "sweep, point 0")
    point = analysis.restored(result.as_dict(), origin)
    assert (point.caveats, point.energy) == ((), result.energy)
    raised(r"sweep, point 0: the same run as ", analysis.combined, [result, point])
    stored = analysis.restored(result.as_dict() | {"caveats": ["a sentence."]}, origin)
    assert stored.caveats == ("a sentence.",)


# ── different gases ──


def test_heat_capacities_of_different_gases_are_kept_apart():
    logs = [made(f"species.gas.temperature={t}", f"species.gas.count={n}") for n, t in ((40, 1), (40, 3), (60, 2))]
    result = combined("heat-capacity", *logs)
    sentence = only(result, "Different gases (closed box) are analysed separately")
    gases = ["N = 40 in 8 × 8, equal discs, reflecting box", "N = 60 in 8 × 8, equal discs, reflecting box"]
    assert all(gas in sentence for gas in gases)
    assert [(r.name, r.gas) for r in result.routes] == [("dE/dT", gases[0]), ("E/T", gases[0]), ("E/T", gases[1])]
    apart = combined("heat-capacity", logs[0], logs[2])
    assert [r.name for r in apart.routes] == ["E/T", "E/T"]
    assert apart.refused["dE/dT"] == "it requires logs of one gas at several energies"
    alike = combined("heat-capacity", *logs[:2])
    assert alike.caveats == ()
    assert [(r.name, r.gas) for r in alike.routes] == [("dE/dT", None), ("E/T", None)]


def test_the_equation_of_state_says_which_gases():
    walls, periodic = made("species.gas.radius=0.2"), made(PERIODIC, "species.gas.radius=0.2")
    result = combined("pressure", walls, periodic)
    assert "equal discs, periodic sides; equal discs, reflecting box" in only(
        result, "different gases, each in a separate row"
    )
    assert len(result.states) == 2
    heads = result.tables()[0].heads
    assert heads[:3] == ("gas", "φ", "N")
    alike = combined("pressure", walls, made("species.gas.radius=0.2", "scene.seed=9"))
    assert alike.caveats == ()
    assert [state.runs for state in alike.states] == [2]


def test_what_does_not_combine():
    mixture = "[{name='a', count=20, radius=0.2, temperature=1}, {name='b', count=20, radius=0.1, temperature=1}]"
    of_mixture = r"requires equal discs, as Z of a mixture \(0.5 of radius 1, 0.5 of radius 2\)"
    raised(of_mixture, combined, "pressure", made(), made(f"species={mixture}"))
    raised("^histogram: does not combine several logs$", combined, "histogram", made(), made("scene.seed=9"))


def test_effusion_of_different_gases_under_one_name():
    def labelled(result):
        return replace(result, origin=replace(result.origin, label="base scene"))

    analysis, log, other = registry.find("effusion"), made(*SLIT), made(*SLIT, "species.gas.count=50")
    results = [labelled(analysis.analyse(each)) for each in (log, other)]
    raised(r"base scene: different gases under one name \(N = 40 .*; N = 50 .*\)", analysis.combined, results)
    third = labelled(analysis.analyse(made(*SLIT, "scene.seed=12")))
    assert list(analysis.combined([results[0], third]).groups) == ["base scene"]


# ── openings ──


def test_effusion_takes_a_slit_narrower_than_a_mean_free_path():
    """With 400 discs of diameter 0.1 on 32 units of area, λ = 1/(2√2 · 0.1 · 12.5 χ), about a seventh of the slit."""
    wide = made(*SLIT, "species.gas.count=400", "species.gas.radius=0.05", "run.until=4")
    result = combined("effusion", wide)
    only(result, "mean free paths wide: discs stream out together")
    (run,) = result.groups[str(wide.path)]
    assert run.expected is None
    assert (run.speed.theory, run.speed.deviation) == (None, None)
    assert run.speed.value > 0
    assert result.figure().axes
    assert registry.find("effusion").restored(run.as_dict(), run.origin).expected is None
    (narrow,) = combined("effusion", made(*SLIT)).groups.values()
    assert narrow[0].expected is not None
    assert narrow[0].speed.theory_error > 0.0125 * narrow[0].speed.theory


# ── samples ──


def test_fluctuations_take_samples():
    bath = ("box={size=[8, 8], left={thermal=1}, right={thermal=1}}", "run.collisions_per_disc=", "log.events=false")
    short = made(*bath, "run.until=200", "log.snapshot_every=10")
    result = combined("heat-capacity", short)
    assert result.routes == ()
    only(result, "No heat capacity from Var(E)/T²: ")
    assert result.figure().axes
    long = combined("heat-capacity", made(*bath, "run.until=4000", "log.snapshot_every=10"))
    assert [route.name for route in long.routes] == ["Var(E)/T²"]
    assert long.caveats == ()
    assert 0 < long.routes[0].value.standard_error < 0.5


def test_exact_numbers_are_shown_as_exact():
    column = ("gravity.acceleration=[0, -0.2]", "log.snapshot_every=0.5", "run.collisions_per_disc=60")
    isolated = analysed("heat-capacity", *column)
    assert (isolated.energy.standard_error, isolated.energy.independent_samples) == (0.0, math.inf)
    assert 0 < isolated.temperature.independent_samples < math.inf
    *_, both = analysed("temperature").species
    assert (both.both.standard_error, both.both.independent_samples, both.both.deviation) == (0.0, math.inf, None)
    assert 0 < both.x.independent_samples < math.inf
    table = estimates("t", [("walls", Estimate(1.0, 0.0, math.inf)), ("gas", Estimate(1.0, 0.1, 20.0))])
    assert [row[1:4] for row in table.shown] == [["1", "exact", ""], ["1.00", "0.10", "20"]]


def test_tests_of_laws_take_samples():
    few = analysed("histogram", "run.collisions_per_disc=1", start=0.0)
    assert [test.agrees for test in few.distributions[0].tests] == [None, None]
    assert "; too few samples (" in few.summary()
    many = analysed("histogram", "run.collisions_per_disc=100")
    assert [test.agrees for test in many.distributions[0].tests] == [True, True]
