#!/usr/bin/env python3
"""A dataset in object storage: a server process that speaks S3 on this machine, and the same bytes.

Needs the packages of requirements-object-storage.txt. `object_storage.py race` and the like run some of it.
"""

import hashlib
import os
import pathlib
import random
import signal
import socket
import subprocess
import sys
import tempfile
import threading
import time

import boto3
import botocore

from common import CROSSHEAD, PROJECT, checksums, crosshead, expect, expect_same, say, wait_until, write_sweep
from faulty_store import FAULTS, FaultyStore
from slurm_cluster import Cluster, install

ROUNDS, RACERS = 30, 16

# Eight cases of 17 MB each, quickly simulated.
LARGE = """
name: large
machine: {machine}
run: {{revolutions: 60, transient: 0, sample_rate: 200 kHz, tolerance: 1e-5, chaos: false}}
splits: {{train: 100 %}}
cases:
  - grid: {{speed: [500 rpm, 501 rpm, 502 rpm, 503 rpm, 504 rpm, 505 rpm, 506 rpm, 507 rpm]}}
"""


def start_server(log):
    """The server's process and its address."""
    with socket.socket() as probe:
        probe.bind(("127.0.0.1", 0))
        port = probe.getsockname()[1]
    program = pathlib.Path(sys.executable).with_name("moto_server")
    arguments = [program, "-H", "127.0.0.1", "-p", str(port)]
    server = subprocess.Popen(arguments, stdout=log, stderr=log)
    return server, f"http://127.0.0.1:{port}"


def client(address):
    return boto3.client("s3", endpoint_url=address)


def objects(s3, prefix):
    """The keys below `prefix` that readers see, with the checksums of their content."""
    found = {}
    for page in s3.get_paginator("list_objects_v2").paginate(Bucket="data", Prefix=prefix + "/"):
        for item in page.get("Contents", []):
            name = item["Key"].removeprefix(prefix + "/")
            if not name.startswith("_sweep/"):
                body = s3.get_object(Bucket="data", Key=item["Key"])["Body"].read()
                found[name] = hashlib.sha256(body).hexdigest()
    return found


def versions(s3, key):
    """How often `key` was written."""
    answer = s3.list_object_versions(Bucket="data", Prefix=key)
    return len([v for v in answer.get("Versions", []) if v["Key"] == key])


def same_bytes(s3, folder):
    sweep = write_sweep(folder, cases=20, shard_size=4)
    whole = folder / "whole"
    crosshead("gen-dataset", sweep, "--out", whole)
    url = "s3://data/sets/steps"
    crosshead("sweep", "plan", sweep, "--out", url)
    missing = crosshead("sweep", "finalize", url, status=3)
    expect(missing == "0-5\n", missing)
    # Each shard twice at once.
    for index in range(6):
        pair = [
            subprocess.Popen(
                [CROSSHEAD, "sweep", "shard", url, "--index", str(index), "--threads", "1"],
                stdout=subprocess.DEVNULL,
            )
            for _ in range(2)
        ]
        ended = [shard.wait() for shard in pair]
        expect(ended == [0, 0], f"shard {index}: {ended}")
    crosshead("sweep", "finalize", url, "--verify")
    expect_same(objects(s3, "sets/steps"), checksums(whole))
    say(f"in steps: the bytes of gen-dataset in a folder ({len(checksums(whole))} objects)")

    url = "s3://data/sets/one"
    crosshead("gen-dataset", sweep, "--out", url)
    expect_same(objects(s3, "sets/one"), checksums(whole))
    begun = time.monotonic()
    crosshead("gen-dataset", sweep, "--out", url, "--resume")
    say(f"in one process: the same; again: {time.monotonic() - begun:.1f} s")
    crosshead("gen-dataset", sweep, "--out", url, status=2)
    changed = folder / "changed.yaml"
    changed.write_text(sweep.read_text().replace("seed: 5", "seed: 6"))
    crosshead("sweep", "plan", changed, "--out", url, status=2)
    say("a changed sweep is refused")
    return sweep


def slurm(s3, folder):
    """Jobs of a Slurm make a dataset in the bucket; their scripts and logs stand in a folder."""
    install()
    sweep, url, scripts = folder / "sweep.yaml", "s3://data/slurm", folder / "jobs"
    crosshead("sweep", "plan", sweep, "--out", url)
    refused = subprocess.run(
        [CROSSHEAD, "sweep", "submit", url, "--engine", "slurm"], capture_output=True, text=True
    )
    expect(refused.returncode == 2 and "--scripts DIR" in refused.stderr, refused.stderr)
    with Cluster(folder / "cluster") as cluster:
        command = lambda step, *a: cluster.client(
            CROSSHEAD, "sweep", step, url, "--scripts", str(scripts), *a
        )
        command("submit", "--engine", "slurm")
        status = command("status")
        expect("Slurm job" in status, status)
        command("cancel")
        wait_until(lambda: not cluster.client("squeue", "-h"), 60, "no job")
        command("submit", "--engine", "slurm")
        wait_until(lambda: "manifest.json" in objects(s3, "slurm"), 200, "a complete dataset")
    expect_same(objects(s3, "slurm"), checksums(folder / "whole"))
    say("by jobs of Slurm: the same")


def race(s3, folder):
    """Many processes commit one shard at once: one record is written, and all are content."""
    sweep = write_sweep(folder, cases=1, shard_size=1)
    several = 0
    for attempt in range(ROUNDS):
        url = f"s3://data/race/{attempt}"
        crosshead("sweep", "plan", sweep, "--out", url)
        racers = [
            subprocess.Popen(
                [CROSSHEAD, "sweep", "shard", url, "--index", "0", "--threads", "1"],
                stdout=subprocess.PIPE,
                text=True,
            )
            for _ in range(RACERS)
        ]
        said = [racer.communicate()[0] for racer in racers]
        expect(all(racer.returncode == 0 for racer in racers), f"round {attempt}: {said}")
        made = sum("made in" in text for text in said)
        several += made
        key = f"race/{attempt}/_sweep/commits/0.json"
        expect(versions(s3, key) == 1, f"round {attempt}: {versions(s3, key)} winners")
    say(f"{ROUNDS} rounds of {RACERS}: one winner each; {several / ROUNDS:.1f} simulated the shard")


class Nuisance(threading.Thread):
    """A proxy before the server whose connections come late and break off, in requests and in
    answers: puts fail, or are done and said to have failed, and are done again."""

    def __init__(self, address):
        super().__init__(daemon=True)
        self.server = ("127.0.0.1", int(address.rsplit(":", 1)[1]))
        self.door = socket.create_server(("127.0.0.1", 0))
        self.address = f"http://127.0.0.1:{self.door.getsockname()[1]}"
        self.random = random.Random(1)
        self.broken = 0

    def run(self):
        while True:
            client, _ = self.door.accept()
            time.sleep(0.2 * (self.random.random() < 0.1))
            server = socket.create_connection(self.server)
            for source, sink in [(client, server), (server, client)]:
                threading.Thread(target=self.pass_on, args=(source, sink), daemon=True).start()

    def pass_on(self, source, sink):
        try:
            while content := source.recv(1 << 16):
                if self.random.random() < 0.05:
                    self.broken += 1
                    break
                sink.sendall(content)
        except OSError:
            pass
        for end in [source, sink]:
            try:
                end.shutdown(socket.SHUT_RDWR)
            except OSError:
                pass


def until_done(command, environment):
    """Calls a command again while it fails, as a user or a scheduler would; how often that was."""
    calls = 1
    while True:
        done = subprocess.run(command, env=environment, capture_output=True, text=True)
        if done.returncode == 0:
            return calls
        expect(done.returncode == 1, f"{command}: {done.returncode}\n{done.stderr}")
        calls += 1
        expect(calls < 20, f"it never came to an end: {done.stderr}")


def written_once(s3, prefix):
    """The record of each part was written once, and no part of an object is to be seen."""
    for shard in range(6):
        name = f"{shard}.json" if shard < 5 else "bifurcation-clearance.json"
        written = versions(s3, f"{prefix}/_sweep/commits/{name}")
        expect(written == 1, f"{name} was written {written} times")


def nuisance(s3, folder, address):
    """Connections break off and come late: nothing is lost, nothing doubled."""
    sweep = write_sweep(folder, cases=20, shard_size=4)
    proxy = Nuisance(address)
    proxy.start()
    environment = {**os.environ, "AWS_ENDPOINT_URL": proxy.address}
    url = "s3://data/nuisance"
    command = [CROSSHEAD, "gen-dataset", sweep, "--out", url, "--resume"]
    # An upload that breaks off too often ends the program, which goes on when it is called again.
    calls = until_done(command, environment)
    expect_same(objects(s3, "nuisance"), checksums(folder / "whole"))
    written_once(s3, "nuisance")
    expect(proxy.broken > 0, "nothing broke")
    say(f"{proxy.broken} connections broken, {calls} calls: the same bytes, each record written once")


def faults(s3, folder, address):
    """Puts fail, come late and are done twice, and listings are old: nothing is lost, nothing doubled."""
    kept = folder / "calibration"
    kept.mkdir()
    for number in range(3):
        (kept / f"{number}.json").write_text(f"{number}\n")
    sweep = folder / "faults.yaml"
    sweep.write_text(write_sweep(folder, cases=20, shard_size=4).read_text() + "calibrated: calibration\n")
    whole = folder / "whole-faults"
    crosshead("gen-dataset", sweep, "--out", whole)
    store = FaultyStore(address, s3, "data")
    environment = {**os.environ, "AWS_ENDPOINT_URL": store.address}
    url = "s3://data/faults"
    calls = until_done([CROSSHEAD, "sweep", "plan", sweep, "--out", url], environment)
    for index in range(6):
        shard = [CROSSHEAD, "sweep", "shard", url, "--index", str(index), "--threads", "1"]
        # Begun and stopped three times: a listing still has those attempts when the shard is made.
        for _ in range(3 if index == 0 else 0):
            stopped = subprocess.Popen(shard, env=environment, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL)
            time.sleep(0.3)
            stopped.send_signal(signal.SIGINT)
            stopped.wait()
        calls += until_done(shard, environment)
    calls += until_done([CROSSHEAD, "sweep", "finalize", url], environment)
    crosshead("sweep", "finalize", url, "--verify")
    expect_same(objects(s3, "faults"), checksums(whole))
    written_once(s3, "faults")
    for fault in [*FAULTS, "stale listings"]:
        expect(store.counts[fault] > 0, f"no fault of the kind {fault}: {store.counts}")
    logs = s3.list_objects_v2(Bucket="data", Prefix="faults/_sweep/logs/")["KeyCount"]
    expect(logs >= 6, f"{logs} logs")
    store.close()
    said = ", ".join(f"{count} {fault}" for fault, count in sorted(store.counts.items()))
    say(f"{said}; {calls} calls for 8 steps: the same bytes, each record written once")


def kill(s3, folder):
    """A process is killed while it sends a large object in parts: nobody sees any of it."""
    sweep = folder / "large.yaml"
    sweep.write_text(LARGE.format(machine=PROJECT / "data" / "machines" / "single-stage.yaml"))
    url = "s3://data/kill"
    crosshead("sweep", "plan", sweep, "--out", url)
    shard = subprocess.Popen([CROSSHEAD, "sweep", "shard", url, "--index", "0"])
    uploads = lambda: s3.list_multipart_uploads(Bucket="data").get("Uploads", [])
    seconds = wait_until(lambda: uploads() or shard.poll() is not None, 300, "an upload in parts")
    expect(shard.poll() is None, "the shard was made before it was killed")
    shard.send_signal(signal.SIGKILL)
    shard.wait()
    expect(uploads(), "no upload was left")
    expect(set(objects(s3, "kill")) == {"sweep.yaml"}, f"{objects(s3, 'kill').keys()}")
    say(f"killed after {seconds:.1f} s, with an upload under way: no object to be seen")


def main():
    os.environ.update(
        AWS_ACCESS_KEY_ID="test",
        AWS_SECRET_ACCESS_KEY="test",
        AWS_REGION="us-east-1",
        AWS_DEFAULT_REGION="us-east-1",
        AWS_ALLOW_HTTP="true",
    )
    # A few of them by name, or all.
    asked = sys.argv[1:] or ["slurm", "race", "nuisance", "faults", "kill"]
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        with open(folder / "server.log", "w") as log:
            server, address = start_server(log)
        try:
            os.environ["AWS_ENDPOINT_URL"] = address
            s3 = client(address)

            def answers():
                try:
                    s3.create_bucket(Bucket="data")
                    return True
                except botocore.exceptions.EndpointConnectionError:
                    return False

            wait_until(answers, 60, "the server")
            versioning = {"Status": "Enabled"}
            s3.put_bucket_versioning(Bucket="data", VersioningConfiguration=versioning)
            same_bytes(s3, folder)
            for name in asked:
                {
                    "slurm": lambda: slurm(s3, folder),
                    "race": lambda: race(s3, folder),
                    "nuisance": lambda: nuisance(s3, folder, address),
                    "faults": lambda: faults(s3, folder, address),
                    "kill": lambda: kill(s3, folder),
                }[name]()
        finally:
            server.terminate()
            server.wait()


if __name__ == "__main__":
    main()
