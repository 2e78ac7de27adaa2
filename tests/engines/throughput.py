#!/usr/bin/env python3
"""One worker of Slurm against two: how many times the cases of one two make in the same time.

Each node has one processor, so that a worker is a task. It takes two cores that are free: where they are
not, nothing is measured and the test fails. Installs Slurm as slurm.py does.
"""

import calendar
import os
import pathlib
import re
import tempfile
import time

from common import CROSSHEAD, crosshead, expect, say, wait_until, write_sweep
from slurm_cluster import Cluster, install

AT_LEAST = 1.8
CASES = 96


def busy(seconds=3):
    """How many processors are at work."""

    def used():
        times = [int(n) for n in pathlib.Path("/proc/stat").read_text().split("\n")[0].split()[1:]]
        return sum(times) - times[3] - times[4], sum(times)

    first = used()
    time.sleep(seconds)
    last = used()
    return os.cpu_count() * (last[0] - first[0]) / (last[1] - first[1])


def begun_and_ended(out):
    """When the first shard was begun, and when the last was made."""
    work = out / "_sweep"
    files = [*work.glob("logs/*.log"), *work.glob("commits/*.json")]
    ended = max(path.stat().st_mtime for path in files if path.suffix == ".json")
    stamps = [re.match(r"\S+", path.read_text())[0] for path in files if path.suffix == ".log"]
    begun = min(calendar.timegm(time.strptime(stamp, "%Y-%m-%dT%H:%M:%SZ")) for stamp in stamps)
    return begun, ended


def rate(folder, sweep, nodes):
    """Cases a second on these nodes."""
    out = folder / f"on-{len(nodes)}"
    crosshead("sweep", "plan", sweep, "--out", out)
    with Cluster(folder / f"cluster-{len(nodes)}", processors=1) as cluster:
        for node in {"n1", "n2"} - set(nodes):
            cluster.client("scontrol", "update", f"nodename={node}", "state=drain", "reason=measured")
        cluster.client(CROSSHEAD, "sweep", "submit", str(out), "--engine", "slurm")
        wait_until(lambda: (out / "manifest.json").exists(), 1800, "a complete dataset")
    begun, ended = begun_and_ended(out)
    found = CASES / (ended - begun)
    say(f"{len(nodes)} worker(s): {CASES} cases in {ended - begun:.1f} s, {found:.2f} a second")
    return found


def main():
    cores, used = os.cpu_count(), busy()
    expect(cores - used > 1.9, f"{used:.1f} of {cores} processors are at work: nothing can be measured")
    install()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        sweep = write_sweep(folder, cases=CASES, shard_size=4, revolutions=200)
        one, two = rate(folder, sweep, ["n1"]), rate(folder, sweep, ["n1", "n2"])
    say(f"two workers make {two / one:.2f} times what one does")
    expect(two >= AT_LEAST * one, f"less than {AT_LEAST}")


if __name__ == "__main__":
    main()
