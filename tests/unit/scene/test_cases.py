"""The folder of valid scenes; `tests/cli/test_check.py` has the invalid and the shipped ones."""

from idealgas.initial.build import make_gas
from idealgas.scene import load_scene, parse_scene
from idealgas.toml.dump import dump_document


def test_a_valid_scene_is_accepted_and_its_dump_is_the_same_scene(valid_case):
    scene = load_scene(valid_case)
    assert parse_scene(dump_document(scene)) == scene
    assert len(make_gas(scene)) == len(scene.disc) + sum(s.count for s in scene.species)
