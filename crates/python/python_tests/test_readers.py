"""The lines of the README by which other libraries read a dataset, each run as it stands."""

import importlib
import os
import pathlib

import pytest

README = pathlib.Path(__file__).parents[1] / "README.md"

# Read when `datasets` is imported: it is to look nothing up.
os.environ.setdefault("HF_HUB_OFFLINE", "1")


def rows():
    """Library and line of each row of the README's table of readers."""
    text = README.read_text(encoding="utf-8")
    table = text[text.index("| library | line |") :].split("\n\n")[0]
    rows = [[cell.strip(" `") for cell in row.strip("|").split("|")] for row in table.splitlines()[2:]]
    return [pytest.param(library, line, id=f"{library}-{i}") for i, (library, line) in enumerate(rows)]


@pytest.mark.parametrize("library, line", rows())
def test_a_line_reads_the_dataset(library, line, dataset, tmp_path, monkeypatch):
    module = pytest.importorskip(library)
    if library == "pyarrow":
        importlib.import_module("pyarrow.parquet")
    (tmp_path / "ds").symlink_to(dataset.folder)
    monkeypatch.chdir(tmp_path)
    monkeypatch.setenv("HF_DATASETS_CACHE", str(tmp_path / "cache"))
    found = eval(line, {"ds": dataset, library: module})
    rows = {"train": len(dataset.table("train")), "all": len(dataset.features)}
    assert len(found) == rows["train" if "train" in line else "all"]


def test_every_reader_is_listed():
    listed = {parameter.values[0] for parameter in rows()}
    assert {"pandas", "polars", "pyarrow", "duckdb", "datasets", "torch"} <= listed
