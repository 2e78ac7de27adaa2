"""The notebooks: they hold the cells of their scripts, and run through with few cases."""

import importlib.util
import pathlib

import pytest

NOTEBOOKS = pathlib.Path(__file__).parents[3] / "pipelines" / "notebooks"
SCRIPTS = sorted((NOTEBOOKS / "cells").glob("*.py"))


@pytest.fixture(scope="module")
def make():
    pytest.importorskip("nbformat")
    pytest.importorskip("nbclient")
    spec = importlib.util.spec_from_file_location("make", NOTEBOOKS / "make.py")
    module = importlib.util.module_from_spec(spec)
    spec.loader.exec_module(module)
    return module


def test_there_are_notebooks():
    assert len(SCRIPTS) == 7


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_notebook_is_that_of_its_script(make, script):
    import nbformat

    written = nbformat.read(NOTEBOOKS / f"{script.stem}.ipynb", as_version=4)
    expected = make.notebook(script)
    sources = [[(cell.cell_type, cell.source) for cell in one.cells] for one in (written, expected)]
    assert sources[0] == sources[1], "stale: python pipelines/notebooks/make.py"


@pytest.mark.parametrize("script", SCRIPTS, ids=lambda path: path.stem)
def test_a_notebook_runs_through(make, script, monkeypatch):
    if "import torch" in script.read_text(encoding="utf-8"):
        pytest.importorskip("torch")
    monkeypatch.setenv("CASES", "24")
    monkeypatch.setenv("EPOCHS", "1")
    # Pictures go into the notebook.
    monkeypatch.delenv("MPLBACKEND", raising=False)
    made = make.notebook(script)
    client = make.NotebookClient(made, timeout=1200, resources={"metadata": {"path": str(NOTEBOOKS)}})
    client.execute()
    drawn = [
        output for cell in made.cells for output in cell.get("outputs", []) if output.output_type == "display_data"
    ]
    assert drawn
