"""Files that are written: what may be replaced, by whom, and that they appear whole or not at all."""

import ast
import errno
import os
import socket
import subprocess
import sys
from pathlib import Path

import idealgas_cli
import pytest
from helpers.log_samples import new_writer, write_rows
from helpers.needs import posix

import idealgas
from idealgas.errors import OutputError
from idealgas.files import LOG, check_output, written
from idealgas.log import open_log

HOLD = """
import sys
from pathlib import Path
from idealgas.locks import WriteLock
with WriteLock(Path(sys.argv[1])):
    print(flush=True)
    sys.stdin.read()
"""


def refused(path, kind=LOG, **options):
    """The line with which an output is refused."""
    with pytest.raises(OutputError) as caught:
        check_output(path, kind, **options)
    assert caught.value.exit_code == 2
    return str(caught.value).removeprefix(f"{path}: ")


def test_only_files_of_the_same_kind_are_replaced(tmp_path):
    scene, page, empty = tmp_path / "gas.toml", tmp_path / "page.html", tmp_path / "empty"
    scene.write_text("[box]")
    page.write_text("<!doctype html><title>mine</title>")
    empty.touch()
    assert refused(scene) == "already exists (use force=True to overwrite)"
    assert refused(scene, force=True) == "is not a log of idealgas and will not be overwritten"
    assert refused(page, ".html", force=True) == "is not a .html file of idealgas and will not be overwritten"
    check_output(empty, LOG, force=True)
    assert (scene.read_text(), page.read_text()) == ("[box]", "<!doctype html><title>mine</title>")


@posix
def test_what_is_no_regular_file_is_left_alone(tmp_path):
    os.mkfifo(tmp_path / "fifo")
    listening = socket.socket(socket.AF_UNIX)
    listening.bind(str(tmp_path / "socket"))
    listening.close()
    for name in ("fifo", "socket"):
        assert refused(tmp_path / name, force=True) == "is not a regular file"
    assert refused("/dev/null", force=True) == "is not a regular file"
    (tmp_path / "page.html").mkdir()
    assert refused(tmp_path / "page.html", ".html", force=True) == "is a folder"
    assert refused(tmp_path / "none" / "run.h5") == f"no folder {tmp_path}/none"


@pytest.mark.parametrize("link", [os.link, os.symlink, lambda source, name: None])
def test_an_input_is_no_output(tmp_path, link):
    source, name = tmp_path / "run.h5", tmp_path / "other.h5"
    new_writer(source).close()
    link(source, name)
    output = name if name.exists() else source
    assert "output would overwrite the input" in refused(output, force=True, inputs=[source])
    check_output(tmp_path / "third.h5", LOG, inputs=[source, tmp_path / "none.toml"])


@posix
def test_a_link_is_written_through(tmp_path):
    (tmp_path / "folder").mkdir()
    link = tmp_path / "page.html"
    link.symlink_to("folder/page.html")
    for text in ("one", "two"):
        with written(link, ".html", force=True) as part:
            part.write_text(f'<!doctype html><meta name="generator" content="idealgas">{text}')
        assert link.is_symlink()
        assert link.read_text().endswith(text)
    assert [path.name for path in (tmp_path / "folder").iterdir()] == ["page.html"]


def test_what_fails_leaves_nothing_and_what_came_in_between_stays(tmp_path):
    def fail():
        with written(tmp_path / "film.gif", ".gif") as part:
            part.write_text("half")
            raise OSError(errno.ENOSPC, "no space")

    with pytest.raises(OutputError, match=r"film\.gif: cannot be written: No space left on device") as caught:
        fail()
    assert caught.value.exit_code == 1
    assert list(tmp_path.iterdir()) == []
    path = tmp_path / "table.csv"

    def late():
        with written(path, ".csv") as part:
            part.write_text("mine")
            path.write_text("theirs")

    with pytest.raises(OutputError, match="already exists"):
        late()
    assert path.read_text() == "theirs"
    path = tmp_path / "other.csv"
    path.write_text('"time","disc"')

    def lose():
        with written(path, ".csv", force=True) as part:
            part.touch()
            part.unlink()

    with pytest.raises(OutputError, match="cannot be written: No such file or directory"):
        lose()
    assert path.read_text() == '"time","disc"'


def test_two_writers_of_a_new_log(tmp_path, monkeypatch):
    """The other process takes the name, and holds its file, after both have found the place free."""
    path = tmp_path / "run.h5"
    with new_writer(tmp_path / "theirs.h5") as theirs:
        write_rows(theirs, 10)
    os.rename(tmp_path / "theirs.h5", path)
    monkeypatch.setattr("idealgas.log.writer.check_output", lambda *_: None)
    with subprocess.Popen([sys.executable, "-c", HOLD, path], stdin=-1, stdout=-1) as other:
        other.stdout.readline()
        with pytest.raises(OutputError, match="another run is writing this file"):
            new_writer(path, force=True)
        other.communicate()
    with open_log(path) as log:
        assert len(log) == 10
    assert list(tmp_path.iterdir()) == [path]


@posix
@pytest.mark.parametrize("how", ["removed", "moved"])
def test_a_log_that_goes_during_the_run(tmp_path, how):
    """Without a name its rows are lost; under another name they are as good as before."""
    path = tmp_path / "run.h5"
    writer = new_writer(path)
    write_rows(writer, 10)
    if how == "removed":
        path.unlink()
        with pytest.raises(OutputError, match=r"run\.h5: cannot be written: No such file or directory") as caught:
            writer.close()
        assert caught.value.exit_code == 1
    else:
        path.rename(tmp_path / "better.h5")
        writer.close()
        with open_log(tmp_path / "better.h5") as log:
            assert len(log) == 10


def test_texts_have_the_same_line_ends_on_every_system():
    """A file is recognised by its first line, also on Windows, where Python writes "\\r\\n" if it is not told."""
    for package in (idealgas, idealgas_cli):
        for path in Path(package.__file__).parent.rglob("*.py"):
            for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
                if isinstance(node, ast.Call) and getattr(node.func, "attr", "") == "write_text":
                    given = {word.arg: ast.unparse(word.value) for word in node.keywords}
                    assert given == {"encoding": "'utf-8'", "newline": "'\\n'"}, (path, node.lineno)
