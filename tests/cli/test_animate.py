"""`idealgas animate`: what it says and makes, and one line for everything it cannot do."""

import os
import sys

import numpy as np
import pytest
from helpers.support import error_of, output_of
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
        "piston": SCENE + 'piston = [{side = "right", position = 15, mass = 20, pressure = 0.1}]\n',
    }
    for name, text in logs.items():
        simulate(parse_scene(text), folder / f"{name}.h5")
    return folder


@pytest.mark.parametrize("colour", ["speed", "species", "order"])
def test_film(folder, colour, tmp_path):
    film = tmp_path / "film.gif"
    made = output_of("animate", folder / "run.h5", "-o", film, "--to", 4, "--speed", 2, "--colour", colour, *SMALL)
    assert made == f"{film}: 21 frames, t = 0 to 4, 10 frames per second\n"
    with Image.open(film) as image:
        assert (image.n_frames, image.size, image.info["duration"]) == (21, (240, 240), 100)


@pytest.mark.parametrize(("background", "bright"), [("light", True), ("dark", False)])
def test_one_picture(folder, background, bright, tmp_path):
    picture = tmp_path / "frame.png"
    arguments = ("-o", picture, "--frame", 4, "--background", background, "--size", "320x240")
    assert output_of("animate", folder / "run.h5", *arguments) == f"{picture}: t = 4\n"
    with Image.open(picture) as image:
        assert (image.size, image.format) == ((320, 240), "PNG")
        assert (min(image.getpixel((1, 1))) > 200) == bright


def test_without_ffmpeg_no_mp4_and_nothing_else(folder, tmp_path, monkeypatch):
    monkeypatch.setenv("PATH", str(tmp_path))
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", None)
    line = error_of("animate", folder / "run.h5", "-o", tmp_path / "film.mp4", "--to", 1, *SMALL)
    assert line == 'an MP4 film, unlike a GIF, requires ffmpeg: .venv/bin/pip install -e ".[film]" in the top folder\n'
    assert os.listdir(tmp_path) == []


def test_a_single_frame_has_the_trails_before_it(folder, tmp_path):
    """The path of a disc over 20 units of time is ink, where nothing was before."""
    dark = []
    for name, trail in (("alone", ()), ("trail", ("--trail", 0))):
        picture = tmp_path / f"{name}.png"
        output_of("animate", folder / "run.h5", "-o", picture, "--frame", 20, "--panel", "none", *trail, *SMALL)
        with Image.open(picture) as image:
            dark.append((np.asarray(image.convert("L")) < 60).sum())
    assert dark[1] > dark[0] + 50


@pytest.mark.parametrize("panel", ["density", "left-right", "none"])
def test_panels_and_trails(folder, panel, tmp_path):
    film = tmp_path / "film.gif"
    output_of("animate", folder / "run.h5", "-o", film, "--to", 2, "--panel", panel, "--trail", 3, "--trail", 0, *SMALL)
    with Image.open(film) as image:
        assert image.n_frames > 2


@pytest.mark.parametrize(
    ("log", "arguments", "message"),
    [
        ("homogeneous", (), "homogeneous.h5: has no positions to show (monte_carlo)"),
        ("eventless", (), "eventless.h5: has no events (made with log.events = false)"),
        ("run", ("--from", 5, "--to", 5), "run.h5: empty time window t = 5 to 5: the log covers t = 0 to 30"),
        ("run", ("--to", 31), "run.h5: empty time window t = 0 to 31: the log covers t = 0 to 30"),
        ("run", ("--speed", 1e-9, "--to", 30), "frames are too many (allowed <= 1,000,000)"),
        ("run", ("-o", "film.avi"), "film.avi: unknown kind of film (allowed: .mp4, .gif)"),
        ("piston", ("--colour", "order"), "has a piston, and neighbours are only found in a box with fixed sides"),
        ("run", ("--frame", 4), "film.gif: unknown figure format (allowed .png)"),
        ("run", ("--frame", 31, "-o", "a.png"), "run.h5: no state at t = 31: the log covers t = 0 to 30"),
        ("run", ("-o", "folder.gif"), "folder.gif: is a folder"),
        ("run", ("--trail", 20), "trail: no disc 20 (allowed 0 to 19)"),
    ],
)
def test_bad_input_is_one_line(folder, log, arguments, message, tmp_path, monkeypatch):
    monkeypatch.chdir(tmp_path)
    (tmp_path / "folder.gif").mkdir()
    assert message in error_of("animate", folder / f"{log}.h5", "-o", "film.gif", *arguments)
    assert os.listdir(tmp_path) == ["folder.gif"]


@pytest.mark.parametrize(
    "arguments",
    [("--size", "960"), ("--size", "100x100"), ("--size", "9000x300"), ("--fps", 0), ("--speed", 0), ("--speed", -1)],
)
def test_options_out_of_range(folder, arguments, tmp_path):
    line = error_of("animate", folder / "run.h5", "-o", tmp_path / "film.gif", *arguments)
    assert f"invalid value for '{arguments[0]}'" in line
    assert os.listdir(tmp_path) == []
