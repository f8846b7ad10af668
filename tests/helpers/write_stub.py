"""Writes the stub by which type checkers know the names of the package, those of analyses included."""

import idealgas
from helpers.support import ROOT
from idealgas.analysis import registry

STUB = ROOT / "idealgas" / "__init__.pyi"


def stub() -> str:
    """Text of the stub: an import for each name of the package."""
    homes = {name: home for home, names in idealgas._HOMES.items() for name in names} | {
        "__version__": "idealgas._version"
    }
    homes |= {name: registry.find(name).measure.__module__ for name in registry.names()}
    lines = sorted(f"from {home} import {name} as {name}" for name, home in homes.items())
    return "\n".join(['"""Names of the package; written by tests/helpers/write_stub.py."""', "", *lines, ""])


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
