"""Which sections a report shows first."""

from helpers.support import ROOT

from idealgas import load_scene
from idealgas.report.sections import main_sections


def test_a_gas_with_holes_begins_with_its_escape():
    assert main_sections(load_scene(ROOT / "configs" / "escape.toml")) == ("Escape", "Evolution")
