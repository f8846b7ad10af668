"""Event logs that stay as they are, bit for bit: `cases/golden/digests.json` has a digest of every event column.

A log may be resumed by every program of its trajectory version, so a scene's log keeps every bit until that version
changes. Once TRAJECTORY has been raised, this makes new digests of the scenes whose logs have changed; the others keep
the version since which they are as they are:

    PYTHONPATH=tests python tests/stability/test_golden_logs.py

They hold on every machine with IEEE doubles: the laws take their functions from `idealgas.physics.elementary`. Two uses
of the C library are left: `hypot` for the lengths of walls, and numpy's normal distribution of velocities at the start,
which takes an exponential to accept a draw, where a last bit hardly ever decides, and a logarithm in the tail (beyond
3.65), where no draw of these seeds lies.
"""

import json
import tempfile
from contextlib import nullcontext
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from helpers.support import output_of, uncompiled

from idealgas import open_log
from idealgas.log.digest import column_digests

FOLDER = Path(__file__).parents[1] / "cases" / "golden"
DIGESTS = FOLDER / "digests.json"
COMMAND = "PYTHONPATH=tests python tests/stability/test_golden_logs.py"
SCENES = sorted(path.stem for path in FOLDER.glob("*.toml"))
UNCOMPILED = (
    "absorbing", "chute", "fixed-discs", "gravity-in-steps", "noninteracting", "permeable", "resting", "steps",
    "thermal", "thermostat", "vibrating", "vibrating-sine",
)  # fmt: skip
"""Scenes of few events, or with effects that few tests have: in Python they take less time, and give the same bits."""


def digests_of(scene: str, folder: Path, *overrides: str) -> dict[str, Any]:
    """Trajectory version, number of event rows, and digest of each event column of a run."""
    path = folder / f"{scene}.h5"
    settings = [argument for override in overrides for argument in ("--set", override)]
    output_of("run", FOLDER / f"{scene}.toml", "-o", path, *settings)
    with h5py.File(path) as file:
        version = int(file["versions"].attrs["trajectory"])
    with open_log(path) as log:
        return {"trajectory": version, "rows": len(log), "columns": column_digests(log)}


def complaint(scene: str, result: dict[str, Any], expected: dict[str, Any]) -> str:
    """What to tell of a log that is not the one on record; empty if it is."""
    version, recorded = result["trajectory"], expected["trajectory"]
    names = sorted(result["columns"].keys() | expected["columns"].keys())
    changed = [name for name in names if result["columns"].get(name) != expected["columns"].get(name)]
    if version >= recorded and not changed and result["rows"] == expected["rows"]:
        return ""
    if version != recorded:
        return f"{scene}: trajectory version {version}, digests of version {recorded}: make new ones with {COMMAND}"
    rows = f"{result['rows']} rows, {expected['rows']} on record"
    rule = f"a changed digest needs a new trajectory version, and TRAJECTORY is still {version}"
    return f"{scene}: {', '.join(changed)}: not the column on record ({rows}); {rule}"


def on_record() -> dict[str, Any]:
    return json.loads(DIGESTS.read_text())


def test_every_scene_is_on_record():
    assert sorted(on_record()) == SCENES


@pytest.mark.parametrize("scene", SCENES)
def test_every_column_is_the_one_on_record(scene, tmp_path):
    with uncompiled() if scene in UNCOMPILED else nullcontext():
        said = complaint(scene, digests_of(scene, tmp_path), on_record()[scene])
    assert not said, said


@pytest.mark.slow
@pytest.mark.parametrize("scene", UNCOMPILED)
def test_compiled_code_gives_the_same_log(scene, tmp_path):
    said = complaint(scene, digests_of(scene, tmp_path), on_record()[scene])
    assert not said, said


def test_brute_force_gives_the_same_log(tmp_path):
    said = complaint("plain", digests_of("plain", tmp_path, "run.method=brute_force"), on_record()["plain"])
    assert not said, said


def test_a_change_of_one_bit_is_told_by_scene_and_column(tmp_path, monkeypatch):
    result = digests_of("explicit", tmp_path)
    expected = on_record()["explicit"]
    now = {"trajectory": expected["trajectory"]}
    with open_log(tmp_path / "explicit.h5") as log:
        *others, last = log.chunks(log.columns)
        velocity = last.velocity.copy()
        velocity[-1, 1] = np.nextafter(velocity[-1, 1], np.inf)
        monkeypatch.setattr(log, "chunks", lambda _: [*others, last._replace(velocity=velocity)])
        other = result | {"columns": column_digests(log)}
    said = complaint("explicit", other | now, expected)
    assert said.startswith("explicit: velocity: not the column on record")
    assert "needs a new trajectory version" in said
    later, before = ({"trajectory": expected["trajectory"] + step} for step in (1, -1))
    assert complaint("explicit", result | now, expected) == complaint("explicit", result | later, expected) == ""
    assert "make new ones" in complaint("explicit", other | later, expected)
    assert "make new ones" in complaint("explicit", result | before, expected)


def write_digests() -> None:
    """Run every scene and put the digests on record of those that are new or have changed."""
    recorded = on_record()
    with tempfile.TemporaryDirectory() as folder:
        made = {scene: digests_of(scene, Path(folder)) for scene in SCENES}
    kept = {
        name: recorded[name] for name in SCENES if name in recorded and not complaint(name, made[name], recorded[name])
    }
    DIGESTS.write_text(json.dumps(made | kept, indent=1) + "\n")


if __name__ == "__main__":
    write_digests()
