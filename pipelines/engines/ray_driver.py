#!/usr/bin/env python3
"""Makes the shards of a planned dataset on a Ray cluster, and completes it.

    crosshead sweep plan SWEEP.yaml --out URL --shards 100
    python ray_driver.py URL --address HEAD:6379

A shard whose process or node ends is begun again by Ray. All nodes need the Python package `crosshead`, or the program at the
same place (`--program`), and all must see URL. Ray itself has no locks on its doors: use it in a network of your
own.
"""

import argparse
import json
import subprocess
import sys

import ray

ROUNDS = 3


def numbers(ranges):
    """`0-3,7` as numbers."""
    for part in filter(None, ranges.split(",")):
        first, _, last = part.partition("-")
        yield from range(int(first), int(last or first) + 1)


def main():
    parser = argparse.ArgumentParser(description="Makes a planned dataset on a Ray cluster.")
    parser.add_argument("url")
    parser.add_argument("--address", default="auto", help="of the cluster's head")
    parser.add_argument("--program", help="instead of the Python package")
    parser.add_argument("--threads", type=int, default=1, help="processors of each shard")
    asked = parser.parse_args()

    def command(*arguments):
        # Where it is called the interpreter is that of the node.
        program = [asked.program] if asked.program else [sys.executable, "-m", "crosshead"]
        return [*program, "sweep", *arguments]

    def sweep(*arguments):
        return subprocess.run(command(*arguments), text=True, stdout=subprocess.PIPE)

    @ray.remote(
        num_cpus=asked.threads, max_retries=6, retry_exceptions=[subprocess.CalledProcessError]
    )
    def shard(index):
        # A process of its own: a case that ends it does not end Ray's.
        which = ["--index", str(index), "--threads", str(asked.threads)]
        subprocess.run(command("shard", asked.url, *which), check=True)
        return index

    ray.init(address=asked.address, log_to_driver=False)
    for _ in range(ROUNDS):
        missing = json.loads(sweep("status", asked.url, "--json").stdout)["missing"]
        pending = [shard.remote(index) for index in numbers(missing)]
        while pending:
            done, pending = ray.wait(pending)
            for task in done:
                try:
                    print(f"shard {ray.get(task)}: made", flush=True)
                except Exception as error:
                    print(f"a shard failed: {error}", file=sys.stderr, flush=True)
        finalized = sweep("finalize", asked.url)
        if finalized.returncode != 3:
            break
    print(finalized.stdout, end="")
    sys.exit(finalized.returncode)


if __name__ == "__main__":
    main()
