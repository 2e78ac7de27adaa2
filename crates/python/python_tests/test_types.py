"""The package is typed."""

import pathlib
import subprocess
import sys

import crosshead
import pytest


def test_the_types_go_together(tmp_path):
    pytest.importorskip("mypy")
    package = pathlib.Path(crosshead.__file__).parent
    checked = subprocess.run(
        [sys.executable, "-m", "mypy", "--ignore-missing-imports", "--disallow-untyped-defs", "-p", "crosshead"],
        capture_output=True,
        text=True,
        cwd=tmp_path,
    )
    assert checked.returncode == 0, checked.stdout
    assert (package / "py.typed").exists()
