"""The shipped notebooks, run as a user runs them."""

import shutil

import pytest
from helpers.support import ROOT

NOTEBOOKS = sorted((ROOT / "configs" / "notebooks").glob("*.ipynb"))
LESSONS = [path for path in NOTEBOOKS if path.stem.startswith("lesson")]


def shown(path, tmp_path):
    """What the cells of a notebook show; a cell that fails ends it."""
    import nbclient
    import nbformat

    shutil.copy(path, tmp_path)
    notebook = nbformat.read(tmp_path / path.name, as_version=4)
    kernel = {"metadata": {"path": tmp_path}}  # where it runs
    nbclient.NotebookClient(notebook, timeout=300, kernel_name="python3", resources=kernel).execute()
    assert list(tmp_path.iterdir()) == [tmp_path / path.name]
    outputs = [output for cell in notebook.cells if cell.cell_type == "code" for output in cell.outputs]
    assert [output.text for output in outputs if output.get("name") == "stderr"] == []
    return outputs


def data(outputs, kind):
    return [output.data[kind] for output in outputs if kind in output.get("data", {})]


def printed(outputs):
    return "".join(output.text for output in outputs if output.get("name") == "stdout")


@pytest.mark.slow
def test_the_first_steps_run(tmp_path):
    outputs = shown(ROOT / "configs" / "notebooks" / "first-steps.ipynb", tmp_path)
    assert len(data(outputs, "image/png")) == 4
    tables = "".join(data(outputs, "text/html"))
    for words in ("Maxwell-Boltzmann", "Z = PA/NT", "pairs, virial", "<th>deviation</th>"):
        assert words in tables
    assert data(outputs, "text/plain").count("True") == 1  # measurement and theory agree
    text = printed(outputs)
    assert "12 points run, 0 done before, 0 failed" in text
    assert "efficiency 0.4" in text


@pytest.mark.slow
@pytest.mark.parametrize("path", LESSONS, ids=lambda path: path.stem)
def test_a_lesson_runs_and_its_physics_holds(path, tmp_path):
    """Each ends with a cell that compares what it has measured with theory."""
    outputs = shown(path, tmp_path)
    assert len(data(outputs, "image/png")) >= 3
    assert printed(outputs).endswith("all checks hold\n")


def test_seven_lessons_have_predictions_checks_questions_and_changes():
    assert len(LESSONS) == 7
    for path in LESSONS:
        text = path.read_text(encoding="utf-8")
        for words in ("45 minutes", "Predict first", "**Expected**", "## Check", "## Questions", "## What to change"):
            assert words in text, (path.name, words)


@pytest.mark.parametrize("path", NOTEBOOKS, ids=lambda path: path.stem)
def test_a_notebook_is_without_results(path):
    """They would be those of another version."""
    text = path.read_text(encoding="utf-8")
    assert text.count('"outputs": []') == text.count('"cell_type": "code"') == text.count('"execution_count": null') > 0
