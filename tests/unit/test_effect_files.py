"""An effect is one word, with a law and a file of this name, from which all lists follow."""

import ast

import pytest
from helpers.support import ROOT

from idealgas.effects import EFFECTS, NAMES
from idealgas.effects.bundle import ENERGIES, Effects
from idealgas.scene.document import Document

COMMON = ("__init__", "bundle", "effect", "properties", "schedule")
"""Files of the effects in common."""


@pytest.mark.parametrize("word", NAMES)
@pytest.mark.parametrize("place", ["physics", "effects"])
def test_an_effect_is_two_files(place, word):
    body = ast.parse((ROOT / "idealgas" / place / f"{word}.py").read_text(encoding="utf-8")).body
    assert any(isinstance(node, ast.FunctionDef | ast.ClassDef) for node in body), "an empty file"


def test_all_lists_follow_from_one():
    assert (*(effect.field for effect in EFFECTS), *ENERGIES, "flow", "schedule") == Effects._fields
    assert {effect.key for effect in EFFECTS if effect.table and effect.key} <= set(Document.model_fields)
    assert {path.stem for path in (ROOT / "idealgas" / "effects").glob("*.py")} == {*NAMES, *COMMON}
