"""The scenes of the bench of effects: each has its effect, and all at once all that go together."""

import pytest

from idealgas.bench.effects import SCENES, bench_effects, effect_scene
from idealgas.effects import EFFECT_NAMES
from idealgas.effects.effect import SAMPLE_DISCS


def test_every_effect_is_there():
    called = {effect for name in SCENES for effect in effect_scene(name, 1).effects}
    assert called == set(EFFECT_NAMES)
    assert set(effect_scene("all", 1).effects) == set(EFFECT_NAMES) - {"sheared sides", "non-interacting discs"}
    assert effect_scene(None, 1).effects == ()


@pytest.mark.parametrize("name", [name for name in SCENES if name != "all"])
def test_one_at_a_time(name):
    scene = effect_scene(name, 1)
    *needed, own = scene.effects
    assert name.startswith(own)
    walls = ["wall segments"] if own in ("permeable walls", "absorbing walls", "arcs") else []
    assert needed == (["periodic sides"] if own == "sheared sides" else walls)
    assert sum(s.count for s in scene.species) == SAMPLE_DISCS


def test_ratios_are_measured(monkeypatch):
    monkeypatch.setattr("idealgas.bench.effects.SCENES", {"restitution": SCENES["restitution"]})
    (row,) = bench_effects(events=200, repeats=3)
    assert row.effect == "restitution"
    assert 0 < row.smallest <= row.ratio <= row.largest
