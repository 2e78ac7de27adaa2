"""Break system calls of a small sweep, one at a time, and go on with the dataset.

    python system_calls.py system_calls|links

Exit status 1 and a message at the first difference from an undisturbed run. Needs strace.
"""

import os
import pathlib
import shutil
import subprocess
import sys
import tempfile

PROJECT = pathlib.Path(__file__).resolve().parents[2]
CROSSHEAD = os.environ.get("CROSSHEAD", PROJECT / "target/debug/crosshead")
SWEEP = """
name: broken
machine: {machine}
run: {{revolutions: 1, transient: 1, sample_rate: 1 kHz, tolerance: 1e-6, chaos: false}}
shard_size: 2
splits: {{train: 100 %}}
cases:
  - grid: {{speed: [500 rpm, 501 rpm, 502 rpm, 503 rpm]}}
"""
# Those that change what stands in the folder, and locks.
CALLS = ["rename", "link", "linkat", "unlink", "unlinkat", "fsync", "flock", "mkdir", "ftruncate"]


def content(root):
    """Every file that readers see, by path."""
    files = (path for path in root.rglob("*") if path.is_file() and "_sweep" not in path.parts)
    return {path.relative_to(root).as_posix(): path.read_bytes() for path in files}


def expect(holds, what):
    if not holds:
        sys.exit(f"system_calls.py: {what}")


def make(sweep, out, *before):
    command = [*before, CROSSHEAD, "gen-dataset", sweep, "--out", out, "--resume", "--threads", "1"]
    return subprocess.run([str(part) for part in command], capture_output=True, text=True)


def injected(sweep, out, trace, fault):
    """Makes the dataset with a fault, and tells whether the fault happened."""
    made = make(sweep, out, "strace", "-f", "-qq", "-o", trace, "-e", f"trace={fault.split(':')[0]}",
                "-e", f"inject={fault}")
    log = trace.read_text()
    return "INJECTED" in log or "killed by SIGKILL" in log, made


def system_calls(sweep, folder, whole):
    points = 0
    for call in CALLS:
        for action in ["signal=SIGKILL", "error=EIO"]:
            for when in range(1, 1000):
                out, trace = folder / "out", folder / "trace"
                happened, made = injected(sweep, out, trace, f"{call}:{action}:when={when}")
                if not happened:
                    shutil.rmtree(out)
                    break
                points += 1
                what = f"{call}, {action}, call {when}"
                expect("panicked" not in made.stderr, f"{what}: {made.stderr}")
                for path, bytes in content(out).items() if out.exists() else []:
                    is_whole = not path.endswith(".parquet") or bytes == whole[path]
                    expect(is_whole, f"{what}: {path} is not whole")
                resumed = make(sweep, out)
                expect(resumed.returncode == 0, f"{what}: {resumed.stderr}")
                found = content(out)
                differ = [path for path in found.keys() | whole.keys() if found.get(path) != whole.get(path)]
                expect(not differ, f"{what}: other bytes in {differ}")
                shutil.rmtree(out)
    print(f"{points} calls broken, the same bytes after each")


def links(sweep, folder, whole):
    out, trace = folder / "out", folder / "trace"
    faults = ["-e", "inject=link,linkat:error=EPERM"]
    made = make(sweep, out, "strace", "-f", "-qq", "-o", trace, "-e", "trace=link,linkat", *faults)
    expect(made.returncode == 0, made.stderr)
    refused = trace.read_text().count("INJECTED")
    expect(refused > 0, "no link was made")
    expect(content(out) == whole, "other bytes")
    print(f"{refused} links refused, the same bytes")


def main():
    if shutil.which("strace") is None:
        print("strace is missing: nothing was broken")
        sys.exit(77)
    with tempfile.TemporaryDirectory() as folder:
        folder = pathlib.Path(folder)
        sweep = folder / "sweep.yaml"
        sweep.write_text(SWEEP.format(machine=PROJECT / "data/machines/single-stage.yaml"))
        made = make(sweep, folder / "whole")
        expect(made.returncode == 0, made.stderr)
        whole = content(folder / "whole")
        {"system_calls": system_calls, "links": links}[sys.argv[1]](sweep, folder, whole)


if __name__ == "__main__":
    main()
