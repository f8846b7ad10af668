"""The shipped notebook, run as a user runs it."""

import shutil

import pytest
from helpers.support import ROOT

NOTEBOOK = ROOT / "configs" / "notebooks" / "first-steps.ipynb"


@pytest.fixture(scope="module")
def shown(tmp_path_factory):
    """Notebook with what its cells show."""
    nbformat = pytest.importorskip("nbformat", reason="no nbclient: pip install nbclient ipykernel")
    nbclient = pytest.importorskip("nbclient")
    folder = tmp_path_factory.mktemp("notebook")
    shutil.copy(NOTEBOOK, folder)
    notebook = nbformat.read(folder / NOTEBOOK.name, as_version=4)
    kernel = {"metadata": {"path": folder}}  # where it runs
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources=kernel).execute()
    assert list(folder.iterdir()) == [folder / NOTEBOOK.name]
    return [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]


def data(shown, kind):
    return [output.data[kind] for output in shown if kind in output.get("data", {})]


@pytest.mark.slow
def test_the_notebook_runs(shown):
    """A cell that fails ends it."""
    assert [output.text for output in shown if output.get("name") == "stderr"] == []
    assert len(data(shown, "image/png")) == 4
    tables = "".join(data(shown, "text/html"))
    for words in ("Maxwell-Boltzmann", "Z = PA/NT", "pairs, virial", "<th>deviation</th>"):
        assert words in tables
    assert data(shown, "text/plain").count("True") == 1  # measurement and theory agree
    printed = "".join(output.text for output in shown if output.get("name") == "stdout")
    assert "12 points run, 0 done before, 0 failed" in printed
    assert "efficiency 0.4" in printed


def test_the_notebook_is_without_results():
    """They would be those of another version."""
    text = NOTEBOOK.read_text(encoding="utf-8")
    assert text.count('"outputs": []') == text.count('"cell_type": "code"') == text.count('"execution_count": null') > 0
