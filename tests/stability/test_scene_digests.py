"""Digests of the shipped scenes, `configs/digests.json`: the same on every machine.

Once the logs of scenes have changed (see test_golden_logs.py), this makes the table:

    PYTHONPATH=tests python tests/stability/test_scene_digests.py
"""

import json
import shutil

import pytest
from helpers.support import ROOT, called, logged, output_of

from idealgas import load_scene
from idealgas.log.digest import digest
from idealgas.run.digest import EVENTS, scene_digest

TABLE = ROOT / "configs" / "digests.json"
SCENES = sorted(ROOT.glob("configs/*.toml"))
QUICK = {"quickstart", "novak-bortz", "heat-bath"}


def on_record():
    return json.loads(TABLE.read_text())


def test_every_scene_is_on_record():
    assert [*on_record()] == [path.stem for path in SCENES]


@pytest.mark.parametrize(
    "name", [pytest.param(p.stem, marks=[] if p.stem in QUICK else pytest.mark.slow) for p in SCENES]
)
def test_a_scene_has_its_digest(name):
    assert output_of("digest", "--check", name) == f"{name}: same {on_record()[name]}\n"


def test_a_difference_gives_exit_code_1(tmp_path, monkeypatch):
    shutil.copy(ROOT / "configs" / "quickstart.toml", tmp_path)
    (tmp_path / "digests.json").write_text(json.dumps({"quickstart": "0" * 64}))
    for module in ("idealgas.examples", "idealgas_cli.digest"):
        monkeypatch.setattr(f"{module}.path_of", tmp_path.joinpath)
    done = called("digest", "--check")
    assert (done.returncode, done.stdout, done.stderr) == (1, f"quickstart: differs {on_record()['quickstart']}\n", "")
    assert called("digest", "--check", "nothing").returncode == 2


def test_storage_does_not_matter_and_one_disc_does(tmp_path):
    actual = []
    quickstart = ROOT / "configs" / "quickstart.toml"
    for changes in ((), ('log.compression="none"', "run.threads=2"), ("scene.seed=99",)):
        path = tmp_path / f"{len(actual)}.h5"
        with logged(load_scene(quickstart, [f"run.events={EVENTS}", *changes]), path) as log:
            actual.append(digest(log))
        assert output_of("digest", path) == actual[-1] + "\n"
    assert actual[0] == actual[1] == on_record()["quickstart"] != actual[2]


def write_table() -> None:
    """Run every scene and write the table."""
    TABLE.write_text(json.dumps({path.stem: scene_digest(path) for path in SCENES}, indent=1) + "\n")


if __name__ == "__main__":
    write_table()
