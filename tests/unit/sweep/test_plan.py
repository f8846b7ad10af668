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


PART = '{name = "part", count = 1, radius = 0.1, temperature = 1.0, region = [0, 0, 5, 5]}'

MANY = "".join(f'[[axis]]\nkey = "species.{key}"\nrange = [1, 2, 1000]\n' for key in ("mass", "radius", "count"))
"""Three axes of 1000 values each."""


@pytest.fixture
def sweep(tmp_path):
    def load(text, name="sweep.toml"):
        (tmp_path / name).write_text(text)
        return load_sweep(tmp_path / name)

    return load


def test_axes_are_crossed_and_zipped(sweep):
    result = sweep(
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
        tuple(point.values[f"species.gas.{key}"] for key in ("radius", "mass", "temperature"))
        for point in result.points
    ]
    assert taken == [(r, m, t) for r, m in ((0.1, 1.0), (0.2, 4.0)) for t in (1.0, 1.5, 2.0)]
    assert [
        (p.scene.species[0].radius, p.scene.species[0].mass, p.scene.species[0].temperature) for p in result.points
    ] == taken
    assert [point.index for point in result.points] == list(range(6))


def test_whole_numbers_of_a_range_are_whole(sweep):
    """As a count wants them; geometric steps in floats come to 23.999999999999993."""
    result = sweep('axis = [{key = "species.gas.count", log_range = [3, 48, 5]}]\n' + BASE)
    assert [point.scene.species[0].count for point in result.points] == [3, 6, 12, 24, 48]


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
    assert min(seeds.values()) > 2**32  # of 63 bits, so that the seeds of many points differ too
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
        ('[[axis]]\nkey = "scene.seed "\nvalues = [1]\n' + BASE, ['2: axis.0.key: blanks in a key (got "scene.seed "']),
        ('[[axis]]\nkey = "species. mass"\nvalues = [1]\n' + BASE, ["2: axis.0.key: blanks in a key"]),
        (
            '[[axis]]\nkey = "scene"\nvalues = [{seed = 1}]\n' + BASE,
            ["2: scene = {seed = 1}: the seed of a scene cannot be chosen in a sweep"],
        ),
        (
            '[[axis]]\nkey = "species.mass"\nvalues = [1]\n[[axis]]\nkey = "species.gas.mass"\nvalues = [2]\n' + BASE,
            ["5: species.gas.mass = 2: replaces the value of"],
        ),
        (
            MANY + BASE,
            ["1: axis.0: too many runs (got 1,000 x 1,000 x 1,000 x 1 = 1,000,000,000; allowed at most 100,000)"],
        ),
        (
            'sweep.replicates = 100_000\n[[axis]]\nkey = "species.mass"\nrange = [1, 2, 1000]\n' + BASE,
            ["2: axis.0: too many runs (got 1,000 x 100,000 = 100,000,000; allowed at most 100,000)"],
        ),
        ("sweep.seed = 1\n", ["1: sweep.scene: not one base scene (got nothing"]),
        ('sweep.scene = "x.toml"\n' + BASE, ["1: sweep.scene: not one base scene (got sweep.scene and [base]"]),
        ('sweep.scene = "missing.toml"\n', ["missing.toml: cannot be read"]),
        ('sweep.analyses = ["speed"]\n' + BASE, ["1: sweep.analyses.0: unknown value"]),
        (
            'axis = [{key = "species.mass", values = [1, 2], zip = "a"},\n'
            '{key = "species.radius", values = [1], zip = "a"}]\n' + BASE,
            ["2: axis.1.zip: length differs from the other axes with this zip (got 1 values; allowed 2"],
        ),
        (
            '[[axis]]\nkey = "species.radius"\nvalues = [0.1, -1, 4]\n' + BASE,
            [
                "2: species.radius = -1: species.gas.radius: out of range",
                "2: species.radius = 4: species.gas.radius: discs wider",
            ],
        ),
        (
            '[[axis]]\nkey = "species.neon.mass"\nvalues = [1]\n' + BASE,
            ["2: species.neon.mass = 1: no such key or table"],
        ),
        ('[[axis]]\nkey = "phi"\nvalues = [0.5, 1.5]\n' + BASE, ["2: phi = 1.5: not a packing fraction"]),
        (
            '[[axis]]\nkey = "phi"\nvalues = [0, 1]\n' + BASE,
            [f"2: phi = {phi}: not a packing fraction" for phi in (0, 1)],
        ),
        (
            '[[axis]]\nkey = "phi"\nvalues = [0.1]\n' + BASE.replace("}]", f"}}, {PART}]"),
            ["2: phi = 0.1: phi scales only the box (got a scene with species.region"],
        ),
        (
            '[[axis]]\nkey = "phi"\nvalues = [0.1]\n' + BASE + "disc = [{position = [1, 1], radius = 0.1}]\n",
            ["2: phi = 0.1: phi scales only the box (got a scene with disc"],
        ),
        (BASE.replace("events = 100", "events = 0"), ["5: run.events: out of range"]),
        ("sweep = [", ["1: not TOML"]),
    ],
)
def test_faults_are_lines_with_their_place(sweep, tmp_path, text, lines):
    with pytest.raises(SceneError) as caught:
        sweep(text)
    assert len(caught.value.errors) == len(lines)
    for result, expected in zip(caught.value.errors, lines, strict=True):
        place = str(tmp_path) + "/" if expected.startswith("missing") else f"{tmp_path / 'sweep.toml'}:"
        assert result.startswith(place + expected)


def test_overrides_change_the_base_scene_or_the_sweep(sweep, tmp_path):
    axis = '[[axis]]\nkey = "species.temperature"\nvalues = [1, 2]\n'
    sweep(axis + BASE)
    overrides = (
        "run.events=7",
        "species.gas.count=5",
        "sweep.replicates=3",
        "axis.0.values=[4]",
        "base.box.size=[3, 4]",
    )
    result = load_sweep(tmp_path / "sweep.toml", overrides)
    (scene, *_) = scenes = [point.scene for point in result.points]
    assert (len(scenes), scene.run.events, scene.species[0].count, scene.box.size) == (3, 7, 5, (3.0, 4.0))
    assert scene.species[0].temperature == 4
    assert result.text.splitlines()[:2] == ["# sweep of 3 points by idealgas", '# --set "run.events=7"']
    (tmp_path / "gas.toml").write_text(BASE.replace("[base]", ""))
    sweep('sweep.scene = "gas.toml"\n' + axis)
    assert [p.scene.run.events for p in load_sweep(tmp_path / "sweep.toml", ["run.events=7"]).points] == [7, 7]


@pytest.mark.parametrize(
    ("override", "line"),
    [
        ("run.events=0", "--set run.events=0: run.events: out of range"),
        ("species.neon.mass=1", "--set species.neon.mass=1: no such key or table"),
        ("sweep.replicates=0", "--set sweep.replicates=0: sweep.replicates: out of range"),
        ("scene.seed=4", "--set scene.seed=4: the seed of a scene cannot be chosen in a sweep (allowed sweep.seed"),
        ("species.0.mass=4", "sweep.toml:2: species.gas.mass = 1: replaces the value of --set species.0.mass=4"),
        ("run", "--set run: not an assignment"),
    ],
)
def test_wrong_overrides_are_named(sweep, tmp_path, override, line):
    sweep('[[axis]]\nkey = "species.gas.mass"\nvalues = [1]\n' + BASE)
    with pytest.raises(SceneError) as caught:
        load_sweep(tmp_path / "sweep.toml", [override])
    assert len(caught.value.errors) == 1
    assert caught.value.errors[0].removeprefix(f"{tmp_path}/").startswith(line)
