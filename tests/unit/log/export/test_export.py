"""Exported files, read by the packages they are for."""

import re
import sys
import warnings

import h5py
import numpy as np
import pytest
from helpers.log_compare import scene_of
from helpers.support import logged

from idealgas.errors import OutputError
from idealgas.log import LogError, open_log
from idealgas.log.export import tables
from idealgas.log.export.export import FORMATS, export, frame_times
from idealgas.log.export.frames import ELEMENTS
from idealgas.log.flights import NO_EVENT, Flights
from idealgas.run.simulate import simulate
from idealgas.scene import SceneError

FRAMES = 5


@pytest.fixture(scope="module", params=["mixture", "rough", "periodic"])
def log(request, tmp_path_factory):
    path = tmp_path_factory.mktemp("export") / "run.h5"
    with logged(scene_of(request.param, "run.events=4000"), path) as log:
        yield log


@pytest.fixture(scope="module")
def frames(log):
    return frame_times(log, str(FRAMES)), list(log.frames(frame_times(log, str(FRAMES))))


def read_table(path):
    from pyarrow import csv as pyarrow_csv
    from pyarrow import parquet

    table = pyarrow_csv.read_csv(path) if path.suffix == ".csv" else parquet.read_table(path)
    return {name: table[name].to_numpy() for name in table.column_names}


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_events_as_a_table(log, kind, tmp_path):
    path = tmp_path / f"events.{kind}"
    assert export(log, kind, path) == len(log)
    table = read_table(path)
    stored = next(log.chunks())
    for name in ("time", "disc", "partner"):
        assert np.array_equal(table[name], getattr(stored, name))
    assert set(table["kind"]) <= {"disc", "wall"}
    assert np.array_equal(table["kind"] == "wall", stored.partner < 0)
    for axis, letter in enumerate("xy"):
        assert np.array_equal(table[letter], stored.position[:, axis])
        assert np.array_equal(table[f"v{letter}"], stored.velocity[:, axis])
    assert ("angular_velocity" in table) == ("angular_velocity" in log.columns)
    assert ("image_x" in table) == ("image" in log.columns)


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_flights_as_a_table(log, kind, tmp_path):
    flights = Flights.joined(log.flights())
    assert export(log, kind, tmp_path / f"flights.{kind}", rows="flights") == len(log) + len(log.discs)
    table = read_table(tmp_path / f"flights.{kind}")
    for name in ("disc", "start", "end", "partner"):
        assert np.array_equal(table[name], getattr(flights, name))
    assert np.array_equal(table["new_vy"], flights.new_velocity[:, 1])
    assert np.array_equal(table["kind"] == "", flights.kind == NO_EVENT)


@pytest.mark.parametrize("rows", ["events", "flights"])
def test_parts_of_a_table(log, rows, tmp_path, monkeypatch):
    """Rows of each part end in its share of the time; together they are the whole table, read in short blocks."""
    monkeypatch.setattr(tables, "_columns", lambda *found, whole=tables._columns: blocks(whole(*found)))
    number = export(log, "parquet", tmp_path / "parts", rows=rows, parts=3)
    assert number == export(log, "parquet", tmp_path / "whole.parquet", rows=rows)
    files = sorted((tmp_path / "parts").iterdir())
    assert [file.name for file in files] == [f"part-{k:04}.parquet" for k in range(3)]
    parts, whole = [read_table(file) for file in files], read_table(tmp_path / "whole.parquet")
    for name, column in whole.items():
        assert np.array_equal(np.concatenate([part[name] for part in parts]), column)
    for k, part in enumerate(parts):
        end = part["time" if rows == "events" else "end"]
        assert k * log.end_time / 3 <= end.min() <= end.max() <= (k + 1) * log.end_time / 3 * (1 + 1e-15)
    assert sorted(path.name for path in tmp_path.iterdir()) == ["parts", "whole.parquet"]
    with pytest.raises(OutputError, match="already exists"):
        export(log, "parquet", tmp_path / "parts", rows=rows, parts=3)
    assert export(log, "parquet", tmp_path / "parts", rows=rows, parts=2, force=True) == number
    assert len(list((tmp_path / "parts").iterdir())) == 2
    (tmp_path / "parts" / "mine.txt").touch()
    with pytest.raises(OutputError, match="not a folder with only export parts"):
        export(log, "parquet", tmp_path / "parts", rows=rows, parts=2, force=True)


def test_parts_without_rows_have_the_columns(log, tmp_path, monkeypatch):
    """Also those of a log without rows; what was there stays until the new folder is complete."""
    whole = tables._columns
    nothing = ({name: column[:0] for name, column in block.items()} for block in whole(log, "events"))
    monkeypatch.setattr(tables, "_columns", lambda *found: nothing)
    assert export(log, "parquet", tmp_path / "parts", parts=3) == 0
    files = sorted((tmp_path / "parts").iterdir())
    assert len(files) == 3
    assert all(len(read_table(file)["time"]) == 0 for file in files)

    def broken(*arguments):
        yield next(whole(log, "events"))
        raise OSError("disk")

    monkeypatch.setattr(tables, "_columns", broken)
    with pytest.raises(OutputError, match="disk"):
        export(log, "parquet", tmp_path / "parts", parts=2, force=True)
    assert sorted((tmp_path / "parts").iterdir()) == files
    assert [path.name for path in tmp_path.iterdir()] == ["parts"]


def blocks(columns):
    for block in columns:
        for first in range(0, max(len(block["disc"]), 1), 500):
            yield {name: column[first : first + 500] for name, column in block.items()}


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_frames_as_a_table(log, frames, kind, tmp_path):
    times, states = frames
    path = tmp_path / f"frames.{kind}"
    assert export(log, kind, path, times) == FRAMES
    table, number = read_table(path), len(log.discs)
    assert np.array_equal(table["time"], np.repeat(times, number))
    assert np.array_equal(table["disc"], np.tile(np.arange(number), FRAMES))
    assert table["species"][0] == log.discs.species_names[log.discs.species[0]]
    assert np.array_equal(table["radius"], np.tile(log.discs.radius, FRAMES))
    assert np.array_equal(table["mass"], np.tile(log.discs.mass, FRAMES))
    assert np.array_equal(table["x"], np.concatenate([state.position[:, 0] for state in states]))
    assert np.array_equal(table["vy"], np.concatenate([state.velocity[:, 1] for state in states]))


def test_gsd(log, frames, tmp_path):
    from gsd import hoomd

    times, states = frames
    assert export(log, "gsd", tmp_path / "run.gsd", times) == FRAMES
    with hoomd.open(str(tmp_path / "run.gsd")) as file:
        assert len(file) == FRAMES
        for time, state, frame in zip(times, states, file, strict=True):
            assert frame.log["time"] == time
            assert frame.configuration.dimensions == 2
            assert frame.configuration.box[:3].tolist() == pytest.approx([*log.box, 0])
            centred = (state.position - np.array(log.box) / 2).astype(np.float32)
            assert np.array_equal(frame.particles.position[:, :2], centred)
            assert not frame.particles.position[:, 2].any()
            assert np.array_equal(frame.particles.velocity[:, :2], state.velocity.astype(np.float32))
            assert np.array_equal(frame.particles.diameter, (2 * log.discs.radius).astype(np.float32))
            assert np.array_equal(frame.particles.mass, log.discs.mass.astype(np.float32))
            assert frame.particles.types == list(log.discs.species_names)
            assert np.array_equal(frame.particles.typeid, log.discs.species)


def test_names_of_species(tmp_path):
    from ase import data
    from ase import io as ase
    from gsd import hoomd

    with logged(scene_of("mixture", "run.events=20", 'species.0.name="klein_ü"'), tmp_path / "run.h5") as log:
        export(log, "gsd", tmp_path / "run.gsd", [0.0])
    with hoomd.open(str(tmp_path / "run.gsd")) as file:
        assert file[0].particles.types[0] == "klein_\\xfc"
    names = ('species.0.name="He"', 'species.1.name="heavy"')
    simulate(scene_of("mixture", "run.events=20", *names), tmp_path / "run.h5", force=True)
    with open_log(tmp_path / "run.h5") as log:
        export(log, "extxyz", tmp_path / "run.extxyz", [0.0])
        species = log.discs.species
    atoms = ase.read(tmp_path / "run.extxyz")
    assert np.array_equal(atoms.symbols == "He", species == 0)
    assert np.array_equal(atoms.symbols == "X", species == 1)

    assert set(data.chemical_symbols) - {"X"} == ELEMENTS
    # Every row of a table repeats them.
    simulate(scene_of("mixture", "run.events=20", f'species.0.name="{"ü" * 255}"'), tmp_path / "run.h5", force=True)
    with open_log(tmp_path / "run.h5") as log:
        export(log, "csv", tmp_path / "frames.csv", [0.0])
    assert "ü" * 255 in read_table(tmp_path / "frames.csv")["species"]
    with pytest.raises(SceneError, match=r"species\.a{255}.*\.name: too long \(got .*; allowed up to 255 characters\)"):
        scene_of("mixture", f'species.0.name="{"a" * 256}"')


def test_extended_xyz(log, frames, tmp_path):
    from ase import io as ase

    times, states = frames
    assert export(log, "extxyz", tmp_path / "run.extxyz", times) == FRAMES
    read = ase.read(tmp_path / "run.extxyz", index=":")
    for time, state, atoms in zip(times, states, read, strict=True):
        assert atoms.info["Time"] == time
        assert atoms.pbc.tolist() == [*log.periodic, False]
        assert np.diag(atoms.cell)[:2].tolist() == list(log.box)
        assert np.array_equal(atoms.positions[:, :2], state.position)
        assert np.array_equal(atoms.arrays["velo"][:, :2], state.velocity)
        assert np.array_equal(atoms.arrays["radius"], log.discs.radius)
        assert np.array_equal(atoms.arrays["type"], np.array(log.discs.species_names)[log.discs.species])
        assert np.array_equal(atoms.get_tags(), log.discs.species)
        assert np.array_equal(atoms.get_masses(), log.discs.mass)
        assert np.array_equal(atoms.get_momenta()[:, :2], log.discs.mass[:, np.newaxis] * state.velocity)
        kinetic = (log.discs.mass * (state.velocity**2).sum(axis=1)).sum() / 2
        assert atoms.get_kinetic_energy() == pytest.approx(kinetic, rel=1e-13)


@pytest.mark.needs("OVITO")
@pytest.mark.parametrize("kind", ["extxyz", "gsd"])
def test_ovito_reads_it(log, frames, kind, tmp_path):
    from ovito import io as ovito

    times, states = frames
    path = tmp_path / f"run.{kind}"
    export(log, kind, path, times)
    pipeline = ovito.import_file(str(path))
    assert pipeline.source.num_frames == FRAMES
    for frame, (time, state) in enumerate(zip(times, states, strict=True)):
        data = pipeline.compute(frame)
        assert data.attributes["Time" if kind == "extxyz" else "time"] == time
        discs, middle = data.particles, np.array(log.box) / 2 * (kind == "gsd")
        expected = {"Position": state.position - middle, "Velocity": state.velocity, "Radius": log.discs.radius}
        if kind == "extxyz" or (log.discs.mass != 1).any():  # 1 is what no mass in a GSD file means
            expected["Mass"] = log.discs.mass
        for name, values in expected.items():
            result = discs[name][...].reshape(len(values), -1)[:, : values.ndim]
            digits = 24 if kind == "gsd" or result.dtype == np.float32 else 53
            bound = max(log.box) * 2.0 ** (1 - digits)  # what it makes of decimals may be an ulp off
            assert np.abs(result - values.reshape(len(values), -1)).max() <= bound, name
        names = {kind.id: kind.name for kind in discs.particle_types.types}
        species = [log.discs.species_names[k] for k in log.discs.species]
        assert [names[k] for k in discs.particle_types[...]] == species


def test_h5md_in_three_dimensions(log, frames, tmp_path):
    times, states = frames
    path = tmp_path / "run.h5md"
    assert export(log, "h5md3d", path, times) == FRAMES
    with h5py.File(path) as file:
        group = file["particles/trajectory"]
        assert np.array_equal(group["position/value"][..., :2], [state.position for state in states])
        assert np.array_equal(group["velocity/time"], times)
        assert ("edges" in group["box"]) == any(log.periodic)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")
        import MDAnalysis as mda

        universe = mda.Universe.empty(len(log.discs), trajectory=False)
        universe.load_new(str(path), format="H5MD", convert_units=False)
        assert len(universe.trajectory) == FRAMES
        for step, state in zip(universe.trajectory, states, strict=True):
            assert step.time == state.time
            assert np.array_equal(step.positions[:, :2], state.position.astype(np.float32))
            assert np.array_equal(step.velocities[:, :2], state.velocity.astype(np.float32))
            assert not step.positions[:, 2].any()


def test_choices_of_frames(log):
    assert frame_times(log, "3").tolist() == [0.0, log.end_time / 2, log.end_time]
    step = log.end_time / 4.5
    assert frame_times(log, f"every={step}").tolist() == [k * step for k in range(5)]
    for choice in ("0", "-1", "x", "every=0", "every=x", "every=nan", "each=1", "2.5", "every="):
        with pytest.raises(LogError, match="invalid choice of frames"):
            frame_times(log, choice)


def test_an_existing_file_stays(log, tmp_path):
    (tmp_path / "run.csv").write_text("precious")
    with pytest.raises(OutputError, match="already exists"):
        export(log, "csv", tmp_path / "run.csv")
    with pytest.raises(OutputError, match=r"run\.csv: is not a \.csv file of idealgas"):
        export(log, "csv", tmp_path / "run.csv", force=True)
    assert (tmp_path / "run.csv").read_text() == "precious"


@pytest.mark.parametrize(("kind", "made"), FORMATS.items())
@pytest.mark.parametrize("share", [0.1, 0.999])
def test_a_full_disk_leaves_nothing(log, kind, made, share, tmp_path):
    """A limit of the size of a file stands for it; HDF5 would crash."""
    import resource

    path = tmp_path / f"out{made.ending}"
    times = frame_times(log, "50")
    export(log, kind, path, times)
    size = path.stat().st_size
    path.unlink()
    limit = resource.getrlimit(resource.RLIMIT_FSIZE)
    resource.setrlimit(resource.RLIMIT_FSIZE, (int(share * size), limit[1]))
    try:
        with pytest.raises(OutputError, match=r"cannot be written: (File too large|Input/output error)"):
            export(log, kind, path, times)
    finally:
        resource.setrlimit(resource.RLIMIT_FSIZE, limit)
    assert list(tmp_path.iterdir()) == []


@pytest.mark.parametrize(("kind", "made"), FORMATS.items())
def test_a_file_of_the_same_kind_is_replaced(log, kind, made, tmp_path):
    path = tmp_path / f"out{made.ending}"
    for events in [False] * 2 + [True] * (2 * made.has_events):
        export(log, kind, path, None if events else [0.0], force=True)
    assert list(tmp_path.iterdir()) == [path]


@pytest.mark.parametrize("kind", ["gsd", "extxyz", "h5md3d"])
def test_events_need_a_table(log, kind, tmp_path):
    with pytest.raises(LogError, match="files cannot contain events"):
        export(log, kind, tmp_path / "out")


@pytest.mark.parametrize(("kind", "package"), [("csv", "pyarrow"), ("parquet", "pyarrow"), ("gsd", "gsd.hoomd")])
def test_a_missing_package_is_named(log, kind, package, tmp_path, monkeypatch):
    monkeypatch.setitem(sys.modules, package, None)
    line = f'{kind} requires {package}: .venv/bin/pip install -e ".[export]" in the top folder'
    with pytest.raises(LogError, match=f"^{re.escape(line)}$"):
        export(log, kind, tmp_path / "out", [0.0])
    assert not list(tmp_path.iterdir())


def test_a_gas_without_positions_or_events_has_tables_only(tmp_path):
    with logged(scene_of("novak-bortz", "run.events=300"), tmp_path / "run.h5") as log:
        assert export(log, "csv", tmp_path / "events.csv") == len(log)
        assert export(log, "csv", tmp_path / "frames.csv", [0.0]) == 1
        assert "x" not in read_table(tmp_path / "events.csv")
        for kind in set(FORMATS) - {"csv", "parquet"}:
            with pytest.raises(LogError, match="no positions"):
                export(log, kind, tmp_path / "out", [0.0])


@pytest.mark.parametrize("kind", ["csv", "parquet"])
def test_a_table_without_events_has_its_columns(kind, tmp_path):
    with logged(scene_of("mixture", "run.until=1e-9"), tmp_path / "run.h5") as log:
        assert export(log, kind, tmp_path / f"events.{kind}") == 0
    assert list(read_table(tmp_path / f"events.{kind}")) == ["time", "disc", "partner", "kind", "x", "y", "vx", "vy"]
