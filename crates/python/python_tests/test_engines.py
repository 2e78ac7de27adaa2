"""Sweeps in steps, by the package's own program: what Slurm and Ray call."""

import os
import pathlib
import subprocess
import sys

import pytest

DRIVER = pathlib.Path(__file__).parents[3] / "pipelines" / "engines" / "ray_driver.py"
PROGRAM = [sys.executable, "-m", "crosshead", "sweep"]

# What the driver uses of Ray, in this process, one task after the other.
RAY = """
class Task:
    def __init__(self, function):
        self.function = function

    def remote(self, *arguments):
        return lambda: self.function(*arguments)

def remote(**options):
    return Task

def init(**options):
    print("address", options["address"])

def wait(pending):
    return pending[:1], pending[1:]

def get(task):
    return task()
"""


@pytest.fixture
def planned(sweep, tmp_path):
    subprocess.run([*PROGRAM, "plan", str(sweep), "--out", str(tmp_path / "ds")], check=True)
    return tmp_path / "ds"


def test_shards_by_the_package_are_the_dataset(planned, dataset):
    for index in ["1", "0"]:
        subprocess.run([*PROGRAM, "shard", str(planned), "--index", index], check=True)
    subprocess.run([*PROGRAM, "finalize", str(planned)], check=True)
    assert (planned / "manifest.json").read_bytes() == (dataset.folder / "manifest.json").read_bytes()


def test_the_driver_for_ray_calls_the_package(planned, dataset, tmp_path):
    (tmp_path / "ray.py").write_text(RAY)
    environment = {**os.environ, "PYTHONPATH": str(tmp_path), "PATH": "/nowhere"}
    driver = [sys.executable, str(DRIVER), str(planned), "--address", "head:6379"]
    ended = subprocess.run(driver, env=environment, capture_output=True, text=True)
    assert ended.returncode == 0, ended.stderr
    assert "address head:6379" in ended.stdout and "shard 1: made" in ended.stdout
    assert (planned / "manifest.json").read_bytes() == (dataset.folder / "manifest.json").read_bytes()


def test_scripts_for_slurm_name_the_program_of_the_package(planned, tmp_path):
    own = pathlib.Path(sys.executable).with_name("crosshead")
    if not own.exists():
        pytest.skip("the package is not installed")
    tools = tmp_path / "slurm"
    tools.mkdir()
    for name, answer in [("sbatch", "echo 17"), ("squeue", ""), ("scancel", "")]:
        (tools / name).write_text(f"#!/bin/sh\n{answer}\n")
        (tools / name).chmod(0o755)
    environment = {**os.environ, "PATH": f"{tools}:{os.environ['PATH']}"}
    submit = [*PROGRAM, "submit", str(planned), "--engine", "slurm"]
    subprocess.run(submit, check=True, env=environment, capture_output=True)
    scripts = [path for path in planned.rglob("*.sh")]
    assert scripts and all(str(own) in script.read_text() for script in scripts)
