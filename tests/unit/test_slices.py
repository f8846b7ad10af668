"""An effect is one word with a file of this name in four places; nobody else names it, but where it is said why."""

import ast
from importlib import import_module

import pytest
from support import ROOT

from idealgas.physics.effects import Effects
from idealgas.run.effects.bundle import SLICES
from idealgas.scene import EFFECTS
from idealgas.scene.tables.document import Document

WORDS = ("gravity", "periodic", "wall", "rotation", "restitution", "thermal", "piston", "thermostat")
PLACES = ("scene/tables", "scene/checks", "physics", "run/effects")

NOTHING_TO_HOLD = {"scene/checks/thermal.py": "a temperature > 0 is all they ask for, and its type says so"}

TOGETHER = {
    "scene/tables/box.py": "the keys of the box, of which some effects are a part",
    "scene/tables/document.py": "the fields of a scene, and which effect each calls for",
    "scene/checks/issues.py": "the list of the checks",
    "run/effects/bundle.py": "the list of the effects of a run",
}
"""Where the effects are put together. `physics` and `engine`, the bundle and the kernels, are another matter: there an
effect is an argument."""

NAMED = {
    "scene/__init__.py": ({*WORDS} - {"periodic"}, "hands out the classes of the tables"),
    "scene/model.py": ({"piston", "restitution"}, "defaults that follow from other tables"),
    "scene/walls.py": ({"piston", "wall", "periodic"}, "lists the walls: sides, segments, and what stands for a side"),
    "scene/geometry.py": ({"periodic", "wall"}, "images of a disc in a box while other tables may not be valid"),
    "scene/checks/discs.py": ({"periodic", "piston"}, "discs in a box while other tables may not be valid"),
    "scene/checks/placement.py": ({"periodic", "wall"}, "a lattice goes on through periodic sides, and among no walls"),
    "initial/contacts.py": ({"gravity", "piston"}, "what discs may rest on, which shows once they are placed"),
    "log/schema.py": ({"gravity"}, "names in the file"),
    "log/header.py": ({"gravity"}, "names in the file"),
    "log/export/frames.py": ({"periodic"}, "H5MD's word for a boundary"),
    "run/layout.py": ({"periodic"}, "H5MD's word for a boundary"),
    "analysis/core/moving_wall.py": ({"gravity", "piston"}, "the room that a piston leaves, and what presses it"),
    "analysis/cooling/theory.py": ({"restitution", "rotation"}, "the coefficients of collisions"),
    "analysis/evolution/theory.py": ({"restitution", "piston"}, "Haff's law and those of a piston"),
    "analysis/evolution/measure.py": ({"gravity", "piston"}, "the course of a piston and its energy"),
    "analysis/evolution/figure.py": ({"piston"}, "the course of a piston"),
    "analysis/heat_capacity/energy_series.py": ({"gravity", "piston"}, "the energy of a piston"),
    "analysis/heat_capacity/measure.py": ({"gravity", "piston"}, "constant pressure, and the kinds of gas by name"),
    "movie/piston_track.py": ({"gravity", "piston"}, "where a piston is"),
    "report/player.py": ({"gravity", "periodic", "piston"}, "names in the data of the page"),
    "bench/effects.py": ({*WORDS} - {"wall"}, "a scene for each effect"),
}
"""Files that name effects all the same: which, and why."""

PATHS = {path.relative_to(ROOT / "idealgas").as_posix(): path for path in sorted((ROOT / "idealgas").rglob("*.py"))}
PATHS |= {path.relative_to(ROOT).as_posix(): path for path in sorted((ROOT / "cli").rglob("*.py"))}
SLICED = {f"{place}/{word}.py" for place in PLACES for word in WORDS}

SUMS = ("wall_energy", "dissipated", "bath_energy", "flow")
"""What the bundle has beside the effects: sums over a run."""

FIELDS = {"gravity", "wall", "rotation", "restitution", "piston", "thermostat"}
SAID = dict(zip(EFFECTS, WORDS, strict=True)) | {word: word for word in WORDS if word != "wall"} | {"segments": "wall"}
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


@pytest.mark.parametrize("word", WORDS)
@pytest.mark.parametrize("place", PLACES)
def test_every_effect_has_its_file_in_every_place(place, word):
    path = f"{place}/{word}.py"
    assert (path in PATHS) != (path in NOTHING_TO_HOLD)
    if path in PATHS:
        body = ast.parse(PATHS[path].read_text(encoding="utf-8")).body
        assert any(isinstance(node, ast.FunctionDef | ast.ClassDef) for node in body), "an empty file"


def test_the_lists_of_effects_have_them_all_in_one_order():
    tables = [import_module(f"idealgas.scene.tables.{word}") for word in WORDS]
    runs = [import_module(f"idealgas.run.effects.{word}") for word in WORDS]
    assert tuple(table.NAME for table in tables) == EFFECTS
    assert tuple(run.SLICE for run in runs) == SLICES
    assert (*(piece.field for piece in SLICES), *SUMS) == Effects._fields
    assert set(Document.model_fields) >= FIELDS


def others() -> list[str]:
    """All files but the slices, the places where they are put together, and the laws and kernels."""
    rest = PATHS.keys() - SLICED - TOGETHER.keys()
    return sorted(path for path in rest if not path.startswith(("physics/", "engine/")))


@pytest.mark.parametrize("path", others())
def test_nobody_else_names_an_effect(path):
    assert named(path) == (NAMED[path][0] if path in NAMED else set())


def test_what_is_excepted_is_there():
    assert set(NAMED) <= set(others())
    assert set(TOGETHER) | set(NOTHING_TO_HOLD) <= set(PATHS) | set(NOTHING_TO_HOLD)
