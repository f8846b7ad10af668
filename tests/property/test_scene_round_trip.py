"""Scenes of all kinds survive being written and read: every float to the last bit, every line found."""

import operator
import string
import tomllib

from hypothesis import given
from hypothesis import strategies as st

from idealgas.scene import parse_scene
from idealgas.toml.dump import dump_document, toml_value
from idealgas.toml.table import LARGEST, SMALLEST
from idealgas.toml.text import key_lines

WIDTH, HEIGHT = 1000.0, 500.0

positive = st.floats(SMALLEST, LARGEST)
numbers = st.just(0.0) | positive | positive.map(operator.neg)
not_negative = st.just(0.0) | positive | st.integers(0, 10**20)
texts = st.text(st.characters(exclude_categories=("Cs",)))
names = st.text(string.ascii_letters + "äßλ" + "_", min_size=1, max_size=8).filter(lambda name: name != "disc")


@st.composite
def species(draw, name):
    count = draw(st.integers(1, 4))
    motion = draw(st.sampled_from(["temperature", "speed", "velocities"]))
    vectors = st.lists(st.tuples(numbers, numbers).map(list), min_size=count, max_size=count)
    table = {
        "name": name,
        "count": count,
        "radius": draw(st.floats(1e-5, 1)),
        motion: draw(vectors if motion == "velocities" else not_negative),
    }
    optional = {"mass": positive, "placement": st.sampled_from(["random", "lattice"])}
    table |= {key: draw(values) for key, values in optional.items() if draw(st.booleans())}
    if draw(st.booleans()):
        table["region"] = [
            draw(st.floats(SMALLEST, 400)),
            draw(st.floats(SMALLEST, 200)),
            draw(st.floats(500, 1000)),
            500,
        ]
    return table


@st.composite
def documents(draw):
    return {
        "scene": {"title": draw(texts), "seed": draw(st.integers(0, 2**63 - 1))},
        "box": {"size": [WIDTH, HEIGHT]},
        "species": [draw(species(name)) for name in draw(st.lists(names, max_size=4, unique=True))],
        "disc": [
            {"position": [10 * k + draw(st.floats(3, 7)), draw(st.floats(3, 497))], "radius": draw(st.floats(1e-5, 1))}
            for k in range(draw(st.integers(1, 5)))
        ],
        "run": {"until": draw(st.floats(SMALLEST, 1e-45)), "events": draw(st.integers(1, 2**63 - 1))},
        "log": {"events": draw(st.booleans()), "compression": draw(st.sampled_from(["gzip", "none"]))},
    }


@given(documents())
def test_a_dump_loads_back_to_an_equal_scene_and_every_key_has_its_line(document):
    scene = parse_scene("\n".join(f"{key} = {toml_value(value)}" for key, value in document.items()))
    text = dump_document(scene)
    again = parse_scene(text)
    assert again == scene
    assert dump_document(again) == text
    lines = key_lines(text)
    for table, content in tomllib.loads(text).items():
        tables = (
            [((table,), content)] if isinstance(content, dict) else [((table, k), c) for k, c in enumerate(content)]
        )
        for path, keys in tables:
            for key in keys:
                assert text.split("\n")[lines[(*path, key)] - 1].startswith(f"{key} = ")
