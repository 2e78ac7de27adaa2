"""Thins the trajectories of the independent reference: every fourth row, all columns.

    python3 thin.py SOURCE_FOLDER

The source is the project's reference folder (MODEL.md, README.md, one CSV a case, reference.json),
computed by three programs written independently of Crosshead; see README.md beside this script.
"""

import pathlib
import shutil
import sys

source = pathlib.Path(sys.argv[1])
here = pathlib.Path(__file__).parent
for path in sorted(source.glob("*.csv")):
    header, *rows = path.read_text().splitlines()
    (here / path.name).write_text("\n".join([header, *rows[::4]]) + "\n")
shutil.copy(source / "reference.json", here / "reference.json")
