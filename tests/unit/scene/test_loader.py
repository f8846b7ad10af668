"""Scenes from files and texts: defaults, the lines of all mistakes, and dumps."""

from functools import partial

import pytest
from helpers.support import ROOT
from helpers.support import refused as refused_of

from idealgas.errors import UserError
from idealgas.examples import load_example
from idealgas.initial.build import make_gas
from idealgas.scene import Header, LogTable, Scene, SceneError, Species, load_scene, parse_scene
from idealgas.toml.dump import dump_document
from idealgas.toml.table import LARGEST

MINIMAL = """
[box]
size = [4, 2]
[[disc]]
position = [1, 1]
radius = 0.5
[run]
until = 1
"""


refused = partial(refused_of, name="s.toml")


def test_of_many_mistakes_the_first_are_lines_and_the_others_a_number():
    errors = refused(MINIMAL + "".join(f"wrong{k} = 1\n" for k in range(100)))
    assert errors[0].startswith("s.toml:9: run.wrong0: unknown key (got wrong0; allowed ")
    assert errors[19].startswith("s.toml:28: run.wrong19: unknown key")
    assert errors[20:] == ["… and 80 more mistakes"]


def test_messages_have_the_names_of_tables():
    species = "[[species]]\nname = '{}'\ncount = 1\nradius = 0.1\n{}\n"
    text = MINIMAL + species.format("light", "temperature = 1") + species.format("heavy", "temperature = 1\nmas = 2")
    assert refused(text) == [
        's.toml:19: species.heavy.mas: unknown key, did you mean "mass"? (got mas; allowed '
        + ", ".join(Species.model_fields)
        + ")"
    ]
    text = text.replace("mas = 2", "")
    assert refused(text, "species.heavy.radius=-1") == [
        "--set species.heavy.radius=-1: species.heavy.radius: out of range (got -1; allowed > 0)"
    ]
    assert refused(text, "species.heavi.radius=1") == [
        '--set species.heavi.radius=1: no such key or table, did you mean "heavy"? '
        "(got heavi; allowed 0 to 1, light, heavy)"
    ]
    wall = "[[wall]]\nname = 'membrane'\nfrom = [2, 0]\nto = [2, 2]\npermeable_to = ['heavi']\n"
    assert refused(text + wall)[0].startswith(
        's.toml:24: wall.membrane.permeable_to: no such species, did you mean "heavy"? (got "heavi"; allowed '
    )
    assert refused(text + wall.replace("heavi", "heavy"), "wall.membran.to=[2, 1]") == [
        '--set wall.membran.to=[2, 1]: no such key or table, did you mean "membrane"? '
        "(got membran; allowed 0 to 0, membrane)"
    ]


def test_defaults_and_types():
    scene = parse_scene(MINIMAL)
    assert scene.scene == Header(title="", seed=0)
    assert scene.log == LogTable(events=True, compression="gzip", checkpoint_every=1)
    assert scene.run.method == "event_driven"
    assert scene.disc[0].velocity == (0.0, 0.0)
    assert scene.disc[0].mass == 1.0
    assert scene.species == ()
    assert scene.effects == ()
    width = parse_scene(MINIMAL).box.size[0]
    assert isinstance(width, float)
    assert width == 4.0
    scene = parse_scene(MINIMAL)
    with pytest.raises(ValueError, match="frozen"):
        scene.run.until = 2.0
    assert parse_scene(MINIMAL, "one.toml") == parse_scene("# moved\n" + MINIMAL, "two.toml")


def test_a_scene_made_in_python_is_checked_too_and_its_error_is_a_user_error():
    with pytest.raises(ValueError, match="no stop rule"):
        Scene.model_validate({"box": {"size": [4, 2]}, "disc": [{"position": [1, 1], "radius": 0.5}], "run": {}})
    error = SceneError(["first", "second"])
    assert isinstance(error, UserError)
    assert isinstance(error, ValueError)
    assert str(error) == "first\nsecond"
    assert error.exit_code == 2


def test_an_unreadable_file_is_one_line(tmp_path):
    for path, reason in ((tmp_path / "none.toml", "No such file or directory"), (tmp_path, "Is a directory")):
        with pytest.raises(SceneError) as refusal:
            load_scene(path)
        assert refusal.value.errors == [f"{path}: cannot be read ({reason})"]
    with pytest.raises(SceneError) as refusal:
        load_scene("a\0b")
    assert len(refusal.value.errors) == 1


@pytest.mark.parametrize(
    ("text", "line"),
    [
        ("[box", "s.toml:1: not TOML: "),
        ("\n\nsize = [1, 2", "s.toml:3: not TOML: "),
        ("a = 1\n\n[box]]", "s.toml:3: not TOML: "),
        ("a = " + "[" * 100_000, "s.toml: not TOML: nested too deeply"),
        ("a = " + "1" * 5_000, "s.toml:1: not TOML: "),
    ],
    ids=["bracket", "end of text", "header", "deep", "huge integer"],
)
def test_not_toml(text, line):
    (error,) = refused(text)
    assert error.startswith(line)


def test_values_too_large_are_refused_in_a_short_line_of_the_right_number():
    (error,) = refused(MINIMAL.replace("until = 1", "until = 0").replace("\n", "\r\n"))
    assert error == "s.toml:8: run.until: out of range (got 0; allowed > 0)"
    (error,) = refused(MINIMAL.replace("radius = 0.5", "radius = 0.5\nmass = 1e200"))
    assert error == f"s.toml:7: disc.0.mass: out of range (got 1e+200; allowed <= {LARGEST:g})"
    assert len(refused(MINIMAL.replace("until = 1", "until = 1" + "0" * 400))) == 1
    (error,) = refused(MINIMAL.replace("until = 1", f'until = "{"x" * 500}"'))
    assert len(error) < 150


def test_faults_between_tables_are_reported_beside_faults_within_them():
    text = MINIMAL.replace("until = 1", "until = -1") + "[[disc]]\nposition = [1.5, 1]\nradius = 0.5\n"
    assert [error.split(" (")[0] for error in refused(text)] == [
        "s.toml:8: run.until: out of range",
        "s.toml:10: disc.1.position: overlaps disc 0",
    ]
    discs = "".join(f"[[disc]]\nposition = [{x}, 1]\nradius = 0.5\n" for x in (3.5, 0.5, 2.75))
    errors = refused(MINIMAL + discs)
    assert [error.split(" (")[0].split(": ", 1)[1] for error in errors] == [
        "disc.2.position: overlaps disc 0",
        "disc.3.position: overlaps disc 1",
    ]
    touching = MINIMAL + "[[disc]]\nposition = [2, 1]\nradius = 0.5\n"
    assert len(parse_scene(touching).disc) == 2
    assert len(parse_scene(touching, overrides=["disc.1.position=[1.9999999999999998, 1]"]).disc) == 2
    assert len(refused(touching, "disc.1.position=[1.9999999, 1]")) == 1


def test_a_dump_shows_the_defaults():
    assert dump_document(parse_scene(MINIMAL)).splitlines() == [
        "[scene]", 'title = ""', 'description = ""', "shows = []", "seed = 0", "",
        "[box]", "size = [4.0, 2.0]", *(f'{side} = "reflecting"' for side in ("left", "right", "bottom", "top")), "",
        "[[disc]]", "position = [1.0, 1.0]", "velocity = [0.0, 0.0]", "radius = 0.5", "mass = 1.0", "",
        "[run]", 'method = "event_driven"', "until = 1.0", "",
        "[log]", "events = true", 'compression = "gzip"', "pressure = false", "checkpoint_every = 1", "fsync = false",
    ]  # fmt: skip


def test_an_example_is_loaded_by_its_name():
    scene = load_example("brownian", ["run.until=1"])
    assert scene == load_scene(ROOT / "configs" / "brownian.toml", ["run.until=1"])
    assert (scene.scene.title, scene.run.until) == ("Brownian motion", 1.0)
    with pytest.raises(UserError) as refusal:
        load_example("brownan")
    assert str(refusal.value).startswith('unknown example, did you mean "brownian"?')


def test_a_valid_scene_is_accepted_and_its_dump_is_the_same_scene(valid_case):
    scene = load_scene(valid_case)
    assert parse_scene(dump_document(scene)) == scene
    assert len(make_gas(scene)) == len(scene.disc) + sum(s.count for s in scene.species)
