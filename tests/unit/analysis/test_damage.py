"""What is damaged is never taken for what does not apply."""

from types import SimpleNamespace

import pytest
from helpers.log_compare import scene_of

from idealgas.analysis import status as module
from idealgas.analysis.status import status
from idealgas.log import DamageError, open_log
from idealgas.report import sections
from idealgas.run.simulate import simulate


def damaged(log, *_, **__):
    raise DamageError(log.path, "events/kind: a checksum does not match")


@pytest.fixture(scope="module")
def log(tmp_path_factory):
    path = tmp_path_factory.mktemp("damage") / "run.h5"
    simulate(scene_of("mixture", "run.events=50"), path)
    with open_log(path) as log:
        yield log


def test_in_a_status(log, monkeypatch):
    monkeypatch.setattr(module, "pressure", damaged)
    with pytest.raises(DamageError):
        status(log)


def test_in_a_section_of_a_report(log, monkeypatch):
    section = SimpleNamespace(title="Pressure", options={})
    analysis = SimpleNamespace(sections=(section,), analyse=damaged, combined=list, reported_from=0)
    monkeypatch.setattr(sections.registry, "analyses", lambda: (analysis,))
    with pytest.raises(DamageError):
        sections.make_sections(log)
