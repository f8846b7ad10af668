"""The case folders: what is refused, with exactly which lines, and what is accepted."""

import pytest

from idealgas.initial.build import make_gas
from idealgas.scene import SceneError, load_scene, parse_scene
from idealgas.toml.dump import dump_document


def test_an_invalid_scene_is_refused_with_all_its_lines(invalid_case):
    with pytest.raises(SceneError) as refusal:
        make_gas(load_scene(invalid_case.path, invalid_case.overrides))
    assert invalid_case.lines
    assert refusal.value.errors == invalid_case.lines


def test_a_valid_scene_is_accepted_and_its_dump_is_the_same_scene(valid_case):
    scene = load_scene(valid_case)
    assert parse_scene(dump_document(scene)) == scene
    assert len(make_gas(scene)) == len(scene.disc) + sum(s.count for s in scene.species)


def test_a_shipped_scene_is_valid(shipped_scene):
    scene = load_scene(shipped_scene)
    assert scene.scene.title
    assert len(make_gas(scene)) > 0
