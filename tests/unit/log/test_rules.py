"""Crafted logs of the right structure whose numbers and texts break a rule: one line that names the dataset."""

import re
import shutil

import h5py
import numpy as np
import pytest
from helpers.crafted import craft, put, read_path, refused, swap
from helpers.log_compare import scene_of
from helpers.log_samples import BATH_VALUES, write_log

from idealgas.columns import BATH, Kind
from idealgas.log import LogError, open_log
from idealgas.run.simulate import simulate

STOP = 300


@pytest.fixture(scope="module")
def sound(tmp_path_factory):
    return write_log(tmp_path_factory.mktemp("log") / "sound.h5", STOP)


@pytest.fixture(scope="module")
def run(tmp_path_factory):
    path = tmp_path_factory.mktemp("log") / "run.h5"
    simulate(scene_of("quickstart", "run.events=3000"), path)
    return path


def cut(path, rows):
    """Fewer rows of a dataset that was stored before the run."""

    def edit(file):
        old = file[path][:rows]
        swap(path, data=old, chunks=old.shape, maxshape=old.shape)(file)

    return edit


def retyped(path, dtype):
    return lambda file: swap(path, data=file[path][()].astype(dtype))(file)


def chunked(path, rows):
    return lambda file: swap(path, chunks=(rows, *file[path].chunks[1:]))(file)


def texts(path, index, text):
    return put(path, index, np.bytes_(text))


def without(path):
    """Remove a dataset and its entry in the commit record."""

    def edit(file):
        names = [name for name in file["commit"].attrs["datasets"].tolist() if name != path.encode()]
        width = file["commit"].shape[1] - 1
        del file["commit"], file[path]
        commit = file.create_dataset("commit", (2, width), "u8", chunks=(1, width), fletcher32=True)
        commit.attrs["datasets"] = np.array(names)

    return edit


def many_discs(file):
    for name in ("id", "species", "radius", "mass", "position", "velocity"):
        old = file["discs"][name]
        shape = (10**7, *old.shape[1:])
        swap(f"discs/{name}", data=None, shape=shape, dtype=old.dtype, chunks=shape, maxshape=shape)(file)


NAN, INF = float("nan"), float("inf")
VALUES = {
    "disc N": (put("events/disc", 17, 25), "events/disc .*: 25 in row 17 .allowed 0 to 24"),
    "disc 4e9": (put("events/disc", 17, 4_000_000_000), "events/disc .*: 4e.09 in row 17"),
    "partner N": (put("events/partner", 17, 25), "events/partner .*: 25 in row 17 .allowed -4 to 24"),
    "heat bath": (put("events/partner", 17, BATH), "events/partner .*in row 17 .allowed -4 to 24"),
    "partner -2e9": (put("events/partner", 17, -2_000_000_000), "events/partner .*in row 17"),
    "wall W": (put("events/partner", 17, -5), "events/partner .*: -5 in row 17"),
    "pair of one": (put("events/partner", 17, 3), "events/partner: no pair in row"),
    "kind": (put("events/kind", 17, 4), "events/kind .*: THERMOSTAT in row 17, which this log cannot have"),
    "kind of a pair": (put("events/kind", 17, 0), "events/kind: disagrees with the partner in row 17"),
    "time nan": (put("events/time", 17, NAN), "events/time .*nan in row 17"),
    "time inf": (put("events/time", 299, INF), "events/time .*inf in row 299"),
    "time tiny": (put("events/time", slice(0, 2), [0.0, 1e-310]), "events/time .*1e-310 in row 1 .allowed 0 or >="),
    "time negative": (put("events/time", 0, -1.0), "events/time .*-1 in row 0"),
    "time falls": (put("events/time", 17, 0.0), "events/time .*decreases in row 17"),
    "velocity nan": (put("events/velocity", (17, 1), NAN), "events/velocity .*nan in row 17 .allowed -1e.50 to 1e.50"),
    "velocity inf": (put("events/velocity", (17, 1), -INF), "events/velocity .*-inf in row 17"),
    "velocity too large": (put("events/velocity", (17, 1), 1e51), "events/velocity .*1e.51 in row 17"),
    "position nan": (put("events/position", (17, 1), NAN), "events/position .*nan in row 17"),
    "above the box": (put("events/position", (17, 1), 6.0), "events/position .*6 in row 17 .allowed 0 to 5"),
    "left of the box": (put("events/position", (17, 0), -1e-3), "events/position .*-0.001 in row 17"),
    "species S": (put("discs/species", 3, 2), r"discs/species: 2 in row 3 \(allowed 0 to 1"),
    "species of none": (put("discs/species", slice(None), 0), "discs/species: no disc of species 1"),
    "species without a name": (texts("discs/species_name", 0, b""), "discs/species: a species without a name"),
    "two species of one name": (texts("discs/species_name", slice(None), b"a"), "discs/species: two species with"),
    "radius 0": (put("discs/radius", 3, 0.0), "discs/radius: 0 in row 3"),
    "radius nan": (put("discs/radius", 3, NAN), "discs/radius: nan in row 3"),
    "mass negative": (put("discs/mass", 3, -1.0), "discs/mass: -1 in row 3"),
    "disc outside": (put("discs/position", (3, 0), 11.0), "discs/position: 11 in row 3"),
    "disc velocity": (put("discs/velocity", (3, 0), INF), "discs/velocity: inf in row 3"),
    "no speed": (
        put("discs/velocity", slice(None), 1e-200),
        "discs/velocity: largest component 1e-200 .allowed 0 or >= 1e-61",
    ),
    "too few masses": (cut("discs/mass", 24), r"discs/mass: of shape \(24,\) .allowed \(25,\)"),
    "no ids": (
        swap("discs/id", data=None, shape=(0,), dtype="u4", chunks=(25,), maxshape=(None,)),
        "discs/id: 0 discs in a file of",
    ),
    "many discs": (many_discs, "discs/id: 10,000,000 discs in a file of"),
    "box 0": (put("box", 0, 0.0), "box: invalid width and height"),
    "box nan": (put("box", 0, NAN), "box: invalid width and height"),
    "box of one": (cut("box", 1), "box: invalid width and height"),
    "boundary": (
        lambda file: file["box"].attrs.create("boundary", np.array([b"none", b"open"])),
        "box: attribute boundary: invalid",
    ),
    "periodic without images": (
        lambda file: file["box"].attrs.create("boundary", np.array([b"periodic", b"none"])),
        "checkpoints/image: missing, with periodic sides",
    ),
    "no positions in checkpoints": (
        without("checkpoints/position"),
        "checkpoints/position: missing",
    ),
    "gravity": (put("gravity", 0, INF), "gravity: inf"),
    "side of the box": (put("walls/endpoints", (1, 0, 0), 9.0), "walls/endpoints: not the sides of a box"),
    "three walls": (cut("walls/name", 3), "walls/name: 3 walls"),
    "name of a wall": (texts("walls/name", 0, b"\xff"), "walls/name: not UTF-8"),
    "name of a species": (texts("discs/species_name", 0, b"\xff"), "discs/species_name: not UTF-8"),
    "text of a scene": (texts("runs/scene", 0, b"\xff"), "runs/scene: not UTF-8"),
    "checkpoint time falls": (put("checkpoints/time", 0, 99.0), "checkpoints/time .*decreases in row 1"),
    "checkpoint time nan": (put("checkpoints/time", 1, NAN), "checkpoints/time .*nan in row 1"),
    "checkpoint row falls": (put("checkpoints/row", 0, 5), "checkpoints/row .*decreases in row 1"),
    "checkpoint behind the end": (put("checkpoints/row", 1, 400), "checkpoints/row: 400 .allowed up to 300"),
    "checkpoint row": (put("checkpoints/row", 1, 7), "checkpoints/row: 7 at t = .*"),
    "checkpoint row negative": (put("checkpoints/row", 0, -1), "checkpoints/row .*-1 in row 0"),
    "checkpoint epoch": (put("checkpoints/epoch", 0, 10**9), "checkpoints/epoch .*decreases in row 1"),
    "checkpoint position": (put("checkpoints/position", (0, 3, 1), 5.5), "checkpoints/position .*5.5 in row 0"),
    "checkpoint velocity": (put("checkpoints/velocity", (0, 3, 1), NAN), "checkpoints/velocity .*nan in row 0"),
    "sample": (put("observables/kinetic_energy/value", 1, NAN), "observables/kinetic_energy/value .*nan in row 1"),
    "sample huge": (
        put("observables/kinetic_energy/value", 1, 1e151),
        "observables/kinetic_energy/value .*1e.151 in row 1 .allowed -1e.150 to 1e.150",
    ),
    "sample time": (put("observables/kinetic_energy/time", 0, 99.0), "observables/kinetic_energy/time .*decreases"),
    "late sample": (
        put("observables/kinetic_energy/time", 1, 99.0),
        "observables/kinetic_energy/time: 99 .allowed up to 0.29",
    ),
    "summary": (texts("summary/value", 0, b"{"), "summary/value"),
    "summary huge": (texts("summary/value", 0, b"1e151"), "summary/value: end_time: 1e151"),
    "summary long": (texts("summary/value", 0, b"9" * 200), "summary/value: end_time: 999"),
    "summary nan": (texts("summary/value", 0, b"NaN"), "summary/value: end_time: NaN"),
    "summary text": (texts("summary/value", 1, b'"many"'), "summary/value: rows: \"many\""),
    "summary negative": (texts("summary/value", 1, b"-1"), "summary/value: rows: -1"),
    "summary twice": (texts("summary/name", 1, b"end_time"), "summary/value: end_time appears twice"),
    "early end": (texts("summary/value", 0, b"0.001"), "summary/value: end_time 0.001"),
    "wrong number of rows": (texts("summary/value", 1, b"299"), "summary/value: 299 rows"),
    "type of ids": (retyped("events/disc", "i8"), "events/disc: of type int64 .allowed uint32"),
    "type of times": (retyped("events/time", "i8"), "events/time: of type int64 .allowed float64"),
    "kind of a sample": (retyped("observables/hits/value", "u8"), "of type uint64 .allowed float64 or int64"),
    "type of a sample": (retyped("observables/hits/value", "S8"), "observables/hits/value: of type"),
    "shape of velocities": (
        lambda file: swap("events/velocity", data=np.zeros((300, 3)), chunks=(65536, 3), maxshape=(None, 3))(file),
        r"events/velocity: entries of shape \(3,\) .allowed \(2,\)",
    ),
    "shape of samples": (
        lambda file: swap("observables/hits/value", data=np.zeros((99, 3)), chunks=(1024, 3), maxshape=(None, 3))(file),
        r"observables/hits/value: entries of shape \(3,\) .allowed \(\)",
    ),
    "chunks of one table": (chunked("events/disc", 8192), "events/time: chunks of"),
}  # fmt: skip


@pytest.mark.parametrize("case", VALUES)
def test_values(sound, tmp_path, case):
    edit, expected = VALUES[case]
    path = craft(shutil.copyfile(sound, tmp_path / "run.h5"), edit)
    message = refused(path)
    assert message.startswith("damaged: ")
    assert re.search(expected, message), message


def thermostat_row(partner, kind):
    """Row 17 with this partner and kind."""

    def edit(file):
        put("events/partner", 17, partner)(file)
        put("events/kind", 17, kind)(file)

    return edit


NOT_OF_PARTNER = "events/kind: disagrees with the partner in row 17"


@pytest.mark.parametrize(
    ("partner", "kind", "expected"),
    [
        (BATH, Kind.THERMOSTAT, ""),
        (BATH, Kind.WALL, NOT_OF_PARTNER),
        (BATH, Kind.DISC, NOT_OF_PARTNER),
        (-1, Kind.THERMOSTAT, NOT_OF_PARTNER),
        (BATH + 1, Kind.THERMOSTAT, "events/partner .*in row 17 .allowed -4 to 24"),
        (BATH, 5, "events/kind .*: STEERED in row 17, which this log cannot have"),
    ],
)
def test_thermostat_collisions(tmp_path, partner, kind, expected):
    """A thermostat collision has the heat bath as its partner; VALUES has the cases of logs without a thermostat."""
    path = craft(write_log(tmp_path / "run.h5", STOP, checkpoint_values=BATH_VALUES), thermostat_row(partner, kind))
    if expected:
        assert re.search(expected, refused(path))
    else:
        with open_log(path) as log:
            (rows,) = log.chunks()
        assert (rows.partner[17], rows.kind[17]) == (BATH, Kind.THERMOSTAT)


def grow(file):
    for name in file["events"]:
        file["events"][name].resize(2**40, axis=0)


ROOM = "events/time: 1,099,511,627,776 rows in a file of"


@pytest.mark.parametrize(
    ("rows", "edit", "expected"),
    [
        ({"events": 301}, None, "events/time: 301 rows .allowed up to 300"),
        ({"events": 2**62}, None, "events/time: .* rows .allowed up to 300"),
        ({"checkpoints": 10**6}, None, "checkpoints/time: 1,000,000 rows"),
        ({"runs": 0}, None, "runs/scene: .*"),
        ({"events": 2**40}, grow, ROOM),
        ({}, grow, ROOM),  # HDF5 would take days to cut off those that are not on record
    ],
)
def test_rows_in_the_record(sound, tmp_path, rows, edit, expected):
    path = craft(shutil.copyfile(sound, tmp_path / "run.h5"), edit or (lambda file: None), rows)
    assert re.search(expected, refused(path))


# ── a scene and its arrays ──


def scene_text(old, new):
    def edit(file):
        text = file["runs/scene"][0]
        assert old in text
        file["runs/scene"][0] = text.replace(old, new)

    return edit


SCENES = {
    "not TOML": (scene_text(b"[box]", b"[box"), "scene:.*not TOML"),
    "unknown key": (scene_text(b"[box]", b"[boxx]"), "scene:"),
    "count": (scene_text(b"count = 1000", b"count = 999"), "999 discs .discs/id: 1000"),
    "huge count": (scene_text(b"count = 1000", b"count = 2000000000"), "2000000000 discs|scene:"),
    "mass": (put("discs/mass", 3, 2.0), "the discs do not have the values of discs/mass"),
    "radius": (put("discs/radius", 3, 1e-3), "the discs do not have the values of discs/radius"),
    "gravity": (put("gravity", 1, -1.0), "gravity"),
    "wall": (texts("walls/name", 0, b"west"), "walls differ from walls/name"),
    "a heat bath": (
        scene_text(b"[run]", b"[thermostat]\ntemperature = 1\nrate = 1\n[run]"),
        "a heat bath .got no thermostat collisions",
    ),
    "species": (texts("discs/species_name", 0, b"x"), "species"),
}  # fmt: skip


def scene_refused(path):
    with open_log(path) as log, pytest.raises(LogError) as caught:
        _ = log.scene
    return str(caught.value)


@pytest.mark.parametrize("case", SCENES)
def test_scenes(run, tmp_path, case):
    edit, expected = SCENES[case]
    path = craft(shutil.copyfile(run, tmp_path / "run.h5"), edit)
    message = scene_refused(path)
    assert message.startswith(f"{path}: damaged: runs/scene: ")
    assert "\n" not in message
    assert re.search(expected, message), message


@pytest.mark.parametrize(
    ("field", "value", "expected"),
    [
        ("events", b"0", "summary/value: 0 events in [0-9,]+ rows"),
        ("wall_hits", b"0", "summary/value: 3,000 events in [0-9,]+ rows"),
        ("threads", b"0", "summary/value: threads: 0"),
        ("trials", str(2**63).encode(), "summary/value: trials: 9223372036854775808"),
    ],
)
def test_summaries_that_contradict_themselves(run, tmp_path, field, value, expected):
    def edit(file):
        names = file["summary/name"][:].tolist()
        file["summary/value"][names.index(field.encode())] = value

    assert re.search(expected, refused(craft(shutil.copyfile(run, tmp_path / "run.h5"), edit)))


@pytest.mark.usefixtures("uncompiled")
def test_a_scene_without_its_heat_bath(tmp_path):
    path = tmp_path / "run.h5"
    simulate(scene_of("thermostat", "run.events=100"), path)
    craft(path, scene_text(b"[thermostat]\ntemperature = 1.0\nrate = 0.2\n", b""))
    assert "no heat bath (got thermostat collisions)" in scene_refused(path)


def test_pairs_and_missing_data(run, tmp_path, sound):
    read_path(run)
    with open_log(run) as log:
        (block,) = log.chunks()
    first = int((block.disc < block.partner).argmax())
    for column, row, value in (
        ("partner", first + 1, block.partner[first + 1] + 1),
        ("disc", first + 1, (block.disc[first + 1] + 1) % 1000),
        ("time", first, np.nextafter(block.time[first], 0)),
        ("partner", first, -1),
    ):
        path = craft(shutil.copyfile(run, tmp_path / "run.h5"), put(f"events/{column}", row, value))
        assert re.search(f"events/partner: no pair in row ({first}|{first + 1})|events/time", refused(path))
    with open_log(sound) as log:
        for table, name in (("observables", "momentum"), ("summary", "trials")):
            with pytest.raises(LogError, match=f"^{re.escape(str(sound))}: damaged: {table}: has no {name}$"):
                getattr(log, table)[name]


def test_chunks_in_order(tmp_path):
    """Times are compared with those of the chunks that have been read, in any order."""
    path = write_log(tmp_path / "run.h5", 200_000)

    def edit(file: h5py.File) -> None:
        file["events/time"][131072:] -= 100.0

    craft(path, edit)
    for use in (lambda log: list(log.chunks(("time",))), lambda log: log.row_at(10.0)):
        with open_log(path) as log, pytest.raises(LogError, match=r"events/time from row \d+: decreases from one"):
            use(log)
