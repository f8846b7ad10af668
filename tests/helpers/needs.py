"""What some tests need that a machine may lack: there, `pytest.mark.needs(name)` deselects them."""

import os
import shutil
import subprocess
import sys
import tempfile
from functools import cache, partial
from importlib.util import find_spec
from pathlib import Path

import numpy as np
import pytest

ROOT = Path(__file__).parents[2]
AXE = ROOT / "tests" / "dev" / "node_modules" / "axe-core" / "axe.min.js"


PACKAGES = {
    "chromium": "chromium",
    "chromedriver": "chromium-driver",
    "h5dump": "hdf5-tools",
    "ffmpeg": "ffmpeg",
    "cc": "gcc",
}
"""Programs beside Python that tests use, and what Debian packs them in."""


def _may_mount() -> bool:
    """Whether this user may mount a disk in memory."""
    with tempfile.TemporaryDirectory() as folder:
        mounted = subprocess.run(["mount", "-t", "tmpfs", "tmpfs", folder], capture_output=True).returncode == 0
        return mounted and subprocess.run(["umount", folder]).returncode == 0


def _is_installed(name: str) -> bool:
    """Whether a program is installed; where all must be, ALL_PROGRAMS, tests fail without it."""
    return bool(os.environ.get("ALL_PROGRAMS") or shutil.which(name))


NEEDS = {
    "an interpreted engine": lambda: os.environ.get("NUMBA_DISABLE_JIT", "0") not in ("", "0"),
    "Linux": lambda: sys.platform == "linux",
    "POSIX": lambda: os.name == "posix",
    "root": lambda: os.name == "posix" and os.geteuid() == 0,
    "a disk to mount": lambda: sys.platform == "linux" and _may_mount(),
    "/dev/full": lambda: Path("/dev/full").exists(),
    "extended precision": lambda: np.finfo(np.longdouble).nmant >= 63,
    "a clone": lambda: (ROOT / ".git").exists(),
    **{name: partial(_is_installed, name) for name in PACKAGES},
    "axe-core": AXE.exists,
    "OVITO": lambda: find_spec("ovito") is not None,
    "mkdocs": lambda: find_spec("mkdocstrings_handlers") is not None,
}
"""By name, whether it is here."""

OF_FIXTURES = {"browser": ("chromium", "chromedriver"), "library": ("cc",)}
"""What tests need that use a fixture of this name."""

posix = pytest.mark.needs("POSIX")
linux = pytest.mark.needs("Linux")
root = pytest.mark.needs("root")


def program(name: str) -> str:
    """Return the path of an installed program; fails the test where it is absent."""
    path = shutil.which(name)
    if path is None:
        pytest.fail(f"no {name}: apt-get install {PACKAGES[name]}")
    return path


@cache
def is_here(name: str) -> bool:
    """Whether what a test needs is here."""
    return NEEDS[name]()


def has_all(item: pytest.Item) -> bool:
    """Whether all that a test needs is here."""
    by_mark = [mark.args[0] for mark in item.iter_markers("needs")]
    by_fixture = [name for fixture in getattr(item, "fixturenames", ()) for name in OF_FIXTURES.get(fixture, ())]
    return all(map(is_here, by_mark + by_fixture))
