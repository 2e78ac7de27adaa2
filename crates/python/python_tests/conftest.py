"""What the tests share: a machine, recordings, a small dataset."""

import pathlib

import crosshead as ch
import pytest

DATA = pathlib.Path(__file__).parents[3] / "data"

SWEEP = """
name: small
machine: {machine}
seed: 7
run: {{revolutions: 4, transient: 2, tolerance: 1e-8, chaos: false}}
shard_size: 6
splits: {{train: 60 %, test: 40 %}}
cases:
  - random:
      count: 12
      axes:
        joints: [[], [big_end], [big_end, small_end]]
        clearance: {{log_uniform: [0.1 mm, 0.3 mm]}}
vary:
  cylinder.exponent: {{normal: {{mean: 1.3, deviation: 0.02}}}}
"""


@pytest.fixture(scope="session")
def machine():
    return DATA / "machines" / "single-stage.yaml"


@pytest.fixture(scope="session")
def diagnosis():
    """Recordings of another program: a healthy machine, and the same with worn joints."""
    return DATA / "recordings" / "example-diagnosis"


@pytest.fixture(scope="session")
def bundle(diagnosis):
    return diagnosis / "healthy"


@pytest.fixture(scope="session")
def worn(machine):
    """A run with a worn small end."""
    return ch.simulate(machine, revolutions=4, **{"joints.small_end.clearance": "0.2 mm"})


@pytest.fixture(scope="session")
def sweep(machine, tmp_path_factory):
    path = tmp_path_factory.mktemp("sweep") / "sweep.yaml"
    path.write_text(SWEEP.format(machine=machine))
    return path


@pytest.fixture(scope="session")
def dataset(sweep, tmp_path_factory):
    return ch.generate(sweep, out=tmp_path_factory.mktemp("datasets") / "small")
