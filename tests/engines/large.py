#!/usr/bin/env python3
"""Memory and time of a sweep of a million cases beside one of a thousand.

The first shard is simulated in both. The others are then copies of it, with records of their own, so
that what is measured takes minutes and not days: planning, one shard, completing, and a complete
dataset run again.
"""

import json
import os
import pathlib
import subprocess
import tempfile
import time

from common import CROSSHEAD, PROJECT, expect, say

SWEEP = """
name: tiny
machine: {machine}
run: {{revolutions: 1, transient: 0, sample_rate: 200 Hz, tolerance: 1e-4, chaos: false}}
splits: {{train: 100 %}}
cases:
  - random: {{count: {cases}, axes: {{speed: {{uniform: [400 rpm, 600 rpm]}}}}}}
"""


def measured(*arguments):
    """Runs the program; seconds and megabytes."""
    begun = time.monotonic()
    process = subprocess.Popen([CROSSHEAD, *map(str, arguments)], stdout=subprocess.DEVNULL)
    _, status, used = os.wait4(process.pid, 0)
    process.returncode = os.waitstatus_to_exitcode(status)
    expect(process.returncode == 0, f"{arguments}: {process.returncode}")
    return time.monotonic() - begun, used.ru_maxrss / 1024


def copy_shards(out):
    """Gives every shard the files of the first, and a record of its own."""
    first = json.loads((out / "_sweep/commits/0.json").read_text())
    plan = json.loads((out / "_sweep/plan.json").read_text())
    shards, cases = plan["shards"], plan["cases"]
    (fault,) = first["rows"]["train"]
    for shard in range(1, shards):
        files = []
        for file in first["files"]:
            path = file["path"].replace("-00000-of-", f"-{shard:05d}-of-")
            os.link(out / file["path"], out / path)
            files.append({**file, "path": path})
        end = min((shard + 1) * 256, cases)
        rows = {"train": {fault: end - shard * 256}}
        record = {**first, "shard": shard, "cases": [shard * 256, end], "files": files, "rows": rows}
        (out / f"_sweep/commits/{shard}.json").write_text(json.dumps(record, indent=2) + "\n")


def main():
    peak = {}
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        for cases in [1_000, 1_000_000]:
            sweep, out = folder / f"{cases}.yaml", folder / str(cases)
            machine = PROJECT / "data" / "machines" / "single-stage.yaml"
            sweep.write_text(SWEEP.format(machine=machine, cases=cases))
            steps = {
                "plan": ["sweep", "plan", sweep, "--out", out],
                "shard": ["sweep", "shard", out, "--index", "0", "--threads", "2"],
                "finalize": ["sweep", "finalize", out],
                "again": ["gen-dataset", sweep, "--out", out, "--resume"],
            }
            for step, arguments in steps.items():
                if step == "finalize":
                    copy_shards(out)
                seconds, megabytes = measured(*arguments)
                peak[step, cases] = megabytes
                say(f"{cases} cases, {step}: {seconds:.2f} s, {megabytes:.1f} MB")
                expect(step != "again" or seconds < 2, "a complete dataset takes 2 s to run again")
    largest = {c: max(m for (_, cases), m in peak.items() if cases == c) for c in [1_000, 1_000_000]}
    say(f"largest: {largest[1_000]:.1f} MB and {largest[1_000_000]:.1f} MB")
    expect(largest[1_000_000] <= 1.2 * largest[1_000], "more than 20 % apart")


if __name__ == "__main__":
    main()
