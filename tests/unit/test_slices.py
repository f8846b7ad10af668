"""An effect is one word with a law and a file of this name; other files name it only for a reason given here."""

import ast

import pytest
from helpers.support import ROOT

from idealgas.effects import EFFECTS, NAMES
from idealgas.effects.bundle import ENERGIES, Effects
from idealgas.scene.document import Document

PLACES = ("physics", "effects")

NAMED = {
    "scene/__init__.py": ({*NAMES} - {"periodic"}, "hands out the classes of the tables"),
    "scene/tables.py": ({"periodic"}, "the word for a side"),
    "scene/document.py": ({*NAMES} - {"thermal", "gravity"}, "defaults that follow from other tables"),
    "scene/checks/__init__.py": (
        {"rotation", "restitution", "wall", "thermostat", "gravity", "piston"},
        "checks of several tables",
    ),
    "scene/checks/piston.py": ({"gravity", "periodic", "piston", "wall", "thermal"}, "checks of several tables"),
    "scene/scene.py": ({"piston", "restitution"}, "defaults that follow from other tables"),
    "scene/walls.py": ({"piston", "wall", "periodic"}, "lists the walls: sides, segments, and what stands for a side"),
    "scene/checks/discs.py": (
        {"periodic", "piston", "wall"},
        "discs in a box while other tables may not be valid, and what lattices do not allow",
    ),
    "initial/contacts.py": ({"piston"}, "what discs may rest on, which shows once they are placed"),
    "log/schema.py": ({"gravity"}, "names in the file"),
    "log/header.py": ({"gravity"}, "names in the file"),
    "log/export/frames.py": ({"periodic"}, "H5MD's word for a boundary"),
    "run/layout.py": ({"periodic"}, "H5MD's word for a boundary"),
    "analysis/core/moving_wall.py": ({"piston"}, "the room that a piston leaves, and what presses it"),
    "analysis/cooling.py": ({"restitution", "rotation"}, "the coefficients of collisions"),
    "analysis/evolution/theory.py": ({"restitution", "piston"}, "Haff's law and those of a piston"),
    "analysis/evolution/measure.py": ({"piston"}, "the course of a piston and its energy"),
    "analysis/evolution/figure.py": ({"piston"}, "the course of a piston"),
    "analysis/heat_capacity/__init__.py": ({"gravity", "piston"}, "the kinds of gas by name"),
    "analysis/heat_capacity/fluctuations.py": ({"piston"}, "constant pressure, and the energy of a piston"),
    "movie/piston_track.py": ({"piston"}, "where a piston is"),
    "report/player.py": ({"gravity", "periodic", "piston"}, "names in the data of the page"),
}
"""Files that name effects all the same: which, and why."""

PATHS = {path.relative_to(ROOT / "idealgas").as_posix(): path for path in sorted((ROOT / "idealgas").rglob("*.py"))}
PATHS |= {path.relative_to(ROOT).as_posix(): path for path in sorted((ROOT / "cli").rglob("*.py"))}
COMMON = ("__init__", "bundle", "effect", "properties")
"""Files of the effects in common."""

SLICED = {f"{place}/{word}.py" for place in PLACES for word in NAMES}

SUMS = (*ENERGIES, "flow")
"""What the bundle has beside the effects: sums over a run."""

FIELDS = {effect.key for effect in EFFECTS if effect.key}
SAID = {text: word for effect, word in zip(EFFECTS, NAMES, strict=True) for text in (effect.name, effect.field)}
SAID |= {word: word for word in NAMES if word != "wall"}
"""Strings that name an effect; "wall" does not, as a wall is anything that has a number."""


def last(node: ast.expr) -> str:
    """The last name of an expression of names with dots."""
    return node.attr if isinstance(node, ast.Attribute) else node.id if isinstance(node, ast.Name) else ""


def owned(owner: str, name: str, own: bool) -> str | None:
    """The effect that `owner.name` stands for: a table of a scene, a part of its box, or a field of the bundle."""
    if owner in ("scene", "_scene") or (own and owner == "self"):
        return name if name in FIELDS else None
    if owner == "effects" and name in Effects._fields and name not in SUMS:
        return SAID[name]
    return "periodic" if owner == "box" and name in ("periodic", "sides") else None


def imported(node: ast.ImportFrom) -> set[str]:
    """The effects whose files are imported; laws are for everybody."""
    modules = {node.module, *(f"{node.module}.{alias.name}" for alias in node.names)}
    paths = {f"{module.removeprefix('idealgas.').replace('.', '/')}.py" for module in modules if module}
    return {path.split("/")[-1].removesuffix(".py") for path in paths & SLICED if not path.startswith("physics/")}


def named(path: str) -> set[str]:
    """The effects that a file names: in its code, not in its prose."""
    tree = ast.parse(PATHS[path].read_text(encoding="utf-8"))
    prose = {id(node.value) for node in ast.walk(tree) if isinstance(node, ast.Expr)}
    found: set[str | None] = set()
    for node in ast.walk(tree):
        if isinstance(node, ast.Attribute):
            found.add(owned(last(node.value), node.attr, path.startswith("scene/")))
        elif isinstance(node, ast.Constant) and isinstance(node.value, str) and id(node) not in prose:
            found.add(SAID.get(node.value))
        elif isinstance(node, ast.ImportFrom):
            found |= imported(node)
    return {word for word in found if word is not None}


@pytest.mark.parametrize("word", NAMES)
def test_an_effect_is_two_files(word):
    for place in PLACES:
        body = ast.parse(PATHS[f"{place}/{word}.py"].read_text(encoding="utf-8")).body
        assert any(isinstance(node, ast.FunctionDef | ast.ClassDef) for node in body), "an empty file"


def test_all_lists_follow_from_one():
    assert (*(effect.field for effect in EFFECTS), *SUMS) == Effects._fields
    assert {effect.key for effect in EFFECTS if effect.table and effect.key} <= set(Document.model_fields)
    files = {f"effects/{name}.py" for name in (*NAMES, *COMMON)}
    assert files == {path for path in PATHS if path.startswith("effects/")}


def others() -> list[str]:
    """All files except those of the effects, the laws and the kernels."""
    rest = PATHS.keys() - SLICED - {f"effects/{name}.py" for name in COMMON}
    return sorted(path for path in rest if not path.startswith(("physics/", "engine/")))


@pytest.mark.parametrize("path", others())
def test_nobody_else_names_an_effect(path):
    assert named(path) == (NAMED[path][0] if path in NAMED else set())


def test_what_is_excepted_is_there():
    assert set(NAMED) <= set(others())
