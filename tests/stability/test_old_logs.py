"""Logs of formats 1 and 2, most of trajectory version 3, as they were once written: every reading command gives the
numbers that it gave then, and a log that is resumed comes to the same events.

`cases/logs` has them packed (xz), as most of a small log is room for more: a run that was killed and one that was
interrupted, all effects at once with thermal walls and, as `effects`, without, Monte Carlo, snapshots, no events, and
the kicks of a heat bath (format 2, trajectory 4). Each has its scene in it. NAME.json has what the commands said, and
resumed.json digests of what runs without a break wrote. Where an analysis is to give other numbers, this puts the new
ones on record:

    python tests/stability/test_old_logs.py

Some defaults are others since trajectory version 4. `cases/logs/defaults` has logs of version 3 that had the old ones,
and digests of what version 3 wrote in runs without a break: they go on with the values that they began with.

New formats get logs of their own; these are never written again. What thermal walls emit and a heat bath gives goes
through the logarithm of the C library, so of such a log no digest is on record: it is compared with a run on this
machine. For the other digests see test_golden_logs.py.
"""

import contextlib
import hashlib
import json
import lzma
import math
import re
import shlex
import tempfile
from collections.abc import Callable
from pathlib import Path
from typing import Any

import h5py
import numpy as np
import pytest
from click.testing import CliRunner
from idealgas_cli.main import main
from PIL import Image

from idealgas import open_log, parse_scene

FOLDER = Path(__file__).parents[1] / "cases" / "logs"
RESUMED = FOLDER / "resumed.json"
DEFAULTS = FOLDER / "defaults"
PACKED = ".h5.xz"
LOGS = sorted(path.name.removesuffix(PACKED) for path in FOLDER.glob(f"*{PACKED}"))

EVERYWHERE = (
    "info --json",
    "histogram --quantity speed --json",
    "histogram --quantity wait --json",
    "temperature --json",
    "pressure --json",
    "transport --json",
    "profile --json",
    "evolution --json",
    "relaxation --json",
    "heat-capacity --json",
    "effusion --json",
    "follow --once",
    "export --format csv --events -o events.csv",
    "export --format csv --frames 5 -o frames.csv",
)
BESIDE = {
    "plain": (
        *(f"histogram --quantity {name} --json" for name in ("vx", "vy", "energy", "free-path", "free-time")),
        "pressure --from 2 --to 12 --json",
    ),
    "monte-carlo": ("relaxation --every 500 --json",),
    "effects": ("report -o page.html",),
    "killed": ("report -o page.html", "recover -o whole.h5"),
    "no-events": ("report -o page.html",),
    "gate": ("animate -o film.gif --to 1 --fps 5 --size 320x240",),
}
"""Commands for single logs, beside EVERYWHERE."""

ENDS = {
    "effects": "--events 800",
    "gate": "--until 18",
    "interrupted": "",
    "killed": "",
    "monte-carlo": "--trials 4500",
    "no-events": "--events 6000",
    "plain": "--events 900",
    "rough": "--events 600",
    "snapshots": "--until 22",
}
"""How each log is resumed; those that were left unfinished go to the end that their scene has."""
BATHS = {"heat-bath": "--until 80", "kicks": "--events 1800"}
"""The same of logs in which logarithms of the C library are."""
RULES = ("until", "events", "collisions_per_disc", "trials")

DIGITS = 15
RELATIVE, ABSOLUTE = 1e-12, 1e-14  # of numbers; the second for those that are zero but for rounding


def commands(log: str) -> tuple[str, ...]:
    return *EVERYWHERE, *BESIDE.get(log, ())


def unpack(folder: Path) -> None:
    """Put every log into a folder as it was written."""
    for log in LOGS:
        (folder / f"{log}.h5").write_bytes(lzma.decompress((FOLDER / f"{log}{PACKED}").read_bytes()))


def outcome(log: str, command: str) -> dict[str, Any]:
    """Exit code of a command on a log in the current folder, and its result in the form that is compared."""
    name, *arguments = shlex.split(command)
    said = CliRunner().invoke(main, [name, f"{log}.h5", *arguments])
    if said.exception is not None and not isinstance(said.exception, SystemExit):
        raise said.exception
    if said.exit_code:
        return {"exit": said.exit_code}
    if "--json" in arguments:
        return {"exit": 0, "result": json.loads(said.stdout)}
    found: dict[str, Any] = {"exit": 0, "numbers": re.findall(r"-?\d[\d.,]*(?:e[-+]\d+)?", said.stdout)}
    if "-o" in arguments:
        written = Path(arguments[arguments.index("-o") + 1])
        found["written"] = WRITTEN[written.suffix](written)
        written.unlink()
    return found


def frames(path: Path) -> dict[str, Any]:
    """Number and size of the pictures of a film."""
    with Image.open(path) as film:
        return {"frames": film.n_frames, "size": list(film.size)}


def rows(path: Path) -> int:
    """Event rows of a log."""
    with open_log(path) as log:
        return len(log)


WRITTEN: dict[str, Callable[[Path], Any]] = {
    ".csv": lambda path: hashlib.sha256(path.read_bytes()).hexdigest(),
    ".gif": frames,
    ".h5": rows,
    ".html": lambda path: dict.fromkeys(re.findall("<h[12]>([^<]+)", path.read_text()), True),
}
"""What of a file that a command wrote is compared, by its ending."""


def rounded(value: Any) -> Any:
    """A result with no more digits than are compared."""
    if isinstance(value, float):
        return float(f"{value:.{DIGITS}g}")
    if isinstance(value, list):
        return [rounded(item) for item in value]
    return {key: rounded(item) for key, item in value.items()} if isinstance(value, dict) else value


def differences(found: Any, recorded: Any, place: str = "") -> list[str]:
    """Where a result is not what is on record; it may have more keys."""
    if isinstance(recorded, dict) and isinstance(found, dict):
        missing = [f"{place}.{key}: missing" for key in recorded.keys() - found.keys()]
        shared = (key for key in recorded if key in found)
        return missing + [line for key in shared for line in differences(found[key], recorded[key], f"{place}.{key}")]
    if isinstance(recorded, list) and isinstance(found, list) and len(found) == len(recorded):
        pairs = enumerate(zip(found, recorded, strict=True))
        return [line for i, (one, other) in pairs for line in differences(one, other, f"{place}[{i}]")]
    if type(recorded) is float and type(found) in (int, float):
        same = math.isclose(found, recorded, rel_tol=RELATIVE, abs_tol=ABSOLUTE)
    else:
        same = type(found) is type(recorded) and found == recorded
    return [] if same else [f"{place}: {found!r}, {recorded!r} on record"]


SUMS = {f"checkpoints/{name}" for name in ("wall_energy", "wall_energy_sum", "dissipated_energy_sum")}
"""Energies that are added up differently than when these logs were written."""


def stored_digests(path: Path) -> dict[str, str]:
    """Digest of each dataset of events, checkpoints and snapshots, without SUMS; event times of Monte Carlo as f4."""
    found = {}

    def keep(name: str, item: object) -> None:
        table = name.split("/")[0]
        if isinstance(item, h5py.Dataset) and table in ("events", "checkpoints", "particles") and name not in SUMS:
            values = item[()].astype("f4") if name == "events/time" and without_positions else item[()]
            found[name] = hashlib.sha256(values.astype(values.dtype.newbyteorder("<")).tobytes()).hexdigest()

    with h5py.File(path) as file:
        without_positions = "events/trial" in file
        file.visititems(keep)
    return found


def run_without_a_break(log: str, end: str) -> Path:
    """A new run of a log's scene, to another end unless that is empty."""
    scene, path = Path(f"{log}.toml"), Path(f"{log}-whole.h5")
    with open_log(f"{log}.h5") as old:
        scene.write_text(old.scene_text)
    rule, _, value = end.removeprefix("--").partition(" ")
    changes = [*(f"run.{name}=" for name in RULES), f"run.{rule}={value}"] if end else []
    settings = [argument for change in changes for argument in ("--set", change)]
    ran = CliRunner().invoke(main, ["run", str(scene), "-o", str(path), *settings])
    assert ran.exit_code == 0, ran.output
    return path


def resume(log: str, end: str) -> Path:
    path = Path(f"{log}.h5")
    ran = CliRunner().invoke(main, ["resume", str(path), *shlex.split(end)])
    assert ran.exit_code == 0, ran.output
    return path


@pytest.fixture(scope="module")
def unpacked(tmp_path_factory):
    folder = tmp_path_factory.mktemp("logs")
    unpack(folder)
    return folder


@pytest.fixture
def own(tmp_path, monkeypatch):
    """A folder of a test's own, the current one, with all logs."""
    unpack(tmp_path)
    monkeypatch.chdir(tmp_path)
    return tmp_path


def on_record(log: str) -> dict[str, Any]:
    return json.loads((FOLDER / f"{log}.json").read_text())


@pytest.mark.parametrize("log", LOGS)
def test_every_command_is_on_record(log):
    assert tuple(on_record(log)) == commands(log)


@pytest.mark.parametrize(("log", "command"), [(log, command) for log in LOGS for command in commands(log)])
def test_same_numbers(log, command, unpacked, monkeypatch):
    monkeypatch.chdir(unpacked)
    assert differences(outcome(log, command), on_record(log)[command]) == []


@pytest.mark.parametrize("log", sorted(ENDS))
def test_resumed_to_the_same_events(log, own):
    assert stored_digests(resume(log, ENDS[log])) == json.loads(RESUMED.read_text())[log]


@pytest.mark.parametrize("log", BATHS)
def test_with_heat_resumed_to_the_same_events(log, own):
    """With the logarithm of another C library, what discs get at first is still the same but for rounding."""
    whole = run_without_a_break(log, BATHS[log])
    with h5py.File(f"{log}.h5") as old, h5py.File(whole) as new:
        rows = len(old["events/time"])
        stored, again = ({name: column[:rows] for name, column in file["events"].items()} for file in (old, new))
    for name, values in stored.items():
        np.testing.assert_allclose(again[name][:100], values[:100], rtol=1e-9, atol=1e-12, err_msg=name)
    if any(not np.array_equal(again[name], values) for name, values in stored.items()):
        pytest.skip("the logarithm of this C library differs in the last bit")
    assert stored_digests(resume(log, BATHS[log])) == stored_digests(whole)


@pytest.mark.parametrize(("log", "end"), [("resting", "--events 4000"), ("monte-carlo", "--trials 4500")])
def test_resumed_with_the_defaults_of_before(log, end, tmp_path):
    path = tmp_path / f"{log}.h5"
    path.write_bytes(lzma.decompress((DEFAULTS / f"{log}{PACKED}").read_bytes()))
    with open_log(path) as old:
        before = old.scene
        default = parse_scene(re.sub("contact_duration = .*", "", old.scene_text))
    ran = CliRunner().invoke(main, ["resume", str(path), *shlex.split(end)])
    assert ran.exit_code == 0, ran.output
    assert stored_digests(path) == json.loads((DEFAULTS / "resumed.json").read_text())[log]
    with open_log(path) as new:
        assert new.attributes["trajectory"] == 3
        assert new.scene.restitution == before.restitution
        assert "v_ref" not in new.observables
    if log == "resting":
        assert before.restitution.contact_duration < 1e-6 < 0.01 < default.restitution.contact_duration


@pytest.mark.parametrize("log", ["effects", "interrupted"])
def test_energies_go_on_as_floats(log, own):
    """What walls gave, in the samples and in the checkpoints of a resumed log, is that of a run of its scene."""
    whole = run_without_a_break(log, ENDS[log])
    with open_log(resume(log, ENDS[log])) as old, open_log(whole) as new:
        time, given = old.observables["wall_energy"]
        assert np.array_equal(time, new.observables["wall_energy"][0])
        assert given == pytest.approx(new.observables["wall_energy"][1], rel=1e-12, abs=1e-12 * np.abs(given).max())
        at = np.searchsorted(time, old.checkpoints[-1].time, "right") - 1
        assert np.array_equal(old.checkpoints[-1].arrays["wall_energy"], given[at])
        assert given.any()
        assert "dissipated_energy" not in old.observables
        assert abs(new.summary["energy_drift"]) < 1e-12
        assert old.summary["energy_drift"] in (None, pytest.approx(0.0, abs=1e-12))


def test_a_difference_is_found():
    recorded = {"a": [1.0, {"b": 2}], "c": "x", "d": True}
    assert differences(recorded | {"new": 1}, recorded) == []
    assert differences({"a": [1.0 + 1e-11, {"b": 2}], "c": "x", "d": True}, recorded) == [
        ".a[0]: 1.00000000001, 1.0 on record"
    ]
    assert differences({"a": [1.0, {"b": 3}], "c": "y", "d": 1}, recorded) == [
        ".a[1].b: 3, 2 on record",
        ".c: 'y', 'x' on record",
        ".d: 1, True on record",
    ]
    assert differences({"a": [1.0], "d": True}, recorded)[0] == ".c: missing"


def write_records() -> None:
    """Put on record what the commands say of each log, and the digests of runs to the ends of those resumed."""
    with tempfile.TemporaryDirectory() as folder, contextlib.chdir(folder):
        unpack(Path(folder))
        for log in LOGS:
            said = {command: rounded(outcome(log, command)) for command in commands(log)}
            lines = (f"{json.dumps(name)}: {json.dumps(each, separators=(',', ':'))}" for name, each in said.items())
            (FOLDER / f"{log}.json").write_text("{\n" + ",\n".join(lines) + "\n}\n")
        made = {log: stored_digests(run_without_a_break(log, end)) for log, end in ENDS.items()}
    RESUMED.write_text(json.dumps(made, indent=1) + "\n")


if __name__ == "__main__":
    write_records()
