"""Which part of the package may import which: data flows one way, no file imports in a circle, physics knows nobody."""

import ast
from graphlib import TopologicalSorter
from pathlib import Path

import pytest
from helpers.support import ROOT

FREE = {"_version", "errors", "catalogue", "columns", "fields", "files", "locks", "pairs", "system", ""}
"""Version, errors, names of analyses, files, locks, near pairs, systems, columns and numbers of walls are for all."""

ROOMS = {"theory", "statistics", "presentation", "tallies"}
"""What analyses are built of."""

ALLOWED = {
    "jit": set(),
    "state": {"jit"},
    "toml": set(),
    "physics": {"jit"},
    "effects": {"jit", "state", "toml", "physics"},  # a scene stands on its effects
    "scene": {"effects", "toml", "physics"},  # defaults that follow from a law
    "initial": {"jit", "state", "toml", "scene", "physics"},  # discs are placed by the nearest image's distance
    "engine": {"effects", "jit", "state", "initial", "physics"},
    "log": {"jit", "state", "toml", "initial", "scene", "physics"},  # states between two events are free flight
    "run": {"effects", "jit", "state", "toml", "scene", "physics", "initial", "engine", "log"},
    "theory": {"state", "scene", "physics"},
    "statistics": {"jit", "theory"},
    "presentation": {"statistics"},
    "tallies": {"jit", "state", "scene", "physics", "initial", "log", "theory", "statistics", "presentation"},
    "analysis": {"jit", "state", "scene", "physics", "initial", "log", *ROOMS},
    "movie": {"state", "scene", "log", "analysis", *ROOMS},
    "report": {"state", "scene", "log", "analysis", *ROOMS, "movie", "examples"},
    "sweep": {"jit", "toml", "scene", "initial", "run", "log", "analysis", *ROOMS},
    "accuracy": {"effects", "state", "toml", "scene", "physics", "initial", "engine", "log", "run", "analysis", *ROOMS},
    "bench": {"effects", "state", "toml", "scene", "physics", "initial", "engine", "log", "run", "analysis", *ROOMS},
    "examples": {"scene"},
    "gallery": {"examples", "initial", "log", "analysis", *ROOMS, "movie", "report"},
    "_version": set(),
    "errors": set(),
    "catalogue": set(),
    "columns": set(),
    "fields": set(),
    "files": set(),
    "locks": set(),
    "pairs": set(),
    "system": set(),
    "": {"scene", "log", "run", "analysis", "movie", "report", "sweep", "accuracy", "examples"},  # when it is asked for
    "__main__": set(),
}

OF_COMMANDS = {"idealgas.__main__"}
"""What of the package may import the commands: `python -m idealgas` is one."""

WITHIN_ANALYSIS = {
    "analysis": {"caveats", "result"},
    "caveats": {"result"},
    "check": set(),
    "result": set(),
    "registry": {"analysis", "result"},
}
"""What parts of the analyses may import of each other: every analysis these two, and what is named in FROM_ANALYSES."""

FROM_ANALYSES = {"escape": {"effusion"}, "heat_capacity": {"pressure"}, "status": {"pressure"}, "info": {"registry"}}

COMPUTES = {"fractions", "idealgas", "math", "operator", "typing", "collections", "enum", "numpy", "numba"}
"""All that the laws of physics need."""


def modules() -> dict[str, Path]:
    """Every module by its installed name."""
    result = {}
    for folder, package in (("idealgas", "idealgas"), ("cli", "idealgas_cli")):
        for path in sorted((ROOT / folder).rglob("*.py")):
            parts = (package, *path.relative_to(ROOT / folder).with_suffix("").parts)
            result[".".join(parts[:-1] if parts[-1] == "__init__" else parts)] = path
    return result


MODULES = modules()


def imports(name: str) -> set[str]:
    """Names that a module imports, anywhere in it, for types as well; of the package its modules only."""
    path = MODULES[name]
    package = name if path.name == "__init__.py" else name.rpartition(".")[0]
    result = set()
    for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
        if isinstance(node, ast.Import):
            result |= {alias.name for alias in node.names}
        elif isinstance(node, ast.ImportFrom):
            above = package.split(".")[: len(package.split(".")) - node.level + 1] if node.level else []
            module = ".".join([*above, *([node.module] if node.module else [])])
            for alias in node.names:
                inner = f"{module}.{alias.name}"
                result.add(inner if inner in MODULES else module)
    return result - {name}


GRAPH = {name: {other for other in imports(name) if other in MODULES} for name in MODULES}
PACKAGE = [name for name in MODULES if name.split(".")[0] == "idealgas"]


def part(name: str, depth: int = 1) -> str:
    """scene for idealgas.scene.scene; nothing for the package itself."""
    parts = name.split(".")
    return parts[depth] if len(parts) > depth else ""


def packages(name: str) -> set[str]:
    """The packages that a module is in, which are imported before it."""
    parts = name.split(".")
    return {".".join(parts[:depth]) for depth in range(1, len(parts))}


def test_no_file_imports_in_a_circle():
    whole = {name: others.union(*map(packages, others)) - packages(name) - {name} for name, others in GRAPH.items()}
    order = list(TopologicalSorter(whole).static_order())  # CycleError names the circle
    assert set(order) == set(MODULES)


@pytest.mark.parametrize("name", PACKAGE)
def test_the_package_imports_one_way(name):
    own = part(name)
    assert own in ALLOWED, "a new part: say what it may import"
    used = {part(other) for other in GRAPH[name] if other.split(".")[0] == "idealgas"}
    assert used - {own} - FREE <= ALLOWED[own]
    commands = [other for other in imports(name) if other.split(".")[0] in ("cli", "idealgas_cli")]
    assert not commands or name in OF_COMMANDS


@pytest.mark.parametrize("name", [name for name in PACKAGE if part(name) == "analysis" and part(name, 2)])
def test_analyses_stand_side_by_side(name):
    own = part(name, 2)
    used = {part(other, 2) for other in GRAPH[name] if part(other) == "analysis"} - {own, ""}
    common = WITHIN_ANALYSIS.get(own, {"analysis", "caveats", "check", "result"})
    assert used <= common | FROM_ANALYSES.get(own, set())


@pytest.mark.parametrize("name", [name for name in PACKAGE if part(name) == "physics"])
def test_physics_only_computes(name):
    assert {other.split(".")[0] for other in imports(name)} <= COMPUTES


@pytest.mark.parametrize("name", [name for name in MODULES if name.startswith("idealgas_cli.")])
def test_commands_use_what_is_public(name):
    used = {part(other) for other in GRAPH[name] if other.split(".")[0] == "idealgas"}
    assert used <= FREE | {
        *ROOMS, "toml", "effects", "scene", "initial", "run", "log", "analysis", "report", "movie", "sweep", "accuracy",
        "bench", "examples", "gallery",
    }  # fmt: skip
