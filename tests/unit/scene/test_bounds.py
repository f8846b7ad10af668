"""Scenes that are too large for memory or patience are refused with one line, before any long work."""

import numpy as np
import pytest
from helpers.support import refused

from idealgas import Scene, SceneError, load_scene, parse_scene
from idealgas.columns import MOST_SPECIES, MOST_WALLS
from idealgas.scene.checks import MOST_DISCS
from idealgas.toml.text import MOST_BYTES, MOST_PARTS, MOST_TEXT

HEAD = "box.size = [100, 100]\nrun.until = 1\n"
GAS = '[[species]]\nname = "a"\ncount = {}\nradius = 1e-6\ntemperature = 1\n'


def error(text):
    (line,) = refused(text)
    return line


def species(number):
    return "".join(f'[[species]]\nname = "s{k}"\ncount = 1\nradius = 1e-6\ntemperature = 1\n' for k in range(number))


def walls(number):
    rows = (f"{{ from = [{k / number}, 1], to = [{k / number}, 2] }}" for k in range(1, number + 1))
    return f"wall = [{', '.join(rows)}]\n"


@pytest.mark.parametrize(
    ("text", "message"),
    [
        (HEAD + species(MOST_SPECIES + 1), f"species: too many species (got 1,001; allowed <= {MOST_SPECIES:,})"),
        (walls(MOST_WALLS + 1) + HEAD + species(1), f"wall: too many walls (got 10,001; allowed <= {MOST_WALLS:,})"),
        (HEAD + GAS.format(10**7), f"species: too many discs (got 10,000,000; allowed <= {MOST_DISCS:,})"),
        (HEAD + "#" * MOST_TEXT, f"too long (got {MOST_TEXT + len(HEAD):,} characters; allowed <= {MOST_TEXT:,}"),
        (HEAD + ".".join("a" * (MOST_PARTS + 1)) + " = 1", "<scene>:3: a key with too many parts"),
        (HEAD + "[" + " . ".join(['"a"'] * 30_000) + "]", "<scene>:3: a key with too many parts"),
        (HEAD + "x = {" + ".".join("a" * 30_000) + " = 1}", "<scene>:3: a key with too many parts"),
    ],
    ids=["species", "walls", "discs", "text", "key", "table", "inline"],
)
def test_one_line_has_the_bound(text, message):
    assert message in error(text)


@pytest.mark.parametrize(
    ("text", "message"),
    [
        ("a" * 1_000_000, "not TOML"),
        ("1." * 1000, "a key with too many parts"),
        ('"' * 1000, "not TOML"),
        ("'a" * 1000, "not TOML"),
        ("-" * 100_000, "not TOML"),
    ],
)
def test_the_search_for_long_keys_ends(text, message):
    """It would take hours if it were done again from every character."""
    assert message in error(text)


def test_many_given_discs_of_all_sizes_are_one_species():
    """10⁵ discs, each of its own radius."""
    n = 317
    place = np.stack(np.meshgrid(np.arange(n), np.arange(n)), -1).reshape(-1, 2) + 0.5
    radius = np.linspace(0.1, 0.4, n * n)
    scene = Scene(
        box={"size": (n, n)}, run={"events": 1}, discs={"position": place, "radius": radius, "velocity": place}
    )
    assert scene.explicit_discs.names == ("disc",)


def test_a_large_file_is_one_line_and_dots_in_numbers_and_texts_are_no_keys(tmp_path):
    discs = "".join(f"[[disc]]\nposition = [{k}, 1]\nradius = 0.1\n" for k in range(100_000))
    (tmp_path / "many.toml").write_text(HEAD + discs)
    with pytest.raises(
        SceneError, match=f"too large .got more; allowed <= {MOST_BYTES:,} bytes; for many discs use .start. file.$"
    ):
        load_scene(tmp_path / "many.toml")
    text = 'scene.title = "' + "e.g. " * 15 + '"\n' + HEAD + species(1)
    assert parse_scene(text).scene.title.startswith("e.g.")
