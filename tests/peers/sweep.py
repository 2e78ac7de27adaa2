"""A sweep of 200 cases x 20 revolutions to Parquet: CPU seconds a case."""

import os
import resource
import shutil
import subprocess

import install

CASES = 200
TOLERANCE = "1e-7"
# Cases that the slow ones run, spread over the same range: the seconds of one case stay the same.
FEW = {"scipy": 10, "scipy_odeint": 40}
# With --quick a quarter of all.
QUICK = 4

SWEEP = """\
name: peers
machine: machine.yaml
seed: 1
run: {{revolutions: 20, transient: 0, sample_rate: 10 kHz, tolerance: {tolerance}, chaos: false}}
cases:
  - random:
      design: sobol
      count: {cases}
      axes:
        joints: [[big_end, small_end]]
        clearance: {{uniform: [0.1 mm, 0.4 mm]}}
"""


def files(cases):
    """Writes the sweep and the shipped machine with the crosshead's acceleration as its only
    sensor, without noise and without the frame, which the peers do not compute either."""
    folder = install.WORK / "sweep"
    folder.mkdir(parents=True, exist_ok=True)
    machine = (install.ROOT / "data" / "machines" / "single-stage.yaml").read_text()
    bodies = machine[:machine.index("\nframe:")]
    (folder / "machine.yaml").write_text(
        bodies + "\nsensors:\n  - measure: crosshead_acceleration\n\neffects: []\n")
    (folder / "sweep.yaml").write_text(SWEEP.format(tolerance=TOLERANCE, cases=cases))
    return folder


def crosshead(command, cases, folder):
    """CPU seconds a case of the whole process, one thread."""
    out = folder / "crosshead"
    shutil.rmtree(out, ignore_errors=True)
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    subprocess.run([*command, folder / "sweep.yaml", "--out", out, "--threads", "1"], check=True,
                   stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, timeout=1800)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    spent = after.ru_utime + after.ru_stime - before.ru_utime - before.ru_stime
    return spent / cases, cases


def peer(script, methods, cases, folder):
    """The least of several methods, without starting Python and compiling."""
    command = [install.PYTHON, install.INTEGRATORS / "write_sweep.py", script, str(cases), TOLERANCE,
               str(folder), *methods]
    done = subprocess.run(command, check=True, capture_output=True, text=True, timeout=1800)
    return min(float(word) for word in done.stdout.split()), cases


def sweeps(installed, quick, say):
    """By name: CPU seconds a case and the cases that were run."""
    share = QUICK if quick else 1
    folder = files(CASES // share)
    found = {}
    ours = os.environ.get("GEN_DATASET") or installed.get("gen-dataset", [None])[0]
    if ours is None:
        say("left out: the sweep by crosshead (cargo build --release --bin gen-dataset first)")
    else:
        say("sweep by crosshead")
        found["crosshead"] = crosshead([ours], CASES // share, folder)
    peers = [("numbalsoda", "with_numbalsoda", ["dop853-restart", "lsoda-restart"]),
             ("scipy", "with_scipy", ["LSODA-restart"]),
             ("scipy_odeint", "with_scipy", ["odeint-restart"])]
    for name, script, methods in peers:
        if script.removeprefix("with_") in installed:
            say(f"sweep by {name}")
            try:
                found[name] = peer(script, methods, FEW.get(name, CASES) // share, folder)
            except (subprocess.SubprocessError, ValueError) as error:
                say(f"left out: the sweep by {name} ({error})")
    return found
