"""Nothing goes without notice: `cases/abilities.json` lists commands, options, effects, scenes and names in Python."""

import json

import click
import idealgas_cli.main
import pytest
from helpers.support import ROOT

import idealgas
from idealgas.effects import NAMES

ABILITIES = json.loads((ROOT / "tests" / "cases" / "abilities.json").read_text(encoding="utf-8"))


def commands(command, name=""):
    """Options of a command and those below it, by name."""
    context = click.Context(command, **command.context_settings)
    actual = {name: {option for item in command.get_params(context) for option in item.opts + item.secondary_opts}}
    for each in command.list_commands(context) if isinstance(command, click.Group) else ():
        actual |= commands(command.get_command(context, each), f"{name} {each}".strip())
    return actual


def test_all_commands_have_their_options():
    result = commands(idealgas_cli.main.main)
    for name, options in ABILITIES["commands"].items():
        assert set(options) <= result[name], name


@pytest.mark.parametrize("name", ABILITIES["python"])
def test_all_names_of_the_package(name):
    assert getattr(idealgas, name)


def test_all_effects_and_scenes():
    assert set(ABILITIES["effects"]) <= set(NAMES)
    missing = [scene for scene in ABILITIES["scenes"] if not (ROOT / "configs" / scene).is_file()]
    assert not missing
