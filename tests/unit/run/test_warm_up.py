"""Compiling beforehand."""

import json

import pytest
from helpers.support import ROOT, error_of, output_of

from idealgas.run import simulate as module
from idealgas.scene import load_scene, parse_scene

SCENE = """
box.size = [10, 10]
species = [{name = "gas", count = 20, radius = 0.3, temperature = 1.0}]
run.collisions_per_disc = 1e6
"""


def test_a_long_scene_runs_for_one_event_and_leaves_nothing(monkeypatch, tmp_path):
    ran = []

    def simulate(scene, path):
        summary = original(scene, path)
        ran.append((path, summary))
        return summary

    original = module.simulate
    monkeypatch.setattr(module, "simulate", simulate)
    seconds = module.warm_up(parse_scene(SCENE))
    ((path, summary),) = ran
    assert summary.events == 1
    assert seconds == summary.compile_seconds >= 0.0
    assert not path.parent.exists()


@pytest.mark.parametrize("name", ["novak-bortz", "periodic"])
def test_every_method_ends_after_one_event(name, monkeypatch):
    ran, original = [], module.simulate
    monkeypatch.setattr(module, "simulate", lambda *arguments: ran.append(original(*arguments)) or ran[0])
    module.warm_up(load_scene(ROOT / "configs" / f"{name}.toml", ["species.0.count=20"]))
    (summary,) = ran
    assert (summary.events, summary.completed) == (1, True)


def test_the_command_says_what_it_compiled(tmp_path, monkeypatch):
    scene = tmp_path / "gas.toml"
    scene.write_text(SCENE)
    assert list(json.loads(output_of("warm-up", scene, "--json"))["compile_seconds"]) == [str(scene)]
    assert [path.name for path in tmp_path.iterdir()] == ["gas.toml"]
    monkeypatch.setattr("idealgas_cli.warm_up.shipped", lambda: [scene])
    assert str(scene) in output_of("warm-up").replace("\n", "")
    error_of("warm-up", scene, tmp_path / "none.toml")
