"""Films: which instants they show, what is painted where, and whether the files are films."""

import json
import os
import subprocess
import sys
from types import ModuleType

import numpy as np
import pytest
from helpers.logs import PERIODIC, log_of, raised
from matplotlib.figure import Figure
from PIL import Image

from idealgas.initial.build import make_gas
from idealgas.log import LogState
from idealgas.movie import film
from idealgas.movie.film import animate
from idealgas.movie.gif import GifWriter
from idealgas.movie.layout import LEFT, layout, view
from idealgas.movie.painter import Painter
from idealgas.movie.panels import DensityPanel, SidesPanel
from idealgas.movie.piston_track import PistonTrack
from idealgas.report.player import player
from idealgas.scene import parse_scene

SIZE = (960, 540)
STATE = LogState(2.5, np.array([[2.0, 7.0], [8.0, 1.0]]), np.array([[1.0, 0.0], [0.0, 1.0]]))
WHITE = 250


TEXT = """
scene.title = "two"
box.size = [10, 10]
run.until = 20
disc = [
    { position = [2, 7], velocity = [1, 0], radius = 0.5 },
    { position = [8, 1], velocity = [0, 1], radius = 0.01 },
]
"""


def scene(extra=""):
    return parse_scene(TEXT + extra)


def paint(extra="", state=STATE, pistons=(), by_species=False, size=SIZE):
    """(height, width, 3) of a frame, and at(x, y): its pixel there in the box."""
    made = scene(extra)
    painter = Painter(made, make_gas(made), pistons, 1.0, size=size, colouring="species" if by_species else "speed")
    frame = painter.paint(state).copy()[..., :3].astype(int)
    place = layout(size, (10.0, 10.0))

    def at(x, y):
        return frame[round(size[1] - place.box[1] - y * place.scale), round(place.box[0] + x * place.scale)]

    return frame, at


@pytest.mark.parametrize("size", [(960, 540), (540, 960), (480, 480), (1920, 400)])
@pytest.mark.parametrize("box", [(1.0, 1.0), (20.0, 1.0), (1.0, 20.0), (1e-3, 2e-3)])
def test_box_and_speeds_are_in_the_frame_and_apart(size, box):
    place = layout(size, box)
    for x, y, width, height in (place.box, place.panel):
        assert LEFT <= x < x + width < size[0]
        assert 0 < y < y + height < size[1]
    assert place.box[2:] == pytest.approx((box[0] * place.scale, box[1] * place.scale))
    (x, y, width, height), (u, v, wide, high) = place.box, place.panel
    assert x + width < u or v + high < y
    assert wide * high > 0.1 * size[0] * size[1]


def test_the_room_beyond_a_piston_is_shown_in_part():
    place = np.array([4.0, 5.0])
    right = PistonTrack(0, place, place, 0 * place, (0.0, 40.0), 1.0, "piston")
    left = PistonTrack(0, place, 40 - place, 0 * place, (0.0, 40.0), -1.0, "piston")
    assert view((40.0, 10.0), [right]) == ((0.0, 6.25), (0.0, 10.0))
    assert view((40.0, 10.0), [left]) == ((33.75, 40.0), (0.0, 10.0))
    assert view((40.0, 10.0), []) == ((0.0, 40.0), (0.0, 10.0))


def test_discs_are_where_they_are():
    _, at = paint()
    assert at(8, 1).min() < 200  # the smallest disc is seen
    assert at(2, 7).max() < WHITE
    assert at(2.45, 7).max() < WHITE
    assert at(2, 6.55).max() < WHITE
    assert at(2.6, 7).min() > WHITE
    assert at(5, 5).min() > WHITE


def test_discs_at_joined_sides_show_their_other_half():
    state = STATE._replace(position=np.array([[0.1, 9.9], [5.0, 5.0]]))
    made = parse_scene(TEXT, overrides=(*PERIODIC, "disc.1.radius=0.5"))
    painter = Painter(made, make_gas(made), (), 1.0, size=SIZE)
    frame = painter.paint(state)[..., :3]
    place = layout(SIZE, (10.0, 10.0))
    for x, y in ((0.25, 9.75), (9.75, 9.75), (0.25, 0.25), (9.75, 0.25)):
        assert frame[round(540 - place.box[1] - y * place.scale), round(place.box[0] + x * place.scale)].max() < WHITE


def test_images_beyond_sheared_sides_move():
    """At t = 6 the image above is 0.25 · 10 · 6 = 15 ahead, so that the halves of a disc are 5 apart."""
    sides = "".join(f"box.{side}.shear = 0.25\n" for side in ("bottom", "top"))
    sides += 'box.left = "periodic"\nbox.right = "periodic"\n'
    made = parse_scene(sides + "box.size = [10, 10]\nrun.until = 1\n" + "".join(
        f"[[disc]]\nposition = [{x}, 5]\nvelocity = [1, 0]\nradius = 0.5\n" for x in (2, 8)
    ))  # fmt: skip
    painter = Painter(made, make_gas(made), (), 1.0, size=SIZE)
    state = STATE._replace(position=np.array([[2.0, 0.1], [5.1, 9.9]]), time=6.0)
    frame, place = painter.paint(state)[..., :3], layout(SIZE, (10.0, 10.0))

    def at(x, y):
        return frame[round(540 - place.box[1] - y * place.scale), round(place.box[0] + x * place.scale)]

    for x, y in ((2, 0.25), (7, 9.75), (5.1, 9.75), (0.25, 0.25), (9.75, 0.25)):
        assert at(x, y).max() < WHITE
    for x, y in ((2, 9.75), (5.1, 0.25)):
        assert at(x, y).min() > WHITE


def test_a_gate_is_there_until_it_opens():
    wall = "[[wall]]\nfrom = [5, 3]\nto = [5, 9]\nopens_at = 3\n"
    assert paint(wall)[1](5, 6).max() < 100
    assert paint(wall, STATE._replace(time=3.0))[1](5, 6).min() > WHITE


def test_the_piston_is_drawn():
    track = PistonTrack(0, np.array([0.0, 4.0]), np.array([4.0, 8.0]), np.zeros(2), (0.0, 10.0), 1.0, "piston")
    red, green, blue = paint(pistons=[track])[1](6.5, 5)
    assert red > 150 > green > blue
    assert paint(pistons=[track])[1](6.2, 5).min() > WHITE


@pytest.mark.parametrize(("name", "place"), [("piston", 10.0), ("right piston", 9.4), ("right piston", 10.0)])
def test_the_name_of_a_piston_at_the_edge_is_whole(name, place):
    made = scene()
    track = PistonTrack(0, np.array([0.0, 4.0]), np.array([9.0, place]), np.zeros(2), (0.0, 10.0), 1.0, name)
    for size in ((720, 720), (360, 360)):
        painter = Painter(made, make_gas(made), [track], 1.0, size=size, panel="none")
        frame = painter.paint(STATE._replace(time=4.0))[..., :3]
        assert frame[:, -2:].min() > WHITE


def test_frames_of_the_same_state_are_the_same_whatever_came_before():
    made = scene()
    painter = Painter(made, make_gas(made), (), 1.0, size=SIZE)
    first = painter.paint(STATE).copy()
    painter.paint(STATE._replace(time=9.0, position=STATE.position + 1, velocity=3 * STATE.velocity))
    assert np.array_equal(painter.paint(STATE), first)


@pytest.mark.parametrize("size", [(240, 240), (320, 240), (2000, 300)])
def test_frames_of_unusual_sizes(size):
    frame, _ = paint(size=size)
    assert frame.shape == (size[1], size[0], 3)


def test_a_gif_gives_its_frames_back(tmp_path):
    frames = np.full((3, 20, 30, 3), 255, np.uint8)
    frames[1, 5:9, 5:9] = (0x00, 0x72, 0xB2)
    frames[2, 5:9, 5:20] = 0
    with (tmp_path / "film.gif").open("wb") as file:
        gif = GifWriter(file, 30, 20, 4)
        for frame in frames:
            gif.write(frame)
        gif.close()
    with Image.open(tmp_path / "film.gif") as image:
        assert (image.n_frames, image.size, image.info["loop"]) == (3, (30, 20), 0)
        for k, frame in enumerate(frames):
            image.seek(k)
            assert image.info["duration"] == 40
            shown = np.asarray(image.convert("RGB")).astype(int)
            assert np.abs(shown - frame).max() <= 8


@pytest.fixture(scope="module")
def log():
    return log_of(TEXT)


def test_instants_are_even_and_in_the_window(log, tmp_path, monkeypatch):
    seen = []
    paint = Painter.paint
    monkeypatch.setattr(Painter, "paint", lambda self, state: seen.append(state) or paint(self, state))
    made = animate(log, tmp_path / "film.gif", start=3.0, end=5.0, fps=20, speed=2.0, size=(321, 240))
    expected = [log.state_at(state.time).position for state in seen]
    times = [state.time for state in seen]
    assert np.allclose(times, 3 + 0.1 * np.arange(21), rtol=0, atol=1e-12)
    assert np.array_equal([state.position for state in seen], expected)
    assert (made.frames, made.fps, made.start, made.end) == (21, 20, 3.0, 5.0)
    with Image.open(made.path) as image:
        assert (image.n_frames, image.size) == (21, (320, 240))


def test_without_an_end_it_is_twenty_seconds_of_film(log, tmp_path):
    made = animate(log, tmp_path / "film.gif", fps=2, speed=0.5, size=(240, 240))
    assert made.end == 10.0
    assert made.frames == 41


@pytest.mark.needs("ffmpeg")
@pytest.mark.slow
def test_a_video_has_all_frames(log, tmp_path):
    made = animate(log, tmp_path / "film.mp4", end=2.0, fps=25, speed=1.0, size=(321, 240))
    probe = ("ffprobe", "-v", "error", "-count_frames", "-show_streams", "-of", "json", str(made.path))
    (stream,) = json.loads(subprocess.run(probe, capture_output=True, check=True).stdout)["streams"]
    assert (stream["width"], stream["height"], stream["codec_name"]) == (320, 240, "h264")
    assert int(stream["nb_read_frames"]) == made.frames == 51


def test_ffmpeg_of_a_package(monkeypatch):
    monkeypatch.setattr(film.shutil, "which", lambda _: None)
    package = ModuleType("imageio_ffmpeg")
    package.get_ffmpeg_exe = lambda: "/there/ffmpeg"
    monkeypatch.setitem(sys.modules, "imageio_ffmpeg", package)
    assert film.ffmpeg() == "/there/ffmpeg"


@pytest.mark.parametrize(
    ("box", "size"), [((20.0, 60.0), (540, 960)), ((40.0, 20.0), (720, 720)), ((10.0, 10.0), (960, 540))]
)
def test_the_size_follows_the_box(box, size):
    made = parse_scene(f"box.size = {list(box)}\nrun.until = 1\nspecies = [{{name='a', count=9, radius=0.1, speed=1}}]")
    painter = Painter(made, make_gas(made), (), 1.0)
    assert painter.size == size
    assert painter.paint(STATE._replace(position=made_up(9, box), velocity=np.ones((9, 2)))).shape[:2] == size[::-1]


def made_up(number, box):
    return np.random.default_rng(1).random((number, 2)) * box


@pytest.mark.parametrize("panel", ["density", "left-right", "none"])
def test_other_panels(panel):
    """The same frame again for the same states; without a panel the box is as high as the frame allows."""

    def frame():
        made = scene()
        painter = Painter(made, make_gas(made), (), 1.0, (0.0, 3.0), [STATE], size=SIZE, panel=panel)
        painter.paint(STATE._replace(time=0.0))
        return painter.paint(STATE).copy()

    assert np.array_equal(frame(), frame())
    place = layout(SIZE, (10.0, 10.0), panel != "none")
    assert (place.panel is None) == (panel == "none")
    if place.panel:
        x, y, width, height = (round(v) for v in place.panel)
        assert frame()[SIZE[1] - y - height : SIZE[1] - y, x : x + width, :3].min() < WHITE


def test_the_panel_counts_the_discs_on_the_right():
    made, axes = scene("[[wall]]\nfrom = [7, 0]\nto = [7, 9]\nopens_at = 1\n"), Figure().add_subplot()
    panel = SidesPanel(axes, made, make_gas(made), "black", (0.0, 3.0))
    for time, places in ((0.0, [2.0, 6.0]), (1.0, [8.0, 6.9]), (2.0, [7.1, 9.0])):
        curve, _ = panel.update(STATE._replace(time=time, position=np.array([[x, 1.0] for x in places])), np.ones(2))
    assert np.array_equal(curve.get_data(), [[0.0, 1.0, 2.0], [0.0, 0.5, 1.0]])
    assert panel.handles[0].get_label() == "equal density"


@pytest.mark.parametrize(("y", "compared"), [(5.0, ["Maxwell-Boltzmann"]), (8.0, [])])
def test_speeds_of_discs_that_never_meet_are_not_compared_with_maxwell_boltzmann(y, compared):
    """As in the report: two discs that fly towards each other, at one height or at two."""
    discs = (f"{{position=[{x}, {at}], velocity=[{v}, 0], radius=0.5}}" for x, at, v in ((2, 5, 1), (8, y, -1)))
    log = log_of(TEXT, "run.until=10", f"disc=[{', '.join(discs)}]")
    painter = film._painter(log, 1.0, (0.0, 10.0), [], {})
    painter.paint(log.state_at(9.0))
    assert [handle.get_label() for handle in painter._panel.handles] == compared
    assert player(log).head["mixes"] == bool(compared)


def test_the_density_is_that_of_the_strips():
    """Along gravity: two discs in a strip 10 wide and 10/36 high."""
    made, axes = scene("[gravity]\nacceleration = [0, -1]"), Figure().add_subplot()
    panel = DensityPanel(axes, made, make_gas(made), "black", [])
    (bars,) = panel.update(STATE._replace(position=np.array([[1.0, 5.1], [9.0, 5.1]])), np.ones(2))
    values, edges, _ = bars.get_data()
    (strip,) = np.flatnonzero(values)
    assert edges[strip] == 5.0
    assert values.max() == pytest.approx(2 / (10 * 10 / 36))


def test_a_trail_is_a_line_between_the_frames_with_gaps_at_joined_sides():
    made = parse_scene(TEXT, overrides=(*PERIODIC[:2], "disc.0.radius=0.1", "disc.1.radius=0.1"))
    painter, place = Painter(made, make_gas(made), (), 1.0, size=SIZE, trails=[1]), layout(SIZE, (10.0, 10.0))
    for x in (6.0, 9.0, 1.0, 3.0):
        frame = painter.paint(STATE._replace(position=np.array([[5.0, 9.0], [x, 4.0]])))[..., :3]
    at = lambda x, y: frame[round(540 - place.box[1] - y * place.scale), round(place.box[0] + x * place.scale)].max()  # noqa: E731
    assert [bool(at(x, 4.0) < 200) for x in (7.5, 2.0, 5.0, 9.6)] == [True, True, False, False]
    raised(r"^trail: no disc 2 \(allowed 0 to 1\)$", Painter, made, make_gas(made), (), 1.0, trails=[0, 2])


def test_a_video_that_fails_says_why_and_leaves_nothing(log, tmp_path, monkeypatch):
    program = tmp_path / "bin" / "ffmpeg"
    program.parent.mkdir()
    program.write_text("#!/bin/sh\necho first >&2\necho 'no such codec' >&2\nexit 3\n")
    program.chmod(0o755)
    monkeypatch.setenv("PATH", str(program.parent) + os.pathsep + os.environ["PATH"])
    raised(r"^ffmpeg: no such codec$", animate, log, tmp_path / "film.mp4", end=2.0, size=(240, 240), code=1)
    assert [entry.name for entry in tmp_path.iterdir()] == ["bin"]


def test_an_old_film_survives_a_failure(log, tmp_path, monkeypatch):
    (tmp_path / "film.gif").write_bytes(b"GIF89a old")

    def fail(self, frame):
        raise OSError(28, "No space left on device")

    monkeypatch.setattr(GifWriter, "write", fail)
    film = {"output": tmp_path / "film.gif", "end": 2.0, "size": (240, 240), "force": True}
    raised("cannot be written: No space left", animate, log, code=1, **film)
    assert [(entry.name, entry.read_bytes()) for entry in tmp_path.iterdir()] == [("film.gif", b"GIF89a old")]


def test_speeds_are_relative_to_a_conserved_motion_of_the_gas():
    """The picture of the speeds is that of the same gas at rest as a whole."""

    def speeds(flow):
        velocities = [[flow + v, 0.0] for v in (1, -1)]
        made = parse_scene(TEXT, overrides=(*PERIODIC, *(f"disc.{k}.velocity={v}" for k, v in enumerate(velocities))))
        frame = Painter(made, make_gas(made), (), 1.0, size=SIZE).paint(STATE._replace(velocity=np.array(velocities)))
        x, y, width, height = (round(v) for v in layout(SIZE, (10.0, 10.0)).panel)
        return frame[SIZE[1] - y - height + 4 : SIZE[1] - y - 4, x + 4 : x + width - 4].copy()

    assert np.array_equal(speeds(10.0), speeds(0.0))
