#!/usr/bin/env python3
"""A dataset by a real Ray cluster, of which the worker node is killed: the same bytes.

Runs as root, in a network namespace of its own that has loopback and nothing else: elsewhere Ray takes
the machine's own interface whatever address it is given. Needs the packages of requirements-ray.txt.
"""

import os
import pathlib
import signal
import subprocess
import sys
import tempfile
import time

from common import CROSSHEAD, PROJECT, checksums, crosshead, expect, expect_same, say, wait_until, write_sweep

HEAD = "127.0.0.1:6379"


def enter_namespace():
    """Begins this program again where only loopback is."""
    if os.environ.get("CROSSHEAD_ALONE") == "yes":
        subprocess.run(["ip", "link", "set", "lo", "up"], check=True)
        links = subprocess.run(["ip", "-o", "link"], capture_output=True, text=True, check=True)
        expect(links.stdout.count("\n") == 1, f"more than loopback: {links.stdout}")
        return
    os.environ["CROSSHEAD_ALONE"] = "yes"
    os.execvp("unshare", ["unshare", "--net", sys.executable, *sys.argv])


def start(log, *arguments):
    command = [
        str(pathlib.Path(sys.executable).with_name("ray")),
        "start",
        "--node-ip-address=127.0.0.1",
        "--num-cpus=2",
        "--object-store-memory=100000000",
        "--disable-usage-stats",
        "--block",
        *arguments,
    ]
    return subprocess.Popen(command, stdout=log, stderr=log, start_new_session=True)


def raylets():
    """The daemons of the nodes, in the order in which they were started."""
    found = []
    for process in pathlib.Path("/proc").glob("[0-9]*"):
        try:
            if os.readlink(process / "ns/net") != os.readlink("/proc/self/ns/net"):
                continue
            if (process / "comm").read_text().strip() == "raylet":
                found.append(int(process.name))
        except OSError:
            pass
    return sorted(found)


def main():
    enter_namespace()
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        sweep = write_sweep(folder, cases=100, shard_size=5, revolutions=30)
        whole, out = folder / "whole", folder / "ray"
        crosshead("gen-dataset", sweep, "--out", whole)
        crosshead("sweep", "plan", sweep, "--out", out)
        commits = lambda: len(list((out / "_sweep/commits").glob("*.json")))
        with open(folder / "ray.log", "w") as log:
            begun = time.monotonic()
            head = start(log, "--head", "--port=6379", "--include-dashboard=false", f"--temp-dir={folder}/t")
            wait_until(lambda: len(raylets()) == 1, 60, "the head")
            time.sleep(3)
            worker = start(log, f"--address={HEAD}")
            try:
                wait_until(lambda: len(raylets()) == 2, 60, "the worker")
                time.sleep(3)
                say(f"head and worker: {time.monotonic() - begun:.1f} s")
                begun = time.monotonic()
                driver = [sys.executable, str(PROJECT / "pipelines/engines/ray_driver.py"), str(out)]
                driver = subprocess.Popen([*driver, "--address", HEAD, "--program", CROSSHEAD])
                wait_until(lambda: commits() >= 5 or driver.poll() is not None, 200, "five shards")
                os.kill(raylets()[-1], signal.SIGKILL)
                say(f"worker killed after {commits()} of 21 shards")
                expect(driver.wait() == 0, f"the driver ended with {driver.returncode}")
                say(f"complete after {time.monotonic() - begun:.0f} s")
            finally:
                for process in [worker, head]:
                    os.killpg(process.pid, signal.SIGTERM)
                    process.wait()
        crosshead("sweep", "finalize", out, "--verify")
        expect_same(checksums(out), checksums(whole))
        say("every file as gen-dataset makes it")


if __name__ == "__main__":
    main()
