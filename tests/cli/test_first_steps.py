"""From nothing to a scene: `new`, `examples` and `schema`."""

import base64
import html
import io
import json
import re
import tomllib

import numpy as np
import pytest
from helpers.support import ROOT, called, error_of, idealgas, logged, output_of
from PIL import Image

from idealgas.examples import first_sentence, load_example
from idealgas.gallery import draw
from idealgas.movie.film import paint_frame
from idealgas.scene import parse_scene

CONFIGS = ROOT / "configs"
SCENES = sorted(path.stem for path in CONFIGS.glob("*.toml"))
NOTEBOOKS = sorted(path.stem for path in (CONFIGS / "notebooks").glob("*.ipynb"))


def test_examples_are_listed_with_what_they_show():
    listed = dict(line.split(maxsplit=1) for line in called("examples").stdout.splitlines())
    assert sorted(listed) == sorted(SCENES + NOTEBOOKS)
    assert listed["lesson-2-pressure"] == "Lesson 2: PV = NkT, and what hard discs add"
    for name, text in ((name, listed[name]) for name in SCENES):
        scene = tomllib.loads((CONFIGS / f"{name}.toml").read_text())["scene"]
        assert " ".join(scene.get("description", scene["title"]).split()).startswith(text)
    assert listed["brownian"] == "Brownian motion: four large, heavy discs among a thousand light ones."
    narrow = idealgas("examples", COLUMNS="70").stdout.splitlines()
    assert max(map(len, narrow)) <= 70


def test_the_first_sentence_of_a_description_and_the_rest():
    assert first_sentence("Joule's\ngas. It grows.\n\n  a  table\n") == ("Joule's gas.", "It grows.\n\n  a  table")
    assert first_sentence("\nA 0.5 gas.\n\nMore. Text.") == ("A 0.5 gas.", "More. Text.")
    assert first_sentence("") == ("", "")


def test_an_example_is_copied_and_can_be_checked(tmp_path):
    done = idealgas("examples", "piston", folder=tmp_path)
    assert (done.returncode, done.stderr) == (0, "")
    assert done.stdout == "piston.toml: written\nscene.schema.json: written\n"
    for name in ("piston.toml", "scene.schema.json"):
        assert (tmp_path / name).read_bytes() == (CONFIGS / name).read_bytes()
    assert called("check", "piston.toml", folder=tmp_path).returncode == 0
    again = error_of("examples", "piston", folder=tmp_path)
    assert again == "piston.toml: already exists (use --force to overwrite)\n"
    assert called("examples", "piston", "--force", folder=tmp_path).returncode == 0
    assert called("examples", "quickstart.toml", "-o", "mine.toml", folder=tmp_path).returncode == 0
    assert (tmp_path / "mine.toml").read_bytes() == (CONFIGS / "quickstart.toml").read_bytes()


def test_a_notebook_is_copied(tmp_path):
    done = called("examples", "lesson-2-pressure", folder=tmp_path)
    assert done.stdout == "lesson-2-pressure.ipynb: written\n"
    (copy,) = tmp_path.iterdir()
    assert copy.read_bytes() == (CONFIGS / "notebooks" / copy.name).read_bytes()
    assert error_of("examples", copy.name, folder=tmp_path).startswith(f"{copy.name}: already exists")


def test_the_gallery_of_a_scene_is_one_page_with_its_picture(tmp_path):
    done = idealgas("examples", "corner", "--gallery", "page.html", folder=tmp_path)
    assert (done.returncode, done.stdout, done.stderr) == (0, "page.html: written\n", "")
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    scene = tomllib.loads((CONFIGS / "corner.toml").read_text(encoding="utf-8"))["scene"]
    text = html.unescape(page)
    assert f"<h2>{scene['title']}</h2>" in text
    prose, table, *_ = scene["description"].split("\n\n")
    assert f'<p>{" ".join(prose.split())}</p><pre tabindex="0">{table}</pre>' in text
    assert "idealgas run corner.toml -o corner.h5" in text
    (picture,) = re.findall(r'src="data:image/png;base64,([^"]+)"', page)
    with Image.open(io.BytesIO(base64.b64decode(picture))) as image:
        assert image.width >= 540
        assert len(image.convert("RGB").getcolors(1 << 20)) > 10
    assert not re.search(r"https?:|<script", page)
    assert called("examples", "corner", "--gallery", "page.html", folder=tmp_path).returncode == 2
    for words in (("pistn", "--gallery", "a.html"), ("--gallery", "a.txt"), ("-o", "a.toml", "--gallery", "a.html")):
        assert error_of("examples", *words, folder=tmp_path).count("\n") == 1
    assert [path.name for path in tmp_path.iterdir()] == ["page.html"]


@pytest.mark.interpreted
def test_a_picture_of_the_gallery_shows_the_start_of_the_run(tmp_path):
    with logged(load_example("mixture", ["run.events=10"]), tmp_path / "run.h5") as log:
        paint_frame(log, tmp_path / "frame.png", 0.0, colouring="species", panel="none")
    with Image.open(io.BytesIO(draw("mixture"))) as drawn, Image.open(tmp_path / "frame.png") as frame:
        assert np.array_equal(np.asarray(drawn), np.asarray(frame))


def test_the_gallery_has_all_scenes(tmp_path):
    assert called("examples", "--gallery", "page.html", folder=tmp_path).returncode == 0
    page = (tmp_path / "page.html").read_text(encoding="utf-8")
    assert re.findall(r'<section id="([\w-]+)"', page) == [name for name in SCENES if name != "template"]
    assert page.count('src="data:image/png') == len(SCENES) - 2, "all but the template and the gas without positions"


def test_a_new_scene_is_valid_or_goes_to_standard_output(tmp_path):
    assert output_of("new", "-", folder=tmp_path) == (CONFIGS / "template.toml").read_text(encoding="utf-8")
    assert not list(tmp_path.iterdir())
    assert called("new", "gas", folder=tmp_path).stdout == "gas.toml: written\nscene.schema.json: written\n"
    assert called("check", "gas.toml", folder=tmp_path).returncode == 0
    assert called("new", "gas", folder=tmp_path).returncode == 2
    (tmp_path / "other.toml").write_text("precious = 1")
    error_of("new", "other", "--force", folder=tmp_path)
    assert (tmp_path / "other.toml").read_text() == "precious = 1"


TABLES = ("[[disc]]", "[[wall]]", "[gravity]", "[rotation]", "[restitution]", "[[piston]]")


@pytest.mark.parametrize(("table", "which"), [*((table, 1) for table in TABLES), ("[[wall]]", 2)])
def test_every_table_of_the_template_is_valid_without_its_comment_signs(table, which):
    parts = (CONFIGS / "template.toml").read_text(encoding="utf-8").split(start := f"\n# {table}")
    before, block = start.join(parts[:which]), start.join(parts[which:])
    lines, after = block.split("\n\n", 1)
    scene = parse_scene(f"{before}\n{table}{lines.replace(chr(10) + '# ', chr(10))}\n\n{after}")
    assert getattr(scene, table.strip("[]"))


@pytest.mark.parametrize("kind", ["scene", "sweep"])
def test_the_schema_beside_the_scenes_is_this_one(kind):
    printed = called("schema", kind).stdout
    assert (CONFIGS / f"{kind}.schema.json").read_text(encoding="utf-8") == printed
    assert json.loads(printed)["additionalProperties"] is False


def test_every_shipped_file_names_a_schema_that_is_there():
    for path in CONFIGS.rglob("*.toml"):
        first = path.read_text(encoding="utf-8").splitlines()[0]
        kind = "sweep" if path.parent.name in ("sweeps", "classics") else "scene"
        named = path.parent / first.removeprefix("#:schema ")
        assert named.resolve() == (CONFIGS / f"{kind}.schema.json").resolve(), path


def test_the_schema_takes_shipped_scenes_and_no_wrong_ones():
    import jsonschema

    check = jsonschema.Draft202012Validator(json.loads((CONFIGS / "scene.schema.json").read_text(encoding="utf-8")))
    for name in SCENES:
        assert check.is_valid(tomllib.loads((CONFIGS / f"{name}.toml").read_text(encoding="utf-8"))), name
    wrong = tomllib.loads((CONFIGS / "quickstart.toml").read_text(encoding="utf-8"))
    wrong_keys = ("box", "sise", [1, 1]), ("scene", "seed", -1), ("run", "until", 0), ("box", "size", [0, 1])
    for table, key, value in wrong_keys:
        assert not check.is_valid(wrong | {table: wrong[table] | {key: value}}), key
