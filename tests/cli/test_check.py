import json

import pytest
from helpers.support import ROOT, called, output_of

from idealgas.effects import EFFECT_NAMES
from idealgas.scene import load_scene

CONFIGS = ROOT / "configs"


def check(*arguments, folder=None):
    return called("check", *arguments, folder=folder)


def test_an_invalid_scene_is_refused_line_by_line(invalid_case, tmp_path):
    overrides = [argument for override in invalid_case.overrides for argument in ("--set", override)]
    result = check(invalid_case.path, *overrides, folder=tmp_path)
    assert result.returncode == 2
    assert result.stderr.splitlines() == invalid_case.lines != []
    assert result.stdout == ""
    assert not list(tmp_path.iterdir())


def test_a_shipped_scene_is_shown_in_full(shipped_scene):
    result = check(shipped_scene)
    assert (result.returncode, result.stderr) == (0, "")
    for part in ("[scene]", "[run]", "compression = ", "packing fraction φ", "wall hits per time", "rows in the log"):
        assert part in result.stdout
    effects = load_scene(shipped_scene).effects
    absent = [name for name in EFFECT_NAMES if name not in effects]
    assert result.stdout.splitlines()[-2:] == [
        f"effects: {', '.join(effects) or 'none (elastic discs in a reflecting box)'}",
        f"compiled out: {', '.join(absent)}",
    ]


def test_walls_are_listed_by_their_numbers():
    shown = check(CONFIGS / "effusion.toml", "--set", "box.left={ thermal = 2 }").stdout
    lines = [line for line in shown.splitlines() if line.startswith("│")]
    assert any(all(word in line for word in ("0", "left", "thermal, temperature 2")) for line in lines)
    assert any(all(word in line for word in ("6", "gate", "(10, 4.9)", "reflecting, open from 5")) for line in lines)
    piston = check(CONFIGS / "piston.toml").stdout
    assert "piston of mass 20 under pressure 2" in piston


def test_what_theory_does_not_know_and_what_it_knows_roughly_is_said():
    shown = check(CONFIGS / "piston.toml").stdout
    assert "not known: the theory of a uniform gas does not cover piston\n" in shown
    result = json.loads(check(CONFIGS / "piston.toml", "--json").stdout)
    assert (result["effects"], result["beyond"]) == (["piston"], ["piston"])
    assert (result["temperature"], result["rows"]) == (None, None)
    assert result["duration"] == 2000
    assert result["compiled_out"] == [name for name in EFFECT_NAMES if name != "piston"]
    shown = check(CONFIGS / "atmosphere.toml").stdout
    assert "about: the law of a dilute column, whose lowest layer has a packing fraction of 0.0063\n" in shown
    assert "not known" not in shown


ROUGH = (
    ("dense", "the packing fraction is above 0.62", ("species.radius=0.147", "species.placement=lattice")),
    ("quickstart", "Enskog's theory is off by up to", ("species.count=6", "species.placement=random")),
)


@pytest.mark.parametrize(("scene", "why", "overrides"), ROUGH)
def test_numbers_of_a_rough_theory_are_about(scene, why, overrides):
    settings = [word for override in overrides for word in ("--set", override)]
    shown = check(CONFIGS / f"{scene}.toml", *settings).stdout
    assert f"about: {why}" in shown.replace("\n", " ")
    for name in ("collisions per disc and time Γ", "pair collisions per time", "events", "rows in", "size of"):
        assert any(line.startswith(f"│ {name}") and " about " in line for line in shown.splitlines()), name
    assert "about" not in next(line for line in shown.splitlines() if line.startswith("│ temperature T"))
    assert why in json.loads(check(CONFIGS / f"{scene}.toml", *settings, "--json").stdout)["rough"]


def test_numbers_of_a_good_theory_are_not_about():
    assert "about" not in check(CONFIGS / "dilute.toml", "--set", "scene.description=").stdout
    assert json.loads(check(CONFIGS / "dilute.toml", "--json").stdout)["rough"] == ""


def test_json():
    shown = output_of("check", CONFIGS / "mixture.toml", "--json", "--set", "species.heavy.count=100")
    result = json.loads(shown)
    assert result["number"] == 900
    assert [(s["name"], s["number"]) for s in result["species"]] == [("light", 800), ("heavy", 100)]
    assert result["scene"]["species"][1]["count"] == 100
    assert result["effects"] == []
    assert result["rows"] > result["events"] > 0


def test_the_shown_scene_is_a_scene(tmp_path):
    shown = check(CONFIGS / "three-discs.toml").stdout
    copy = tmp_path / "copy.toml"
    copy.write_text(shown[: shown.index("Discs at the start")])
    assert check(copy).stdout == shown


RESTING = """
box.size = [10, 10]
gravity.acceleration = [0, -1]
restitution.wall = 0.9
run.until = 20
species = [{ name = "gas", count = 5, radius = 0.5, temperature = 1 }]
"""


@pytest.mark.parametrize(
    ("override", "said", "warned"),
    [
        ("restitution.wall=0.9", "at rest: a disc keeps bouncing, with 13.72 to 15.25 hits per unit time, up to", ""),
        ("restitution.contact_duration=1e-6", "1e+06 to 1.111e+06 hits per unit time", "warning: A disc at rest has"),
        ("restitution.wall=0", "", "warning: With a restitution of 0, a resting disc collides infinitely often"),
        ("gravity=", "", ""),
    ],
)
def test_discs_that_may_come_to_rest(override, said, warned, tmp_path):
    (tmp_path / "scene.toml").write_text(RESTING)
    result = called("check", "scene.toml", "--set", override, folder=tmp_path)
    assert result.returncode == 0
    assert ("at rest:" in result.stdout) == bool(said)
    assert said in result.stdout
    assert ("warning:" in result.stdout) == bool(warned)
    assert warned in result.stdout
    measured = json.loads(called("check", "scene.toml", "--json", "--set", override, folder=tmp_path).stdout)
    assert (measured["rest"] is None) == (not said and not warned)


def test_rough_discs_that_come_to_rest(tmp_path):
    (tmp_path / "scene.toml").write_text(RESTING.replace("restitution.wall = 0.9", "rotation.wall_roughness = 0.5"))
    warned = "warning: Rough collisions dissipate kinetic energy"
    for override in ("run.until=20", "restitution.normal=0.95", "box.top={ thermal = 1 }", "rotation.roughness=0.5"):
        assert warned in called("check", "scene.toml", "--set", override, folder=tmp_path).stdout
    assert json.loads(called("check", "scene.toml", "--json", folder=tmp_path).stdout)["warning"]
    for override in ("rotation.wall_roughness=1", "rotation.wall_roughness=-1", "gravity="):
        result = called("check", "scene.toml", "--set", override, folder=tmp_path)
        assert (result.returncode, warned in result.stdout) == (0, False)
