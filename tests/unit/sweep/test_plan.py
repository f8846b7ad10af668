import math

import pytest

from idealgas.scene import SceneError
from idealgas.sweep.plan import load_sweep

BASE = """
[base]
box.size = [10, 5]
species = [{name = "gas", count = 20, radius = 0.1, temperature = 1.0}]
run.events = 100
"""


@pytest.fixture
def sweep(tmp_path):
    def load(text, name="sweep.toml"):
        (tmp_path / name).write_text(text)
        return load_sweep(tmp_path / name)

    return load


def test_axes_are_crossed_and_zipped(sweep):
    found = sweep(
        """
        axis = [
            {key = "species.gas.radius", values = [0.1, 0.2], zip = "a"},
            {key = "species.gas.temperature", range = [1, 2, 3]},
            {key = "species.gas.mass", log_range = [1, 4, 2], zip = "a"},
        ]
        """
        + BASE
    )
    taken = [
        tuple(point.values[f"species.gas.{key}"] for key in ("radius", "mass", "temperature")) for point in found.points
    ]
    assert taken == [(r, m, t) for r, m in ((0.1, 1.0), (0.2, 4.0)) for t in (1.0, 1.5, 2.0)]
    assert [
        (p.scene.species[0].radius, p.scene.species[0].mass, p.scene.species[0].temperature) for p in found.points
    ] == taken
    assert [point.index for point in found.points] == list(range(6))


def test_whole_numbers_of_a_range_are_whole(sweep):
    """As a count wants them; geometric steps in floats come to 23.999999999999993."""
    found = sweep('axis = [{key = "species.gas.count", log_range = [3, 48, 5]}]\n' + BASE)
    assert [point.scene.species[0].count for point in found.points] == [3, 6, 12, 24, 48]


def test_phi_scales_the_box_after_all_other_axes(sweep):
    text = '[[axis]]\nkey = "phi"\nvalues = [0.01, 0.3]\n[[axis]]\nkey = "species.radius"\nvalues = [0.1, 0.4]\n'
    for point in sweep(text + BASE).points:
        width, height = point.scene.box.size
        covered = 20 * math.pi * point.values["species.radius"] ** 2
        assert covered / (width * height) == pytest.approx(point.values["phi"], rel=1e-14)
        assert width / height == pytest.approx(2.0, rel=1e-14)


def test_seeds_depend_on_the_values_number_and_the_replicate_alone(sweep):
    axis = '[[axis]]\nkey = "species.temperature"\nvalues = [1, 2, 3]\n'
    few = sweep("[sweep]\nseed = 5\nreplicates = 2\n" + axis + BASE)
    more = sweep("[sweep]\nseed = 5\nreplicates = 4\n" + axis + BASE)
    seeds = {(p.combination, p.replicate): p.scene.scene.seed for p in more.points}
    assert all(seeds[p.combination, p.replicate] == p.scene.scene.seed for p in few.points)
    assert len(set(seeds.values())) == 12
    others = sweep("[sweep]\nseed = 6\nreplicates = 2\n" + axis + BASE)
    assert not {p.scene.scene.seed for p in others.points} & set(seeds.values())


def test_base_scenes_in_files_of_their_own(sweep, tmp_path):
    scene = BASE.replace("[base]", "")
    (tmp_path / "folder").mkdir()
    (tmp_path / "folder" / "a.toml").write_text(scene)
    (tmp_path / "b.toml").write_text(scene.replace("count = 20", "count = 30"))
    assert [p.scene.species[0].count for p in sweep('sweep.scene = "b.toml"').points] == [30]
    both = sweep('[[axis]]\nkey = "base"\nvalues = ["folder/a.toml", "b.toml"]\n')
    assert [p.scene.species[0].count for p in both.points] == [20, 30]


@pytest.mark.parametrize(
    ("text", "lines"),
    [
        ("sweep.seeds = 1\n" + BASE, ["1: sweep.seeds: unknown key, did you mean"]),
        ("[[axis]]\nkey = 3\n" + BASE, ["2: axis.0.key: wrong type (got 3; allowed text in quotes)"]),
        ('[[axis]]\nkey = "phi"\n' + BASE, ["1: axis.0: not one list of values (got nothing"]),
        (
            '[[axis]]\nkey = "phi"\nvalues = [1]\nrange = [0, 1, 2]\n' + BASE,
            ["1: axis.0: not one list of values (got values and"],
        ),
        ('[[axis]]\nkey = "scene.seed"\nvalues = [1]\n' + BASE, ["2: axis.0.key: seeds are not an axis"]),
        ("sweep.seed = 1\n", ["1: sweep.scene: not one base scene (got nothing"]),
        ('sweep.scene = "x.toml"\n' + BASE, ["1: sweep.scene: not one base scene (got sweep.scene and [base]"]),
        ('sweep.scene = "missing.toml"\n', ["missing.toml: cannot be read"]),
        ('sweep.analyses = ["speed"]\n' + BASE, ["1: sweep.analyses.0: unknown value"]),
        (
            'axis = [{key = "species.mass", values = [1, 2], zip = "a"},\n'
            '{key = "species.radius", values = [1], zip = "a"}]\n' + BASE,
            ["2: axis.1.zip: not as long as the axes it goes along with (got 1 values; allowed 2"],
        ),
        (
            '[[axis]]\nkey = "species.radius"\nvalues = [0.1, -1, 4]\n' + BASE,
            [
                "2: species.radius = -1: species.0.radius: out of range",
                "2: species.radius = 4: species.0.radius: discs wider",
            ],
        ),
        (
            '[[axis]]\nkey = "species.neon.mass"\nvalues = [1]\n' + BASE,
            ["2: species.neon.mass = 1: nothing of this name"],
        ),
        ('[[axis]]\nkey = "phi"\nvalues = [0.5, 1.5]\n' + BASE, ["2: phi = 1.5: not a packing fraction"]),
        (
            '[[axis]]\nkey = "phi"\nvalues = [0.1]\n' + BASE + "disc = [{position = [1, 1], radius = 0.1}]\n",
            ["2: phi = 0.1: the box alone is scaled (got a scene with disc"],
        ),
        (BASE.replace("events = 100", "events = 0"), ["5: run.events: out of range"]),
        ("sweep = [", ["1: not TOML"]),
    ],
)
def test_faults_are_lines_with_their_place(sweep, tmp_path, text, lines):
    with pytest.raises(SceneError) as caught:
        sweep(text)
    assert len(caught.value.errors) == len(lines)
    for found, expected in zip(caught.value.errors, lines, strict=True):
        place = str(tmp_path) + "/" if expected.startswith("missing") else f"{tmp_path / 'sweep.toml'}:"
        assert found.startswith(place + expected)
