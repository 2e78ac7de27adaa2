#!/usr/bin/env python3
"""A dataset by a real Slurm, of which one node crashes, or loses its network: the same bytes.

Runs as root; installs Slurm from Debian's packages where it is not there.
"""

import pathlib
import re
import tempfile
import time

from common import CROSSHEAD, checksums, crosshead, expect, expect_same, say, wait_until, write_sweep
from slurm_cluster import Cluster, install


def commits(out):
    return len(list((out / "_sweep" / "commits").glob("*.json")))


def wait_for_dataset(cluster, out, seconds):
    def complete():
        cluster.hurry()
        return (out / "manifest.json").exists()

    return wait_until(complete, seconds, "a complete dataset")


def says(out):
    """What the tasks said."""
    return "".join(log.read_text() for log in (out / "_sweep" / "slurm").glob("*.log"))


def crash(folder):
    """One of two nodes crashes midway."""
    sweep = write_sweep(folder, cases=200, shard_size=5, revolutions=30)
    whole, out = folder / "whole", folder / "a crash"
    crosshead("gen-dataset", sweep, "--out", whole)
    crosshead("sweep", "plan", sweep, "--out", out)
    with Cluster(folder / "crash-cluster") as cluster:
        begun = time.monotonic()
        # Several arrays, as where there are more shards than an array can have.
        submit = [CROSSHEAD, "sweep", "submit", out, "--engine", "slurm", "--array-size", "25"]
        said = cluster.client(*map(str, submit))
        expect("41 shards submitted" in said, said)
        wait_until(lambda: commits(out) >= 8, 120, "eight shards")
        status = cluster.client(CROSSHEAD, "sweep", "status", str(out))
        expect("RUNNING" in status and "Dependency" in status, status)
        killed = cluster.crash("n2")
        say(f"n2 crashed after {commits(out)} of 41 shards, with {killed} processes")
        expect(killed > 0, "nothing ran on n2")
        wait_for_dataset(cluster, out, 400)
        say(f"complete after {time.monotonic() - begun:.0f} s")
    crosshead("sweep", "finalize", out, "--verify")
    expect_same(checksums(out), checksums(whole))
    say("every file as gen-dataset makes it")
    return sweep, whole


def cancel(folder, sweep, whole):
    """What is cancelled goes on when it is submitted again; what fails is submitted again by itself."""
    out = folder / "cancel"
    crosshead("sweep", "plan", sweep, "--out", out)
    with Cluster(folder / "cancel-cluster") as cluster:
        command = lambda *a: cluster.client(CROSSHEAD, "sweep", *map(str, a))
        command("submit", out, "--engine", "slurm")
        wait_until(lambda: commits(out) >= 3, 120, "three shards")
        command("cancel", out)
        wait_until(lambda: not cluster.client("squeue", "-h"), 60, "no job")
        made = commits(out)
        expect(made < 41 and not (out / "manifest.json").exists(), f"{made} shards")
        command("submit", out, "--engine", "slurm", "--", "--cpus-per-task=2")
        wait_until(lambda: commits(out) >= made + 3, 120, "three shards more")
        wait_until(lambda: cluster.end_tasks("n1") > 1, 60, "a task to end")
        wait_for_dataset(cluster, out, 400)
    expect_same(checksums(out), checksums(whole))
    rounds = re.findall("shards submitted", says(out))
    say(f"cancelled after {made} shards and submitted again: the same files")
    expect(rounds, "a task was ended, and nothing was submitted again")
    say("a task that was ended was submitted again by the finalising job")


def partition(folder):
    """A node loses its network and goes on alone, while its tasks run again elsewhere."""
    sweep = write_sweep(folder, cases=48, shard_size=8, revolutions=60)
    whole, out = folder / "whole-partition", folder / "partition"
    crosshead("gen-dataset", sweep, "--out", whole)
    crosshead("sweep", "plan", sweep, "--out", out)
    with Cluster(folder / "partition-cluster", network=True) as cluster:
        begun = time.monotonic()
        cluster.client(CROSSHEAD, "sweep", "submit", str(out), "--engine", "slurm")
        wait_until(lambda: len(cluster.payloads("n2")) > 0, 60, "a task on n2")
        cluster.cable("down")
        down = lambda: "down" in cluster.client("sinfo", "-h", "-n", "n2", "-o", "%t")
        seconds = wait_until(down, 90, "n2 down")
        say(f"cable pulled; n2 is down after {seconds:.0f} s")
        cluster.hurry()
        time.sleep(20)
        cluster.cable("up")
        wait_for_dataset(cluster, out, 400)
        say(f"complete after {time.monotonic() - begun:.0f} s")
        wait_until(lambda: not cluster.payloads("n2"), 200, "the end of n2's tasks")
    text = says(out)
    made = re.findall(r"shard (\d+): (?:made|was made)", text)
    twice = sorted({shard for shard in made if made.count(shard) > 1}, key=int)
    expect(twice, f"no shard ran twice: {text}")
    crosshead("sweep", "finalize", out, "--verify")
    expect_same(checksums(out), checksums(whole))
    say(f"shards {', '.join(twice)} came to their end twice; every file as gen-dataset makes it")


def main():
    install()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        sweep, whole = crash(folder)
        cancel(folder, sweep, whole)
        partition(folder)


if __name__ == "__main__":
    main()
