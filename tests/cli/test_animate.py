"""`idealgas animate`: what it says and makes."""

import os
import sys

import numpy as np
import pytest
from helpers.support import error_of, output_of
from PIL import Image

SMALL = ("--size", "240x240", "--fps", 10)


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
