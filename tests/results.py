"""Writes what a bench has measured into data/results: CSV, every row with command, date, version and machine."""

import csv
import datetime
import os
import platform
import re
import shlex
import sys
from pathlib import Path

ROOT = Path(__file__).resolve().parents[1]
FOLDER = ROOT / "data" / "results"


def version():
    """The version of this project."""
    text = (ROOT / "Cargo.toml").read_text()
    return re.search(r'^version = "(.+)"', text, re.M).group(1)


def machine():
    """The processor and how many of it there are."""
    model = re.search(r"^model name\s*: (.+)$", Path("/proc/cpuinfo").read_text(), re.M)
    name = model.group(1) if model else platform.processor()
    return f"{name}, {os.cpu_count()} CPUs"


def command():
    """The command line as it is typed in the project's folder."""
    program = Path(sys.argv[0]).resolve().relative_to(ROOT)
    return shlex.join([str(program), *sys.argv[1:]])


def write(name, rows, by=None):
    """Writes `rows`, dictionaries with the same keys, and returns the path of the file. They were made by the command `by`, or
    else by this program."""
    made = {"command": by or command(), "date": datetime.date.today().isoformat(), "version": version(),
            "machine": machine()}
    FOLDER.mkdir(parents=True, exist_ok=True)
    path = FOLDER / name
    with path.open("w", newline="") as file:
        table = csv.DictWriter(file, [*rows[0], *made], lineterminator="\n")
        table.writeheader()
        table.writerows(row | made for row in rows)
    return path
