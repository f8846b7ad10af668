"""Exact event-driven simulation of a two-dimensional gas of hard discs, with a log of every event.

    import idealgas

    scene = idealgas.load_scene("configs/quickstart.toml", ["run.until=20"])
    summary = idealgas.simulate(scene, "run.h5")
    print(summary.events, summary.energy_drift)
    with idealgas.open_log("run.h5") as log:
        result = idealgas.pressure(log)  # or analyse(log, "pressure")
        for route in result.routes:
            print(route.name, route.compressibility_factor.value, route.compressibility_factor.standard_error)
        print(log.to_pandas("events", disc=0))

`load_scene`, `load_example` and `parse_scene` return a `Scene`. `simulate` runs a scene and writes a log, and `resume`
continues a run; both return a `Summary`. `open_run` starts a run that a program advances and steers.

`open_log` opens a `Log` for reading. Each analysis is a function, such as `pressure`; `analyse` runs an analysis given
by name, and `combine` combines the results of an analysis from several logs. Analyses, `write_report`, `animate` and
`export` accept a log or the path of a log. `load_sweep` reads a sweep, and `run_sweep` runs it.

Results are dataclasses with the methods `as_dict()`, which returns plain values for JSON, `tables()`, and `plot()`,
which returns a matplotlib figure; notebooks show their tables. A measured number is an `Estimate`, a value with its
standard error. An error that a user can correct is a `UserError` with a one-line message; `SceneError`, `LogError` and
`OutputError` are derived from it.

Lengths, times and masses are in arbitrary units, and Boltzmann's constant is 1. Each name is imported when it is first
used, so that `import idealgas` itself is fast. If idealgas is imported before NumPy, the linear algebra of NumPy and
SciPy uses one thread, unless the environment variable OPENBLAS_NUM_THREADS specifies another number.
"""

import os
from functools import cache
from importlib import import_module
from typing import Any

from idealgas._version import __version__

os.environ.setdefault("OPENBLAS_NUM_THREADS", "1")  # waiting threads would spin for longer than small products take

_HOMES = {
    "idealgas.accuracy.study": ("study_accuracy",),
    "idealgas.tallies.tangent_space": ("sensitivity",),
    "idealgas.statistics.estimates": ("Estimate",),
    "idealgas.analysis.registry": ("analyse", "combine"),
    "idealgas.errors": ("OutputError", "UserError"),
    "idealgas.columns": ("EventBatch", "Kind"),
    "idealgas.examples": ("load_example",),
    "idealgas.log": ("Log", "LogError", "LogState", "open_log"),
    "idealgas.log.export.export": ("export",),
    "idealgas.movie.film": ("animate",),
    "idealgas.report.page": ("write_report",),
    "idealgas.run.resume": ("resume",),
    "idealgas.log.summary": ("Summary",),
    "idealgas.run.logged_run": ("Progress",),
    "idealgas.run.simulate": ("open_run", "simulate"),
    "idealgas.scene": ("Scene", "SceneError", "load_scene", "parse_scene"),
    "idealgas.sweep.plan": ("load_sweep",),
    "idealgas.sweep.run": ("run_sweep",),
}
"""Modules of all names that are not analyses; the analyses are in the registry."""

__all__ = ["__version__", *sorted(name for names in _HOMES.values() for name in names)]  # and all analyses


def __getattr__(name: str) -> Any:
    """Return the object with this name; it is imported when it is first used (PEP 562)."""
    for home, names in _HOMES.items():
        if name in names:
            globals()[name] = value = getattr(import_module(home), name)
            return value
    from idealgas.analysis import registry

    if name not in registry.names():
        raise AttributeError(f"module {__name__!r} has no attribute {name!r}")
    return _function(name)


@cache
def _function(name: str) -> Any:
    """Return the function that runs an analysis, always the same object."""
    from idealgas.analysis import registry

    return registry.find(name).function()


def __dir__() -> list[str]:
    """Return all names of the interface, including the analyses in the registry."""
    from idealgas.analysis import registry

    return sorted({*__all__, *registry.names()})
