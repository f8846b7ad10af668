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
    lines = [f"from {home} import {name} as {name}" for name, home in homes.items()]
    lines.append("from idealgas.log import takes_path")
    functions = []
    for analysis in map(registry.find, registry.names()):
        lines.append(f"from {analysis.__module__} import {analysis.__name__}")
        functions.append(f"{analysis.name} = takes_path({analysis.__name__}.measure)")
    head = '"""Names of the package; written by tests/helpers/write_stub.py."""'
    return "\n".join([head, "", *sorted(lines), "", *functions, ""])


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
