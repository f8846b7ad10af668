"""Which part of the package may import which. Data flows one way, and physics knows nobody."""

import ast
from pathlib import Path

import pytest
from support import ROOT

FREE = {"", "errors", "events"}
"""The version, the errors of the user and the columns of events are for all."""

ALLOWED = {
    "scene": set(),
    "physics": {"_jit"},
    "placement": {"_jit"},
    "gas": {"scene", "placement", "resting"},
    "engine": {"_jit", "physics", "gas"},
    "log": {"_jit", "gas", "scene"},
    "resting": {"scene", "gas"},
    "effects": {"scene", "gas", "engine", "physics"},
    "energy": {"gas", "engine"},
    "columns": {"scene", "gas", "engine", "energy", "log"},
    "simulate": {"_jit", "scene", "gas", "effects", "resting", "energy", "columns", "engine", "log"},
    "resume": {"_jit", "scene", "effects", "energy", "columns", "engine", "log", "simulate"},
    "analysis": {"_jit", "scene", "gas", "log"},
    "study": {"scene", "gas", "effects", "engine", "log", "simulate", "analysis"},
    "_jit": set(),
    "errors": set(),
    "events": set(),
    "": {"log"},  # open_log, imported when it is asked for
}

COMPUTES = {"idealgas", "math", "typing", "collections", "enum", "numpy", "numba"}
"""All that the laws of physics need."""

MODULES = sorted((ROOT / "idealgas").rglob("*.py"))
COMMANDS = sorted((ROOT / "cli").glob("*.py"))


def imports(path: Path) -> set[str]:
    """Dotted names that a module imports, anywhere in it; relative imports keep their dots."""
    names = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            names |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            module = "." * node.level + (node.module or "")
            names |= {f"{module}.{alias.name}" for alias in node.names} if module == "idealgas" else {module}
    return names


def part(name: str) -> str:
    """scene for idealgas.scene.model; nothing for the package itself and what it defines."""
    first = name.split(".")[1] if "." in name else ""
    return first if first in ALLOWED else ""


def name_of(path: Path) -> str:
    return path.relative_to(ROOT).as_posix()


@pytest.mark.parametrize("path", MODULES, ids=name_of)
def test_the_package_imports_one_way(path):
    place = path.relative_to(ROOT / "idealgas").with_suffix("").parts[0]
    own = "" if place == "__init__" else place
    assert own in ALLOWED, "a new part: say what it may import"
    names = imports(path)
    used = {part(name) for name in names if name.split(".")[0] == "idealgas"}
    assert used - {own} - FREE <= ALLOWED[own]
    assert not any(name.startswith("..") or name.split(".")[0] in ("cli", "idealgas_cli") for name in names)


@pytest.mark.parametrize("path", [p for p in MODULES if p.parent.name == "physics"], ids=name_of)
def test_physics_only_computes(path):
    assert {name.split(".")[0] for name in imports(path)} <= COMPUTES


@pytest.mark.parametrize("path", COMMANDS, ids=name_of)
def test_commands_use_what_is_public(path):
    used = {part(name) for name in imports(path) if name.split(".")[0] == "idealgas"}
    assert used <= FREE | {"scene", "gas", "simulate", "resume", "log", "analysis", "study"}
