"""The folder of a sweep: who holds it, and what goes on in it when the sweep gets new values."""

import json
import subprocess
import sys

import pytest

from idealgas.errors import UserError
from idealgas.locks import WriteLock
from idealgas.run.simulate import open_run, simulate
from idealgas.sweep.folder import hold_folder, resume_numbering
from idealgas.sweep.plan import load_sweep
from idealgas.sweep.point import log_path, points_folder, result_path, run_point, unfinished_log
from idealgas.sweep.results import write_tables
from idealgas.toml.dump import dump_document

PLAN = """
[sweep]
seed = 5
replicates = {replicates}
analyses = {analyses}
[[axis]]
key = "species.temperature"
values = {temperatures}
[[axis]]
key = "species.mass"
values = {masses}
[base]
box.size = [10, 5]
species = [{{name = "gas", count = {count}, radius = 0.1, temperature = 1.0}}]
run.events = 100
"""

HOLD = """
import sys
from pathlib import Path
from idealgas.sweep.folder import hold_folder
with hold_folder(Path(sys.argv[1])):
    print(flush=True)
    sys.stdin.read()
"""


@pytest.fixture
def plan(tmp_path):
    def load(temperatures=(1, 2), masses=(1, 2), replicates=1, analyses=(), count=20):
        texts = {"temperatures": list(temperatures), "masses": list(masses), "analyses": list(analyses)}
        (tmp_path / "plan.toml").write_text(PLAN.format(replicates=replicates, count=count, **texts))
        return load_sweep(tmp_path / "plan.toml")

    return load


@pytest.fixture
def folder(tmp_path):
    folder = tmp_path / "out"
    points_folder(folder).mkdir(parents=True)
    return folder


def finish(sweep, folder, points, **summary):
    """Results of points as their workers leave them, with a summary as their only numbers."""
    for point in points:
        actual = {
            "point": point.index, "seed": point.scene.scene.seed, "combination": point.combination,
            "replicate": point.replicate, "values": point.values, "scene": dump_document(point.scene),
            "summary": summary,
            "analyses": {name: {"caveats": []} for name in sweep.analyses},
        }  # fmt: skip
        result_path(folder, point.index).write_text(json.dumps(actual))


def numbers(sweep):
    """Number, number of the combination, and seed of each point, by its values and replicate."""
    return {
        (*point.values.values(), point.replicate): (point.index, point.combination, point.scene.scene.seed)
        for point in sweep.points
    }


def test_a_new_sweep_is_as_it_is_and_values_may_be_there_twice(plan, folder):
    assert resume_numbering(plan(), folder) == plan()
    assert (folder / "sweep.toml").read_text().endswith((folder.parent / "plan.toml").read_text())
    twice = plan(temperatures=(1, 1))
    finish(twice, folder, twice.points[:3])
    assert resume_numbering(twice, folder) == twice


def test_new_values_get_new_numbers_and_seeds(plan, folder):
    old = plan()
    finish(old, folder, old.points[1:3])
    more = resume_numbering(plan(temperatures=(0.5, 1, 2), masses=(2, 3, 1), replicates=2), folder)
    before, after = numbers(old), numbers(more)
    for point in old.points[1:3]:
        label = (*point.values.values(), point.replicate)
        assert after[label] == before[label]
    assert len(more.points) == 18
    for column in zip(*after.values(), strict=True):
        assert len(set(column)) in (9, 18)
    assert sorted(point.index for point in more.points) == list(range(18))
    for point in more.points[::4]:
        finish(more, folder, [point])
        assert resume_numbering(plan(temperatures=(0.5, 1, 2), masses=(2, 3, 1), replicates=2), folder) == more


@pytest.mark.parametrize(
    "change", [{"temperatures": [1]}, {"analyses": ["pressure"]}, {"count": 30}], ids=["value", "analyses", "base"]
)
def test_what_is_done_must_be_of_the_sweep(plan, folder, change):
    old = plan()
    resume_numbering(old, folder)
    finish(old, folder, old.points)
    before = {path: path.read_bytes() for path in folder.rglob("*.*")}
    with pytest.raises(UserError, match=r"out: contains another sweep: point \d \(species\..*remove this one"):
        resume_numbering(plan(**change), folder)
    assert {path: path.read_bytes() for path in folder.rglob("*.*")} == before


def test_a_folder_has_one_sweep_at_a_time(tmp_path):
    folder = tmp_path / "out"
    with subprocess.Popen([sys.executable, "-c", HOLD, folder], stdin=-1, stdout=-1) as other:
        other.stdout.readline()
        with pytest.raises(UserError, match="out: another sweep is running in this folder"), hold_folder(folder):
            pass
        other.kill()
    with hold_folder(folder):
        assert points_folder(folder).is_dir()


def test_a_sweep_that_fails_leaves_only_files_that_others_are_writing(plan, tmp_path):
    folder = tmp_path / "out"
    with pytest.raises(UserError, match="unknown analysis"), hold_folder(folder):
        run_point(plan().points[1], folder, ("unheard-of",), True)
    assert list(points_folder(folder).iterdir()) == []
    with hold_folder(folder):
        run = open_run(plan().points[0].scene, unfinished_log(folder, 0))
        run.__enter__()
    assert list(points_folder(folder).iterdir()) == [unfinished_log(folder, 0)]
    run.__exit__(None, None, None)


def is_no_sweep(folder):
    """The folder is refused, and left as it is."""
    before = [path.name for path in folder.iterdir()]
    with pytest.raises(UserError, match="exists and is not the folder of a sweep"), hold_folder(folder):
        pass
    assert [path.name for path in folder.iterdir()] == before


def test_a_folder_of_others_is_left_alone(tmp_path):
    for k, name in enumerate(("precious", "sweep.toml")):
        (tmp_path / str(k)).mkdir()
        (tmp_path / str(k) / name).write_text("[sweep]")
        is_no_sweep(tmp_path / str(k))
    for text in ("", "precious", "idealgas sweep"):  # a lock file of others makes no folder of a sweep
        folder, elsewhere = tmp_path / f"folder {text}", tmp_path / "elsewhere"
        folder.mkdir()
        elsewhere.write_text(text)
        (folder / ".lock").symlink_to(elsewhere)
        is_no_sweep(folder)
        assert elsewhere.read_text() == text


@pytest.mark.parametrize("name", ["sweep.toml", "points/0000.h5", "points/0001.h5"])
@pytest.mark.parametrize("text", ["a,b\n1,2\n", "# 5 points\n[sweep]\n"])
def test_files_of_others_are_not_replaced(plan, folder, name, text):
    with hold_folder(folder / "new"):
        (folder / "new" / name).write_text(text)
        with pytest.raises(UserError, match=rf"{name}: is not a .* of idealgas and will not be overwritten"):
            resume_numbering(plan(), folder / "new")
        assert (folder / "new" / name).read_text() == text


def test_a_log_of_another_command_is_not_replaced(plan, folder):
    sweep = plan()
    simulate(sweep.points[0].scene, log_path(folder, 0), command="idealgas run")
    before = log_path(folder, 0).read_bytes()
    with pytest.raises(UserError, match=r"0000.h5: was not written by this sweep"):
        resume_numbering(sweep, folder)
    assert log_path(folder, 0).read_bytes() == before


@pytest.mark.parametrize(
    ("old", "new", "line"),
    [(",", ";", 1), ("5.0", "6.0", 3), ("point", "\ufeffpoint", 1)],
    ids=["separator", "value", "mark"],
)
def test_a_table_that_was_changed_by_hand_is_kept(plan, folder, old, new, line):
    """A sweep goes on from the files of its points, and names the first line that is not of these."""
    sweep = plan()
    finish(sweep, folder, sweep.points, events=5)
    table, kept = folder / "results.csv", folder / "results.previous-1.csv"
    assert write_tables(folder)[1] == []
    assert write_tables(folder)[1] == []
    written = table.read_bytes()
    lines = written.decode().splitlines(keepends=True)
    edited = "".join(
        [*lines[: line - 1], *(text.replace(old, new, 1 if old == "point" else -1) for text in lines[line - 1 :])]
    )
    table.write_bytes(edited.encode())
    (notice,) = write_tables(folder)[1]
    why = "not a row of this sweep (edited, or from other points); the file is kept as results.previous-1.csv"
    assert notice == f"{table}:{line}: {why}"
    assert (table.read_bytes(), kept.read_bytes()) == (written, edited.encode())
    table.write_text("precious")
    write_tables(folder)
    assert (folder / "results.previous-2.csv").read_text() == "precious"
    assert kept.read_bytes() == edited.encode()


def test_what_died_processes_left_is_removed(folder):
    """Hidden parts of files and logs without an end, but not a log that a process is writing, and no file of others."""
    with hold_folder(folder.parent / "new"):
        pass
    points = points_folder(folder.parent / "new")
    left = [".0004.h5.part.0123abcd", ".0003.json.0123abcd", "0004.h5.part"]
    others = [".notes", "mine.h5.part", "0005.h5.part.gz"]
    for name in (*left, *others, "0002.h5.part"):
        (points / name).touch()
    (points.parent / ".results.csv.0123abcd").touch()
    with WriteLock(points / "0002.h5.part"), hold_folder(points.parent):
        assert sorted(path.name for path in points.iterdir()) == sorted([*others, "0002.h5.part"])
        assert sorted(path.name for path in points.parent.iterdir()) == [".lock", "points"]
