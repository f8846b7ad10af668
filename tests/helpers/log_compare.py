"""Whole logs compared, dataset by dataset; and scenes for them, shipped ones with snapshots and an end of their own."""

from pathlib import Path

import h5py
import numpy as np

from helpers.support import ROOT
from idealgas.log import open_log
from idealgas.scene import Scene, load_scene

OWN = {"seconds", "compile_seconds", "threads", "threads_reason", "shared_slices", "aborted_slices"}
"""What a summary tells of the way a run was computed."""

NO_END = ("run.until=", "run.events=", "run.collisions_per_disc=", "run.trials=")


def scene_of(name: str, *overrides: str) -> Scene:
    """A shipped scene that ends by the overrides only."""
    return load_scene(ROOT / "configs" / f"{name}.toml", [*NO_END, *overrides])


def contents(path: Path) -> dict[str, np.ndarray | str | dict]:
    """Everything that does not tell of the writing: runs, commits, the seconds it took and the threads."""
    with open_log(path) as log:
        summary = {name: value for name, value in log.summary.items() if name not in OWN}
        found: dict[str, np.ndarray | str | dict] = {"summary": summary, "scene": log.scene_text}
        rows = len(log)

    def keep(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and name.partition("/")[0] not in ("runs", "commit", "summary"):
            found[name] = item[:rows] if name.startswith("events/") else item[()]

    with h5py.File(path) as file:
        file.visititems(keep)
    return found


def differences(one: Path, other: Path) -> list[str]:
    """Names of what is not equal bit for bit in two logs."""
    a, b = contents(one), contents(other)
    assert a.keys() == b.keys()
    return [name for name in a if not np.array_equal(a[name], b[name])]
