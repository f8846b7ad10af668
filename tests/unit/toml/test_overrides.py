from helpers import support

from idealgas.scene import parse_scene

TWO = """
[scene]
title = "two"
[box]
size = [10, 10]
[[species]]
name = "argon"
count = 10
radius = 0.1
speed = 1
[[species]]
name = "neon"
count = 20
radius = 0.1
temperature = 1
[run]
events = 5
"""
ONE = TWO[: TWO.index('[[species]]\nname = "neon"')] + "[run]\nevents = 5\n"


def scene(*overrides, text=TWO):
    return parse_scene(text, "s.toml", overrides)


def refused(*overrides, text=TWO):
    return support.refused(text, *overrides, name="s.toml")


def test_species_by_index_by_name_and_by_being_the_only_one():
    assert [s.count for s in scene("species.0.count=3", "species.neon.count=4").species] == [3, 4]
    assert scene("species.count=7", text=ONE).species[0].count == 7


def test_text_needs_no_quotes():
    for override in ("run.method=brute_force", 'run.method="brute_force"', " run.method = brute_force "):
        assert scene(override).run.method == "brute_force"


def test_values_of_overrides():
    assert scene("scene.title=PV = NkT").scene.title == "PV = NkT"
    assert scene("box.size=[20, 30]").box.size == (20.0, 30.0)
    assert scene("box.size.1=30").box.size == (10.0, 30.0)
    assert scene("log.compression=none").log.compression == "none"
    assert scene("scene.seed=1", "scene.seed=2").scene.seed == 2
    assert scene("scene.title=1\nseed = 3").scene.title == "1\nseed = 3"
    changed = scene("species.argon.speed=", "species.argon.temperature=2", "scene.title=")
    assert (changed.species[0].speed, changed.species[0].temperature) == (None, 2.0)
    assert changed.scene.title == ""


def test_errors_name_the_override_not_the_file():
    assert refused("species.neon.radius=-1") == [
        "--set species.neon.radius=-1: species.neon.radius: out of range (got -1; allowed > 0)"
    ]
    assert refused("run.events=") == [
        "--set run.events=: run: no stop rule (got nothing; allowed at least one of until, events and "
        "collisions_per_disc)"
    ]
    assert refused("run.events.most=3") == [
        "--set run.events.most=3: no such key or table (got most; allowed no key below a value)"
    ]
    assert refused("species.count=3") == [
        "--set species.count=3: no such key or table (got count; allowed 0 to 1, argon, neon)"
    ]
    errors = refused("species.9.count=1", text=TWO.replace("events = 5", "events = 0"))
    assert [error.split(": ")[0] for error in errors] == ["--set species.9.count=1", "s.toml:17"]


def test_an_override_in_a_table_that_is_unknown_or_not_whole():
    (unknown,) = refused("foo.bar=1")
    assert unknown.startswith("--set foo.bar=1: foo: unknown table (got foo; allowed scene, ")
    assert refused("gravity.accelerations=1")[0].startswith("--set gravity.accelerations=1: gravity")
    two = ("thermostat.rate=5", "thermostat.temperature=hot")
    (wrong,) = [error for error in refused(*two) if "thermostat.temperature" in error]
    assert wrong.startswith("--set thermostat.temperature=hot: ")
    assert [error.split(": ")[0] for error in refused("foo.bar=1", text="x = 1\n[foo]\n" + TWO)] == [
        "s.toml:1",
        "s.toml:2",  # the file has it too
    ]
