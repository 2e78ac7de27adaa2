"""What the tests of the engines share: a sweep, the programs, and the comparison of datasets.

The program is target/debug/crosshead, or what CROSSHEAD names.
"""

import hashlib
import os
import pathlib
import signal
import subprocess
import sys
import time

PROJECT = pathlib.Path(__file__).resolve().parents[2]
TARGET = pathlib.Path(os.environ.get("CARGO_TARGET_DIR", PROJECT / "target"))
CROSSHEAD = os.environ.get("CROSSHEAD", str(TARGET / "debug" / "crosshead"))

# Whoever ends a test lets it stop what it started.
signal.signal(signal.SIGTERM, lambda *_: sys.exit("ended"))

SWEEP = """
name: engines
machine: {machine}
seed: 5
run: {{revolutions: {revolutions}, transient: 2, sample_rate: 5 kHz, tolerance: 1e-7, chaos: false}}
shard_size: {shard_size}
splits: {{train: 60 %, validation: 20 %, test: 20 %}}
cases:
  - random:
      count: {cases}
      axes:
        joints: [[], [big_end], [small_end], [big_end, small_end]]
        clearance: {{log_uniform: [0.1 mm, 0.3 mm]}}
        speed: {{uniform: [400 rpm, 600 rpm]}}
bifurcations:
  - {{name: clearance, path: joints.big_end.clearance, from: 0.1 mm, to: 0.2 mm, steps: 3,
     transient: 1, revolutions: 2}}
"""


def write_sweep(folder, cases, shard_size, revolutions=4):
    """The path of a sweep file in `folder`."""
    path = pathlib.Path(folder) / "sweep.yaml"
    machine = PROJECT / "data" / "machines" / "single-stage.yaml"
    path.write_text(
        SWEEP.format(machine=machine, cases=cases, shard_size=shard_size, revolutions=revolutions)
    )
    return path


def crosshead(*arguments, status=0, **options):
    """Runs the program and hands back what it printed."""
    done = subprocess.run(
        [CROSSHEAD, *map(str, arguments)], capture_output=True, text=True, **options
    )
    expect(done.returncode == status, f"{arguments}: {done.returncode}\n{done.stdout}{done.stderr}")
    return done.stdout


def checksums(folder):
    """The files of a dataset that readers see, with their checksums."""
    folder = pathlib.Path(folder)
    files = (path for path in folder.rglob("*") if path.is_file())
    names = {str(path.relative_to(folder)): path for path in files}
    return {
        name: hashlib.sha256(path.read_bytes()).hexdigest()
        for name, path in sorted(names.items())
        if not name.startswith("_sweep/")
    }


def expect_same(found, expected):
    """Two results of `checksums` are equal."""
    expect(found.keys() == expected.keys(), f"files: {found.keys() ^ expected.keys()}")
    differ = [name for name in expected if found[name] != expected[name]]
    expect(not differ, f"other bytes: {differ}")


def expect(holds, message):
    """Ends the test where something does not hold."""
    if not holds:
        sys.exit(f"FAILED: {message}")


def wait_until(holds, seconds, what):
    """Waits until `holds()`, and tells how long that took."""
    begun = time.monotonic()
    while not holds():
        expect(time.monotonic() - begun < seconds, f"{what}: not after {seconds} s")
        time.sleep(0.25)
    return time.monotonic() - begun


def say(text):
    print(text, flush=True)
