"""What is damaged is never taken for what does not apply."""

from types import SimpleNamespace

import pytest
from helpers.logs import gas

from idealgas.analysis import status as module
from idealgas.analysis.status import status
from idealgas.log import DamageError
from idealgas.report import sections

GAS = gas(9, 0.1, (8, 8), "events = 50")


def damaged(log, *_, **__):
    raise DamageError(log.path, "events/kind: a checksum does not match")


def test_in_a_status(log, monkeypatch):
    monkeypatch.setattr(module, "pressure", damaged)
    with pytest.raises(DamageError):
        status(log)


def test_in_a_section_of_a_report(log, monkeypatch):
    section = SimpleNamespace(title="Pressure", options={})
    analysis = SimpleNamespace(sections=(section,), analyse=damaged, combined=list, reported_from=0, on_request=False)
    monkeypatch.setattr(sections.registry, "analyses", lambda: (analysis,))
    with pytest.raises(DamageError):
        sections.make_sections(log)
