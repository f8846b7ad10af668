"""Whole logs compared, dataset by dataset; and scenes for them, shipped ones with snapshots and an end of their own."""

from collections.abc import Sequence
from pathlib import Path

import h5py
import numpy as np

from helpers.support import ROOT
from idealgas.log import open_log
from idealgas.log.summary import Summary
from idealgas.run.resume import STOP_RULES, resume
from idealgas.run.simulate import simulate
from idealgas.scene import Scene, load_scene

OWN = {"seconds", "compile_seconds", "threads", "threads_reason", "shared_slices", "aborted_slices"}
"""What a summary tells of the way a run was computed."""

NO_END = tuple(f"run.{name}=" for name in STOP_RULES)


def scene_of(name: str, *overrides: str) -> Scene:
    """A shipped scene that ends by the overrides only."""
    return load_scene(ROOT / "configs" / f"{name}.toml", [*NO_END, *overrides])


def contents(path: Path) -> dict[str, np.ndarray | str | dict]:
    """Everything that does not tell of the writing: runs, commits, the seconds it took and the threads."""
    with open_log(path) as log:
        summary = {name: value for name, value in log.summary.items() if name not in OWN}
        result: dict[str, np.ndarray | str | dict] = {"summary": summary, "scene": log.scene_text}
        rows = len(log)

    def keep(name: str, item: object) -> None:
        if isinstance(item, h5py.Dataset) and name.partition("/")[0] not in ("runs", "commit", "summary"):
            result[name] = item[:rows] if name.startswith("events/") else item[()]

    with h5py.File(path) as file:
        file.visititems(keep)
    return result


def differences(each: Path, other: Path) -> list[str]:
    """Names of what is not equal bit for bit in two logs."""
    a, b = contents(each), contents(other)
    assert a.keys() == b.keys()
    return [name for name in a if not _equal(a[name], b[name])]


def _equal(a: np.ndarray | str | dict, b: np.ndarray | str | dict) -> bool:
    """Whether two values are equal, also where they are nan."""
    return np.array_equal(a, b, equal_nan=isinstance(a, np.ndarray) and a.dtype.kind == "f")


def same_by_brute_force_and_resumed(folder: Path, path: Path, overrides: Sequence[str], *ends: str) -> Summary:
    """Run a scene to `whole.h5`, by brute force and in pieces: the same log, and no energy unaccounted for.

    ends: overrides at which the run in pieces ends before its own end.
    """
    whole, oracle, resumed = (folder / name for name in ("whole.h5", "oracle.h5", "resumed.h5"))
    scene = load_scene(path, overrides)
    own_end = [f"run.{name}={'' if (end := getattr(scene.run, name)) is None else end}" for name in STOP_RULES]
    summary = simulate(scene, whole)
    simulate(load_scene(path, [*overrides, "run.method=brute_force"]), oracle)
    simulate(load_scene(path, [*overrides, ends[0]]), resumed)
    for end in (*([end] for end in ends[1:]), own_end):
        resume(resumed, end)
    assert differences(resumed, whole) == []
    with open_log(whole) as log, open_log(oracle) as oracle_log:
        columns = list(zip(log.chunks(), oracle_log.chunks(), strict=True))
        assert all(np.array_equal(getattr(a, name), getattr(b, name)) for a, b in columns for name in log.columns)
    assert abs(summary.energy_drift) < 1e-12
    return summary
