"""The README, word for word: its code runs where `data` and `pipelines` are."""

import os
import pathlib
import re
import subprocess
import sys

import pytest

ROOT = pathlib.Path(__file__).parents[3]
README = (ROOT / "crates" / "python" / "README.md").read_text(encoding="utf-8")


@pytest.fixture
def clone(tmp_path):
    """A folder with data and sweeps, of few cases."""
    (tmp_path / "data").symlink_to(ROOT / "data")
    (tmp_path / "pipelines").mkdir()
    for path in (ROOT / "pipelines").glob("*.yaml"):
        (tmp_path / "pipelines" / path.name).write_text(re.sub(r"count: \d+", "count: 40", path.read_text("utf-8")))
    return tmp_path


def run(code, clone):
    program = [sys.executable, "-W", "error::DeprecationWarning", "-c", code]
    environment = {**os.environ, "MPLBACKEND": "agg"}
    ended = subprocess.run(program, cwd=clone, env=environment, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    return ended.stdout


def blocks(after):
    """The Python code blocks of the section that begins with this heading."""
    section = README[README.index(f"\n## {after}\n") :].split("\n## ")[1]
    return re.findall(r"```python\n(.*?)```", section, re.DOTALL)


def test_what_it_does(clone):
    pytest.importorskip("sklearn")
    (code,) = blocks("What it does")
    shown = run(code, clone)
    # What it prints last, and what it leaves behind.
    assert shown.startswith("AUC 0.") or shown.startswith("AUC 1.")
    assert (clone / "ds" / "manifest.json").exists() and (clone / "calibrated" / "machine.yaml").exists()


def test_without_a_folder(clone):
    (code,) = blocks("Without a folder")
    run(code, clone)
    assert sorted(path.name for path in clone.iterdir()) == ["data", "pipelines"]


def test_a_first_plot_takes_five_lines(clone):
    pytest.importorskip("matplotlib")
    first = re.search(r"```sh\n(.*?)```", README, re.DOTALL).group(1).strip().splitlines()
    assert len(first) <= 5
    prompt = ">>> "
    run("\n".join(line.removeprefix(prompt) for line in first if line.startswith(prompt)), clone)
    assert (clone / "run.png").stat().st_size > 10_000
