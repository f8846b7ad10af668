"""`idealgas animate`: what it says and makes, and one line for everything it cannot do."""

import os

import pytest
from click.testing import CliRunner
from idealgas_cli.main import main
from PIL import Image

from idealgas.run.simulate import simulate
from idealgas.scene import parse_scene

SCENE = """
box.size = [20, 20]
species = [{name = "gas", count = 20, radius = 0.5, speed = 1.0}]
run.until = 30
"""
SMALL = ("--size", "240x240", "--fps", 10)


@pytest.fixture(scope="module")
def folder(tmp_path_factory):
    """With run.h5, one without positions, and one without events."""
    folder = tmp_path_factory.mktemp("animate")
    logs = {
        "run": SCENE,
        "homogeneous": SCENE + 'run.method = "monte_carlo"\n',
        "eventless": SCENE + "log.events = false\n",
        "piston": SCENE + 'piston = {side = "right", position = 15, mass = 20, pressure = 0.1}\n',
    }
    for name, text in logs.items():
        simulate(parse_scene(text), folder / f"{name}.h5")
    return folder


def idealgas(*arguments):
    return CliRunner().invoke(main, [str(argument) for argument in arguments])


@pytest.mark.parametrize("colour", ["speed", "species", "order"])
def test_film(folder, colour, tmp_path):
    film = tmp_path / "film.gif"
    made = idealgas("animate", folder / "run.h5", "-o", film, "--to", 4, "--speed", 2, "--colour", colour, *SMALL)
    assert (made.exit_code, made.stderr) == (0, "")
    assert made.stdout == f"{film}: 21 frames, t = 0 to 4, 10 frames per second\n"
    with Image.open(film) as image:
        assert (image.n_frames, image.size, image.info["duration"]) == (21, (240, 240), 100)


@pytest.mark.parametrize(("background", "bright"), [("light", True), ("dark", False)])
def test_one_picture(folder, background, bright, tmp_path):
    picture = tmp_path / "frame.png"
    arguments = ("-o", picture, "--frame", 4, "--background", background, "--size", "320x240")
    made = idealgas("animate", folder / "run.h5", *arguments)
    assert (made.exit_code, made.stderr, made.stdout) == (0, "", f"{picture}: t = 4\n")
    with Image.open(picture) as image:
        assert (image.size, image.format) == ((320, 240), "PNG")
        assert (min(image.getpixel((1, 1))) > 200) == bright


def test_without_ffmpeg_it_is_a_gif_and_says_so(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    made = idealgas("animate", folder / "run.h5", "-o", tmp_path / "film.mp4", "--to", 1, *SMALL)
    assert (made.exit_code, made.stderr) == (0, "")
    assert made.stdout.startswith(f"{tmp_path}/film.gif instead of {tmp_path}/film.mp4, because ffmpeg was not found: ")
    assert made.stdout.count("\n") == 1
    assert os.listdir(tmp_path) == ["film.gif"]


@pytest.mark.parametrize(
    ("log", "arguments", "message"),
    [
        ("homogeneous", (), "homogeneous.h5: has no positions to show (monte_carlo does not know where discs are)"),
        ("eventless", (), "eventless.h5: has no events to show (made with log.events = false)"),
        ("run", ("--from", 5, "--to", 5), "run.h5: no window from t = 5 to 5: the log covers t = 0 to 30"),
        ("run", ("--from", 31), "run.h5: no window from t = 31 to 30: the log covers t = 0 to 30"),
        ("run", ("--to", 31), "run.h5: no window from t = 0 to 31: the log covers t = 0 to 30"),
        ("run", ("--speed", 1e-9, "--to", 30), "frames are too many (allowed <= 1,000,000)"),
        ("run", ("-o", "film.avi"), "film.avi: unknown kind of film (allowed: .mp4, .gif)"),
        ("run", ("-o", "film"), "film: unknown kind of film (allowed: .mp4, .gif)"),
        ("run", ("-o", "no/film.gif"), "no/film.gif: no folder no"),
        ("piston", ("--colour", "order"), "piston.h5: has a piston, and neighbours are told in a box whose sides stay"),
        ("run", ("--frame", 4), "film.gif: unknown figure format (allowed .png)"),
        ("run", ("--frame", 31, "-o", "a.png"), "run.h5: no state at t = 31: it covers t = 0 to 30"),
        ("none", (), "none.h5: cannot be read: No such file or directory"),
    ],
)
def test_bad_input_is_one_line(folder, log, arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    result = idealgas("animate", folder / f"{log}.h5", "-o", "film.gif", *arguments)
    assert (result.exit_code, result.stdout) == (2, "")
    assert message in result.stderr
    assert result.stderr.count("\n") == 1
    assert os.listdir(tmp_path) == []


@pytest.mark.parametrize(
    "arguments",
    [("--size", "960"), ("--size", "100x100"), ("--size", "9000x300"), ("--fps", 0), ("--speed", 0), ("--speed", -1)],
)
def test_options_out_of_range(folder, arguments, tmp_path):
    result = idealgas("animate", folder / "run.h5", "-o", tmp_path / "film.gif", *arguments)
    assert result.exit_code == 2
    assert f"Invalid value for '{arguments[0]}'" in result.stderr
    assert os.listdir(tmp_path) == []


def test_a_film_that_cannot_be_written(folder, tmp_path):
    (tmp_path / "film.gif").mkdir()
    result = idealgas("animate", folder / "run.h5", "-o", tmp_path / "film.gif", "--to", 1, *SMALL)
    assert (result.exit_code, result.stdout) == (2, "")
    assert result.stderr == f"{tmp_path}/film.gif: is a folder\n"
    assert os.listdir(tmp_path) == ["film.gif"]
