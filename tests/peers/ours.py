"""What the scripts of this folder share: one thread, and this project's side of the comparison.

Import it before numpy: the libraries read their number of threads when they are loaded.
"""

import functools
import os
import re
import subprocess
import sys
import time
from pathlib import Path

for variable in ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "NUMBA_NUM_THREADS",
                 "POCL_MAX_PTHREAD_COUNT"):
    os.environ[variable] = "1"
os.environ.setdefault("MPLBACKEND", "Agg")

ROOT = Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "tests"))
TARGET = Path(os.environ.get("CARGO_TARGET_DIR", ROOT / "target"))
SIGNALS = TARGET / "peers-signals"


@functools.cache
def build(crate, example):
    """The path of a crate's example, built for release."""
    command = ["cargo", "build", "--quiet", "--release", "--package", f"crosshead-{crate}", "--example", example]
    subprocess.run(command, cwd=ROOT, check=True)
    return TARGET / "release" / "examples" / example


def samples(chaos, system, length, seed, noise=0.0):
    """The path of a file with one sample per line, written by the example of `chaos`."""
    SIGNALS.mkdir(parents=True, exist_ok=True)
    path = SIGNALS / f"{system}-{length}-{seed}-{noise}.txt"
    arguments = [chaos, "samples", system, str(length), str(seed), str(noise)]
    path.write_text(subprocess.run(arguments, check=True, capture_output=True, text=True).stdout)
    return path


@functools.cache
def measures(*command):
    """Name: (CPU time in s, numbers found) of each line that an example prints."""
    text = subprocess.run([str(c) for c in command], check=True, capture_output=True, text=True).stdout
    found = {}
    for line in text.splitlines():
        name, seconds, numbers = line.split(" ", 2)
        found[name] = float(seconds), [float(n) for n in re.findall(r"[-+.\deE]+", numbers)]
    return found


def cpu_time(work, at_least=1.0):
    """CPU time of one run, s (the least of several), and the result. What takes long runs once."""
    least, spent, result = float("inf"), 0.0, None
    while spent < at_least:
        start = time.process_time()
        result = work()
        passed = time.process_time() - start
        least, spent = min(least, passed), spent + passed
    return least, result


def process(command, runs=9):
    """CPU time of a whole process, s, the least of several."""
    least = float("inf")
    for _ in range(runs):
        child = subprocess.Popen([str(c) for c in command], stdout=subprocess.DEVNULL)
        _, status, usage = os.wait4(child.pid, 0)
        child.returncode = os.waitstatus_to_exitcode(status)
        if child.returncode:
            raise subprocess.CalledProcessError(child.returncode, command)
        least = min(least, usage.ru_utime + usage.ru_stime)
    return least
