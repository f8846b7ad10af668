"""Which sources the machine code of the package's own entry points depends on, against two other ways to find them."""

import ast
import importlib
import sys
from pathlib import Path
from types import FunctionType, ModuleType

import pytest
from support import ROOT

from idealgas.jit import compiled_from

MODULES = [
    path.relative_to(ROOT).with_suffix("").as_posix().replace("/", ".")
    for path in sorted((ROOT / "idealgas").rglob("*.py"))
    if "\n@njit" in path.read_text(encoding="utf-8")
]
"""All with entry points."""


def functions(name):
    """A module's own functions, as they are in Python."""
    values = [getattr(value, "py_func", value) for value in vars(importlib.import_module(name)).values()]
    return [value for value in values if isinstance(value, FunctionType) and value.__module__ == name]


def used(function, seen):
    """Modules whose functions, classes or names a function uses, in turn; read off the objects themselves."""
    if function in seen:
        return
    seen.add(function)
    yield function.__module__
    for name in function.__code__.co_names:
        value = function.__globals__.get(name)
        value = getattr(value, "py_func", value)
        if isinstance(value, FunctionType):
            yield from used(value, seen)
        elif isinstance(value, type):
            yield value.__module__
        elif isinstance(value, ModuleType):
            yield value.__name__


@pytest.mark.parametrize("name", MODULES)
def test_all_that_a_function_uses_determines_its_machine_code(name):
    assert functions(name)
    for function in functions(name):
        assert {each for each in used(function, set()) if each.startswith("idealgas")} <= compiled_from(function).keys()


def named_in(node):
    """Imports below a node of a syntax tree, but for those for type checkers: the modules, each with a name or none."""
    if isinstance(node, ast.If) and "TYPE_CHECKING" in ast.unparse(node.test):
        children = node.orelse
    else:
        children = ast.iter_child_nodes(node)
    if isinstance(node, ast.Import):
        yield from ((alias.name, "") for alias in node.names)
    elif isinstance(node, ast.ImportFrom):
        yield from ((node.module, alias.name) for alias in node.names)
    for child in children:
        yield from named_in(child)


@pytest.mark.parametrize("name", MODULES)
def test_no_import_is_missed(name):
    """Held against the syntax trees of all sources."""
    sources = compiled_from(functions(name)[0])
    assert sources[name] == sys.modules[name].__file__
    for source in sources.values():
        for origin, taken in named_in(ast.parse(Path(source).read_text(encoding="utf-8"))):
            if origin.startswith("idealgas"):
                places = [ROOT.joinpath(*place.split(".")) for place in (f"{origin}.{taken}", origin)]
                files = [file for place in places for file in (place / "__init__.py", Path(f"{place}.py"))]
                assert str(next(file for file in files if file.is_file())) in sources.values()
