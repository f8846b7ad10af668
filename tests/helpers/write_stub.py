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
    functions = []
    for analysis in map(registry.find, registry.names()):
        if analysis.measure.__name__ == analysis.name:
            homes[analysis.name] = analysis.measure.__module__
        else:
            functions.append(f"{analysis.name} = {analysis.__name__}.measure")
    lines = [f"from {home} import {name} as {name}" for name, home in homes.items()]
    lines += [f"from {registry.find(line.split()[0]).__module__} import {line.split()[2][:-8]}" for line in functions]
    head = '"""Names of the package; written by tests/helpers/write_stub.py."""'
    return "\n".join([head, "", *sorted(lines), "", *functions, ""])


if __name__ == "__main__":
    STUB.write_text(stub(), encoding="utf-8")
