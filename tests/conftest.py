"""What is not here is deselected; case files as parameters: `invalid_case` and those of FOLDERS go through folders.

Hypothesis sets no deadlines: the first example of a test may have to compile.
"""

import os
from collections.abc import Iterator
from functools import cache
from pathlib import Path
from typing import Any, NamedTuple

import pytest
from helpers.needs import NEEDS, has_all, is_here
from helpers.support import uncompiled
from hypothesis import settings

settings.register_profile("no-deadline", deadline=None)
settings.load_profile("no-deadline")
os.environ.pop("COLUMNS", None)  # readline, which pytest imports, leaves it to the workers: tables are of full width

ROOT = Path(__file__).parent.parent
CASES = ROOT / "tests" / "cases"
FOLDERS = {"valid_case": CASES / "valid", "shipped_scene": ROOT / "configs"}


class InvalidCase(NamedTuple):
    """A scene and the lines it is refused with: its comments `# set: override` and `# expect: line, less the file`."""

    path: Path
    overrides: list[str]
    lines: list[str]


@cache
def lists_in_messages() -> dict[str, list[str]]:
    """Lists that grow with the package, by their names in the expected lines."""
    from idealgas.catalogue import commands
    from idealgas.effects import EFFECTS
    from idealgas.scene import Scene

    of_sheared = [effect.name for effect in EFFECTS if effect.shearable and effect.name != "sheared sides"]
    return {
        "tables": list(Scene.model_fields),
        "analyses": [f'"{name}"' for name in commands()],
        "effects of sheared gases": of_sheared,
    }


def read_invalid(path: Path) -> InvalidCase:
    comments = path.read_text(encoding="utf-8", errors="replace").splitlines()
    expected = [line.removeprefix("# expect: ") for line in comments if line.startswith("# expect: ")]
    for name, words in lists_in_messages().items():
        expected = [line.replace(f"{{{name}}}", ", ".join(words)) for line in expected]
    return InvalidCase(
        path,
        [line.removeprefix("# set: ") for line in comments if line.startswith("# set: ")],
        [line if line.startswith("--set ") else f"{path}:{line}" for line in expected],
    )


def pytest_generate_tests(metafunc: pytest.Metafunc) -> None:
    if "invalid_case" in metafunc.fixturenames:
        paths = sorted((CASES / "invalid").glob("*.toml"))
        metafunc.parametrize("invalid_case", [read_invalid(path) for path in paths], ids=[path.stem for path in paths])
    for name, folder in FOLDERS.items():
        if name in metafunc.fixturenames:
            paths = sorted(folder.glob("*.toml"))
            metafunc.parametrize(name, paths, ids=[path.stem for path in paths])


def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Deselect the tests that need what is not here."""
    absent = [item for item in items if not has_all(item)]
    config.hook.pytest_deselected(items=absent)
    items[:] = [item for item in items if item not in set(absent)]


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter) -> None:
    """Name in one line what is deselected."""
    lacking = ", ".join(name for name in NEEDS if not is_here(name))
    chosen = terminalreporter.config.option.markexpr
    terminalreporter.write_line(f"Selected: {chosen or 'all tests'}; deselected: those that need {lacking}.")


@pytest.fixture(name="uncompiled")
def run_uncompiled() -> Iterator[None]:
    with uncompiled():
        yield


@pytest.hookimpl(optionalhook=True)
def pytest_xdist_make_scheduler(config: pytest.Config, log: Any) -> Any:
    """Every worker sets out with tests that lie together, so that few fixtures and kernels are made twice."""
    from xdist.scheduler import WorkStealingScheduling

    return WorkStealingScheduling(config, log)
