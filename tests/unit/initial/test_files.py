"""Files from which a scene starts: what they give, how much they may hold, and the lines that refuse them."""

import io
import re
import tracemalloc
import zipfile

import numpy as np
import pytest
from helpers.support import error_of

from idealgas import SceneError, parse_scene
from idealgas.initial.files import read_state


@pytest.mark.parametrize(
    ("name", "text"),
    [
        ("a.csv", ""),
        ("a.csv", "x,y\n1\n"),
        ("a.csv", "x,y,mas\n1,1,1\n"),
        ("a.csv", "x,y\n1,one\n"),
        ("a.csv", "x,y,radius\n1,nan,1\n"),
        ("a.csv", "x,y,radius\n1,1,-1\n"),
        ("a.csv", "x,y\n1,1\n"),
        ("a.npz", "PK"),
        ("a.gsd", "gsd"),
        ("a.extxyz", "x\n"),
        ("a.extxyz", "2\nProperties=pos:R:3\n1 1 1\n"),
        ("a.extxyz", "1000000000000\nProperties=pos:R:3:radius:R:1\n1 1 0 1\n"),
        ("a.extxyz", "1000000\nProperties=pos:R:3:radius:R:1\n1 1 0 1\n"),
        ("a.extxyz", f"1\nProperties=pos:R:3:radius:R:1\n{'1' * 200_000} 1 0 1\n"),
        ("a.csv", f"x,y,radius\n{'1' * 200_000},1,1\n"),
        ("a.csv", 'x,y,radius\n"' + "1\n" * 100_000 + '",1,1\n'),
    ],
)
def test_damaged_files_are_lines(tmp_path, name, text):
    (tmp_path / name).write_text(text)
    (tmp_path / "next.toml").write_text(f"box.size = [8, 6]\nrun.until = 1\n[start]\nfile = '{name}'\n")
    assert "next.toml:4: start.file" in error_of("check", tmp_path / "next.toml")


FILE = "box.size = [8, 6]\nrun.until = 1\nstart.file = '{}'\n"


def start_of(path, time="end"):
    """Discs of a scene that starts from a file."""
    return parse_scene(FILE.format(path) + (f"start.time = {time}\n" if time != "end" else "")).explicit_discs


def test_frames_without_times_are_numbered_and_the_last_is_the_default(tmp_path):
    frame = "2\nProperties=species:S:1:pos:R:3:radius:R:1\nA 1 {} 0 .1\nB 3 4 0 .2\n"
    (tmp_path / "a.extxyz").write_text(frame.format(1) + frame.format(2) + frame.format(3))
    last, middle = start_of(tmp_path / "a.extxyz"), start_of(tmp_path / "a.extxyz", 1)
    assert last.position.tolist() == [[1, 3], [3, 4]]
    assert (last.names, last.radius.tolist()) == (("A", "B"), [0.1, 0.2])
    assert middle.position.tolist() == [[1, 2], [3, 4]]
    with pytest.raises(SceneError, match=r"start.time: no such time in the file \(got 3.0; allowed 0 to 2\)"):
        start_of(tmp_path / "a.extxyz", 3)


def test_rows_of_a_time_in_any_order_and_number(tmp_path):
    """More rows than are read at a time, those of the last time in between."""
    rows = [f"{k % 7 + 0.5},{k % 5 + 0.5},0.1,{k % 3}" for k in range(40_000)]
    wanted = [k for k in range(40_000) if k % 3 == 2]
    (tmp_path / "a.csv").write_text("\n".join(["x,y,radius,time", *rows]))
    columns, _ = read_state(tmp_path / "a.csv", "end")
    assert columns["position"][:, 0].tolist() == [k % 7 + 0.5 for k in wanted]
    assert len(read_state(tmp_path / "a.csv", 0.0)[0]["radius"]) == 13_334


@pytest.mark.parametrize(
    ("columns", "message"),
    [
        ({"position": np.ones((2, 2), complex)}, "column position does not contain real numbers (got complex128; "),
        (
            {"position": np.ones((2, 2)), "radius": np.array("0.1")},
            "column radius does not contain real numbers (got <U3; ",
        ),
        ({"position": np.ones((2, 2)), "radis": np.ones(2)}, "unknown column (got radis; "),
        ({"position": np.zeros((2_000_001, 2), np.int8)}, "too many discs (got 2,000,001; allowed <= 2,000,000)"),
        ({"position": np.zeros((2_000_000, 135), np.int8)}, "column position too large (got 270,000,000 bytes; "),
    ],
)
def test_columns_are_refused_before_they_are_read(tmp_path, columns, message):
    np.savez_compressed(tmp_path / "a.npz", **columns)
    with pytest.raises(SceneError, match=re.escape(f"start.file: {message}")):
        start_of(tmp_path / "a.npz")


def test_a_file_that_claims_more_than_it_holds_takes_no_memory(tmp_path):
    """A .npy header of 10¹² rows without any."""
    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (10**12, 2)})
    with zipfile.ZipFile(tmp_path / "a.npz", "w") as archive:
        archive.writestr("position.npy", header.getvalue())
    tracemalloc.start()
    with pytest.raises(SceneError, match="too many discs"):
        start_of(tmp_path / "a.npz")
    assert tracemalloc.get_traced_memory()[1] < 20_000_000
    tracemalloc.stop()


def test_one_number_is_that_of_every_disc_of_a_file_and_a_mark_is_read_over(tmp_path):
    np.savez(tmp_path / "a.npz", position=[[1.0, 1], [3, 3]], velocity=[[1.0, 0], [0, 1]], radius=0.25, species="a")
    discs = start_of(tmp_path / "a.npz")
    assert (discs.radius.tolist(), discs.names) == ([0.25, 0.25], ("a",))
    (tmp_path / "a.csv").write_text("x,y,radius\n1,2,0.1\n3,4,0.2\n", encoding="utf-8-sig")
    assert start_of(tmp_path / "a.csv").position.tolist() == [[1, 2], [3, 4]]


@pytest.mark.parametrize("radius", ["0.2", "nan", "-0.1"])
def test_a_file_and_a_table_agree_about_radius_and_mass(tmp_path, radius):
    """The rule of the page: without a column that of the table, with one the same or a refusal."""
    table = "[[species]]\nname = 'a'\ncount = 2\nradius = 0.1\nmass = 2\ntemperature = 1\n"
    (tmp_path / "a.csv").write_text("x,y,radius\n1,1,0.1\n3,3,0.1\n")
    given = parse_scene(FILE.format(tmp_path / "a.csv") + table).explicit_discs
    assert (given.radius.tolist(), given.mass.tolist(), given.names) == ([0.1, 0.1], [2, 2], ("a",))
    (tmp_path / "a.csv").write_text(f"x,y,radius\n1,1,0.1\n3,3,{radius}\n")
    with pytest.raises(
        SceneError, match=rf"column radius, disc 1: differs from its species \(got {radius}; allowed 0.1"
    ):
        parse_scene(FILE.format(tmp_path / "a.csv") + table)
